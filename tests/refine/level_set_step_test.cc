#include "refine/level_set_step.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/triangle_mesh.h"
#include "sdf/mesh_to_level_set.h"
#include "sdf/rebuild.h"
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

// Knowledge all around says that the surface is farther out, and turns as it would if that went on below.
TEST(LevelSetStep, TheFootDoesNotGoBelowTheGround) {
  TriangleMesh mesh = testing::Icosphere(4);
  for (Eigen::Vector3d& v : mesh.vertices) v *= kRadius;
  mesh.normals = testing::Icosphere(4).vertices;
  const LevelSet surface = MeshToLevelSet(mesh, kVoxel, {.half_width_voxels = 4});
  const LevelSet seed = MeshToLevelSet(mesh, kVoxel, {.half_width_voxels = 9});
  std::vector<SurfacePoint> points;
  std::vector<float> on_foot;
  for (const Eigen::Vector3d& n : mesh.normals) {
    on_foot.push_back(n.z() < -0.8 ? 1.0F : 0.0F);
    if (n.z() < -0.7) continue;
    SurfacePoint point;
    point.position = (kRadius + 0.5 * kVoxel) * n;
    point.normal = n;
    point.sigma = 0.05 * kVoxel;
    points.push_back(point);
  }
  // The first step shows that it would, the second does something about it.
  const auto moved_below = [&](const FootPlaces& foot) {
    LevelSet stepped = surface;
    for (int k = 0; k < 2; ++k)
      stepped = Redistance(
          VariationalStep(
              {stepped, seed, Bend::kLikeSeed, SurfaceArea(mesh), {}, points, {}, StepInput::kNoTilts, nullptr, &foot},
              {}, nullptr),
          4);
    return -stepped.Value({0, 0, -kRadius});
  };
  const double loose = moved_below(FootPlaces(mesh, {})), held = moved_below(FootPlaces(mesh, on_foot));
  EXPECT_GT(loose, 0.2 * kVoxel);
  EXPECT_LT(std::abs(held), 0.4 * loose);
}

}  // namespace
}  // namespace glint
