#include "refine/level_set_step.h"

#include <gtest/gtest.h>

#include "geometry/triangle_mesh.h"
#include "sdf/mesh_to_level_set.h"
#include "tests/support/shapes.h"

namespace glint {
namespace {

constexpr double kVoxel = 0.02, kRadius = 0.4;

// A step from a sphere of so many facets, with normals of the smooth one all over it.
StepSummary StepFrom(int subdivisions, Bend bend) {
  TriangleMesh mesh = testing::Icosphere(subdivisions);
  for (Eigen::Vector3d& v : mesh.vertices) v *= kRadius;
  const LevelSet surface = MeshToLevelSet(mesh, kVoxel, {.half_width_voxels = 4});
  const LevelSet seed = MeshToLevelSet(mesh, kVoxel, {.half_width_voxels = 9});
  std::vector<OrientedPoint> contacts;
  for (const Eigen::Vector3d& x : testing::Icosphere(3).vertices) {
    OrientedPoint contact;
    contact.position = kRadius * x;
    contact.normal = x;
    contact.sigma_normal = 0.01;
    contact.reach = 0.05;
    contacts.push_back(contact);
  }
  StepSummary summary;
  VariationalStep({surface, seed, bend, SurfaceArea(mesh), contacts, {}, {}}, {}, &summary);
  return summary;
}

TEST(LevelSetStep, BendsLikeASeedThatBendsLikeTheObject) {
  const StepSummary either = StepFrom(5, Bend::kEither);
  EXPECT_TRUE(either.bends_like_seed);
  EXPECT_EQ(either.energy_after, StepFrom(5, Bend::kLikeSeed).energy_after);
  EXPECT_LT(either.energy_after, StepFrom(5, Bend::kFlat).energy_after);
}

TEST(LevelSetStep, DoesNotBendLikeASeedOfFacets) {
  const StepSummary either = StepFrom(1, Bend::kEither);
  EXPECT_FALSE(either.bends_like_seed);
  EXPECT_LT(either.energy_after, StepFrom(1, Bend::kLikeSeed).energy_after);
}

}  // namespace
}  // namespace glint
