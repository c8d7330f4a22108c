// report.html in a browser: every chart is drawn, nothing is complained of, nobody is asked for anything, names stay text.
#include <algorithm>
#include <regex>
#include <sstream>

#include <gmock/gmock.h>

#include "poecal/core/text.hpp"
#include "poecal/report/fleet_page.hpp"
#include "poecal/report/report.hpp"
#include "report/report_cells.hpp"
#include "support/program.hpp"
#include "support/temp_folder.hpp"

namespace poecal {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr const char* kBrowser = "/usr/bin/chromium";

/// What a browser made of a page.
struct Opened {
  std::string dom;       ///< after its program ran
  std::string console;   ///< lines of its console
  std::string requests;  ///< that the page made, as the browser noted them
};

std::string linesWith(const std::string& text, const std::string& word) {
  std::string lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    if (line.find(word) != std::string::npos) lines += line + '\n';
    begin = end + 1;
  }
  return lines;
}

Opened openPage(const std::string& html, const test::TempFolder& folder) {
  folder.write("report.html", html);
  const test::ProgramRun run = test::runShell(
      folder.path(), std::string(kBrowser) +
                         " --headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking"
                         " --host-resolver-rules='MAP * ~NOTFOUND' --disable-component-update --disable-sync --disable-extensions "
                         "--user-data-dir=profile --enable-logging=stderr"
                         " --log-net-log=net.json --virtual-time-budget=10000 --dump-dom report.html");
  EXPECT_EQ(run.status, 0) << run.err;
  Opened opened{run.out, linesWith(run.err, "CONSOLE"), ""};
  // The browser's own requests have no origin. Names are not looked up, so that none of them leaves the machine.
  std::istringstream net(linesWith(readTextFile(folder.path() / "net.json"), "\"initiator\":"));
  for (std::string line; std::getline(net, line);) {
    if (line.find("\"initiator\":\"not an origin\"") == std::string::npos) opened.requests += line + '\n';
  }
  return opened;
}

/// The value of an attribute of the page's root.
std::string rootAttribute(const std::string& dom, const std::string& name) {
  std::smatch match;
  return std::regex_search(dom, match, std::regex(name + "=\"([^\"]*)\"")) ? match[1].str() : "";
}

struct NamedRun {
  const char* name;
  CalibrationRun (*run)();
  std::vector<const char*> charts;  ///< some of those that it must have
};

std::ostream& operator<<(std::ostream& stream, const NamedRun& named) { return stream << named.name; }

class InABrowser : public ::testing::TestWithParam<NamedRun> {};

TEST_P(InABrowser, EveryChartIsDrawnAndNobodyIsAsked) {
  if (!std::filesystem::exists(kBrowser)) GTEST_SKIP() << "no " << kBrowser << " (apps/install-dependencies.sh --ci)";
  if (!reportBuilt()) GTEST_SKIP() << "built without D3";
  const test::TempFolder folder;
  const Opened opened = openPage(reportHtml(reportJson(GetParam().run(), ""), {}, 1), folder);
  EXPECT_THAT(opened.console, IsEmpty());
  EXPECT_THAT(opened.requests, IsEmpty());
  const std::string charts = rootAttribute(opened.dom, "data-charts");
  EXPECT_EQ(rootAttribute(opened.dom, "data-drawn"), charts);
  for (const char* chart : GetParam().charts) EXPECT_THAT(" " + charts + " ", HasSubstr(" " + std::string(chart) + " "));
  // The name of the arm, as text: had it become markup, its tag would stand here as one.
  EXPECT_THAT(opened.dom, HasSubstr("&lt;/script&gt;&lt;img src=x onerror=alert(1)&gt;&amp;amp;{{data}}"));
  EXPECT_THAT(opened.dom, Not(HasSubstr("<img")));
}

INSTANTIATE_TEST_SUITE_P(
    Reports, InABrowser,
    ::testing::Values(
        NamedRun{"Diagnosed",
                 [] { return test::runWithBacklash(); },
                 {"ladder", "curve-0", "rivals-0", "space", "sample", "sample-near", "field-before", "field-after", "driver-0", "lens",
                  "uncertainty-side", "coverage-joints", "coverage-picture", "parameters-tilts", "detectable-0"}},
        NamedRun{"NothingFound", [] { return test::runWithout(); }, {"ladder", "space", "field-after", "lens", "detectable-0"}},
        NamedRun{"CurveWithoutAName", [] { return test::runWithCurve(); }, {"ladder", "curve-0", "rivals-0", "space"}},
        NamedRun{"RandomMotion", [] { return test::runWithScatter(); }, {"ladder", "curve-0", "rivals-0", "space"}},
        NamedRun{"IdentifiedOnly", [] { return test::identifiedOnly(); }, {"ladder", "space", "field-after", "parameters-shifts"}},
        NamedRun{"PosesOfAnInstrument", [] { return test::runOfPoses(); }, {"ladder", "space", "sample", "driver-0", "coverage-joints"}}),
    [](const auto& instance) { return std::string(instance.param.name); });

