// The lenses that are closed formulas: point in the camera's frame to a plane of unit focal length, and back to a ray.
// Internal to colmap/.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace glint::internal {

using Plane = std::optional<Eigen::Vector2d>;
using Ray = std::optional<Eigen::Vector3d>;  // not of unit length

// Equidistant: direction around the axis times angle from the axis.
Plane FisheyePlane(const Eigen::Vector3d& x);
Ray FisheyeRay(const Eigen::Vector2d& plane);

// Devernay, Faugeras 2001: r_d = atan(2 r tan(omega/2)) / omega.
Plane FovPlane(double omega, const Eigen::Vector3d& x);
Ray FovRay(double omega, const Eigen::Vector2d& plane);

// Fitzgibbon 2001: the ray of the plane point p is (p, 1 + k |p|²).
Plane DivisionPlane(double k, const Eigen::Vector3d& x);
Ray DivisionRay(double k, const Eigen::Vector2d& plane);

// Enhanced unified model (Khomutenko, Garcia, Martinet 2016), alpha in [0, 1], beta > 0.
Plane EucmPlane(double alpha, double beta, const Eigen::Vector3d& x);
Ray EucmRay(double alpha, double beta, const Eigen::Vector2d& plane);

// The whole sphere, in pixels: longitude 0 (the +z axis) at the middle column, latitude from the upper edge (-y) down.
Plane EquirectangularPixel(double width, double height, const Eigen::Vector3d& x);
Ray EquirectangularRay(double width, double height, const Eigen::Vector2d& px);

}  // namespace glint::internal
