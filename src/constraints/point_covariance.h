// How well a sparse point is known: the covariance of its triangulation.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "colmap/scene.h"

namespace glint {

// Covariance (world units squared) of every point with used[i] != 0, zero for the others. (Σ Jᵀ J)⁻¹ σ² over the
// point's observations, J the derivative of the pixel; poses count as exact. σ is the point's own reprojection error,
// drawn towards the median of all where few observations say little about it. A point whose observations do not fix it
// (one view, rays all alike) is very uncertain along them, never infinitely so.
std::vector<Eigen::Matrix3d> PointCovariances(const Scene& scene, const std::vector<uint8_t>& used);

}  // namespace glint
