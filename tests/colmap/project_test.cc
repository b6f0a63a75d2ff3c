#include "colmap/project.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/colmap/test_model.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::SmallModel;
using testing_support::TemporaryFolder;
using testing_support::WriteFile;

void WriteImages(const fs::path& folder, const std::string& suffix = "", int num_images = 4) {
  for (const Image& image : SmallModel(num_images).images) WriteFile(folder / (image.name + suffix), "x");
}

struct Layout {
  std::string name, model, images, given;  // relative to a scratch folder
};

class ProjectLayout : public testing::TestWithParam<Layout> {};

INSTANTIATE_TEST_SUITE_P(Usual, ProjectLayout,
                         testing::Values(Layout{"Sparse0", "p/sparse/0", "p/images", "p"},
                                         Layout{"Sparse", "p/sparse", "p/images", "p"},
                                         Layout{"Dense", "p/dense/sparse", "p/dense/images", "p"},
                                         Layout{"DenseGiven", "p/dense/sparse", "p/dense/images", "p/dense"},
                                         Layout{"Dense0", "p/dense/0/sparse", "p/dense/0/images", "p"},
                                         Layout{"Colmap", "p/colmap/sparse/0", "p/images", "p"},
                                         Layout{"Distorted", "p/distorted/sparse/0", "p/input", "p"},
                                         Layout{"ModelItself", "p/sparse/0", "p/images", "p/sparse/0"},
                                         Layout{"SparseGiven", "p/sparse/0", "p/images", "p/sparse"},
                                         Layout{"AllInOneFolder", "p", "p", "p"},
                                         Layout{"ImagesBesideModelFiles", "p", "p/images", "p"},
                                         Layout{"NumberedModels", "p/0", "p/images", "p"},
                                         Layout{"OtherImageFolder", "p/sparse/0", "p/photos", "p"},
                                         Layout{"ImagesInTheProject", "p/sparse/0", "p", "p"}),
                         [](const auto& test) { return test.param.name; });

TEST_P(ProjectLayout, IsFound) {
  for (const ModelFormat format : {ModelFormat::kBinary, ModelFormat::kText}) {
    const TemporaryFolder folder;
    WriteModel(SmallModel(), folder / GetParam().model, format);
    WriteImages(folder / GetParam().images);
    for (const std::string ending : {"", "/", "/."}) {
      const ProjectPaths paths = FindProject(folder.path().string() + "/" + GetParam().given + ending);
      EXPECT_TRUE(fs::equivalent(paths.model, folder / GetParam().model)) << paths.model;
      ASSERT_FALSE(paths.images.empty());
      EXPECT_TRUE(fs::equivalent(paths.images, folder / GetParam().images)) << paths.images;
      EXPECT_TRUE(paths.masks.empty());
      EXPECT_THAT(paths.notes, testing::IsEmpty());
    }
  }
}

TEST(Project, RelativePathsWork) {
  const TemporaryFolder folder;
  WriteModel(SmallModel(), folder / "sparse/0");
  WriteImages(folder / "images");
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  const ProjectPaths here = FindProject("."), below = FindProject("sparse/0");
  fs::current_path(before);
  EXPECT_EQ(here.images.filename(), "images");
  EXPECT_EQ(below.images.filename(), "images");
}

TEST(Project, LinkedModelsAndImagesWork) {
  const TemporaryFolder folder, elsewhere;
  WriteModel(SmallModel(), elsewhere / "model/0");
  WriteImages(elsewhere / "photographs");
  fs::create_directory_symlink(elsewhere / "model", folder / "sparse");
  fs::create_directory_symlink(elsewhere / "photographs", folder / "images");
  EXPECT_TRUE(fs::equivalent(FindProject(folder.path()).images, elsewhere / "photographs"));
}

TEST(Project, TheLargestSubModelIsTakenAndThatIsSaid) {
  const TemporaryFolder folder;
  WriteModel(SmallModel(2), folder / "sparse/0");
  WriteModel(SmallModel(4), folder / "sparse/1", ModelFormat::kText);
  WriteModel(SmallModel(3), folder / "sparse/10");
  WriteImages(folder / "images");
  const ProjectPaths paths = FindProject(folder.path());
  EXPECT_EQ(paths.model.filename(), "1");
  EXPECT_THAT(paths.notes, testing::ElementsAre(AllOf(HasSubstr("3 sub-models: 0 (2 images), 1 (4 images), 10 (3"),
                                                      HasSubstr("took 1"))));
}

