#include "geometry/winding_number.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/geometry/test_meshes.h"

namespace glint {
namespace {

TEST(WindingNumber, ExactInsideAndOutside) {
  const TriangleMesh box = testing::Box({0, 0, 0}, {1, 1, 1});
  EXPECT_NEAR(ExactWindingNumber(box, {0.5, 0.4, 0.3}), 1, 1e-14);
  EXPECT_NEAR(ExactWindingNumber(box, {1.5, 0.4, 0.3}), 0, 1e-14);
  EXPECT_NEAR(ExactWindingNumber(testing::Inverted(box), {0.5, 0.4, 0.3}), -1, 1e-14);
  EXPECT_NEAR(ExactWindingNumber(testing::Joined(box, box), {0.5, 0.4, 0.3}), 2, 1e-14);
  EXPECT_NEAR(std::abs(ExactWindingNumber(box, {1, 0.4, 0.3})), 0.5, 0.5 + 1e-12);  // on a face: finite
  EXPECT_TRUE(std::isfinite(ExactWindingNumber(box, {0, 0, 0})));
}

// Half a sphere sees half of the sphere of directions from its centre.
TEST(WindingNumber, OfAnOpenMesh) {
  TriangleMesh mesh = testing::Icosphere(4);
  std::erase_if(mesh.faces, [&](const Eigen::Vector3i& f) {
    return mesh.vertices[f[0]][2] + mesh.vertices[f[1]][2] + mesh.vertices[f[2]][2] < 0;
  });
  EXPECT_NEAR(ExactWindingNumber(mesh, {0, 0, 0}), 0.5, 0.02);
}

TEST(WindingNumber, FastOneIsClose) {
  for (const TriangleMesh& mesh : {testing::SpikySphere(4, 0.4, 2), testing::Icosphere(5)}) {
    TriangleMesh open = mesh;
    open.faces.resize(open.faces.size() * 9 / 10);
    for (const TriangleMesh* m : {&mesh, static_cast<const TriangleMesh*>(&open)}) {
      const Bvh bvh(*m);
      const WindingNumber fast(*m, bvh);
      std::mt19937 random(3);
      double worst = 0;
      for (int i = 0; i < 500; ++i) {
        Eigen::Vector3d p;
        for (int k = 0; k < 3; ++k) p[k] = 3.0 * random() / 4294967295.0 - 1.5;
        worst = std::max(worst, std::abs(fast(p) - ExactWindingNumber(*m, p)));
      }
      EXPECT_LT(worst, 0.015);
    }
  }
}

TEST(WindingNumber, FarFromTheOriginAndOfAnySize) {
  for (double scale : {1e-3, 1.0, 1e6}) {
    const Eigen::Vector3d offset = 1e5 * scale * Eigen::Vector3d(1, -1, 0.5);
    const TriangleMesh mesh = testing::Transformed(testing::Icosphere(3), scale, offset);
    const Bvh bvh(mesh);
    const WindingNumber fast(mesh, bvh);
    EXPECT_NEAR(fast(offset), 1, 3e-3);
    EXPECT_NEAR(fast(offset + Eigen::Vector3d(0.9, 0, 0) * scale), 1, 1e-2);
    EXPECT_NEAR(fast(offset + Eigen::Vector3d(1.1, 0, 0) * scale), 0, 1e-2);
  }
}

TEST(WindingNumber, EmptyMesh) {
  const TriangleMesh none;
  const Bvh bvh(none);
  EXPECT_EQ(WindingNumber(none, bvh)({0, 0, 0}), 0);
}

}  // namespace
}  // namespace glint
