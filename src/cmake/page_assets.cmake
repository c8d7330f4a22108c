# The page of the report: its own files under src/report/page, and D3 of Debian's node-d3, which is taken in when poecal is built and never
# committed. Included, this adds the source that holds them; run as a script (cmake -P), it writes that source.
if(CMAKE_SCRIPT_MODE_FILE)
  function(literal name)
    set(content "")
    foreach(file IN LISTS ARGN)
      file(READ "${file}" part)
      if(part MATCHES "</script" AND NOT file MATCHES "[.]html$")
        message(FATAL_ERROR "${file} ends the script element that it stands in")
      endif()
      string(APPEND content "${part}")
    endforeach()
    set(${name} "R\"asset(${content})asset\"" PARENT_SCOPE)
  endfunction()
  literal(html "${PAGE}/page.html")
  literal(style "${PAGE}/style.css")
  literal(program ${PROGRAM})
  literal(fleet "${PAGE}/frame.js" "${PAGE}/fleet.js")
  literal(licence "${PAGE}/d3-licence.txt")
  literal(d3 ${D3})
  file(WRITE "${OUTPUT}" "#include \"report/page_assets.hpp\"

namespace poecal {

const PageAssets& pageAssets() {
  static const PageAssets kAssets{${html}, ${style}, ${program}, ${fleet}, ${d3}, ${licence}};
  return kAssets;
}

}  // namespace poecal
")
  return()
endif()

set(page "${PROJECT_SOURCE_DIR}/src/report/page")
# In the order in which they run; the first belongs to both pages.
set(page_program "")
foreach(name frame core ladder findings residuals arm sample workspace tables main)
  list(APPEND page_program "${page}/${name}.js")
endforeach()
find_file(POECAL_D3 d3.min.js PATHS /usr/share/nodejs/d3/dist NO_DEFAULT_PATH DOC "D3 5, minified, as Debian's node-d3 has it")
set(d3_begin "")
if(EXISTS "${POECAL_D3}")
  file(READ "${POECAL_D3}" d3_begin LIMIT 100)
endif()
if(d3_begin MATCHES "d3js.org v5[.]")
  set(d3 "${POECAL_D3}")
else()
  set(d3 "")
  message(WARNING "D3 5 is not there (POECAL_D3), so that `poecal report` will say that it is not built: apps/install-dependencies.sh installs it")
endif()
set(page_assets "${CMAKE_CURRENT_BINARY_DIR}/page_assets.cpp")
add_custom_command(OUTPUT "${page_assets}"
  COMMAND "${CMAKE_COMMAND}" -D "PAGE=${page}" -D "PROGRAM=${page_program}" -D "D3=${d3}" -D "OUTPUT=${page_assets}" -P "${CMAKE_CURRENT_LIST_FILE}"
  DEPENDS ${page_program} "${page}/fleet.js" ${d3} "${page}/page.html" "${page}/style.css" "${page}/d3-licence.txt" "${CMAKE_CURRENT_LIST_FILE}"
  COMMENT "Taking in the page of the report"
  VERBATIM)
target_sources(poecal PRIVATE "${page_assets}")
