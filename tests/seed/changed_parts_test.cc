#include "seed/changed_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sdf/csg.h"
#include "tests/support/ball_mesh.h"

namespace glint {
namespace {

using testing::BallMesh;

constexpr double kLump = 1.1;  // how far it reaches

// A unit ball with a lump on top, and rays that touch the lump from all around.
class ChangedParts : public ::testing::Test {
 protected:
  ChangedParts() {
    for (int k = 0; k < 12; ++k) {
      const OutlineSample s{.view = static_cast<uint32_t>(k),
                            .px = {0, 0},
                            .ray = {std::cos(2 * M_PI * k / 12), std::sin(2 * M_PI * k / 12), 0},
                            .normal = {0, 0, 1},
                            .depth = 5,
                            .near = 4.9,
                            .far = 5.1};
      outline_.push_back(s);
      View& view = scene_.views.emplace_back();
      view.cam_from_world.translation = -(Eigen::Vector3d(0, 0, kLump) - 5 * s.ray);
    }
  }

  static double Top(const TriangleMesh& mesh) {
    double top = 0;
    for (const Eigen::Vector3d& v : mesh.vertices) top = std::max(top, v.z());
    return top;
  }

  const TriangleMesh ball_ = BallMesh({0, 0, 0}, 1, 50);
  const TriangleMesh with_lump_ = Union(ball_, BallMesh({0, 0, kLump - 0.12}, 0.12, 15), 0.03);
  Scene scene_;
  std::vector<OutlineSample> outline_;
};

TEST_F(ChangedParts, BendsNoMoreThanOutlinesAsk) {
  ASSERT_NEAR(Top(with_lump_), kLump, 0.01);
  // Nothing speaks for the lump.
  EXPECT_LT(Top(SmoothChangedParts(scene_, {}, ball_, with_lump_, 0)), 1.03);
  // The outlines do.
  EXPECT_NEAR(Top(SmoothChangedParts(scene_, outline_, ball_, with_lump_, 0)), kLump, 0.02);
}

TEST_F(ChangedParts, StaysButForWhatIsNarrow) {
  EXPECT_GT(Top(SmoothChangedParts(scene_, {}, ball_, with_lump_, 0.03)), 1.07);
  EXPECT_LT(Top(SmoothChangedParts(scene_, {}, ball_, with_lump_, 0.3)), 1.04);
}

TEST_F(ChangedParts, TheRestIsNotTouched) {
  const TriangleMesh smooth = SmoothChangedParts(scene_, outline_, ball_, with_lump_, 0);
  ASSERT_EQ(smooth.vertices.size(), with_lump_.vertices.size());
  for (size_t v = 0; v < smooth.vertices.size(); ++v)
    if (with_lump_.vertices[v].z() < 0.8) {
      ASSERT_EQ(smooth.vertices[v], with_lump_.vertices[v]);
    }
}

}  // namespace
}  // namespace glint
