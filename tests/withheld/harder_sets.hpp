// Sets of what real recordings have: structure that no effect describes beside a listed one or alone, large effects, few poses, three
// effects, the camera in hand, columns that nobody recorded.
#pragma once

#include <map>
#include <string>

#include "withheld/case.hpp"

namespace withheld {

using MakeSet = void (*)(Case&, Chance&);

/// By name.
const std::map<std::string, MakeSet>& harderSets();

}  // namespace withheld
