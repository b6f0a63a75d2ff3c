// What the installed COLMAP makes of our files and of our camera models. Skipped where there is no colmap program.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "colmap/model.h"
#include "tests/colmap/test_model.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::SmallModel;
using testing_support::TemporaryFolder;

bool HasColmap() { return std::system("command -v colmap > /dev/null 2>&1") == 0; }

// What `colmap ARGUMENTS` prints.
std::string Colmap(const std::string& arguments) {
  FILE* pipe = ::popen(("QT_QPA_PLATFORM=offscreen colmap " + arguments + " 2>&1").c_str(), "r");
  std::string output;
  std::array<char, 4096> buffer;
  while (const size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe)) output.append(buffer.data(), n);
  EXPECT_EQ(::pclose(pipe), 0) << output;
  return output;
}

// The number after "NAME :" in what COLMAP printed.
double Printed(const std::string& name, const std::string& output) {
  const size_t at = output.find(name);
  EXPECT_NE(at, std::string::npos) << output;
  return at == std::string::npos ? -1 : std::strtod(output.c_str() + output.find(':', at) + 1, nullptr);
}

void ExpectNear(const Model& a, const Model& b) {
  ASSERT_EQ(a.images.size(), b.images.size());
  ASSERT_EQ(a.points.size(), b.points.size());
  for (const auto& [id, camera] : a.cameras) EXPECT_EQ(camera.params, b.cameras.at(id).params);
  for (size_t i = 0; i < a.images.size(); ++i) {
    EXPECT_EQ(a.images[i].name, b.images[i].name);
    const auto &x = a.images[i].cam_from_world, &y = b.images[i].cam_from_world;
    EXPECT_LT((x.rotation.coeffs() - y.rotation.coeffs()).norm(), 1e-14);
    EXPECT_LT((x.translation - y.translation).norm(), 1e-14);
    ASSERT_EQ(a.images[i].points2d.size(), b.images[i].points2d.size());
    for (size_t k = 0; k < a.images[i].points2d.size(); ++k) {
      EXPECT_LT((a.images[i].points2d[k].px - b.images[i].points2d[k].px).norm(), 1e-10);
      EXPECT_EQ(a.images[i].points2d[k].point3d_id, b.images[i].points2d[k].point3d_id);
    }
  }
  for (size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(a.points[i].id, b.points[i].id);
    EXPECT_LT((a.points[i].xyz - b.points[i].xyz).norm(), 1e-14);
    EXPECT_EQ(a.points[i].rgb, b.points[i].rgb);
    EXPECT_EQ(a.points[i].track.size(), b.points[i].track.size());
  }
}

Model ModelWithoutBlanksInNames() {
  Model model = SmallModel();
  model.images[1].name = "left/übung_1.jpg";  // COLMAP 3.8 reads a name of its text files up to the first blank
  return model;
}

TEST(ColmapProgram, ConvertsOurBinaryAndOurText) {
  if (!HasColmap()) GTEST_SKIP() << "no colmap program";
  const Model model = ModelWithoutBlanksInNames();
  for (const bool to_text : {true, false}) {
    const TemporaryFolder ours, theirs;
    WriteModel(model, ours.path(), to_text ? ModelFormat::kBinary : ModelFormat::kText);
    Colmap("model_converter --input_path " + ours.path().string() + " --output_path " + theirs.path().string() +
           " --output_type " + (to_text ? "TXT" : "BIN"));
    EXPECT_TRUE(fs::exists(theirs / (to_text ? "images.txt" : "images.bin")));
    const Model read = ReadModel(theirs.path());
    EXPECT_THAT(read.warnings, testing::IsEmpty());
    ExpectNear(model, read);
  }
}

TEST(ColmapProgram, AnalyzesOurModel) {
  if (!HasColmap()) GTEST_SKIP() << "no colmap program";
  const TemporaryFolder folder;
  WriteModel(SmallModel(), folder.path());
  const std::string output = Colmap("model_analyzer --path " + folder.path().string());
  EXPECT_THAT(output, HasSubstr("Registered images: 4"));
  EXPECT_THAT(output, HasSubstr("Points: 12"));
  EXPECT_THAT(output, HasSubstr("Observations: 48"));
}

