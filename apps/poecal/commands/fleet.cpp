// poecal fleet: the results of many captures in one table.
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "fleet.hpp"
#include "poecal/core/text.hpp"

namespace poecal::app {
namespace {

constexpr const char* kExample = R"(
Example:
  $ poecal fleet results/* --out fleet.csv
)";

}  // namespace

std::function<int()> setUpFleet(CLI::App& app, const Common& common) {
  struct Options {
    std::vector<std::filesystem::path> folders;
    std::filesystem::path out;
  };
  const auto options = std::make_shared<Options>();
  app.add_option("OUT", options->folders, "Result folders, one a capture: what `run`, or its stages, wrote")->required();
  app.add_option("--out", options->out, "The table to write (fleet.csv)")->required();
  app.footer(kExample);
  return [options, &common] {
    std::vector<FleetRow> rows;
    for (const std::filesystem::path& folder : options->folders) rows.push_back(readFleetRow(folder));
    writeTextFile(options->out, fleetCsv(rows));
    printSummary(common, fleetText(rows) + fmt::format("{} captures in {}\n", rows.size(), options->out.string()),
                 {{"captures", rows}, {"file", options->out.string()}});
    return 0;
  };
}

}  // namespace poecal::app
