#include "highlights/lobe_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "highlights/lobe_kernel.cc"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
// What compiles this file once a target comes first.
// clang-format off
#include <hwy/foreach_target.h>  // NOLINT
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace glint::internal::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;

// The model's parameters for all lanes, and what depends on the pixel.
struct Model {
  explicit Model(const LobeSamples& samples, const LobeParams& params) {
    const D d;
    for (int k = 0; k < kNumLobeParams; ++k) p[k] = hn::Set(d, params[k]);
    amplitude = hn::Set(d, std::exp(params[kLogAmplitude]));
    long_x = hn::Set(d, samples.long_axis.x()), long_y = hn::Set(d, samples.long_axis.y());
  }

  // w = (u, v) = (a dx + c dy, e dy), bent to w' = w + b (w·long)² across, q = |w'|² exp(k u + m v).
  void At(V x, V y) {
    const D d;
    const V one = hn::Set(d, 1.0f);
    dx = hn::Sub(x, p[kPeakX]), dy = hn::Sub(y, p[kPeakY]);
    u = hn::MulAdd(p[kA], dx, hn::Mul(p[kC], dy)), v = hn::Mul(p[kE], dy);
    along = hn::MulAdd(long_x, u, hn::Mul(long_y, v));
    const V bend = hn::Mul(p[kB], hn::Mul(along, along));
    bent_u = hn::NegMulAdd(bend, long_y, u), bent_v = hn::MulAdd(bend, long_x, v);
    const V lean = hn::MulAdd(p[kK], u, hn::Mul(p[kM], v));
    skew = hn::Exp(d, hn::Min(hn::Max(lean, hn::Set(d, -3.0f)), hn::Set(d, 3.0f)));
    q = hn::Mul(hn::MulAdd(bent_u, bent_u, hn::Mul(bent_v, bent_v)), skew);
    fall = hn::Div(one, hn::Add(one, q));
    lobe = hn::Mul(fall, fall);
  }

  V Value() const { return hn::MulAdd(amplitude, lobe, p[kBody]); }

  V p[kNumLobeParams], amplitude, long_x, long_y;
  V dx, dy, u, v, along, bent_u, bent_v, skew, q, fall, lobe;
};

void EvaluateImpl(const LobeSamples& samples, const LobeParams& params, LobeRows& rows) {
  const D d;
  const V two = hn::Set(d, 2.0f), zero = hn::Zero(d);
  Model m(samples, params);
  const V minus_two_amplitudes = hn::Mul(hn::Set(d, -2.0f), m.amplitude);
  for (size_t i = 0; i < samples.count; i += hn::Lanes(d)) {
    m.At(hn::Load(d, samples.x + i), hn::Load(d, samples.y + i));
    const V over = hn::Sub(m.Value(), hn::Load(d, samples.value + i));
    const auto says_nothing = hn::And(hn::Gt(hn::Load(d, samples.saturated + i), zero), hn::Gt(over, zero));
    const V weight = hn::IfThenElse(says_nothing, zero, hn::Load(d, samples.inverse_sigma + i));
    const V df = hn::Mul(weight, hn::Mul(minus_two_amplitudes, hn::Mul(m.lobe, m.fall)));  // by q
    const V across = hn::NegMulAdd(m.bent_u, m.long_y, hn::Mul(m.bent_v, m.long_x));
    const V turn = hn::Mul(two, hn::Mul(m.p[kB], hn::Mul(m.along, across)));
    const V two_skew = hn::Mul(two, m.skew);
    const V du = hn::Mul(df, hn::MulAdd(two_skew, hn::MulAdd(turn, m.long_x, m.bent_u), hn::Mul(m.p[kK], m.q)));
    const V dv = hn::Mul(df, hn::MulAdd(two_skew, hn::MulAdd(turn, m.long_y, m.bent_v), hn::Mul(m.p[kM], m.q)));
    const V df_q = hn::Mul(df, m.q);
    const V row[LobeRows::kRows] = {hn::Mul(weight, hn::Mul(m.amplitude, m.lobe)),
                                    weight,
                                    hn::Mul(du, m.dx),
                                    hn::Mul(du, m.dy),
                                    hn::Mul(dv, m.dy),
                                    hn::Mul(df_q, m.u),
                                    hn::Mul(df_q, m.v),
                                    hn::Mul(hn::Mul(df, two_skew), hn::Mul(across, hn::Mul(m.along, m.along))),
                                    hn::Neg(hn::Mul(du, m.p[kA])),
                                    hn::Neg(hn::MulAdd(du, m.p[kC], hn::Mul(dv, m.p[kE]))),
                                    hn::Mul(weight, over)};
    for (int k = 0; k < LobeRows::kRows; ++k) hn::Store(row[k], d, rows.Row(k) + i);
  }
}

