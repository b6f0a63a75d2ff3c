// What a LevelSet holds. Only for .cc files: it brings OpenVDB along.
#pragma once

#include <openvdb/openvdb.h>

#include <memory>
#include <utility>

#include "sdf/level_set.h"

namespace glint {

struct LevelSetImpl {
  openvdb::FloatGrid::Ptr grid;  // never null; class level set; uniform voxels
};

inline LevelSet MakeLevelSet(openvdb::FloatGrid::Ptr grid) {
  return LevelSet(std::make_shared<LevelSetImpl>(LevelSetImpl{std::move(grid)}));
}

// Throws InputError unless the surface φ = iso_world lies within the band.
void RequireInBand(const LevelSet& level_set, double iso_world);

inline openvdb::Vec3d ToVdb(const Eigen::Vector3d& x) { return {x[0], x[1], x[2]}; }
inline Eigen::Vector3d FromVdb(const openvdb::Vec3d& x) { return {x[0], x[1], x[2]}; }

}  // namespace glint
