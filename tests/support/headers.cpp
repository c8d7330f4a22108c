// The source that the precompiled headers of the tests want to belong to.
