// withheld_world --set SET --cases N --seed S --out DIR: cases for `poecal diagnose`, their answers sealed beside them.
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "withheld/baselines.hpp"
#include "withheld/case.hpp"
#include "withheld/injected.hpp"

int main(int argc, char** argv) {
  std::string set = "single", folder, real;
  std::uint64_t seed = 1, cases = 10;
  unsigned jobs = 1;
  bool compare = false, second_family = false;
  CLI::App app("Makes cases of the withheld world: DIR/NNNN/capture for poecal, DIR/NNNN/unseen and DIR/NNNN.truth.json for the scorer");
  std::vector<std::string> sets = withheld::setNames();
  sets.emplace_back(withheld::kInjectedSet);
  app.add_option("--set", set, "Which set")->check(CLI::IsMember(sets))->required();
  app.add_option("--cases", cases, "How many")->required();
  app.add_option("--seed", seed, "The same seed gives the same cases")->required();
  app.add_option("--out", folder, "Where to")->required();
  app.add_option("--real", real, "Folder of the real recordings, for the set injected");
  app.add_flag("--baselines", compare, "Notes beside the truth what simple diagnoses would have said");
  app.add_flag("--second-family", second_family, "Draws unlisted structure from the second family of generators");
  app.add_option("--jobs", jobs, "Threads")->check(CLI::Range(1, 64));
  CLI11_PARSE(app, argc, argv);

  std::atomic<std::uint64_t> next = 0;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    try {
      for (std::uint64_t number = next++; number < cases; number = next++) {
        if (set == withheld::kInjectedSet) {
          withheld::writeInjectedCase(real, seed, number, folder);
          continue;
        }
        withheld::Case made = withheld::makeCase(set, seed, number, second_family ? withheld::Family::second : withheld::Family::first);
        if (compare) made.baselines = withheld::baselines(made);
        withheld::writeCase(made, folder);
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      failure = std::current_exception();
      next = cases;
    }
  };
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < jobs; ++i) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
  try {
    if (failure) std::rethrow_exception(failure);
  } catch (const std::exception& error) {
    fmt::print(stderr, "withheld_world: {}\n", error.what());
    return 3;
  }
  return 0;
}
