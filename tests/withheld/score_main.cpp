// withheld_score DIR --poecal PATH: runs `poecal diagnose` on every case below DIR, then opens the truths and prints how it did.
#include <algorithm>
#include <atomic>
#include <exception>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "withheld/poecal_runs.hpp"
#include "withheld/tables.hpp"

namespace {

namespace fs = std::filesystem;
using namespace withheld;

/// Folders of the cases below a folder, in the order of their names.
std::vector<fs::path> caseFolders(const fs::path& root) {
  const std::string ending = ".truth.json";
  std::vector<fs::path> folders;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root)) {
    const std::string path = entry.path().string();
    if (path.ends_with(ending)) folders.emplace_back(path.substr(0, path.size() - ending.size()));
  }
  std::sort(folders.begin(), folders.end());
  return folders;
}

Scored score(const std::string& poecal, const fs::path& folder, bool predict) {
  Scored scored;
  scored.truth = readTruth(folder.string() + ".truth.json");
  const fs::path file = folder / "out" / "diagnosis.json";
  scored.answered = fs::exists(file);
  if (scored.answered) scored.answer = readAnswer(file);
  scored.verdict = judge(scored.truth, scored.answer);
  scored.seconds = secondsOf(folder / "out").value_or(0.0);
  scored.identify_seconds = secondsOf(folder / "identified").value_or(0.0);
  if (predict && scored.answered && !scored.truth.effects.empty()) {
    scored.before_px = rmsOnUnseen(poecal, folder, "identified").value_or(0.0);
    scored.after_px = rmsOnUnseen(poecal, folder, "out").value_or(0.0);
  }
  return scored;
}

/// Calls work(i) for 0 .. count - 1 from some threads. @throws what work throws, the last of it
template <typename Work>
void forEach(std::size_t count, unsigned jobs, const Work& work) {
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::exception_ptr failure;
  std::vector<std::thread> threads;
  for (unsigned job = 0; job < jobs; ++job) {
    threads.emplace_back([&] {
      try {
        for (std::size_t i = next++; i < count; i = next++) work(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        failure = std::current_exception();
        next = count;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace

int main(int argc, char** argv) {
  std::string root, poecal, table;
  unsigned jobs = 1;
  bool no_predict = false;
  CLI::App app("Scores `poecal diagnose` on cases of withheld_world. Answers that are there already are not asked for again");
  app.add_option("folder", root, "Cases, at any depth")->required()->check(CLI::ExistingDirectory);
  app.add_option("--poecal", poecal, "The program under test")->required();
  app.add_option("--jobs", jobs, "Cases at a time")->check(CLI::Range(1, 64));
  app.add_option("--table", table, "Writes the tables to this file too");
  app.add_flag("--no-predict", no_predict, "Does not measure the shrinkage");
  CLI11_PARSE(app, argc, argv);

  try {
    const std::vector<fs::path> folders = caseFolders(root);
    // All answers first: no truth is opened before the last one is given.
    forEach(folders.size(), jobs, [&](std::size_t i) { diagnose(poecal, folders[i]); });
    std::vector<Scored> cases(folders.size());
    forEach(folders.size(), jobs, [&](std::size_t i) { cases[i] = score(poecal, folders[i], !no_predict); });
    const std::string text = tables(cases);
    fmt::print("{}", text);
    if (!table.empty()) std::ofstream(table) << text;
  } catch (const std::exception& error) {
    fmt::print(stderr, "withheld_score: {}\n", error.what());
    return 3;
  }
  return 0;
}
