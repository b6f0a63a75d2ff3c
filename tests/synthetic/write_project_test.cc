#include "synthetic/write_project.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "colmap/project.h"
#include "io/mesh_io.h"
#include "light/light_io.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

class WriteProject : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    dir_ = fs::temp_directory_path() / ("glint_write_project_" + std::to_string(::getpid()));
    SyntheticOptions options;
    options.scene = "blob";
    options.views = 10;
    options.width = 200;
    options.height = 150;
    options.lights = 2;
    scene_ = SynthesizeScene(options);
    WriteSyntheticProject(scene_, dir_);
  }
  static void TearDownTestSuite() { fs::remove_all(dir_); }

  static inline fs::path dir_;
  static inline SyntheticScene scene_;
};

TEST_F(WriteProject, IsCompleteAndReadsBack) {
  const ProjectPaths paths = FindProject(dir_);
  EXPECT_EQ(paths.model, dir_ / "sparse" / "0");
  EXPECT_EQ(paths.images, dir_ / "images");
  const Model model = ReadModel(paths.model);
  EXPECT_TRUE(model.warnings.empty());
  ASSERT_EQ(model.images.size(), 10u);
  ASSERT_EQ(model.points.size(), scene_.model.points.size());
  for (size_t i = 0; i < model.points.size(); ++i) EXPECT_EQ(model.points[i].xyz, scene_.model.points[i].xyz);

  const std::vector<Light> lights = ReadLights(dir_ / "truth" / "lights.json");
  ASSERT_EQ(lights.size(), 2u);
  EXPECT_LT((lights[1].vector - scene_.lights[1].vector).norm(), 1e-12);

  const TriangleMesh mesh = ReadMesh(dir_ / "truth" / "mesh.ply");
  EXPECT_EQ(mesh.normals.size(), mesh.vertices.size());
  for (const Eigen::Vector3d& x : mesh.vertices) ASSERT_LT(std::abs(scene_.shape->Value(x)), 1e-6);

  std::ifstream points_file(dir_ / "truth" / "points.json");
  const auto origins = nlohmann::json::parse(points_file);
  EXPECT_EQ(origins["virtual"].size() + origins["object"].size() + origins["surroundings"].size(), model.points.size());
}

TEST_F(WriteProject, TruthImagesAgreeWithTheList) {
  std::ifstream file(dir_ / "truth" / "highlights.json");
  const auto highlights = nlohmann::json::parse(file)["highlights"];
  ASSERT_GE(highlights.size(), 10u);
  for (const Image& image : scene_.model.images) {
    const cv::Mat photograph = cv::imread((dir_ / "images" / image.name).string());
    const cv::Mat mask = cv::imread((dir_ / "truth" / "masks" / (image.name + ".png")).string(), cv::IMREAD_UNCHANGED);
    const cv::Mat bright =
        cv::imread((dir_ / "truth" / "highlights" / (image.name + ".png")).string(), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(photograph.size(), cv::Size(200, 150));
    ASSERT_EQ(mask.type(), CV_8UC1);
    ASSERT_EQ(bright.type(), CV_8UC1);
    EXPECT_EQ(cv::countNonZero(bright & ~mask), 0);
    for (const auto& h : highlights)
      if (h["image"] == image.name && h["lit"] && h["strength"] > 1.5) {
        const cv::Point pixel(static_cast<int>(h["x"].get<double>()), static_cast<int>(h["y"].get<double>()));
        EXPECT_EQ(mask.at<uint8_t>(pixel), 255);
      }
  }
}

TEST_F(WriteProject, ColmapReadsItAndAgreesOnTheError) {
  if (std::system("command -v colmap > /dev/null 2>&1") != 0) GTEST_SKIP() << "the colmap program is not installed";
  const std::string command =
      "QT_QPA_PLATFORM=offscreen colmap model_analyzer --path '" + (dir_ / "sparse" / "0").string() + "' 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  ASSERT_TRUE(pipe);
  std::string output;
  char buffer[512];
  while (fgets(buffer, sizeof buffer, pipe)) output += buffer;
  ASSERT_EQ(pclose(pipe), 0) << output;
  EXPECT_NE(output.find("Registered images: 10"), std::string::npos) << output;
  EXPECT_NE(output.find("Points: " + std::to_string(scene_.model.points.size())), std::string::npos) << output;
  double mean = 0;
  for (const Point3D& p : scene_.model.points) mean += p.error_px / static_cast<double>(scene_.model.points.size());
  const std::string label = "Mean reprojection error: ";
  const size_t at = output.find(label);
  ASSERT_NE(at, std::string::npos) << output;
  EXPECT_NEAR(std::stod(output.substr(at + label.size())), mean, 1e-4);
}

}  // namespace
}  // namespace glint
