#include "seed/subdivide.h"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "geometry/edge_topology.h"
#include "tests/support/shapes.h"

namespace glint {
namespace {

// Mean distance from the unit sphere, outward.
double MeanOutward(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Eigen::Vector3d& v : mesh.vertices) sum += v.norm() - 1;
  return sum / static_cast<double>(mesh.vertices.size());
}

TEST(SubdivideSmoothly, ASphereNeitherShrinksNorGrows) {
  std::vector<double> errors;
  for (int level : {2, 3}) {
    const TriangleMesh coarse = testing::Icosphere(level);
    const TriangleMesh fine = SubdivideSmoothly(coarse, 2);
    ASSERT_EQ(fine.faces.size(), 16 * coarse.faces.size());
    errors.push_back(std::abs(MeanOutward(fine)));
  }
  EXPECT_LT(errors[0], 2e-3);  // the middles of these facets lie 10e-3 inside
  EXPECT_LT(errors[1], errors[0] / 3);
}

TEST(SubdivideSmoothly, KeepsOrientation) {
  const TriangleMesh fine = SubdivideSmoothly(testing::Icosphere(1), 1);
  double volume = 0;
  for (const Eigen::Vector3i& f : fine.faces)
    volume += fine.vertices[f[0]].dot(fine.vertices[f[1]].cross(fine.vertices[f[2]])) / 6;
  EXPECT_NEAR(volume, 4 * M_PI / 3, 0.2);
}

}  // namespace
}  // namespace glint
