#include "colmap/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

namespace glint {
namespace {

using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

// A sound camera of every model, with distortion as real lenses have it.
std::vector<Camera> AllCameras() {
  const auto camera = [](CameraModel model, std::vector<double> params) {
    return Camera{1, model, 1600, 1200, std::move(params)};
  };
  return {
      camera(CameraModel::kSimplePinhole, {1300, 790, 610}),
      camera(CameraModel::kPinhole, {1300, 1310, 790, 610}),
      camera(CameraModel::kSimpleRadial, {1300, 790, 610, -0.13}),
      camera(CameraModel::kRadial, {1300, 790, 610, -0.21, 0.11}),
      camera(CameraModel::kOpenCV, {1300, 1310, 790, 610, -0.21, 0.11, 1e-3, -2e-3}),
      camera(CameraModel::kOpenCVFisheye, {620, 625, 790, 610, -0.01, 0.02, -0.012, 0.002}),
      camera(CameraModel::kFullOpenCV, {1300, 1310, 790, 610, -0.3, 0.2, 1e-3, -2e-3, 0.05, 0.1, 0.02, 0.01}),
      camera(CameraModel::kFov, {900, 905, 790, 610, 0.9}),
      camera(CameraModel::kSimpleRadialFisheye, {620, 790, 610, -0.02}),
      camera(CameraModel::kRadialFisheye, {620, 790, 610, -0.02, 0.003}),
      camera(CameraModel::kThinPrismFisheye,
             {620, 625, 790, 610, -0.01, 0.004, 1e-3, -1e-3, -0.001, 0.0002, 1e-3, -2e-3}),
      camera(CameraModel::kRadTanThinPrismFisheye,
             {620, 625, 790, 610, 0.02, -0.01, 0.003, -0.001, 0.0004, -0.00005, 1e-3, -1e-3, 1e-3, -5e-4, 5e-4, 2e-4}),
      camera(CameraModel::kSimpleDivision, {1000, 790, 610, -0.2}),
      camera(CameraModel::kDivision, {1000, 1010, 790, 610, -0.2}),
      camera(CameraModel::kSimpleFisheye, {620, 790, 610}),
      camera(CameraModel::kFisheye, {620, 625, 790, 610}),
      camera(CameraModel::kEucm, {800, 805, 790, 610, 0.6, 1.1}),
      camera(CameraModel::kEquirectangular, {1600, 1200}),
  };
}

std::string NameOf(const Camera& camera) { return std::string(*CameraModelName(static_cast<int>(camera.model))); }

class EveryCamera : public testing::TestWithParam<Camera> {};

INSTANTIATE_TEST_SUITE_P(Models, EveryCamera, testing::ValuesIn(AllCameras()),
                         [](const auto& test) { return NameOf(test.param); });

TEST(CameraModels, IdsAndNamesAreThoseOfColmap) {
  const auto cameras = AllCameras();
  ASSERT_EQ(cameras.size(), 18);
  for (int id = 0; id < 18; ++id) {
    EXPECT_EQ(static_cast<int>(cameras[id].model), id);
    EXPECT_EQ(CameraModelFromName(*CameraModelName(id)), cameras[id].model);
    EXPECT_EQ(CameraModelNumParams(id), cameras[id].params.size());
    const auto names = *CameraModelParamNames(id);
    EXPECT_EQ(std::count(names.begin(), names.end(), ',') + 1, static_cast<long>(cameras[id].params.size()));
  }
  EXPECT_FALSE(CameraModelName(-1));
  EXPECT_FALSE(CameraModelName(18));
  EXPECT_FALSE(CameraModelNumParams(1000));
  EXPECT_FALSE(CameraModelFromName("PINHOLE "));
}

TEST_P(EveryCamera, PixelToBearingAndBackOverTheWholeImage) {
  const Camera& camera = GetParam();
  for (int y = 0; y <= 24; ++y) {
    for (int x = 0; x <= 32; ++x) {
      const Eigen::Vector2d px(x * 50 + 0.25 * (x == 0) - 0.25 * (x == 32),
                               y * 50 + 0.25 * (y == 0) - 0.25 * (y == 24));
      const auto bearing = BearingOfPixel(camera, px);
      ASSERT_TRUE(bearing) << px.transpose();
      EXPECT_NEAR(bearing->norm(), 1, 1e-14);
      const auto back = ProjectToPixel(camera, *bearing);
      ASSERT_TRUE(back) << px.transpose();
      EXPECT_LT((*back - px).norm(), 1e-9) << px.transpose();
    }
  }
}

TEST_P(EveryCamera, ProjectionDependsOnTheDirectionAlone) {
  const Camera& camera = GetParam();
  const auto bearing = BearingOfPixel(camera, {1000, 300});
  ASSERT_TRUE(bearing);
  for (const double scale : {1e-6, 1e-3, 1e3, 1e6}) {
    EXPECT_LT((*ProjectToPixel(camera, scale * *bearing) - Eigen::Vector2d(1000, 300)).norm(), 1e-9) << scale;
  }
}

TEST_P(EveryCamera, IsSmoothAndOrientedLikeTheImage) {
  const Camera& camera = GetParam();
  // x to the right, y down: the pixel's axes and the bearing's agree, and the map keeps its orientation.
  for (const Eigen::Vector2d& px : {Eigen::Vector2d(800, 600), Eigen::Vector2d(300, 900), Eigen::Vector2d(1400, 200)}) {
    const auto b = *BearingOfPixel(camera, px);
    const Eigen::Vector3d dx = *BearingOfPixel(camera, px + Eigen::Vector2d(1, 0)) - b;
    const Eigen::Vector3d dy = *BearingOfPixel(camera, px + Eigen::Vector2d(0, 1)) - b;
    EXPECT_GT(dx.cross(dy).dot(b), 0);
  }
  const auto center = *BearingOfPixel(camera, {camera.width * 0.5, camera.height * 0.5});
  EXPECT_GT(center.z(), 0.99);
  EXPECT_GT(BearingOfPixel(camera, {1000, 600})->x(), center.x());
  EXPECT_GT(BearingOfPixel(camera, {800, 800})->y(), center.y());
}

TEST_P(EveryCamera, MeanFocalLengthIsPixelsARadianAtTheAxis) {
  const Camera& camera = GetParam();
  const double angle = 1e-4;
  const auto pixel = [&](double ax, double ay) { return *ProjectToPixel(camera, {std::sin(ax), std::sin(ay), 1}); };
  const double slope =
      0.5 * ((pixel(angle, 0) - pixel(-angle, 0)).norm() + (pixel(0, angle) - pixel(0, -angle)).norm()) / (2 * angle);
  // FOV's and EUCM's focal length is not the slope at the axis: there r_d = r · 2 tan(ω/2)/ω, and r/(α + 1 - α).
  const double factor = camera.model == CameraModel::kFov ? 2 * std::tan(0.45) / 0.9 : 1;
  EXPECT_NEAR(slope, factor * MeanFocalLength(camera), 1e-4 * slope);
}

TEST_P(EveryCamera, WithoutDistortionIsThePlainProjection) {
  Camera camera = GetParam();
  const size_t num_intrinsics = NameOf(camera).starts_with("SIMPLE") || NameOf(camera).starts_with("RADIAL") ? 3 : 4;
  for (size_t i = num_intrinsics; i < camera.params.size(); ++i) camera.params[i] = 0;
  if (camera.model == CameraModel::kEucm) camera.params[5] = 1;
  if (camera.model == CameraModel::kEquirectangular) return;
  const Eigen::Vector3d x(0.4, -0.3, 1.2);
  const double f1 = camera.params[0], f2 = camera.params[num_intrinsics == 3 ? 0 : 1];
  const Eigen::Vector2d c(camera.params[num_intrinsics - 2], camera.params[num_intrinsics - 1]);
  const bool is_fisheye = NameOf(camera).find("FISHEYE") != std::string::npos;
  const double r = 0.5 / 1.2, scale = is_fisheye ? std::atan(r) / 0.5 : 1 / 1.2;
  const Eigen::Vector2d expected = Eigen::Vector2d(f1 * 0.4 * scale, -f2 * 0.3 * scale) + c;
  EXPECT_LT((*ProjectToPixel(camera, x) - expected).norm(), 1e-10);
}

TEST_P(EveryCamera, RefusesWhatCannotBeUsed) {
  const Camera sound = GetParam();
  EXPECT_FALSE(CameraProblem(sound)) << *CameraProblem(sound);
  Camera camera = sound;
  camera.params.pop_back();
  EXPECT_THAT(CameraProblem(camera).value_or(""), HasSubstr("parameters"));
  camera = sound;
  camera.params[0] = -camera.params[0];
  EXPECT_THAT(CameraProblem(camera).value_or(""), HasSubstr("positive"));
  camera = sound;
  camera.params.back() = std::nan("");
  EXPECT_THAT(CameraProblem(camera).value_or(""), HasSubstr("finite"));
  camera = sound;
  camera.width = 0;
  EXPECT_THAT(CameraProblem(camera).value_or(""), HasSubstr("width"));
  camera.width = camera.height = 40000;  // more than OpenCV reads
  EXPECT_THAT(CameraProblem(camera).value_or(""), HasSubstr("pixels"));
}

TEST(Camera, PerspectiveModelsSeeNothingBehindThem) {
  for (const Camera& camera : AllCameras()) {
    const auto id = static_cast<int>(camera.model);
    if (id > 4 && id != 6 && id != 7) continue;
    EXPECT_FALSE(ProjectToPixel(camera, {0.1, 0.1, -1})) << NameOf(camera);
    EXPECT_FALSE(ProjectToPixel(camera, {0.1, 0.1, 0})) << NameOf(camera);
  }
}

TEST(Camera, FisheyesSeeBehindThemAsFarAsTheyAreOneToOne) {
  const Camera camera{1, CameraModel::kFisheye, 1600, 1600, {250, 250, 800, 800}};
  const Eigen::Vector3d behind = Eigen::Vector3d(1, 0, -0.5).normalized();
  const auto px = ProjectToPixel(camera, behind);
  ASSERT_TRUE(px);
  EXPECT_NEAR(px->x(), 800 + 250 * std::atan2(1, -0.5), 1e-10);
  EXPECT_LT((*BearingOfPixel(camera, *px) - behind).norm(), 1e-14);
  EXPECT_FALSE(ProjectToPixel(camera, {0, 0, -1}));
  EXPECT_FALSE(BearingOfPixel(camera, {800 + 250 * 3.2, 800}));
}

TEST(Camera, DivisionModelsInvertBehindTheCamera) {
  const Camera camera{1, CameraModel::kSimpleDivision, 1600, 1200, {500, 800, 600, -0.6}};
  for (const double angle : {0.3, 1.5, 1.6, 2.2, 2.8}) {
    const Eigen::Vector3d ray(std::sin(angle) * 0.6, std::sin(angle) * 0.8, std::cos(angle));
    const auto px = ProjectToPixel(camera, ray);
    ASSERT_TRUE(px) << angle;
    EXPECT_LT((*BearingOfPixel(camera, *px) - ray).norm(), 1e-12) << angle;
  }
}

TEST(Camera, NothingIsProjectedBeyondTheFoldOfADistortion) {
  // r (1 - 0.4 r²) rises up to r = 0.913 and falls again: beyond it two points share a pixel.
  const Camera camera{1, CameraModel::kSimpleRadial, 1600, 1200, {1000, 800, 600, -0.4}};
  const double fold = std::sqrt(1 / 1.2);
  EXPECT_TRUE(ProjectToPixel(camera, {fold - 1e-3, 0, 1}));
  EXPECT_FALSE(ProjectToPixel(camera, {fold + 1e-3, 0, 1}));
  EXPECT_FALSE(ProjectToPixel(camera, {1.4, 0, 1}));
  const double farthest = fold * (1 - 0.4 * fold * fold);
  EXPECT_TRUE(BearingOfPixel(camera, {800 + 1000 * (farthest - 1e-4), 600}));
  EXPECT_FALSE(BearingOfPixel(camera, {800 + 1000 * (farthest + 1e-4), 600}));
  // With a higher order that bends it back up the outer branch is not taken either.
  const Camera waved{1, CameraModel::kRadial, 1600, 1200, {1000, 800, 600, -0.6, 0.12}};
  EXPECT_FALSE(ProjectToPixel(waved, {2.5, 0, 1}));
  for (double r = 0; r < 0.85; r += 0.01) {
    const auto px = ProjectToPixel(waved, {r, 0, 1});
    ASSERT_TRUE(px) << r;
    const auto bearing = BearingOfPixel(waved, *px);
    ASSERT_TRUE(bearing) << r;
    EXPECT_NEAR(bearing->x() / bearing->z(), r, 1e-9);
  }
}

TEST(Camera, StrongRandomDistortionsInvertWhereverTheyProject) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> strength(-0.6, 0.6), place(-1.5, 1.5);
  int num_projected = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    Camera camera = AllCameras()[trial % 18];
    const auto id = static_cast<int>(camera.model);
    if (id == 7 || id >= 12) continue;
    const size_t first = camera.params.size() - (id == 2 || id == 8 ? 1 : id == 3 || id == 9 ? 2 : 0);
    for (size_t i = std::min(first, std::max<size_t>(4, first)); i < camera.params.size(); ++i) {
      camera.params[i] = strength(random);
    }
    const Eigen::Vector3d x = Eigen::Vector3d(place(random), place(random), 1).normalized();
    const auto px = ProjectToPixel(camera, x);
    if (!px) continue;
    ++num_projected;
    const auto bearing = BearingOfPixel(camera, *px);
    ASSERT_TRUE(bearing) << NameOf(camera) << " trial " << trial;
    // Near a fold the inverse is badly conditioned; the pixel must be met all the same.
    const auto back = ProjectToPixel(camera, *bearing);
    ASSERT_TRUE(back) << NameOf(camera) << " trial " << trial;
    EXPECT_LT((*back - *px).norm(), 1e-9) << NameOf(camera) << " trial " << trial;
  }
  EXPECT_GT(num_projected, 800);
}

