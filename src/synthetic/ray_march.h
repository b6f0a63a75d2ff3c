// The steps that sphere tracing shares with and without a grid.
#pragma once

#include <utility>

#include "synthetic/shapes.h"

namespace glint {

inline constexpr double kNearSurface = 1e-4;  // of the radius: where Newton's method takes over
inline constexpr double kTouching = 1e-5;     // of the radius: a shadow ray that comes so near is blocked

// The part of the ray inside the bounding sphere; empty (first > second) where it misses.
std::pair<double, double> ClipToBounds(const ImplicitShape& shape, const Eigen::Vector3d& origin,
                                       const Eigen::Vector3d& direction);

// Newton's method along the ray from a parameter near the surface; stays there where the ray grazes.
ShapeHit PolishHit(const ImplicitShape& shape, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                   double t);

}  // namespace glint
