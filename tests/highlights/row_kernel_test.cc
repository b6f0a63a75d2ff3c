#include "highlights/row_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "highlights/samples_around.h"

namespace glint {
namespace {

// Rows shorter than a vector, of whole vectors, and with some left over.
class RowKernel : public ::testing::TestWithParam<size_t> {
 protected:
  std::vector<uint16_t> Row(int values) {
    std::vector<uint16_t> row(GetParam() + 64, 0);
    for (size_t i = 0; i < GetParam(); ++i) row[i] = static_cast<uint16_t>(random_() % values * (65536 / values));
    return row;
  }

  std::mt19937 random_{5};
};

TEST_P(RowKernel, SmoothsAndSubtracts) {
  const std::vector<uint16_t> a = Row(65536), b = Row(65536), c = Row(65536);
  std::vector<uint16_t> smooth(GetParam()), difference(GetParam());
  internal::SmoothRow(a.data(), b.data(), c.data(), GetParam(), smooth.data());
  internal::SubtractRow(a.data(), b.data(), GetParam(), difference.data());
  for (size_t i = 0; i < GetParam(); ++i) {
    EXPECT_NEAR(smooth[i], b[i] * 2 / 3.0 + (a[i] + c[i]) / 6.0, 2);
    EXPECT_EQ(difference[i], std::max(0, a[i] - b[i]));
  }
}

TEST_P(RowKernel, LeastOfThree) {
  std::vector<uint8_t> in(3 * GetParam()), out(GetParam());
  for (uint8_t& value : in) value = static_cast<uint8_t>(random_());
  internal::LeastOfThreeRow(in.data(), GetParam(), out.data());
  for (size_t i = 0; i < GetParam(); ++i) EXPECT_EQ(out[i], std::min({in[3 * i], in[3 * i + 1], in[3 * i + 2]}));
}

TEST_P(RowKernel, MaximaAreAboveAllNeighbours) {
  const std::vector<uint16_t> above = Row(8), row = Row(8), below = Row(8);
  std::vector<int> expected, found(GetParam());
  for (size_t x = 1; x + 1 < GetParam(); ++x) {
    const uint16_t before = std::max({above[x - 1], above[x], above[x + 1], row[x - 1]});
    const uint16_t after = std::max({below[x - 1], below[x], below[x + 1], row[x + 1]});
    if (row[x] > 20000 && row[x] > before && row[x] >= after) expected.push_back(static_cast<int>(x));
  }
  found.resize(internal::RowMaxima(above.data(), row.data(), below.data(), GetParam(), 20000, found.data()));
  EXPECT_EQ(found, expected);
}

INSTANTIATE_TEST_SUITE_P(Rows, RowKernel, ::testing::Values(3, 12, 64, 203));

TEST(BitsAbove, OfSixtyFourValues) {
  std::mt19937 random(1);
  std::vector<uint16_t> values(64);
  for (uint16_t& value : values) value = static_cast<uint16_t>(random());
  uint64_t expected = 0;
  for (size_t i = 0; i < 64; ++i) expected |= uint64_t{values[i] > 40000} << i;
  EXPECT_EQ(internal::BitsAbove(values.data(), 40000), expected);
}

TEST(SamplesAround, AreRanked) {
  std::mt19937 random(2);
  for (size_t count = 1; count <= SamplesAround::kMost; ++count) {
    SamplesAround samples;
    std::vector<uint16_t> sorted;
    for (size_t k = 0; k < count; ++k) {
      sorted.push_back(static_cast<uint16_t>(random() % 40 * 1680));
      samples.Put(sorted.back());
    }
    std::sort(sorted.begin(), sorted.end());
    for (size_t rank = 0; rank < count; ++rank) EXPECT_EQ(samples.Ranked(rank), sorted[rank]);
  }
}

}  // namespace
}  // namespace glint
