#include "report/page_text.hpp"

#include "report/page_assets.hpp"

namespace poecal {
namespace {

/// `html` with each {{name}} replaced, once, so that nothing in a part is taken for a place of another.
std::string filled(std::string_view html, const std::map<std::string, std::string_view, std::less<>>& parts) {
  std::string text;
  for (std::size_t at = 0; at < html.size();) {
    const std::size_t open = html.find("{{", at), close = open == std::string_view::npos ? open : html.find("}}", open);
    if (close == std::string_view::npos) return text.append(html.substr(at));
    text.append(html.substr(at, open - at));
    text.append(parts.at(std::string(html.substr(open + 2, close - open - 2))));
    at = close + 2;
  }
  return text;
}

}  // namespace

std::string inScript(const std::string& json) {
  std::string text;
  text.reserve(json.size() + json.size() / 16);
  for (std::size_t k = 0; k < json.size(); ++k) {
    const char c = json[k];
    const bool line_end = json.compare(k, 3, "\xE2\x80\xA8") == 0 || json.compare(k, 3, "\xE2\x80\xA9") == 0;
    if (c == '<') {
      text += "\\u003c";
    } else if (c == '>') {
      text += "\\u003e";
    } else if (c == '&') {
      text += "\\u0026";
    } else if (line_end) {
      text += json[k + 2] == '\xA8' ? "\\u2028" : "\\u2029";
      k += 2;
    } else {
      text += c;
    }
  }
  return text;
}

std::string pageText(std::string_view program, std::string_view data, std::string_view pictures) {
  const PageAssets& assets = pageAssets();
  return filled(assets.html, {{"style", assets.style},
                              {"program", program},
                              {"d3", assets.d3},
                              {"licence", assets.licence},
                              {"data", data},
                              {"pictures", pictures}});
}

}  // namespace poecal
