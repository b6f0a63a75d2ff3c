#include "synthetic/marks.h"

#include <algorithm>
#include <cmath>

namespace glint {
namespace {

using Eigen::Vector3d;

// (u, v) in radii from the mark's centre.
bool Covers(Mark::Kind kind, double u, double v) {
  const double r = std::hypot(u, v), chess = std::max(std::abs(u), std::abs(v));
  switch (kind) {
    case Mark::Kind::kDisc:
      return r < 0.8;
    case Mark::Kind::kRing:
      return r < 1 && (r > 0.6 || r < 0.25);
    case Mark::Kind::kSquare:
      return chess < 0.7;
    case Mark::Kind::kCross:
      return chess < 0.9 && std::min(std::abs(u), std::abs(v)) < 0.25;
    case Mark::Kind::kQuarters:
      return r < 1 && u * v > 0;
  }
  return false;
}

}  // namespace

Marks::Marks(std::vector<Mark> marks, double median_height) : marks_(std::move(marks)), median_height_(median_height) {
  if (marks_.empty()) return;
  Vector3d low = marks_[0].position, high = low;
  double reach = 0;
  for (const Mark& m : marks_) {
    reach = std::max(reach, 1.2 * m.radius);
    low = low.cwiseMin(m.position);
    high = high.cwiseMax(m.position);
  }
  origin_ = low.array() - reach;
  cell_ = 2 * reach;
  size_ = static_cast<int>(std::ceil((high - low).maxCoeff() / cell_)) + 2;
  cells_.resize(static_cast<size_t>(size_) * size_ * size_);
  for (size_t i = 0; i < marks_.size(); ++i) {
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3d offset((corner & 1 ? reach : -reach), (corner & 2 ? reach : -reach),
                            (corner & 4 ? reach : -reach));
      const int cell = CellIndex(marks_[i].position + offset);
      if (cell < 0) continue;
      auto& list = cells_[cell];
      if (list.empty() || list.back() != static_cast<int>(i)) list.push_back(static_cast<int>(i));
    }
  }
}

int Marks::CellIndex(const Vector3d& x) const {
  const Eigen::Array3d scaled = (x - origin_).array() / cell_;
  if (!(scaled >= 0).all() || !(scaled < size_).all()) return -1;
  const Eigen::Array3i c = scaled.cast<int>();
  return (c.z() * size_ + c.y()) * size_ + c.x();
}

const Mark* Marks::At(const Vector3d& x) const {
  if (marks_.empty()) return nullptr;
  const int cell = CellIndex(x);
  if (cell < 0) return nullptr;
  for (int i : cells_[cell]) {
    const Mark& mark = marks_[i];
    const Vector3d d = (x - mark.position) / mark.radius;
    if (d.squaredNorm() < 1.44 && Covers(mark.kind, d.dot(mark.tangent), d.dot(mark.bitangent))) return &mark;
  }
  return nullptr;
}

std::vector<Vector3d> MarkFeatures(const ImplicitShape& shape, const Mark& mark) {
  std::vector<Eigen::Vector2d> local;
  switch (mark.kind) {
    case Mark::Kind::kDisc:
    case Mark::Kind::kRing:
      local = {{0, 0}};
      break;
    case Mark::Kind::kSquare:
      local = {{0.7, 0.7}, {-0.7, 0.7}, {-0.7, -0.7}, {0.7, -0.7}};
      break;
    case Mark::Kind::kCross:
      local = {{0, 0}, {0.9, 0.25}, {-0.25, 0.9}};
      break;
    case Mark::Kind::kQuarters:
      local = {{0, 0}, {1, 0}, {0, 1}};
      break;
  }
  std::vector<Vector3d> features;
  for (const Eigen::Vector2d& p : local)
    features.push_back(
        ProjectToSurface(shape, mark.position + mark.radius * (p.x() * mark.tangent + p.y() * mark.bitangent)));
  return features;
}

std::optional<ShapeHit> SampleSurface(const ImplicitShape& shape, Random& random) {
  const Vector3d inward = random.UnitVector();
  // Cosine-weighted about `inward`: the sum of it and a uniform direction.
  const Vector3d direction = (inward + random.UnitVector()).normalized();
  const Vector3d origin = shape.center() - shape.radius() * inward;
  return TraceRay(shape, origin, direction, 0, 2.1 * shape.radius());
}

Mark MakeMark(const ShapeHit& at, const std::vector<Eigen::Array3d>& palette, Random& random) {
  Mark mark;
  mark.kind = static_cast<Mark::Kind>(random.Index(5));
  mark.radius = random.Uniform(0.022, 0.04);
  mark.position = at.position;
  mark.normal = at.normal;
  mark.tangent = at.normal.cross(random.UnitVector()).normalized();
  mark.bitangent = at.normal.cross(mark.tangent);
  mark.color = palette[random.Index(static_cast<int>(palette.size()))];
  return mark;
}

}  // namespace glint
