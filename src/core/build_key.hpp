// Which build this is.
#pragma once

#include <string_view>

namespace poecal {

/// 64 hexadecimal digits that change with the sources, the compiler, its flags and the libraries. The same sources built the same way have
/// the same key, on whatever machine. Defined in a file that CMake writes (src/cmake/build_key.cmake).
std::string_view buildKey();

}  // namespace poecal
