#include "core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <stdexcept>

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

}  // namespace
}  // namespace glint
