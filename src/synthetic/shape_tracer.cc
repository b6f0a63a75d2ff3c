#include "synthetic/shape_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "core/square.h"
#include "synthetic/ray_march.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr int kMaxSteps = 1000;
// Gradients are sampled at the cells' centres; between them they may differ a little more.
constexpr float kDeviationMargin = 1.25f, kLeastDeviation = 0.02f;

}  // namespace

ShapeTracer::ShapeTracer(std::shared_ptr<const ImplicitShape> shape)
    : shape_(std::move(shape)),
      corner_(shape_->center().array() - 1.01 * shape_->radius()),
      cell_(2.02 * shape_->radius() / kSize),
      clear_(static_cast<size_t>(kSize) * kSize * kSize, std::numeric_limits<float>::infinity()),
      slopes_(clear_.size()) {
  Measure();
  MeasureClearance();
}

Vector3d ShapeTracer::CellCenter(int i, int j, int k) const {
  return corner_ + cell_ * Vector3d(i + 0.5, j + 0.5, k + 0.5);
}

// Gradients, their spread, and which cells the surface may pass (clear = 0; else infinity for now).
void ShapeTracer::Measure() {
  std::vector<double> values(clear_.size());
  ParallelFor(clear_.size(), kSize, [&](size_t index) {
    const int i = static_cast<int>(index % kSize), j = static_cast<int>(index / kSize % kSize);
    const int k = static_cast<int>(index / kSize / kSize);
    const Vector3d x = CellCenter(i, j, k), gradient = shape_->Gradient(x);
    values[index] = shape_->Value(x);
    slopes_[index].gradient = gradient.allFinite() ? Eigen::Vector3f(gradient.cast<float>()) : Eigen::Vector3f::Zero();
  });
  const double half_diagonal = 0.5 * std::sqrt(3.0) * cell_;
  ParallelFor(clear_.size(), kSize, [&](size_t index) {
    Slope& cell = slopes_[index];
    // The value bounds the distance from below.
    if (std::abs(values[index]) > half_diagonal) return;
    const int i = static_cast<int>(index % kSize), j = static_cast<int>(index / kSize % kSize);
    const int k = static_cast<int>(index / kSize / kSize);
    float most = 0;
    for (int c = std::max(k - 1, 0); c <= std::min(k + 1, kSize - 1); ++c)
      for (int b = std::max(j - 1, 0); b <= std::min(j + 1, kSize - 1); ++b)
        for (int a = std::max(i - 1, 0); a <= std::min(i + 1, kSize - 1); ++a)
          most = std::max(most, (slopes_[Index(a, b, c)].gradient - cell.gradient).norm());
    cell.deviation = kDeviationMargin * most + kLeastDeviation;
    const double slope = std::min(1.0f, cell.gradient.norm() + cell.deviation);
    if (std::abs(values[index]) <= slope * half_diagonal) clear_[index] = 0;
  });
}

// The distance between boxes splits into a sum over the axes: one sweep an axis over squared distances.
void ShapeTracer::MeasureClearance() {
  std::vector<float> gap(kSize);
  for (int d = 0; d < kSize; ++d) gap[d] = static_cast<float>(Square(std::max(d - 1, 0) * cell_));
  const size_t strides[3] = {1, kSize, static_cast<size_t>(kSize) * kSize};
  for (int axis = 0; axis < 3; ++axis) {
    const size_t along = strides[axis], u = strides[(axis + 1) % 3], v = strides[(axis + 2) % 3];
    ParallelFor(static_cast<size_t>(kSize) * kSize, kSize, [&](size_t line) {
      const size_t first = line % kSize * u + line / kSize * v;
      float before[kSize];
      for (int i = 0; i < kSize; ++i) before[i] = clear_[first + i * along];
      for (int i = 0; i < kSize; ++i) {
        float least = std::numeric_limits<float>::infinity();
        for (int j = 0; j < kSize; ++j) least = std::min(least, before[j] + gap[std::abs(i - j)]);
        clear_[first + i * along] = least;
      }
    });
  }
  for (float& clear : clear_) clear = 0.9999f * std::sqrt(clear);
}

double ShapeTracer::March(const Vector3d& origin, const Vector3d& direction, double t_min, double t_max,
                          double near) const {
  const auto [enter, leave] = ClipToBounds(*shape_, origin, direction);
  const double end = std::min(t_max, leave);
  const Eigen::Vector3f toward = direction.cast<float>();
  // The ray in cells: what is inside the bounding sphere is inside the grid.
  const Vector3d start = (origin - corner_) / cell_, step = direction / cell_;
  double t = std::max(t_min, enter);
  for (int i = 0; i < kMaxSteps && t < end; ++i) {
    const size_t cell = Index(static_cast<int>(start.x() + t * step.x()), static_cast<int>(start.y() + t * step.y()),
                              static_cast<int>(start.z() + t * step.z()));
    if (clear_[cell] > 0) {
      t += clear_[cell];
      continue;
    }
    const double value = shape_->Value(origin + t * direction);
    if (value < near) return t;
    // How fast the value can fall along the ray; known for the neighbouring cells only.
    const Slope& slope = slopes_[cell];
    const double fall = std::max(-slope.gradient.dot(toward), 0.f) + slope.deviation;
    t += std::max(value, std::min(value / fall, cell_));
  }
  return -1;
}

std::optional<ShapeHit> ShapeTracer::Trace(const Vector3d& origin, const Vector3d& direction, double t_min,
                                           double t_max) const {
  const double t = March(origin, direction, t_min, t_max, kNearSurface * shape_->radius());
  if (t < 0) return std::nullopt;
  return PolishHit(*shape_, origin, direction, t);
}

bool ShapeTracer::Meets(const Vector3d& origin, const Vector3d& direction, double t_min, double t_max) const {
  return March(origin, direction, t_min, t_max, kTouching * shape_->radius()) >= 0;
}

}  // namespace glint
