// What Google Benchmark measured, kept for tables; and the memory that a piece of work needs.
#pragma once

#include <map>
#include <string>

#include <benchmark/benchmark.h>

namespace poecal::benchmarks {

struct Measured {
  double seconds = 0.0;                    ///< processor time of one iteration, least of the repetitions
  std::map<std::string, double> counters;  ///< of the last repetition
};

/// Collects instead of printing, but for a line on stderr when each is done.
class Collector : public ::benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context& context) override;
  void ReportRuns(const std::vector<Run>& runs) override;
  /// By the name it ran under, "bundle/1000". @throws std::out_of_range where it did not run.
  const Measured& at(const std::string& name) const { return measured_.at(name); }
  bool ran(const std::string& name) const { return measured_.contains(name); }

 private:
  std::map<std::string, Measured> measured_;
};

/// Largest memory of the process since its making, less what there was then [MB].
class PeakMemory {
 public:
  PeakMemory();
  double megabytes() const;

 private:
  double before_ = 0.0;
};

}  // namespace poecal::benchmarks
