#include "highlights/lobe_kernel.h"

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

constexpr int kRows = kNumLobeParams + 1;  // the derivatives, and the residual
constexpr size_t kStride = LobeSamples::kMost;

// The model's parameters for all lanes, and what depends on the pixel.
struct Model {
  explicit Model(const LobeSamples& samples, const LobeParams& params) {
    const D d;
    for (int k = 0; k < kNumLobeParams; ++k) p[k] = hn::Set(d, params[k]);
    amplitude = hn::Set(d, std::exp(params[0]));
    long_x = hn::Set(d, samples.long_axis.x()), long_y = hn::Set(d, samples.long_axis.y());
  }

  // w = (u, v) = (a dx + c dy, e dy), bent to w' = w + b (w·long)² across, q = |w'|² exp(k u + m v).
  void At(V x, V y) {
    const D d;
    const V one = hn::Set(d, 1.0f);
    dx = hn::Sub(x, p[2]), dy = hn::Sub(y, p[3]);
    u = hn::MulAdd(p[4], dx, hn::Mul(p[5], dy)), v = hn::Mul(p[6], dy);
    along = hn::MulAdd(long_x, u, hn::Mul(long_y, v));
    const V bend = hn::Mul(p[9], hn::Mul(along, along));
    bent_u = hn::NegMulAdd(bend, long_y, u), bent_v = hn::MulAdd(bend, long_x, v);
    const V lean = hn::MulAdd(p[7], u, hn::Mul(p[8], v));
    skew = hn::Exp(d, hn::Min(hn::Max(lean, hn::Set(d, -3.0f)), hn::Set(d, 3.0f)));
    q = hn::Mul(hn::MulAdd(bent_u, bent_u, hn::Mul(bent_v, bent_v)), skew);
    fall = hn::Div(one, hn::Add(one, q));
    lobe = hn::Mul(fall, fall);
  }

  V Value() const { return hn::MulAdd(amplitude, lobe, p[1]); }

  V p[kNumLobeParams], amplitude, long_x, long_y;
  V dx, dy, u, v, along, bent_u, bent_v, skew, q, fall, lobe;
};

V Residual(const LobeSamples& samples, size_t i, Model& model) {
  const D d;
  model.At(hn::Load(d, samples.x + i), hn::Load(d, samples.y + i));
  const V r = hn::Mul(hn::Sub(model.Value(), hn::Load(d, samples.value + i)), hn::Load(d, samples.inverse_sigma + i));
  const V zero = hn::Zero(d);
  const auto says_nothing = hn::And(hn::Gt(hn::Load(d, samples.saturated + i), zero), hn::Gt(r, zero));
  return hn::IfThenElse(says_nothing, zero, r);
}

void ResidualsImpl(const LobeSamples& samples, const LobeParams& params, float* residuals) {
  const D d;
  Model model(samples, params);
  for (size_t i = 0; i < samples.count; i += hn::Lanes(d)) hn::StoreU(Residual(samples, i, model), d, residuals + i);
}

// Row `kRow` of the weighted derivatives times itself and the rows after it.
template <int kRow, size_t... kAfter>
void Products(const float* rows, size_t count, std::index_sequence<kAfter...>, LobeEquations& equations) {
  const D d;
  V sums[] = {(static_cast<void>(kAfter), hn::Zero(d))...};
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const V own = hn::Load(d, rows + kRow * kStride + i);
    ((sums[kAfter] = hn::MulAdd(own, hn::Load(d, rows + (kRow + kAfter) * kStride + i), sums[kAfter])), ...);
  }
  const auto store = [&](int column, float sum) {
    if (column == kNumLobeParams)
      equations.rhs[kRow] = -sum;
    else
      equations.hessian(kRow, column) = equations.hessian(column, kRow) = sum;
  };
  (store(kRow + static_cast<int>(kAfter), hn::GetLane(hn::SumOfLanes(d, sums[kAfter]))), ...);
}

template <size_t... kRow>
void AllProducts(const float* rows, size_t count, std::index_sequence<kRow...>, LobeEquations& equations) {
  (Products<static_cast<int>(kRow)>(rows, count, std::make_index_sequence<kRows - kRow>(), equations), ...);
}

