#include "core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <stdexcept>

#include "core/cancel_scope.h"
#include "core/error.h"

namespace glint {
namespace {

TEST(Parallel, ForVisitsEveryIndexOnce) {
  for (size_t count : {0u, 1u, 7u, 1000u}) {
    std::vector<std::atomic<int>> visits(count);
    ParallelFor(count, 16, [&](size_t i) { ++visits[i]; });
    for (const auto& v : visits) EXPECT_EQ(v, 1);
  }
}

TEST(Parallel, ChunksDoNotDependOnThreads) {
  for (int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    std::vector<size_t> begin_of(100);
    ParallelChunks(100, 7, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) begin_of[i] = begin;
    });
    for (size_t i = 0; i < 100; ++i) EXPECT_EQ(begin_of[i], i / 7 * 7);
  }
}

TEST(Parallel, SumIsTheSameAtAnyNumberOfThreads) {
  // Terms of very different size: the order of the additions shows in the last bits.
  const auto value = [](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = begin; i < end; ++i)
      sum += std::pow(-1.7, static_cast<double>(i % 60)) / static_cast<double>(i + 1);
    return sum;
  };
  std::vector<double> sums;
  for (int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    sums.push_back(ParallelSum(100000, 128, 0.0, value));
  }
  EXPECT_EQ(sums[0], sums[1]);
  EXPECT_EQ(sums[0], sums[2]);
}

TEST(Parallel, ThreadLimitHoldsWhileItLives) {
  {
    const ThreadLimit limit(1);
    EXPECT_EQ(NumThreads(), 1);
  }
  EXPECT_GE(NumThreads(), 1);
}

TEST(Parallel, ExceptionsReachTheCaller) {
  EXPECT_THROW(ParallelFor(100, 1,
                           [](size_t i) {
                             if (i == 42) throw std::runtime_error("42");
                           }),
               std::runtime_error);
}

// Cancelled from the outside, or by the work itself after some steps.
class Wish : public Progress {
 public:
  bool Cancelled() const override { return cancelled; }
  std::atomic<bool> cancelled = false;
};

TEST(CancelScope, LoopsEndBetweenChunks) {
  Wish wish;
  std::atomic<int> done = 0;
  const auto work = [&] {
    ParallelFor(1000000, 1, [&](size_t) {
      if (++done == 100) wish.cancelled = true;
    });
  };
  {
    const CancelScope scope(wish);
    EXPECT_THROW(work(), CancelledError);
  }
  EXPECT_LT(done, 10000);
  EXPECT_NO_THROW(ParallelFor(10, 1, [](size_t) {})) << "out of the scope nobody is asked";
}

TEST(CancelScope, HoldsInLoopsWithinLoopsOnWhateverThread) {
  Wish wish;
  std::atomic<int> asked = 0, inner = 0;
  const CancelScope scope(wish);
  EXPECT_THROW(ParallelFor(64, 1,
                           [&](size_t) {
                             asked += &CancelScope::Current() == &wish;
                             ParallelFor(1000000, 1, [&](size_t) {
                               if (++inner == 100) wish.cancelled = true;
                             });
                           }),
               CancelledError);
  EXPECT_GT(asked, 0);
  EXPECT_LT(inner, 10000);
  EXPECT_EQ(&CancelScope::Current(), &wish);
}

TEST(CancelScope, TheInnermostIsAsked) {
  Wish outer, inner;
  outer.cancelled = true;
  const CancelScope outside(outer);
  {
    const CancelScope inside(inner);
    EXPECT_NO_THROW(ParallelFor(10, 1, [](size_t) {}));
  }
  EXPECT_THROW(ParallelFor(10, 1, [](size_t) {}), CancelledError);
}

}  // namespace
}  // namespace glint
