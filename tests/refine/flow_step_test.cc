#include "refine/flow_step.h"

#include <gmock/gmock.h>

#include <cmath>

#include "geometry/triangle_mesh.h"
#include "sdf/extract_mesh.h"
#include "sdf/mesh_to_level_set.h"
#include "tests/support/shapes.h"

namespace glint {
namespace {

constexpr double kVoxel = 0.02;

LevelSet SphereOf(double radius) {
  TriangleMesh sphere = testing::Icosphere(4);
  for (Eigen::Vector3d& v : sphere.vertices) v *= radius;
  SdfOptions sdf;
  sdf.half_width_voxels = 4;
  return MeshToLevelSet(sphere, kVoxel, sdf);
}

double MeanRadius(const LevelSet& surface) {
  double sum = 0;
  const TriangleMesh mesh = ExtractMesh(surface);
  for (const Eigen::Vector3d& v : mesh.vertices) sum += v.norm() / static_cast<double>(mesh.vertices.size());
  return sum;
}

FlowOptions Nothing() {
  FlowOptions options;
  options.alignment = options.points = options.curvature = options.force = 0;
  return options;
}

// A sphere that shrinks by its mean curvature 2 / r has r² = r₀² − 4 γ t.
TEST(FlowStep, CurvatureShrinksASphereAsItShould) {
  const LevelSet sphere = SphereOf(0.4);
  FlowOptions options = Nothing();
  options.curvature = 1;
  options.max_steps = 10;
  StepSummary summary;
  const LevelSet shrunk = FlowStep({sphere, sphere, Bend::kFlat, 1, {}, {}, {}}, options, &summary);
  ASSERT_EQ(summary.solver_iterations, 10);
  const double time = 10 * 0.45 / 6 * kVoxel * kVoxel;
  EXPECT_NEAR(MeanRadius(sphere) - MeanRadius(shrunk), 0.4 - std::sqrt(0.16 - 4 * time), 2e-4);
}

// Contacts whose normals are those of a plane lean the surface towards it, and the energy falls.
TEST(FlowStep, TurnsTheSurfaceToTheNormals) {
  const LevelSet sphere = SphereOf(0.4);
  std::vector<OrientedPoint> contacts;
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j) {
      OrientedPoint contact;
      contact.position = 0.4 * Eigen::Vector3d(0.25 * i, 0.25 * j, 1).normalized();
      contact.normal = (contact.position.normalized() + Eigen::Vector3d(0.15, 0, 0)).normalized();
      contact.sigma_normal = 0.01;
      contact.reach = 0.1;
      contacts.push_back(contact);
    }
  FlowOptions options = Nothing();
  options.alignment = 1;
  options.max_steps = 400;
  StepSummary summary;
  const LevelSet turned = FlowStep({sphere, sphere, Bend::kFlat, 1, contacts, {}, {}}, options, &summary);

  EXPECT_LT(summary.energy_after, 0.8 * summary.energy_before);
  const Eigen::Vector3d before = sphere.Gradient({0, 0, 0.4});
  Eigen::Vector3d top(0, 0, 0.4);
  top -= turned.Value(top) * turned.Gradient(top).normalized();
  EXPECT_GT(turned.Gradient(top).normalized().x(), before.normalized().x() + 0.04);
}

// Two balls a voxel and a half apart that contacts between them say are one.
TEST(FlowStep, TwoBodiesMerge) {
  TriangleMesh two = testing::Icosphere(3);
  for (Eigen::Vector3d& v : two.vertices) v = 0.2 * v - Eigen::Vector3d(0.215, 0, 0);
  const size_t n = two.vertices.size(), faces = two.faces.size();
  for (size_t i = 0; i < n; ++i) two.vertices.push_back(two.vertices[i] + Eigen::Vector3d(0.43, 0, 0));
  for (size_t f = 0; f < faces; ++f) two.faces.push_back(two.faces[f].array() + static_cast<int>(n));
  SdfOptions sdf;
  sdf.half_width_voxels = 4;
  const LevelSet surface = MeshToLevelSet(two, kVoxel, sdf);
  ASSERT_GT(surface.Value(Eigen::Vector3d::Zero()), 0);
  std::vector<OrientedPoint> contacts;
  for (int k = 0; k < 8; ++k) {
    OrientedPoint contact;
    const Eigen::Vector3d out(0, std::cos(k * M_PI / 4), std::sin(k * M_PI / 4));
    contact.bundle_position = 0.1 * out;
    contact.normal = out;
    contact.sigma_position = 0.001;
    contact.sigma_normal = 0.1;
    contact.reach = 0.1;
    contacts.push_back(contact);
  }
  FlowOptions options = Nothing();
  options.force = 1;
  options.max_steps = 200;
  const LevelSet merged = FlowStep({surface, surface, Bend::kFlat, 1, contacts, {}, {}}, options, nullptr);
  EXPECT_LT(merged.Value(Eigen::Vector3d::Zero()), 0);
}

}  // namespace
}  // namespace glint