float CostImpl(size_t count, const LobeRows& rows, float scale) {
  const D d;
  const float* residual = rows.Row(LobeRows::kResidual);
  const V one = hn::Set(d, 1.0f), inverse_scale = hn::Set(d, 1 / scale);
  V sum = hn::Zero(d);
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const V ratio = hn::Mul(hn::Load(d, residual + i), inverse_scale);
    sum = hn::Add(sum, hn::Log(d, hn::MulAdd(ratio, ratio, one)));
  }
  return scale * scale * hn::GetLane(hn::SumOfLanes(d, sum));
}

float ScaleImpl(size_t count, const LobeRows& rows) {
  const D d;
  const float* residual = rows.Row(LobeRows::kResidual);
  const auto num_above = [&](float limit) {
    size_t num = 0;
    for (size_t i = 0; i < count; i += hn::Lanes(d))
      num += hn::CountTrue(d, hn::Gt(hn::Abs(hn::Load(d, residual + i)), hn::Set(d, limit)));
    return num;
  };
  const size_t half = num_above(0) / 2;
  if (half == 0) return 1;
  // By bisection of the logarithm.
  float median = 0.2f;
  for (const float factor : {256.f, 16.f, 4.f, 2.f, 1.414214f, 1.189207f, 1.090508f, 1.044274f})
    if (num_above(median * factor) >= half) median *= factor;
  return 1.4826f * 1.02f * median;
}

float ProfileErrorImpl(const LobeSamples& samples, const LobeRows& rows, float rise) {
  const D d;
  const float* residual = rows.Row(LobeRows::kResidual);
  const V zero = hn::Zero(d), most = hn::Set(d, 0.5f * rise), tiny = hn::Set(d, 1e-6f);
  V sum = zero;
  for (size_t i = 0; i < samples.count; i += hn::Lanes(d)) {
    const V sigma_off = hn::Abs(hn::Load(d, residual + i));
    const V off = hn::Min(hn::Div(sigma_off, hn::Max(hn::Load(d, samples.inverse_sigma + i), tiny)), most);
    sum = hn::Add(sum, hn::IfThenElse(hn::Gt(hn::Load(d, samples.saturated + i), zero), zero, off));
  }
  const size_t count = std::max<size_t>(1, samples.count - samples.saturated_count);
  return hn::GetLane(hn::SumOfLanes(d, sum)) / (static_cast<float>(count) * rise);
}

constexpr size_t kNumProducts = kNumLobeParams * (kNumLobeParams + 3) / 2;

// Row `kRow` of the derivatives, weighted, times itself, the rows after it, and the pull.
template <int kRow, size_t... kAfter>
void Products(const LobeRows& rows, const float* weight, const float* pull, size_t count,
              std::index_sequence<kAfter...>, V* products) {
  const D d;
  V sums[] = {(static_cast<void>(kAfter), hn::Zero(d))...}, pulls = hn::Zero(d);
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const V own = hn::Mul(hn::Load(d, weight + i), hn::Load(d, rows.Row(kRow) + i));
    ((sums[kAfter] = hn::MulAdd(own, hn::Load(d, rows.Row(kRow + static_cast<int>(kAfter)) + i), sums[kAfter])), ...);
    pulls = hn::MulAdd(own, hn::Load(d, pull + i), pulls);
  }
  ((products[kAfter] = sums[kAfter]), ...);
  products[sizeof...(kAfter)] = pulls;
}

template <size_t... kRow>
void AllProducts(const LobeRows& rows, const float* weight, const float* pull, size_t count,
                 std::index_sequence<kRow...>, V* products) {
  ((Products<static_cast<int>(kRow)>(rows, weight, pull, count, std::make_index_sequence<kNumLobeParams - kRow>(),
                                     products),
    products += kNumLobeParams + 1 - kRow),
   ...);
}

