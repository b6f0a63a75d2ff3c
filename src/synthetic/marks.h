// Small contrasty motifs painted on the object, under its gloss: what structure from motion can follow.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "synthetic/random.h"
#include "synthetic/shapes.h"

namespace glint {

struct Mark {
  enum class Kind { kDisc, kRing, kSquare, kCross, kQuarters };
  Kind kind;
  double radius;
  Eigen::Vector3d position, normal;    // on the surface
  Eigen::Vector3d tangent, bitangent;  // unit
  Eigen::Array3d color;                // linear albedo
};

// Marks with a grid over them for quick look-up.
class Marks {
 public:
  Marks() = default;
  // `median_height`: of the surface; above it the marks are sparser.
  explicit Marks(std::vector<Mark> marks, double median_height = 0);

  // The mark painted at x, or null.
  const Mark* At(const Eigen::Vector3d& x) const;
  const std::vector<Mark>& all() const { return marks_; }
  double median_height() const { return median_height_; }

 private:
  int CellIndex(const Eigen::Vector3d& x) const;
  std::vector<Mark> marks_;
  double median_height_ = 0;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  double cell_ = 1;
  int size_ = 0;  // cells along each axis
  std::vector<std::vector<int>> cells_;
};

// Distinct corners and centres of the motif, on the surface: where feature detectors fire.
std::vector<Eigen::Vector3d> MarkFeatures(const ImplicitShape& shape, const Mark& mark);

// A point of the surface drawn by a random line through the bounding sphere: uniform over a convex surface.
std::optional<ShapeHit> SampleSurface(const ImplicitShape& shape, Random& random);

// A mark of random kind, size and colour there.
Mark MakeMark(const ShapeHit& at, const std::vector<Eigen::Array3d>& palette, Random& random);

}  // namespace glint
