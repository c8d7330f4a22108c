// Every reader of a file keeps its promise to whatever bytes come: it reads them, or says in one line what is wrong with the file.
#include <algorithm>
#include <cstdlib>
#include <regex>
#include <set>
#include <sstream>

#include <gmock/gmock.h>

#include "fuzz/mutator.hpp"
#include "fuzz/readers.hpp"
#include "support/temp_folder.hpp"

namespace poecal::test {

void PrintTo(const Reader& reader, std::ostream* stream) { *stream << reader.name; }

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kSeed = 20261126;

/// Inputs for a reader: $POECAL_FUZZ_INPUTS, or as many as make a minute for all.
std::size_t inputCount(const Reader& reader) {
  constexpr std::size_t kUsual = 1500;
  const char* asked = std::getenv("POECAL_FUZZ_INPUTS");
  return std::max<std::size_t>(1, (asked != nullptr ? std::stoul(asked) : kUsual) / reader.cost);
}

class FuzzedReader : public ::testing::TestWithParam<Reader> {
 protected:
  FuzzedReader() { writeCell(folder_.path()); }

  /// Feeds one input. What it did wrong is told with the input, which is kept.
  bool feedOne(const std::string& name, const std::string& bytes) {
    try {
      return feed(GetParam(), folder_.path(), bytes);
    } catch (const std::exception& fault) {
      const fs::path kept = fs::path(::testing::TempDir()) / (GetParam().name + "-" + name);
      writeTextFile(kept, bytes);
      ADD_FAILURE() << name << ", kept in " << kept << ": " << fault.what();
      return false;
    }
  }

  TempFolder folder_;
};

TEST_P(FuzzedReader, TakesItsCorpus) {
  const std::vector<Seed> seeds = seedsOf(GetParam());
  ASSERT_FALSE(seeds.empty());
  std::size_t taken = 0;
  for (const Seed& seed : seeds) taken += feedOne(seed.name, seed.bytes) ? 1 : 0;
  EXPECT_GT(taken, 0u) << "what is all refused shows nothing";
}

TEST_P(FuzzedReader, StandsWhateverComes) {
  std::vector<std::string> known;
  for (const Seed& seed : seedsOf(GetParam())) known.push_back(seed.bytes);
  const Mutator mutator(known);
  for (std::size_t k = 0; k < inputCount(GetParam()) && !HasFailure(); ++k) {
    Rng rng(kSeed, k);
    feedOne(std::to_string(k), mutator.mutated(rng));
  }
}

INSTANTIATE_TEST_SUITE_P(Each, FuzzedReader, ::testing::ValuesIn(readers()), [](const auto& instance) { return instance.param.name; });

/// Names of functions of the public headers that read files.
std::set<std::string> readingFunctions() {
  std::set<std::string> names;
  const std::regex declaration(R"((?:^|[ &>])(read[A-Z]\w*)\((?:const )?[^)]*(?:path|Source)[&\w ]*)");
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(POECAL_SOURCE_DIR) / "include")) {
    if (!entry.is_regular_file()) continue;
    std::istringstream lines(readTextFile(entry.path()));
    for (std::string line; std::getline(lines, line);) {
      std::smatch found;
      if (line.find("//") > line.find("read") && std::regex_search(line, found, declaration)) names.insert(found[1]);
    }
  }
  return names;
}

TEST(FuzzedReaders, AreAllThatReadFiles) {
  std::set<std::string> fuzzed;
  for (const Reader& reader : readers()) {
    std::istringstream functions(reader.functions);
    for (std::string name; functions >> name;) fuzzed.insert(name);
  }
  const std::set<std::string> all = readingFunctions();
  EXPECT_GE(all.size(), 20u) << "the headers are searched";
  for (const std::string& name : all) EXPECT_TRUE(fuzzed.contains(name)) << name << "() is in no reader of tests/fuzz/readers.cpp";
}

TEST(Mutator, MakesTheSameOfTheSameSeed) {
  const Mutator mutator({"a: 1\nb: [2, 3]\n", "c,d\n4,5\n"});
  std::set<std::string> different;
  for (std::uint64_t k = 0; k < 200; ++k) {
    Rng first(1, k), second(1, k);
    const std::string text = mutator.mutated(first);
    EXPECT_EQ(text, mutator.mutated(second));
    different.insert(text);
  }
  EXPECT_GT(different.size(), 150u);
}

}  // namespace
}  // namespace poecal::test