void NormaliseImpl(size_t count, const LobeRows& rows, float scale, float least, LobeEquations& equations) {
  const D d;
  const V one = hn::Set(d, 1.0f), inverse_scale = hn::Set(d, 1 / scale), floor = hn::Set(d, least);
  alignas(64) float weight[LobeSamples::kMost], pull[LobeSamples::kMost];
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const V residual = hn::Load(d, rows.Row(LobeRows::kResidual) + i);
    const V ratio = hn::Mul(residual, inverse_scale);
    const V cauchy = hn::Div(one, hn::MulAdd(ratio, ratio, one));
    const V bend = hn::Max(floor, hn::Mul(cauchy, hn::NegMulAdd(ratio, ratio, one)));
    hn::Store(hn::Mul(cauchy, bend), d, weight + i);
    hn::Store(hn::Div(residual, bend), d, pull + i);
  }

  V products[kNumProducts + 1];
  AllProducts(rows, weight, pull, count, std::make_index_sequence<kNumLobeParams>(), products);
  size_t num = kNumProducts;
#if HWY_TARGET != HWY_SCALAR
  // Sums over the lanes, of two vectors at a time.
  for (size_t lanes = hn::Lanes(d); lanes > 1; lanes /= 2) {
    products[num] = hn::Zero(d);
    num = (num + 1) / 2;
    for (size_t k = 0; k < num; ++k) {
      const V low = products[2 * k], high = products[2 * k + 1];
      products[k] = hn::Add(hn::ConcatEven(d, high, low), hn::ConcatOdd(d, high, low));
    }
  }
#endif
  alignas(64) std::array<float, (kNumProducts / 16 + 1) * 16> sums;
  for (size_t k = 0; k < num; ++k) hn::Store(products[k], d, sums.data() + k * hn::Lanes(d));
  const float* sum = sums.data();
  for (int row = 0; row < kNumLobeParams; ++row) {
    for (int column = row; column < kNumLobeParams; ++column)
      equations.hessian(row, column) = equations.hessian(column, row) = *sum++;
    equations.rhs[row] = -*sum++;
  }
}

}  // namespace glint::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace glint::internal {

HWY_EXPORT(EvaluateImpl);
HWY_EXPORT(CostImpl);
HWY_EXPORT(ScaleImpl);
HWY_EXPORT(ProfileErrorImpl);
HWY_EXPORT(NormaliseImpl);

void LobeSamples::Finish(float body, float sigma, float sigma_per_rise, float saturation) {
  for (size_t i = 0; i < count; ++i) {
    inverse_sigma[i] = 1 / (sigma + sigma_per_rise * std::abs(value[i] - body));
    saturated[i] = value[i] >= saturation ? 1.0f : 0.0f;
    saturated_count += value[i] >= saturation;
  }
  // The arithmetic takes up to 16 at a time.
  for (size_t i = count; i < (count + 15) / 16 * 16; ++i) {
    x[i] = y[i] = value[i] = inverse_sigma[i] = 0;
    saturated[i] = 1;
  }
}

void EvaluateLobe(const LobeSamples& samples, const LobeParams& params, LobeRows& rows) {
  HWY_DYNAMIC_DISPATCH(EvaluateImpl)(samples, params, rows);
}

float LobeCost(size_t count, const LobeRows& rows, float scale) {
  return HWY_DYNAMIC_DISPATCH(CostImpl)(count, rows, scale);
}

float LobeScale(size_t count, const LobeRows& rows) { return HWY_DYNAMIC_DISPATCH(ScaleImpl)(count, rows); }

float LobeProfileError(const LobeSamples& samples, const LobeRows& rows, float rise) {
  return HWY_DYNAMIC_DISPATCH(ProfileErrorImpl)(samples, rows, rise);
}

void NormaliseLobe(size_t count, const LobeRows& rows, float scale, float least, LobeEquations& equations) {
  HWY_DYNAMIC_DISPATCH(NormaliseImpl)(count, rows, scale, least, equations);
}

}  // namespace glint::internal
#endif
