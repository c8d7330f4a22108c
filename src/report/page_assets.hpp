// What the page is made of beside data: files of src/report/page and the library that draws the charts, taken in when poecal is built.
#pragma once

#include <string_view>

namespace poecal {

struct PageAssets {
  std::string_view html;     ///< with {{name}} where the other parts go
  std::string_view style;    ///< CSS
  std::string_view program;  ///< JavaScript of a report, all files one after the other
  std::string_view fleet;    ///< JavaScript of the page of a fleet
  std::string_view d3;       ///< D3 5, minified; empty where it was not there
  std::string_view licence;  ///< of D3
};
const PageAssets& pageAssets();

}  // namespace poecal
