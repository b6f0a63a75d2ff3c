#include "photometry/materials.h"

#include <gmock/gmock.h>

#include <cmath>

namespace glint {
namespace {

SurfacePatch Patch(const Eigen::Array3d& rgb) {
  SurfacePatch patch;
  patch.looks = {{0, rgb}, {1, 1.01 * rgb}, {2, 0.99 * rgb}};
  return patch;
}

// Whatever the light does, a paint keeps its chromaticity.
TEST(Materials, TellsPaintsApartAtAnyBrightness) {
  std::vector<SurfacePatch> patches;
  for (int i = 0; i < 100; ++i) patches.push_back(Patch((0.05 + 0.008 * i) * Eigen::Array3d(0.6, 0.2, 0.2)));
  for (int i = 0; i < 60; ++i) patches.push_back(Patch((0.05 + 0.008 * i) * Eigen::Array3d(0.2, 0.3, 0.6)));
  const auto materials = SortIntoMaterials(patches);
  ASSERT_EQ(materials.size(), 2u);
  EXPECT_EQ(materials[0].size(), 100u);
  EXPECT_EQ(materials[0].back(), 99u);
  EXPECT_EQ(materials[1].size(), 60u);
  EXPECT_EQ(materials[1].front(), 100u);
}

TEST(Materials, AFewSpotsAreNoneAndWhatNobodySeesIsInNone) {
  std::vector<SurfacePatch> patches(10);
  for (int i = 0; i < 100; ++i) patches.push_back(Patch({0.3, 0.2, 0.1}));
  for (int i = 0; i < 3; ++i) patches.push_back(Patch({0.02, 0.02, 0.5}));
  const auto materials = SortIntoMaterials(patches);
  ASSERT_EQ(materials.size(), 1u);
  EXPECT_EQ(materials[0].size(), 100u);
  EXPECT_EQ(materials[0].front(), 10u);
}

TEST(Materials, BlackIsNoTrouble) {
  const auto materials = SortIntoMaterials(std::vector<SurfacePatch>(50, Patch({0, 0, 0})));
  ASSERT_EQ(materials.size(), 1u);
  EXPECT_EQ(materials[0].size(), 50u);
  EXPECT_TRUE(SortIntoMaterials({}).empty());
}

}  // namespace
}  // namespace glint