TEST(Project, TheImageFolderThatHoldsTheNamesIsTaken) {
  const TemporaryFolder folder;
  WriteModel(SmallModel(), folder / "sparse/0");
  WriteFile(folder / "images/other.jpg", "x");
  WriteImages(folder / "input");
  EXPECT_EQ(FindProject(folder.path()).images.filename(), "input");
}

TEST(Project, MasksInColmapsNaming) {
  const TemporaryFolder folder;
  WriteModel(SmallModel(), folder / "sparse/0");
  WriteImages(folder / "images");
  WriteImages(folder / "masks", ".png");
  const ProjectPaths paths = FindProject(folder.path());
  EXPECT_TRUE(fs::equivalent(paths.masks, folder / "masks"));
  EXPECT_THAT(paths.notes, testing::IsEmpty());
}

TEST(Project, MasksNamedOtherwiseAreMentioned) {
  const TemporaryFolder folder;
  WriteModel(SmallModel(), folder / "sparse/0");
  WriteImages(folder / "images");
  WriteFile(folder / "masks/view_9.png", "x");
  const ProjectPaths paths = FindProject(folder.path());
  EXPECT_TRUE(paths.masks.empty());
  EXPECT_THAT(paths.notes, testing::ElementsAre(HasSubstr(".jpg.png")));
}

TEST(Project, WhatLiesAboveItIsNotItsOwn) {
  const TemporaryFolder folder;
  // Many objects in one folder, and somebody else's photographs and masks of the same names beside them.
  WriteImages(folder / "images");
  WriteImages(folder / "masks", ".png");
  WriteImages(folder / "scans/masks", ".png");
  WriteModel(SmallModel(), folder / "scans/mug/sparse/0");
  for (const char* given : {"scans/mug", "scans/mug/sparse", "scans/mug/sparse/0"}) {
    const ProjectPaths paths = FindProject(folder / given);
    EXPECT_TRUE(paths.images.empty()) << given << ": " << paths.images;
    EXPECT_TRUE(paths.masks.empty()) << given << ": " << paths.masks;
  }
  WriteImages(folder / "scans/mug");
  WriteModel(SmallModel(), folder / "scans/cup");
  WriteImages(folder / "scans/cup");
  for (const char* given : {"scans/mug", "scans/mug/sparse", "scans/mug/sparse/0", "scans/cup"}) {
    const ProjectPaths paths = FindProject(folder / given);
    EXPECT_FALSE(paths.images.empty()) << given;
    EXPECT_TRUE(paths.masks.empty()) << given << ": " << paths.masks;
  }
  WriteImages(folder / "scans/mug/masks", ".png");
  EXPECT_TRUE(fs::equivalent(FindProject(folder / "scans/mug/sparse/0").masks, folder / "scans/mug/masks"));
}

TEST(Project, WithoutImagesIsFoundWithANote) {
  const TemporaryFolder folder;
  WriteModel(SmallModel(), folder / "sparse/0");
  const ProjectPaths paths = FindProject(folder.path());
  EXPECT_TRUE(paths.images.empty());
  EXPECT_THAT(paths.notes, testing::ElementsAre(HasSubstr("no folder with the model's images")));
}

TEST(Project, GivenFoldersAreTakenAsTheyAre) {
  const TemporaryFolder folder;
  WriteModel(SmallModel(), folder / "sparse/0");
  WriteImages(folder / "images");
  fs::create_directories(folder / "elsewhere");
  EXPECT_EQ(FindProject(folder.path(), folder / "elsewhere").images, folder / "elsewhere");
  EXPECT_EQ(FindProject(folder.path(), {}, folder / "elsewhere").masks, folder / "elsewhere");
  EXPECT_THROW(FindProject(folder.path(), folder / "nowhere"), InputError);
  EXPECT_THROW(FindProject(folder.path(), {}, folder / "nowhere"), InputError);
}

TEST(Project, SaysWhatIsMissing) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "images");
  WriteFile(folder / "file", "x");
  const auto error_of = [](const fs::path& path) -> std::string {
    try {
      FindProject(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(error_of(folder / "none"), HasSubstr("found nothing"));
  EXPECT_THAT(error_of(folder / "file"), HasSubstr("found a file"));
  EXPECT_THAT(error_of(folder.path()), HasSubstr("sparse/0, sparse or dense/sparse, found none"));
}

}  // namespace
}  // namespace glint
