#pragma once

namespace withheld {

/// Unlisted structure comes from two families of generators that share no shape: what poecal's numbers are set on is drawn from the first,
/// what is told of it from the second.
enum class Family { first, second };

}  // namespace withheld