// Two views of one camera, points all over the image, observations as we project them.
Model ProjectedModel(const Camera& camera) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x(20, 1580), y(20, 1180), depth(2, 6);
  Model model;
  model.cameras[camera.id] = camera;
  for (uint32_t i = 1; i <= 2; ++i) {
    Image& image = model.images.emplace_back();
    image.id = i;
    image.name = std::to_string(i) + ".jpg";
    image.camera_id = camera.id;
    image.cam_from_world.rotation = Eigen::AngleAxisd(0.05 * i, Eigen::Vector3d(0.3, 1, 0.1).normalized());
    image.cam_from_world.translation = {0.1 * i, 0, 0.02};
  }
  for (uint64_t id = 1; model.points.size() < 300; ++id) {
    const auto bearing = BearingOfPixel(camera, {x(random), y(random)});
    if (!bearing || bearing->z() < 0.15) continue;  // COLMAP sees only what lies before the camera
    const Eigen::Vector3d position = model.images[0].cam_from_world.Inverse() * (depth(random) * *bearing);
    const Eigen::Vector3d in_second = model.images[1].cam_from_world * position;
    const auto second = ProjectToPixel(camera, in_second);
    if (!second || in_second.z() < 0.1) continue;
    Point3D& point = model.points.emplace_back();
    point.id = id;
    point.xyz = position;
    for (Image& image : model.images) {
      point.track.push_back({image.id, static_cast<uint32_t>(image.points2d.size())});
      image.points2d.push_back({*ProjectToPixel(camera, image.cam_from_world * position), id});
    }
  }
  return model;
}

class ColmapCamera : public testing::TestWithParam<std::pair<int, std::vector<double>>> {};

// COLMAP 3.8 knows the ids 0 to 10.
INSTANTIATE_TEST_SUITE_P(
    Models, ColmapCamera,
    testing::Values(
        std::pair(0, std::vector<double>{1300, 790, 610}), std::pair(1, std::vector<double>{1300, 1310, 790, 610}),
        std::pair(2, std::vector<double>{1300, 790, 610, -0.13}),
        std::pair(3, std::vector<double>{1300, 790, 610, -0.21, 0.11}),
        std::pair(4, std::vector<double>{1300, 1310, 790, 610, -0.21, 0.11, 1e-3, -2e-3}),
        std::pair(5, std::vector<double>{620, 625, 790, 610, -0.01, 0.02, -0.012, 0.002}),
        std::pair(6, std::vector<double>{1300, 1310, 790, 610, -0.3, 0.2, 1e-3, -2e-3, 0.05, 0.1, 0.02, 0.01}),
        std::pair(7, std::vector<double>{900, 905, 790, 610, 0.9}),
        std::pair(8, std::vector<double>{620, 790, 610, -0.02}),
        std::pair(9, std::vector<double>{620, 790, 610, -0.02, 0.003}),
        std::pair(10, std::vector<double>{620, 625, 790, 610, -0.01, 0.004, 1e-3, -1e-3, -0.001, 0.0002, 1e-3, -2e-3})),
    [](const auto& test) { return std::string(*CameraModelName(test.param.first)); });

TEST_P(ColmapCamera, ProjectsAsWeDo) {
  if (!HasColmap()) GTEST_SKIP() << "no colmap program";
  const auto& [id, params] = GetParam();
  const Camera camera{1, static_cast<CameraModel>(id), 1600, 1200, params};
  const TemporaryFolder ours, theirs;
  WriteModel(ProjectedModel(camera), ours.path());
  // The cost at which COLMAP's bundle adjustment begins is the RMS of its own reprojection errors.
  const std::string output = Colmap("bundle_adjuster --input_path " + ours.path().string() + " --output_path " +
                                    theirs.path().string() + " --BundleAdjustment.max_num_iterations 1");
  EXPECT_EQ(Printed("Residuals", output), 1200);
  EXPECT_LT(Printed("Initial cost", output), 1e-9) << output;
}

TEST(ColmapProgram, BundleAdjustmentSeesADifferentCamera) {
  if (!HasColmap()) GTEST_SKIP() << "no colmap program";
  // The test above can fail: a coefficient that is off by 1e-5 is seen.
  Camera camera{1, CameraModel::kSimpleRadial, 1600, 1200, {1300, 790, 610, -0.13}};
  Model model = ProjectedModel(camera);
  model.cameras[1].params[3] += 1e-5;
  const TemporaryFolder ours, theirs;
  WriteModel(model, ours.path());
  const std::string output = Colmap("bundle_adjuster --input_path " + ours.path().string() + " --output_path " +
                                    theirs.path().string() + " --BundleAdjustment.max_num_iterations 1");
  EXPECT_GT(Printed("Initial cost", output), 1e-4);
}

}  // namespace
}  // namespace glint
