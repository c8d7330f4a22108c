// Pages as text: a template with data and the page's own files in it.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace poecal {

/// JSON that stands in a script element: nothing in it can end that, or be taken for the end of a line.
std::string inScript(const std::string& json);

/// The page of this program, style and library with data. @param data, pictures  as inScript() gives them.
std::string pageText(std::string_view program, std::string_view data, std::string_view pictures);

}  // namespace poecal