TEST(Camera, FovIsContinuousInOmegaAndRadius) {
  for (const double omega : {0.0, 1e-12, 1e-8, 1e-5, 1e-3, 0.0099, 0.0101, 0.5}) {
    const Camera camera{1, CameraModel::kFov, 1600, 1200, {1000, 1000, 800, 600, omega}};
    for (const double r : {0.0, 1e-12, 1e-6, 0.009, 0.011, 0.7}) {
      const Eigen::Vector3d x(r, 0, 1);
      const auto px = ProjectToPixel(camera, x);
      ASSERT_TRUE(px);
      const double tangent = 2 * std::tan(omega / 2);
      const double exact = omega < 1e-6 ? r : std::atan(r * tangent) / omega;
      EXPECT_NEAR(px->x(), 800 + 1000 * exact, 1e-8) << omega << " " << r;
      EXPECT_LT((*BearingOfPixel(camera, *px) - x.normalized()).norm(), 1e-12);
    }
  }
}

TEST(Camera, EquirectangularPutsTheAxesWhereColmapDoes) {
  const Camera camera{1, CameraModel::kEquirectangular, 400, 200, {400, 200}};
  const auto near = [&](const Eigen::Vector3d& x, double px, double py) {
    EXPECT_LT((*ProjectToPixel(camera, x) - Eigen::Vector2d(px, py)).norm(), 1e-10) << x.transpose();
  };
  near({0, 0, 1}, 200, 100);
  near({1, 0, 0}, 300, 100);
  near({-1, 0, 0}, 100, 100);
  near({0, -1, 0}, 200, 0);
  near({0, 1, 1}, 200, 150);
  EXPECT_FALSE(ProjectToPixel(camera, {0, 0, 0}));
  EXPECT_FALSE(BearingOfPixel(camera, {100, -1}));
  EXPECT_NEAR(MeanFocalLength(camera), 200 / kPi, 1e-12);
}

}  // namespace
}  // namespace glint
