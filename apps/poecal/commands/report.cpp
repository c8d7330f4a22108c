// poecal report: results of a capture as one page.
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "poecal/report/report.hpp"
#include "terminal.hpp"

namespace poecal::app {
namespace {

constexpr const char* kExample = R"(
Example:
  $ poecal report out
  out/report.html
`run` writes the page by itself; after `identify` or `diagnose` this does. It opens from the file in any browser, without a network.
)";

}  // namespace

std::function<int()> setUpReport(CLI::App& app, const Common& common) {
  const auto folder = std::make_shared<std::filesystem::path>();
  app.add_option("OUT", *folder, "Folder that `run`, `identify` or `diagnose` wrote")->required();
  app.footer(kExample);
  return [folder, &common] {
    TerminalListener listener(common);
    renderReport(*folder, common.jobs, listener.progressFunction());
    const std::string page = (*folder / "report.html").string();
    printSummary(common, page + "\n", {{"file", page}});
    return 0;
  };
}

}  // namespace poecal::app
