#include "pipeline/outline_file.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "core/error.h"

namespace glint {
namespace {

OutlineSample Sample() {
  OutlineSample s;
  s.view = 2;
  s.px = {100.0 / 3, 0.1};
  s.ray = Eigen::Vector3d(1, 2, 3).normalized();
  s.normal = Eigen::Vector3d(-2, 1, 0).normalized();
  s.near = 0.7;
  s.depth = 1.0 / 3 + 0.5;
  s.far = 0.9;
  s.sigma = 1e-4 / 7;
  return s;
}

TEST(OutlineFile, ReadsBackExactlyWhatWasWritten) {
  const std::filesystem::path path = std::filesystem::path(::testing::TempDir()) / "outline.txt";
  WriteOutline(path, {Sample(), Sample()});
  const std::vector<OutlineSample> read = ReadOutline(path, 3);
  ASSERT_EQ(read.size(), 2u);
  const OutlineSample s = Sample();
  EXPECT_EQ(read[1].view, s.view);
  EXPECT_EQ(read[1].px, s.px);
  EXPECT_EQ(read[1].ray, s.ray);
  EXPECT_EQ(read[1].normal, s.normal);
  EXPECT_EQ(read[1].near, s.near);
  EXPECT_EQ(read[1].depth, s.depth);
  EXPECT_EQ(read[1].far, s.far);
  EXPECT_EQ(read[1].sigma, s.sigma);
}

TEST(OutlineFile, NamesTheLineThatIsWrong) {
  const std::filesystem::path path = std::filesystem::path(::testing::TempDir()) / "outline.txt";
  WriteOutline(path, {Sample(), Sample()});
  EXPECT_THROW(ReadOutline(path, 2), InputError);  // of a scene with fewer views
  std::ofstream(path, std::ios::app) << "0 1 1 1 0 0 0 1 0 1 1 nan 1\n";
  try {
    ReadOutline(path, 3);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), ::testing::AllOf(::testing::HasSubstr("outline.txt"), ::testing::HasSubstr("line 4")));
  }
  EXPECT_THROW(ReadOutline(path.parent_path() / "no outline.txt", 3), InputError);
}

}  // namespace
}  // namespace glint
