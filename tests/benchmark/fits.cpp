// Time of the fits: `bundle` against the same problem in Ceres, and how every stage grows with the number of poses.
#include <algorithm>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "benchmark/ceres_bundle.hpp"
#include "benchmark/measured.hpp"
#include "diagnosis/small_cell.hpp"
#include "poecal/registration/registration.hpp"

namespace poecal {
namespace {

using benchmarks::Collector;
using benchmarks::PeakMemory;

constexpr double kCornerSigma = 0.1;  // [px]

/// A simulated capture, registered; made once for each number of poses.
struct Capture {
  test::SmallCell small;
  Cell stated;
  Measurements measurements;
  RegistrationResult registration;
};

const Capture& captureOf(int poses) {
  static std::map<int, Capture> made;
  const auto [entry, is_new] = made.try_emplace(poses);
  Capture& capture = entry->second;
  if (is_new) {
    capture.small = test::smallCell(1, poses, kCornerSigma, {});
    capture.stated = capture.small.cell;
    capture.stated.arm = capture.small.nominal;
    capture.measurements = capture.small.measurements();
    capture.registration = registerCell(capture.stated, capture.small.observations, {});
  }
  return capture;
}

AdjustmentOptions bundleOptions(const Cell& cell, bool camera_free) {
  AdjustmentOptions options;
  options.free = {.twists = true, .near = true, .far = true, .intrinsics = camera_free};
  options.twists = TwistPrior(*cell.arm, 1e-3, 3e-3);
  options.robust = false;
  options.scale = 1.0;
  if (camera_free) {
    options.camera_prior_sigma = Eigen::VectorXd::Constant(cell.camera->parameterCount(), 0.1);
    options.camera_prior_sigma.head<4>().setConstant(10.0);
  }
  return options;
}

Cell registeredCell(const Capture& capture) { return capture.registration.cell; }

void bundle(::benchmark::State& state, bool camera_free) {
  const Capture& capture = captureOf(static_cast<int>(state.range(0)));
  const Cell start = registeredCell(capture);
  const AdjustmentOptions options = bundleOptions(start, camera_free);
  for ([[maybe_unused]] auto _ : state) {
    const Adjustment fit = adjust(start, capture.small.observations, options);
    state.counters["iterations"] = static_cast<double>(fit.steps.size()) - 1.0;
  }
}

/// Largest difference of any number that both found, twists [rad, m], transforms and, where free, the lens (relative to its focal length
/// where pixels).
double difference(const Adjustment& ours, const benchmarks::CeresBundle& theirs) {
  const Registration &a = ours.cell.registration, &b = theirs.registration;
  double largest = (ours.beta - theirs.beta).cwiseAbs().maxCoeff();
  largest = std::max(largest, (a.T_camera_near.matrix() - b.T_camera_near.matrix()).cwiseAbs().maxCoeff());
  largest = std::max(largest, (a.T_far_target.matrix() - b.T_far_target.matrix()).cwiseAbs().maxCoeff());
  Eigen::VectorXd lens = (ours.cell.camera->parameters() - theirs.camera).cwiseAbs();
  lens.head<4>() /= ours.cell.camera->fx;
  return std::max(largest, lens.maxCoeff());
}

void ceresBundle(::benchmark::State& state, bool camera_free) {
  const Capture& capture = captureOf(static_cast<int>(state.range(0)));
  const Cell start = registeredCell(capture);
  const AdjustmentOptions options = bundleOptions(start, camera_free);
  benchmarks::CeresBundle found;
  for ([[maybe_unused]] auto _ : state) found = benchmarks::solveWithCeres(start, capture.small.observations, options);
  state.counters["iterations"] = found.iterations;
  state.counters["difference"] = found.converged ? difference(adjust(start, capture.small.observations, options), found) : 1.0;
}

/// One stage as the program calls it, cross-validation included.
void stage(::benchmark::State& state, const std::string& name) {
  const Capture& capture = captureOf(static_cast<int>(state.range(0)));
  const std::vector<Observation>& observations = capture.small.observations;
  IdentifyOptions options;
  Identification identified;
  if (name == "diagnose") {
    identified = identify(capture.stated, capture.measurements, options, &capture.registration);
  } else if (name != "measure") {
    options.method = methodFromName(name);
  }
  const PeakMemory memory;
  for ([[maybe_unused]] auto _ : state) {
    if (name == "measure") {
      ::benchmark::DoNotOptimize(registerCell(capture.stated, observations, {}));
    } else if (name == "diagnose") {
      ::benchmark::DoNotOptimize(diagnose(identified, capture.measurements));
    } else {
      ::benchmark::DoNotOptimize(identify(capture.stated, capture.measurements, options, &capture.registration));
    }
  }
  state.counters["megabytes"] = memory.megabytes();
}

const char* const kStages[] = {"measure", "gao", "weighted", "bundle", "diagnose"};

void registerAll(bool quick) {
  const auto once = [](::benchmark::internal::Benchmark* entry, int repetitions) {
    entry->Iterations(1)->Repetitions(repetitions)->UseRealTime()->Unit(::benchmark::kSecond);
  };
  for (const bool camera_free : {false, true}) {
    const std::string end = camera_free ? " with camera" : "";
    once(::benchmark::RegisterBenchmark(("fit" + end).c_str(), bundle, camera_free)->Arg(quick ? 100 : 1000), quick ? 1 : 5);
    once(::benchmark::RegisterBenchmark(("Ceres" + end).c_str(), ceresBundle, camera_free)->Arg(quick ? 100 : 1000), quick ? 1 : 3);
  }
  for (const char* name : kStages) {
    for (const int poses : quick ? std::vector<int>{100} : std::vector<int>{100, 1000, 10000}) {
      once(::benchmark::RegisterBenchmark(name, stage, std::string(name))->Arg(poses), quick ? 1 : 3);
    }
  }
}

/// @return whether both always found the same.
bool printCeresTable(const Collector& collector, int poses) {
  constexpr double kSame = 1e-9;
  bool same = true;
  fmt::print(
      "One fit of `bundle` to {} poses (4 corners each), processor time of one thread, against Ceres with automatic derivatives.\n\n",
      poses);
  fmt::print("| free | poecal [ms] | Ceres [ms] | ratio | largest difference |\n|---|---|---|---|---|\n");
  for (const bool camera_free : {false, true}) {
    const std::string end = fmt::format("{}/{}", camera_free ? " with camera" : "", poses);
    const auto &ours = collector.at("fit" + end), &theirs = collector.at("Ceres" + end);
    same = same && theirs.counters.at("difference") < kSame;
    fmt::print("| twists, both transforms{} | {:.1f} ({:.0f} steps) | {:.1f} ({:.0f} steps) | {:.1f} | {:.0e} |\n",
               camera_free ? ", lens" : "", 1e3 * ours.seconds, ours.counters.at("iterations"), 1e3 * theirs.seconds,
               theirs.counters.at("iterations"), theirs.seconds / ours.seconds, theirs.counters.at("difference"));
  }
  fmt::print("\n");
  return same;
}

void printStageTable(const Collector& collector) {
  fmt::print("Processor time and memory of each stage, cross-validation included, one thread.\n\n");
  fmt::print(
      "| stage | 100 poses [s] | 1,000 [s] | 10,000 [s] | from 1,000 to 10,000 | memory at 10,000 [MB] |\n|---|---|---|---|---|---|\n");
  for (const std::string name : kStages) {
    std::string row = fmt::format("| `{}` |", name);
    for (const int poses : {100, 1000, 10000}) {
      const std::string key = fmt::format("{}/{}", name, poses);
      row += collector.ran(key) ? fmt::format(" {:.3f} |", collector.at(key).seconds) : " |";
    }
    if (collector.ran(name + "/10000")) {
      const auto& most = collector.at(name + "/10000");
      row += fmt::format(" {:.1f} | {:.0f} |", most.seconds / collector.at(name + "/1000").seconds, most.counters.at("megabytes"));
    } else {
      row += " | |";
    }
    fmt::print("{}\n", row);
  }
  fmt::print("\n");
}

int run(bool quick) {
  registerAll(quick);
  Collector collector;
  ::benchmark::RunSpecifiedBenchmarks(&collector);
  const bool same = printCeresTable(collector, quick ? 100 : 1000);
  printStageTable(collector);
  if (!same) fmt::print(stderr, "poecal and Ceres found different minima\n");
  return same ? 0 : 1;
}

}  // namespace
}  // namespace poecal

int main(int argc, char** argv) {
  const bool quick = argc > 1 && std::strcmp(argv[1], "--quick") == 0;
  int no_arguments = 1;
  ::benchmark::Initialize(&no_arguments, argv);
  return poecal::run(quick);
}
