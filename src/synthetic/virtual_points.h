// Points that structure from motion triangulates on a sliding highlight: virtual, behind a convex surface.
#pragma once

#include <cstddef>
#include <vector>

#include "synthetic/sparse_points.h"

namespace glint {

// Least-squares position for the point's observations with the true cameras, starting from its position; sets
// position and error. False if it does not converge in front of the cameras.
bool Triangulate(const Stage& stage, SyntheticPoint& point);

// Up to `count` points, each on one highlight in three to five neighbouring views, with reprojection errors that
// COLMAP would accept. Fewer where highlights slide too fast for that.
std::vector<SyntheticPoint> MakeVirtualPoints(const Stage& stage, size_t count, double noise_px);

}  // namespace glint
