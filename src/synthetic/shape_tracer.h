// Rays against an implicit shape, for renderers: sphere tracing helped by a coarse grid.
#pragma once

#include <memory>
#include <vector>

#include "synthetic/shapes.h"

namespace glint {

// The same answers as TraceRay and RayMeets, several times faster where the shape's values understate the distance.
class ShapeTracer {
 public:
  explicit ShapeTracer(std::shared_ptr<const ImplicitShape> shape);

  const ImplicitShape& shape() const { return *shape_; }
  std::optional<ShapeHit> Trace(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double t_min,
                                double t_max) const;
  bool Meets(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double t_min, double t_max) const;

 private:
  struct Slope {
    float deviation;           // bound of the gradient's difference from its mean, in and around the cell
    Eigen::Vector3f gradient;  // its mean
  };
  Eigen::Vector3d CellCenter(int i, int j, int k) const;
  size_t Index(int i, int j, int k) const { return (static_cast<size_t>(k) * kSize + j) * kSize + i; }
  void Measure();
  void MeasureClearance();
  double March(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double t_min, double t_max,
               double near) const;

  static constexpr int kSize = 64;  // cells along each axis of the bounding cube
  std::shared_ptr<const ImplicitShape> shape_;
  Eigen::Vector3d corner_;
  double cell_;
  std::vector<float> clear_;  // distance from anywhere in a cell to the nearest cell that the surface may pass
  std::vector<Slope> slopes_;
};

}  // namespace glint
