// What stands around the object: a textured ground, a dim room, and for the pane a textured interior below it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>

#include "synthetic/shape_tracer.h"

namespace glint {

// Radiances and albedos are linear, red first.
class Surroundings {
 public:
  Surroundings() = default;
  Surroundings(double ground_z, std::shared_ptr<const ShapeTracer> interior, uint64_t seed);

  double ground_z() const { return ground_z_; }
  const ShapeTracer* interior() const { return interior_.get(); }

  // Albedo of the ground; detail finer than `footprint` (units a pixel) is left out.
  Eigen::Array3d GroundAlbedo(double x, double y, double footprint) const;
  Eigen::Array3d InteriorAlbedo(const Eigen::Vector3d& x, const Eigen::Vector3d& normal, double footprint) const;

  // Radiance of the room from a direction.
  Eigen::Array3d Room(const Eigen::Vector3d& direction) const;

  // Radiance of a white diffuse surface under the room alone.
  Eigen::Array3d Ambient(const Eigen::Vector3d& normal) const;

 private:
  double Mottle(double x, double y, double footprint, int octaves, uint64_t layer) const;

  double ground_z_ = -1;
  std::shared_ptr<const ShapeTracer> interior_;
  uint64_t seed_ = 0;
  double turn_cos_ = 1, turn_sin_ = 0, tile_ = 0.5;
  std::array<Eigen::Array3d, 4> palette_;
  std::array<Eigen::Vector3d, 2> window_;
};

}  // namespace glint
