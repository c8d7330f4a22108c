# The key of what the library and the program are built from: sources, compiler, flags and libraries. It is part of the key of every result
# that is kept, so that no build takes what another one made for its own. Included, it adds the source that holds the key; run as a script
# (cmake -P), it writes that source.
if(CMAKE_SCRIPT_MODE_FILE)
  file(GLOB_RECURSE sources LIST_DIRECTORIES false RELATIVE "${SOURCE_DIR}" "${SOURCE_DIR}/src/*.[ch]pp" "${SOURCE_DIR}/include/*.hpp" "${SOURCE_DIR}/apps/poecal/*.[ch]pp")
  list(SORT sources)
  set(all "${FACTS}")
  foreach(source IN LISTS sources)
    file(SHA256 "${SOURCE_DIR}/${source}" hash)
    string(APPEND all "\n${source} ${hash}")
  endforeach()
  string(SHA256 key "${all}")
  file(CONFIGURE OUTPUT "${OUTPUT}" CONTENT [[
#include "core/build_key.hpp"

namespace poecal {

std::string_view buildKey() { return "@key@"; }

}  // namespace poecal
]] @ONLY)
  return()
endif()

string(TOUPPER "${CMAKE_BUILD_TYPE}" configuration)
set(facts "${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION} ${CMAKE_SYSTEM_PROCESSOR} ${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${configuration}}")
foreach(package Eigen3 OpenCV apriltag Ceres)
  string(APPEND facts " ${package} ${${package}_VERSION}")
endforeach()
file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/*.[ch]pp" "${PROJECT_SOURCE_DIR}/include/*.hpp" "${PROJECT_SOURCE_DIR}/apps/poecal/*.[ch]pp")
set(build_key "${CMAKE_CURRENT_BINARY_DIR}/build_key.cpp")
add_custom_command(OUTPUT "${build_key}"
  COMMAND "${CMAKE_COMMAND}" -D "SOURCE_DIR=${PROJECT_SOURCE_DIR}" -D "OUTPUT=${build_key}" -D "FACTS=${facts}" -P "${CMAKE_CURRENT_LIST_FILE}"
  DEPENDS ${sources} "${CMAKE_CURRENT_LIST_FILE}"
  COMMENT "Writing the key of this build"
  VERBATIM)
target_sources(poecal PRIVATE "${build_key}")
