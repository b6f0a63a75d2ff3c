// The faces of OpenVDB's mesher as ours. Only for .cc files: it brings OpenVDB along.
#pragma once

#include <openvdb/openvdb.h>

#include <Eigen/Core>
#include <vector>

namespace glint::internal {

// Triangles oriented towards larger values; faces without three corners of their own are left out.
std::vector<Eigen::Vector3i> Triangulate(const std::vector<openvdb::Vec3d>& x,
                                         const std::vector<openvdb::Vec3I>& triangles,
                                         const std::vector<openvdb::Vec4I>& quads);

}  // namespace glint::internal
