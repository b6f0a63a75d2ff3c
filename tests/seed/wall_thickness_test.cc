#include "seed/wall_thickness.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/edge_topology.h"
#include "geometry/pseudo_normals.h"
#include "tests/support/shapes.h"

namespace glint {
namespace {

constexpr double kHalf = 0.04;

// A round plate, 2 wide and twice `kHalf` thick but for its rim.
TriangleMesh Plate() {
  TriangleMesh plate = testing::Icosphere(5);
  for (Eigen::Vector3d& x : plate.vertices) x.z() = kHalf * std::tanh(6 * x.z());
  return plate;
}

std::vector<WallPlace> PlacesOf(const TriangleMesh& mesh, const Eigen::VectorXd& known) {
  std::vector<Eigen::Vector3d> normals = ComputePseudoNormals(mesh, BuildEdgeTopology(mesh)).vertex;
  for (Eigen::Vector3d& n : normals) n.normalize();
  return WallPlaces(mesh, normals, MakeEvenLaplacian(mesh), known, 0.05, Diagonal(mesh));
}

TEST(WallThickness, AnUnknownSideIsAsFarFromTheOtherAsBesideIt) {
  TriangleMesh plate = Plate();
  Eigen::VectorXd known = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(plate.vertices.size()));
  int num_swollen = 0;
  for (size_t v = 0; v < plate.vertices.size(); ++v) {
    Eigen::Vector3d& x = plate.vertices[v];
    if (x.z() < 0.9 * kHalf || x.x() < 0.4) continue;
    known[static_cast<Eigen::Index>(v)] = 0;
    x.z() += 0.1 * (x.x() - 0.4);
    ++num_swollen;
  }
  const std::vector<WallPlace> places = PlacesOf(plate, known);
  EXPECT_GT(static_cast<double>(places.size()), 0.8 * num_swollen);
  for (const WallPlace& place : places) {
    EXPECT_EQ(known[place.vertex], 0);
    if (plate.vertices[static_cast<size_t>(place.vertex)].head<2>().norm() > 0.85) continue;  // it ends there
    EXPECT_NEAR(place.position.z(), kHalf, 0.15 * kHalf) << plate.vertices[static_cast<size_t>(place.vertex)];
    EXPECT_LT(place.sigma, 0.3 * kHalf);
  }
}

TEST(WallThickness, OnlyAWallThatIsKnownHasAThickness) {
  const TriangleMesh plate = Plate(), ball = testing::Icosphere(4);
  const auto with = [](const TriangleMesh& mesh, double above, double below) {
    Eigen::VectorXd known(static_cast<Eigen::Index>(mesh.vertices.size()));
    for (Eigen::Index v = 0; v < known.size(); ++v)
      known[v] = mesh.vertices[static_cast<size_t>(v)].z() > 0 ? above : below;
    return known;
  };
  EXPECT_TRUE(PlacesOf(plate, with(plate, 1, 0.1)).empty());
  EXPECT_TRUE(PlacesOf(ball, with(ball, 1, 0.9)).empty());
  EXPECT_FALSE(PlacesOf(plate, with(plate, 1, 0.9)).empty());
}

// Spikes are what is measured wrongly.
TEST(WallThickness, AnUnevenWallSaysNothing) {
  TriangleMesh rough = Plate();
  for (size_t v = 0; v < rough.vertices.size(); ++v)
    if (rough.vertices[v].z() > 0.9 * kHalf) rough.vertices[v].z() += (v % 3 == 0 ? 1.5 : 0) * kHalf;
  Eigen::VectorXd known = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(rough.vertices.size()));
  for (Eigen::Index v = 0; v < known.size(); v += 7) known[v] = 0.8;
  EXPECT_TRUE(PlacesOf(rough, known).empty());
}

}  // namespace
}  // namespace glint
