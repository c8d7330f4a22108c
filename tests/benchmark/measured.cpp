#include "benchmark/measured.hpp"

#include <malloc.h>

#include <algorithm>
#include <fstream>

#include <fmt/format.h>

namespace poecal::benchmarks {
namespace {

/// A line of /proc/self/status, in MB.
double statusOf(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(key + ":")) return std::stod(line.substr(key.size() + 1)) / 1024.0;
  }
  return 0.0;
}

}  // namespace

bool Collector::ReportContext(const Context&) { return true; }

void Collector::ReportRuns(const std::vector<Run>& runs) {
  for (const Run& run : runs) {
    if (run.run_type != Run::RT_Iteration) continue;
    const double seconds = run.cpu_accumulated_time / static_cast<double>(run.iterations);
    const std::string name = run.run_name.function_name + (run.run_name.args.empty() ? "" : "/" + run.run_name.args);
    const auto [entry, is_new] = measured_.try_emplace(name, Measured{seconds, {}});
    if (!is_new) entry->second.seconds = std::min(entry->second.seconds, seconds);
    for (const auto& [counter, value] : run.counters) entry->second.counters[counter] = value.value;
    fmt::print(stderr, "{}: {:.4f} s\n", name, seconds);
  }
}

PeakMemory::PeakMemory() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";  // the peak starts again from here
  before_ = statusOf("VmRSS");
}

double PeakMemory::megabytes() const { return statusOf("VmHWM") - before_; }

}  // namespace poecal::benchmarks
