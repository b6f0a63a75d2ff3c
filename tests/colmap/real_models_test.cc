// Models that exist in the wild, and what must become of them. Skipped where ../shared/data is absent.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>

#include "colmap/model.h"
#include "colmap/project.h"
#include "colmap/scene.h"
#include "core/error.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

fs::path Data() { return fs::path(GLINT_SOURCE_DIR) / "../shared/data"; }

std::string ErrorOf(const fs::path& model) {
  try {
    ReadModel(model);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

struct Expected {
  std::string project;
  size_t num_images, num_points, num_observations;  // as COLMAP's model_analyzer counts them
  double error_px;
};

void PrintTo(const Expected& expected, std::ostream* out) { *out << expected.project; }

class SoundProject : public testing::TestWithParam<Expected> {};

INSTANTIATE_TEST_SUITE_P(RealModels, SoundProject,
                         testing::Values(Expected{"vase/project", 44, 8760, 48711, 0.60},
                                         Expected{"real/bronze", 26, 5561, 25103, 0.60},
                                         Expected{"real/can", 71, 4414, 30839, 0.90},
                                         Expected{"real/tumbler", 77, 9262, 57847, 0.70}));

TEST_P(SoundProject, IsReadWhole) {
  const Expected& expected = GetParam();
  if (!fs::exists(Data() / expected.project)) GTEST_SKIP() << "no " << Data() / expected.project;
  const ProjectPaths paths = FindProject(Data() / expected.project);
  EXPECT_EQ(paths.images.filename(), "images");
  const Model model = ReadModel(paths.model);
  EXPECT_THAT(model.warnings, testing::IsEmpty());
  EXPECT_EQ(model.images.size(), expected.num_images);
  EXPECT_EQ(model.points.size(), expected.num_points);
  const Scene scene = MakeScene(model);
  double sum = 0;
  size_t num_observations = 0;
  for (const ScenePoint& point : scene.points) {
    for (const Observation& observation : point.observations) {
      const auto px = scene.views[observation.view].Project(point.position);
      ASSERT_TRUE(px);
      sum += (*px - observation.px.cast<double>()).norm();
      ++num_observations;
    }
  }
  EXPECT_EQ(num_observations, expected.num_observations);
  EXPECT_LT(sum / static_cast<double>(num_observations), expected.error_px);
}

TEST(RealModels, CutFilesAreNamedWithTheRecord) {
  const fs::path model = Data() / "real/stitch_truncated/sparse/0";
  if (!fs::exists(model)) GTEST_SKIP() << "no " << model;
  const std::string error = ErrorOf(model);
  EXPECT_THAT(error, HasSubstr("images.bin: image 14 of 82 (id 14) 'frame_0020.jpg'"));
  EXPECT_THAT(error, HasSubstr("the file is cut at 2359296 bytes"));
}

TEST(RealModels, PosesOfAnotherFrameAreRefused) {
  // All 2D points are at zero, and the poses were replaced by those of an ideal turntable: they do not see the points.
  const fs::path model = Data() / "real/tumbler/sparse_zeroed";
  if (!fs::exists(model)) GTEST_SKIP() << "no " << model;
  EXPECT_THAT(ErrorOf(model), HasSubstr("the poses do not belong to the points"));
}

}  // namespace
}  // namespace glint
