#include "photometry/shading.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "photometry/shadows.h"
#include "tests/support/ellipsoid_scene.h"
#include "tests/support/shapes.h"

namespace glint {
namespace {

// A matte unit sphere in a room and under lights, its patches' normals off by some degrees, one in ten of them a mark.
struct MatteSphere {
  TriangleMesh mesh = testing::Icosphere(4);
  Scene scene;
  std::vector<Light> lights;
  std::vector<SurfacePatch> patches;

  explicit MatteSphere(const std::vector<Light>& given) : lights(given) {
    mesh.normals = mesh.vertices;
    for (const Rigid3d& pose : testing::DomeViews(4)) {
      View& view = scene.views.emplace_back();
      view.camera = {1, CameraModel::kPinhole, 100, 100, {100, 100, 50, 50}};
      view.cam_from_world = pose;
    }
  }

  void Paint(double normal_error, bool follows_normals = true) {
    std::mt19937 random(7);
    std::normal_distribution<double> error(0, normal_error);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const Eigen::Vector3d& n : mesh.vertices) {
      SurfacePatch patch;
      patch.position = n;
      patch.normal = (n + Eigen::Vector3d(error(random), error(random), error(random))).normalized();
      patch.radius_world = 0.02;
      const double albedo = uniform(random) < 0.1 ? 0.3 : 1;
      for (uint32_t v = 0; v < scene.views.size(); ++v) {
        double light = 0.1 + 0.04 * n.z();
        for (const Light& l : lights)
          light += 0.5 * std::max(0.0, n.dot(DirectionToLight(l, scene.views[v].cam_from_world, n)));
        if (!follows_normals) light = uniform(random);
        patch.looks.push_back({v, albedo * light * Eigen::Array3d(0.8, 0.3, 0.2)});
      }
      patches.push_back(patch);
    }
  }
};

double MedianError(const std::vector<Tilt>& tilts) {
  std::vector<double> errors;
  for (const Tilt& tilt : tilts)
    errors.push_back(std::abs(tilt.cosine - tilt.direction.dot(tilt.position.normalized())));
  std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
  return errors[errors.size() / 2];
}

// What it says of the normals is better than the normals that it was fitted with.
TEST(Shading, TellsTheNormalsOfAMatteSphere) {
  MatteSphere sphere({testing::DistantLight(1, 0.2, 1), testing::DistantLight(-0.8, 0.5, 1)});
  sphere.Paint(0.08);
  const ShadingTilts shading = TiltsFromShading(sphere.mesh, sphere.scene, sphere.lights, sphere.patches);
  ASSERT_EQ(shading.materials.size(), 1u);
  EXPECT_TRUE(shading.materials[0].used);
  EXPECT_GT(shading.tilts.size(), sphere.patches.size() / 3);
  EXPECT_LT(MedianError(shading.tilts), 0.01);
  for (const Tilt& tilt : shading.tilts) {
    EXPECT_NEAR(tilt.direction.norm(), 1, 1e-9);
    EXPECT_LE(tilt.cosine, 1);
    EXPECT_GT(tilt.sigma, 0);
  }
}

// A flash lights each photograph in its own way.
TEST(Shading, LightsThatTheCameraCarriesAreTakenViewByView) {
  Light flash;
  flash.type = LightType::kPoint;
  flash.frame = LightFrame::kCamera;
  flash.vector = {0.3, 0, 0};
  MatteSphere sphere({flash});
  sphere.Paint(0.05);
  // The falloff that the painted sphere does not have is small in the distance.
  for (View& view : sphere.scene.views) EXPECT_GT(view.Center().norm(), 2);
  const ShadingTilts shading = TiltsFromShading(sphere.mesh, sphere.scene, sphere.lights, sphere.patches);
  EXPECT_GT(shading.tilts.size(), sphere.patches.size() / 2);
  EXPECT_LT(MedianError(shading.tilts), 0.1);
}

TEST(Shading, SaysNothingWhereBrightnessDoesNotFollowTheNormals) {
  MatteSphere sphere({testing::DistantLight(1, 0.2, 1)});
  sphere.Paint(0.05, false);
  const ShadingTilts shading = TiltsFromShading(sphere.mesh, sphere.scene, sphere.lights, sphere.patches);
  ASSERT_EQ(shading.materials.size(), 1u);
  EXPECT_FALSE(shading.materials[0].used);
  EXPECT_TRUE(shading.tilts.empty());
}

TEST(Shading, BlackAndUnlitSurfacesSayNothing) {
  MatteSphere sphere({testing::DistantLight(1, 0.2, 1)});
  sphere.Paint(0.05);
  EXPECT_TRUE(TiltsFromShading(sphere.mesh, sphere.scene, {}, sphere.patches).tilts.empty());
  for (SurfacePatch& patch : sphere.patches)
    for (PatchLook& look : patch.looks) look.rgb.setZero();
  EXPECT_TRUE(TiltsFromShading(sphere.mesh, sphere.scene, sphere.lights, sphere.patches).tilts.empty());
}

// A small ball over a large one, the light above them.
TEST(Shadows, AreDarkAndTheirEdgesAreInDoubt) {
  TriangleMesh mesh = testing::Icosphere(4);
  const TriangleMesh ball = testing::Icosphere(3);
  const auto offset = static_cast<int>(mesh.vertices.size());
  for (const Eigen::Vector3d& v : ball.vertices) mesh.vertices.push_back(0.4 * v + Eigen::Vector3d(0, 0, 2));
  for (const Eigen::Vector3i& f : ball.faces) mesh.faces.push_back(f + Eigen::Vector3i::Constant(offset));
  const Shadows shadows(mesh);
  const Light above = testing::DistantLight(0, 0, 1);
  const auto at = [&](double x) {
    const Eigen::Vector3d n(x, 0, std::sqrt(1 - x * x));
    return shadows.Irradiance(n, n, above, Rigid3d());
  };
  ASSERT_TRUE(at(0.1));
  EXPECT_TRUE(at(0.1)->isZero());
  EXPECT_FALSE(at(0.4));
  ASSERT_TRUE(at(0.6));
  EXPECT_TRUE(at(0.6)->isApprox(Eigen::Vector3d::UnitZ()));
  const Eigen::Vector3d below = -Eigen::Vector3d::UnitZ();
  EXPECT_TRUE(shadows.Irradiance(below, below, above, Rigid3d())->isZero());
  Light lamp = above;
  lamp.type = LightType::kPoint;
  lamp.vector = {3, 0, 0};
  const Eigen::Vector3d side = Eigen::Vector3d::UnitX();
  const double center_z = BoundingBox(mesh).center().z();
  EXPECT_NEAR(shadows.Irradiance(side, side, lamp, Rigid3d())->norm(), (9 + center_z * center_z) / 4, 1e-9);
}

}  // namespace
}  // namespace glint
