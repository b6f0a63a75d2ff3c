// Rows of pixels, as many at a time as the machine can.
#pragma once

#include <cstddef>
#include <cstdint>

namespace glint::internal {

// Two thirds of the middle and a sixth of either side: a Gaussian of 0.6 pixels. `out` is none of the others.
void SmoothRow(const uint16_t* before, const uint16_t* middle, const uint16_t* after, size_t count, uint16_t* out);

// a - b, or 0. `out` is none of the others.
void SubtractRow(const uint16_t* a, const uint16_t* b, size_t count, uint16_t* out);

// The least of three interleaved values.
void LeastOfThreeRow(const uint8_t* in, size_t count, uint8_t* out);

// Columns, but for the first and the last, where `row` is above the threshold and above all its neighbours; of equal
// neighbours the first counts. Returns how many. The rows have room for 64 values more.
size_t RowMaxima(const uint16_t* above, const uint16_t* row, const uint16_t* below, size_t count, uint16_t threshold,
                 int* columns);

// A bit for each of 64 values that is above the threshold.
uint64_t BitsAbove(const uint16_t* values, uint16_t threshold);

}  // namespace glint::internal
