// poecal fleet: the results of many captures in one table.
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "fleet.hpp"
#include "poecal/core/text.hpp"

namespace poecal::app {
namespace {

constexpr const char* kExample = R"(
Example:
  $ poecal fleet results/* --out fleet.csv
                        nominal  registered  identified
  name       pictures        px          px          px        mm  warnings  diagnosis
  cell-1        60/60     3.042       3.125       0.005     0.046         0  nothing
  cell-2        80/80     3.239       3.150       0.179     1.352         0  joint_coupling at joint:6 (ratio 0.0009735, source 5); gap shrinks by 70 %
  cell-3        80/80     3.467       3.453       0.209     1.304         0  joint_backlash at joint:2 (half_gap 0.0002968 rad); gap shrinks by 77 %
  cell-4        80/80         -           -           -         -         0  -
  4 captures in fleet.csv
The figures are on poses that the fit did not see; of cell-4 only `measure` was run.
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
