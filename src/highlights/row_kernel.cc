#include "highlights/row_kernel.h"

#include <algorithm>
#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "highlights/row_kernel.cc"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
// What compiles this file once a target comes first.
// clang-format off
#include <hwy/foreach_target.h>  // NOLINT
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace glint::internal::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<uint16_t, 32>;
using Bytes = hn::CappedTag<uint8_t, 64>;
using V = hn::Vec<D>;

// `vector(i)` for whole vectors, the last of which may do some values again; `one(i)` where there are not even so many.
template <class Vector, class One>
void ForRow(size_t count, size_t lanes, const Vector& vector, const One& one) {
  size_t i = 0;
  for (; i + lanes <= count; i += lanes) vector(i);
  if (i == count) return;
  if (count >= lanes) return vector(count - lanes);
  for (; i < count; ++i) one(i);
}

void SmoothImpl(const uint16_t* before, const uint16_t* middle, const uint16_t* after, size_t count, uint16_t* out) {
  constexpr uint16_t kMiddle = 43691, kSides = 21845;  // sum: 65536
  const D d;
  const V middle_weight = hn::Set(d, kMiddle), sides_weight = hn::Set(d, kSides);
  ForRow(
      count, hn::Lanes(d),
      [&](size_t i) {
        const V sides = hn::AverageRound(hn::LoadU(d, before + i), hn::LoadU(d, after + i));
        hn::StoreU(hn::Add(hn::MulHigh(hn::LoadU(d, middle + i), middle_weight), hn::MulHigh(sides, sides_weight)), d,
                   out + i);
      },
      [&](size_t i) {
        const uint32_t sides = (uint32_t{before[i]} + after[i] + 1) / 2;
        out[i] = static_cast<uint16_t>((uint32_t{kMiddle} * middle[i] >> 16) + (kSides * sides >> 16));
      });
}

void SubtractImpl(const uint16_t* a, const uint16_t* b, size_t count, uint16_t* out) {
  const D d;
  ForRow(
      count, hn::Lanes(d),
      [&](size_t i) { hn::StoreU(hn::SaturatedSub(hn::LoadU(d, a + i), hn::LoadU(d, b + i)), d, out + i); },
      [&](size_t i) { out[i] = static_cast<uint16_t>(a[i] - std::min(a[i], b[i])); });
}

void LeastOfThreeImpl(const uint8_t* in, size_t count, uint8_t* out) {
  const Bytes d;
  ForRow(
      count, hn::Lanes(d),
      [&](size_t i) {
        hn::Vec<Bytes> a, b, c;
        hn::LoadInterleaved3(d, in + 3 * i, a, b, c);
        hn::StoreU(hn::Min(a, hn::Min(b, c)), d, out + i);
      },
      [&](size_t i) {
        out[i] = std::min({in[3 * i], in[3 * i + 1], in[3 * i + 2]});
      });
}

size_t MaximaImpl(const uint16_t* above, const uint16_t* row, const uint16_t* below, size_t count, uint16_t threshold,
                  int* columns) {
  const D d;
  const V least = hn::Set(d, threshold);
  size_t num = 0;
  for (size_t x = 1; x + 1 < count; x += hn::Lanes(d)) {
    const V value = hn::LoadU(d, row + x);
    if (hn::AllFalse(d, hn::Gt(value, least))) continue;
    const V before = hn::Max(hn::Max(hn::LoadU(d, above + x - 1), hn::LoadU(d, above + x)),
                             hn::Max(hn::LoadU(d, above + x + 1), hn::LoadU(d, row + x - 1)));
    const V after = hn::Max(hn::Max(hn::LoadU(d, below + x - 1), hn::LoadU(d, below + x)),
                            hn::Max(hn::LoadU(d, below + x + 1), hn::LoadU(d, row + x + 1)));
    const auto highest = hn::And(hn::Gt(value, hn::Max(before, least)), hn::Eq(value, hn::Max(value, after)));
    uint64_t bits = 0;
    hn::StoreMaskBits(d, highest, reinterpret_cast<uint8_t*>(&bits));
    for (; bits != 0; bits &= bits - 1) {
      const size_t at = x + static_cast<size_t>(std::countr_zero(bits));
      if (at + 1 < count) columns[num++] = static_cast<int>(at);
    }
  }
  return num;
}

uint64_t BitsAboveImpl(const uint16_t* values, uint16_t threshold) {
  const D d;
  const V least = hn::Set(d, threshold);
  uint64_t bits = 0;
  for (size_t k = 0; k < 64; k += hn::Lanes(d)) {
    uint64_t some = 0;
    hn::StoreMaskBits(d, hn::Gt(hn::LoadU(d, values + k), least), reinterpret_cast<uint8_t*>(&some));
    bits |= some << k;
  }
  return bits;
}

}  // namespace glint::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace glint::internal {

HWY_EXPORT(SmoothImpl);
HWY_EXPORT(SubtractImpl);
HWY_EXPORT(LeastOfThreeImpl);
HWY_EXPORT(MaximaImpl);
HWY_EXPORT(BitsAboveImpl);

void SmoothRow(const uint16_t* before, const uint16_t* middle, const uint16_t* after, size_t count, uint16_t* out) {
  HWY_DYNAMIC_DISPATCH(SmoothImpl)(before, middle, after, count, out);
}

void SubtractRow(const uint16_t* a, const uint16_t* b, size_t count, uint16_t* out) {
  HWY_DYNAMIC_DISPATCH(SubtractImpl)(a, b, count, out);
}

void LeastOfThreeRow(const uint8_t* in, size_t count, uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(LeastOfThreeImpl)(in, count, out);
}

size_t RowMaxima(const uint16_t* above, const uint16_t* row, const uint16_t* below, size_t count, uint16_t threshold,
                 int* columns) {
  return HWY_DYNAMIC_DISPATCH(MaximaImpl)(above, row, below, count, threshold, columns);
}

uint64_t BitsAbove(const uint16_t* values, uint16_t threshold) {
  return HWY_DYNAMIC_DISPATCH(BitsAboveImpl)(values, threshold);
}

}  // namespace glint::internal
#endif
