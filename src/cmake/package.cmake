# The installed package: find_package(poecal) gives the target poecal::poecal.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/poecal)

install(TARGETS poecal EXPORT poecal_targets FILE_SET HEADERS)
install(EXPORT poecal_targets NAMESPACE poecal:: FILE poecal-targets.cmake DESTINATION ${package_dir})

# What poecal names privately an archive leaves to its user's linker; a shared library has linked it already.
set(link_dependencies "")
get_target_property(library_type poecal TYPE)
if(library_type STREQUAL "STATIC_LIBRARY")
  set(link_dependencies "
find_dependency(OpenCV 4.6 COMPONENTS ${POECAL_OPENCV_MODULES})
find_dependency(apriltag)
find_dependency(Ceres 2.1)
find_dependency(yaml-cpp)
find_dependency(urdfdom)
find_dependency(tinyxml2)
find_dependency(fmt)
find_dependency(TBB)")
endif()
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/poecal-config.cmake @ONLY CONTENT [=[
include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.4 NO_MODULE)@link_dependencies@
include("${CMAKE_CURRENT_LIST_DIR}/poecal-targets.cmake")
]=])
write_basic_package_version_file(${PROJECT_BINARY_DIR}/poecal-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/poecal-config.cmake ${PROJECT_BINARY_DIR}/poecal-config-version.cmake DESTINATION ${package_dir})
