#include "poecal/core/progress.hpp"

#include <stdexcept>
#include <tuple>

#include <gmock/gmock.h>

#include "poecal/core/parallel.hpp"

namespace poecal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using Told = std::tuple<std::string, std::size_t, std::size_t>;

class Jobs : public ::testing::Test {
 protected:
  ProgressFunction listening() {
    return [this](const std::string& label, std::size_t done, std::size_t total) { told_.emplace_back(label, done, total); };
  }
  std::vector<Told> told_;
};

TEST_F(Jobs, AreToldPieceByPiece) {
  {
    Progress progress(listening(), "job", 2);
    progress.show();
    progress.advance();
    progress.advance();
    progress.show();
  }
  EXPECT_THAT(told_, ElementsAre(Told{"job", 0, 2}, Told{"job", 1, 2}, Told{"job", 2, 2}));
}

TEST_F(Jobs, OfManyThreadsAreToldOneAtATime) {
  constexpr std::size_t kPieces = 500;
  Progress progress(listening(), "job", kPieces);
  parallelFor(kPieces, 4, [&](std::size_t) { progress.advance(); });
  ASSERT_EQ(told_.size(), kPieces);
  for (std::size_t k = 0; k < kPieces; ++k) EXPECT_EQ(told_[k], Told("job", k + 1, kPieces));
}

TEST_F(Jobs, ThatNeedFewerPiecesEndAllTheSame) {
  {
    Progress progress(listening(), "job", 9);
    progress.advance();
    progress.finish();
    progress.finish();
  }
  EXPECT_THAT(told_, ElementsAre(Told{"job", 1, 9}, Told{"job", 9, 9}));
}

TEST_F(Jobs, ThatFailSaySo) {
  const auto job = [this] {
    Progress progress(listening(), "job", 2);
    progress.advance();
    throw std::runtime_error("broken");
  };
  EXPECT_THAT(job, ::testing::ThrowsMessage<std::runtime_error>("broken"));
  EXPECT_THAT(told_, ElementsAre(Told{"job", 1, 2}, Told{"job", 0, 0}));
}

TEST_F(Jobs, WithoutAListenerAreDoneInSilence) {
  Progress progress({}, "job", 2);
  progress.show();
  progress.advance();
  progress.finish();
  EXPECT_THAT(told_, IsEmpty());
}

// Whoever wants to stop throws at every call: at the one that says that the job has failed too.
TEST(Listeners, ThatAlwaysThrowStopTheJobWithTheirFirstException) {
  int calls = 0;
  const ProgressFunction always = [&calls](const std::string&, std::size_t, std::size_t) {
    throw std::runtime_error("call " + std::to_string(++calls));
  };
  const auto job = [&] {
    Progress outer(always, "outer", 2);
    Progress inner(always, "inner", 2);
    inner.advance();
  };
  EXPECT_THAT(job, ::testing::ThrowsMessage<std::runtime_error>("call 1"));
  EXPECT_EQ(calls, 3);
}

TEST(Listeners, ThatThrowAtTheEndOfAFailureDoNotHideIt) {
  const ProgressFunction at_the_end = [](const std::string&, std::size_t, std::size_t total) {
    if (total == 0) throw std::logic_error("second");
  };
  const auto job = [&] {
    const Progress progress(at_the_end, "job", 1);
    throw std::runtime_error("first");
  };
  EXPECT_THAT(job, ::testing::ThrowsMessage<std::runtime_error>("first"));
}

}  // namespace
}  // namespace poecal
