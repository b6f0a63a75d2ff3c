#include "stereo/textured_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/median.h"
#include "geometry/edge_topology.h"
#include "geometry/pseudo_normals.h"
#include "io/project_images.h"
#include "tests/stereo/textured_ball.h"
#include "tests/support/ball_mesh.h"

namespace glint {
namespace {

class TexturedPlacesTest : public ::testing::Test {
 protected:
  // On the surface of a ball of that radius.
  std::vector<TexturedPlace> Find(const testing::Look& look, double radius,
                                  const std::vector<Light>& lights = {}) const {
    const SightColors colors(MemoryImages(testing::Photographs(scene_, look)), 48, size_t{1} << 28, Progress::Silent());
    TriangleMesh surface = testing::BallMesh({0, 0, 0}, radius, 40);
    surface.normals = ComputePseudoNormals(surface, BuildEdgeTopology(surface)).vertex;
    return FindTexturedPlaces(scene_, colors, SpreadPatches(surface, scene_, 0.1), lights, 0.05);
  }

  const Scene scene_ = testing::BallScene(30);
};

TEST_F(TexturedPlacesTest, ATexturedSurfaceIsFoundWhereItIs) {
  for (const double radius : {0.985, 1.0, 1.02}) {
    const std::vector<TexturedPlace> places = Find(testing::Texture, radius);
    ASSERT_GT(places.size(), 60u) << radius;
    std::vector<double> off, in_sigmas;
    for (const TexturedPlace& p : places) {
      off.push_back(p.position.norm() - 1);
      in_sigmas.push_back(std::abs(off.back()) / p.sigma);
      EXPECT_GT(p.normal.dot(p.position), 0.95);
    }
    EXPECT_NEAR(Median(off), 0, 0.0015) << radius;  // a pixel is 0.009 wide
    std::sort(in_sigmas.begin(), in_sigmas.end());
    EXPECT_LT(in_sigmas[in_sigmas.size() * 9 / 10], 3) << radius;
  }
}

TEST_F(TexturedPlacesTest, OneColourShowsNothing) { EXPECT_TRUE(Find(testing::Plain, 1.01).empty()); }

// A gloss of some degrees' width, mirroring a lamp: it moves with the eye, and lies behind the surface for any two.
TEST_F(TexturedPlacesTest, AHighlightIsNoTexture) {
  const Eigen::Vector3d to_light = Eigen::Vector3d(0.3, 0.2, 1).normalized();
  const testing::Look glossy = [&](const Eigen::Vector3d& x, const Eigen::Vector3d& to_eye) -> Eigen::Vector3d {
    const double cosine = x.normalized().dot((to_light + to_eye).normalized());
    return testing::Plain(x, to_eye) + Eigen::Vector3d::Constant(80 * std::exp((cosine - 1) / 0.002));
  };
  Light light;
  light.vector = to_light;
  EXPECT_TRUE(Find(glossy, 1.005, {light}).empty());
  for (const TexturedPlace& p : Find(glossy, 1.005)) EXPECT_GT(p.sigma, 0);  // unknown lights: few at the most
  EXPECT_LT(Find(glossy, 1.005).size(), 5u);
}

}  // namespace
}  // namespace glint
