#include "poecal/core/parallel.hpp"

#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

namespace poecal {
namespace {

using ::testing::ThrowsMessage;

TEST(ParallelFor, DoesEachItemOnceWhateverTheNumberOfThreads) {
  for (const int jobs : {1, 2, 0}) {
    std::vector<int> done(1000, 0);
    parallelFor(done.size(), jobs, [&](std::size_t i) { ++done[i]; });
    EXPECT_EQ(done, std::vector<int>(1000, 1));
  }
}

TEST(ParallelFor, ThrowsTheExceptionOfTheLowestItemWhateverTheNumberOfThreads) {
  const auto work = [](std::size_t i) {
    if (i % 100 == 37) throw std::runtime_error(std::to_string(i));
  };
  for (const int jobs : {1, 2, 0}) EXPECT_THAT([&] { parallelFor(1000, jobs, work); }, ThrowsMessage<std::runtime_error>("37"));
}

TEST(ParallelFor, StopsAtAFailure) {
  int done = 0;
  const auto work = [&](std::size_t i) {
    if (i == 37) throw std::runtime_error("stop");
    ++done;
  };
  EXPECT_THROW(parallelFor(1000, 1, work), std::runtime_error);
  EXPECT_EQ(done, 37);  // one thread goes in order
}

}  // namespace
}  // namespace poecal
