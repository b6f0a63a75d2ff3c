#include "core/inside.h"

#include <gtest/gtest.h>

#include <fstream>

namespace glint {
namespace {

namespace fs = std::filesystem;

TEST(LiesInside, FollowsLinks) {
  const fs::path root = fs::path(::testing::TempDir()) / "glint_inside_test";
  fs::remove_all(root);
  fs::create_directories(root / "a/b");
  fs::create_directories(root / "elsewhere");
  std::ofstream(root / "elsewhere/file") << "x";
  fs::create_directory_symlink(root / "elsewhere", root / "a/out");
  fs::create_directory_symlink(root / "a/b", root / "a/in");
  fs::create_symlink("../elsewhere/file", root / "a/file");
  fs::create_directory_symlink(root / "a", root / "link_to_a");

  EXPECT_TRUE(LiesInside(root / "a", root / "a"));
  EXPECT_TRUE(LiesInside(root / "a/b", root / "a"));
  EXPECT_TRUE(LiesInside(root / "a/in/new/file", root / "a"));
  EXPECT_TRUE(LiesInside(root / "link_to_a/b", root / "a"));
  EXPECT_TRUE(LiesInside(root / "a/b", root / "link_to_a"));
  EXPECT_FALSE(LiesInside(root / "a/out", root / "a"));
  EXPECT_FALSE(LiesInside(root / "a/out/new/file", root / "a"));
  EXPECT_FALSE(LiesInside(root / "a/file", root / "a"));
  EXPECT_FALSE(LiesInside(root / "a/../elsewhere", root / "a"));
  EXPECT_FALSE(LiesInside(root / "ab", root / "a"));
  fs::remove_all(root);
}

}  // namespace
}  // namespace glint