/// A page that does by itself what its user may: moves every slider, chooses every option, presses every button and key, picks points.
std::string usedByItself(std::string html) {
  const std::string user = R"(<script>
    const every = (what) => Array.from(document.querySelectorAll(what));
    for (const slider of every('input[type=range]')) {
      for (const value of [slider.min, slider.max]) { slider.value = value; slider.dispatchEvent(new Event('input')); }
    }
    for (const choice of every('select')) {
      for (const option of choice.options) { choice.value = option.value; choice.dispatchEvent(new Event('change')); }
    }
    for (const pressed of every('button')) pressed.click();
    for (const key of ['ArrowLeft', 'ArrowUp', 'ArrowRight', 'ArrowDown']) {
      document.getElementById('chart-space').dispatchEvent(new KeyboardEvent('keydown', {key, bubbles: true, cancelable: true}));
    }
    for (const row of ['0', '1', '2']) document.querySelector('circle[data-row="' + row + '"]').dispatchEvent(new MouseEvent('click', {bubbles: true}));
    window.dispatchEvent(new Event('beforeprint'));
    const empty = charts.filter((chart) => chart.svg.childElementCount === 0).length;
    document.documentElement.dataset.used = empty + ' empty, row ' + picked.row + ', ' + document.documentElement.dataset.theme;
  </script>)";
  return html.insert(html.rfind("</body>"), user);
}

TEST(Browser, EveryControlWorks) {
  if (!std::filesystem::exists(kBrowser)) GTEST_SKIP() << "no " << kBrowser << " (apps/install-dependencies.sh --ci)";
  if (!reportBuilt()) GTEST_SKIP() << "built without D3";
  for (const CalibrationRun& run : {test::runWithBacklash(), test::runOfPoses()}) {
    const test::TempFolder folder;
    const Opened opened = openPage(usedByItself(reportHtml(reportJson(run, ""), {}, 1)), folder);
    EXPECT_THAT(opened.console, IsEmpty());
    EXPECT_EQ(rootAttribute(opened.dom, "data-used"), "0 empty, row 2, dark");  // it begins light, and the button was pressed once
  }
}

/// Captures of which one is not more than a name.
std::vector<ResultSummary> fleet() {
  ResultSummary flawed, bare;
  flawed.name = test::kHostileName;
  flawed.folder = bare.folder = "nowhere";
  flawed.stages = {{"nominal", 3.0, 3.5, 7.0}, {"registered", 2.9, 3.4, 6.0}, {"identified", 0.2, 0.05, 2.0}};
  flawed.verdict = "effects";
  flawed.findings = {{"joint_backlash", "joint:2", "half_gap 0.0004 rad"}};
  flawed.diagnosed = StageErrors{"identified + joint_backlash@joint:2", 0.1, 0.01, 0.3};
  flawed.warnings = {test::kHostileName};
  bare.name = "bare";
  return {flawed, bare};
}

TEST(Browser, DrawsEveryCellOfAFleet) {
  if (!std::filesystem::exists(kBrowser)) GTEST_SKIP() << "no " << kBrowser << " (apps/install-dependencies.sh --ci)";
  if (!reportBuilt()) GTEST_SKIP() << "built without D3";
  const test::TempFolder folder;
  const Opened opened = openPage(fleetHtml(fleet(), folder.path() / "fleet.html"), folder);
  EXPECT_THAT(opened.console, IsEmpty());
  EXPECT_THAT(opened.requests, IsEmpty());
  EXPECT_EQ(rootAttribute(opened.dom, "data-charts"), "cell-0 cell-1");
  EXPECT_EQ(rootAttribute(opened.dom, "data-drawn"), "cell-0 cell-1");
  EXPECT_THAT(opened.dom, HasSubstr("2 captures: 1 with findings, 0 with none, 1 without a diagnosis"));
  EXPECT_THAT(opened.dom, HasSubstr("joint_backlash at joint 2 (half_gap 0.0004 rad)"));
  EXPECT_THAT(opened.dom, Not(HasSubstr("<img")));
}

// That the tests above can fail: a page whose program throws, and one that asks for a picture.
TEST(Browser, TellsOfWhatItComplains) {
  if (!std::filesystem::exists(kBrowser)) GTEST_SKIP() << "no " << kBrowser << " (apps/install-dependencies.sh --ci)";
  const test::TempFolder folder;
  const Opened broken = openPage("<!DOCTYPE html><script>throw new Error('broken');</script>", folder);
  EXPECT_THAT(broken.console, HasSubstr("broken"));
  const Opened asking = openPage("<!DOCTYPE html><img src=\"http://127.0.0.1:9/x.png\">", folder);
  EXPECT_THAT(asking.requests, HasSubstr("127.0.0.1:9/x.png"));
}

}  // namespace
}  // namespace poecal
