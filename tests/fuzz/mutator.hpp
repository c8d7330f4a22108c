// Changes files as bad luck and bad will do. The same seed gives the same changes on every machine.
#pragma once

#include <string>
#include <vector>

#include "poecal/core/random.hpp"

namespace poecal::test {

class Mutator {
 public:
  /// @param known  files of the kind, whole ones: words, lines and pieces of them are put into others.
  explicit Mutator(std::vector<std::string> known);

  /// One of the known files with one to four changes: of bits, bytes, numbers, words, lines, cells of a table, its beginning or its end.
  std::string mutated(Rng& rng) const;
  /// `text` with one change.
  std::string changed(const std::string& text, Rng& rng) const;

 private:
  std::vector<std::string> known_, words_;
};

}  // namespace poecal::test