void LineariseImpl(const LobeSamples& samples, const LobeParams& params, float scale, LobeEquations& equations) {
  const D d;
  alignas(64) float rows[kRows * kStride];
  const V one = hn::Set(d, 1.0f), inverse_scale = hn::Set(d, 1 / scale), two = hn::Set(d, 2.0f), zero = hn::Zero(d);
  V cost = zero;
  Model m(samples, params);
  const V minus_two_amplitudes = hn::Mul(hn::Set(d, -2.0f), m.amplitude);
  for (size_t i = 0; i < samples.count; i += hn::Lanes(d)) {
    const V r = Residual(samples, i, m);
    const V ratio = hn::Mul(r, inverse_scale);
    const V square = hn::MulAdd(ratio, ratio, one);
    cost = hn::Add(cost, hn::Log(d, square));
    // The square root of the weight. A residual of exactly 0 is one of a pixel that says nothing.
    const V sigma = hn::Load(d, samples.inverse_sigma + i);
    const V root = hn::Div(hn::IfThenElse(hn::Eq(r, zero), zero, sigma), hn::Sqrt(square));
    const V df = hn::Mul(root, hn::Mul(minus_two_amplitudes, hn::Mul(m.lobe, m.fall)));  // by q
    const V across = hn::NegMulAdd(m.bent_u, m.long_y, hn::Mul(m.bent_v, m.long_x));
    const V turn = hn::Mul(two, hn::Mul(m.p[9], hn::Mul(m.along, across)));
    const V two_skew = hn::Mul(two, m.skew);
    const V du = hn::Mul(df, hn::MulAdd(two_skew, hn::MulAdd(turn, m.long_x, m.bent_u), hn::Mul(m.p[7], m.q)));
    const V dv = hn::Mul(df, hn::MulAdd(two_skew, hn::MulAdd(turn, m.long_y, m.bent_v), hn::Mul(m.p[8], m.q)));
    const V df_q = hn::Mul(df, m.q);
    const V row[kRows] = {hn::Mul(root, hn::Mul(m.amplitude, m.lobe)),
                          root,
                          hn::Neg(hn::Mul(du, m.p[4])),
                          hn::Neg(hn::MulAdd(du, m.p[5], hn::Mul(dv, m.p[6]))),
                          hn::Mul(du, m.dx),
                          hn::Mul(du, m.dy),
                          hn::Mul(dv, m.dy),
                          hn::Mul(df_q, m.u),
                          hn::Mul(df_q, m.v),
                          hn::Mul(hn::Mul(df, two_skew), hn::Mul(across, hn::Mul(m.along, m.along))),
                          hn::Div(r, hn::Sqrt(square))};
    for (int k = 0; k < kRows; ++k) hn::Store(row[k], d, rows + k * kStride + i);
  }
  equations.cost = scale * scale * hn::GetLane(hn::SumOfLanes(d, cost));
  AllProducts(rows, samples.count, std::make_index_sequence<kNumLobeParams>(), equations);
}

}  // namespace glint::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace glint::internal {

HWY_EXPORT(ResidualsImpl);
HWY_EXPORT(LineariseImpl);

void LobeSamples::Add(float px, float py, float brightness, float sigma, bool is_saturated) {
  if (count == kMost) return;
  x[count] = px, y[count] = py, value[count] = brightness, inverse_sigma[count] = 1 / sigma;
  saturated[count] = is_saturated ? 1.0f : 0.0f;
  saturated_count += is_saturated;
  ++count;
}

void LobeSamples::Finish() {
  for (size_t i = count; i < (count + 15) / 16 * 16; ++i) {
    x[i] = y[i] = value[i] = inverse_sigma[i] = 0;
    saturated[i] = 1;
  }
}

void LobeResiduals(const LobeSamples& samples, const LobeParams& params, float* residuals) {
  HWY_DYNAMIC_DISPATCH(ResidualsImpl)(samples, params, residuals);
}

void LineariseLobe(const LobeSamples& samples, const LobeParams& params, float scale, LobeEquations& equations) {
  HWY_DYNAMIC_DISPATCH(LineariseImpl)(samples, params, scale, equations);
}

}  // namespace glint::internal
#endif
