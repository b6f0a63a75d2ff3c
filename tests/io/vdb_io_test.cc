#include "io/vdb_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

#include "core/error.h"
#include "sdf/level_set_impl.h"
#include "tests/colmap/test_model.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::ReadText;
using testing_support::TemporaryFolder;
using testing_support::WriteFile;

openvdb::FloatGrid::Ptr Sphere() {
  openvdb::initialize();
  return openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(1.5f, {0.2f, 0, -1}, 0.1f, 3.f);
}

void WriteGrids(const fs::path& path, const openvdb::GridPtrVec& grids) {
  openvdb::io::File file(path.string());
  file.write(grids);
}

std::string ErrorOf(const fs::path& path) {
  try {
    ReadVdb(path);
  } catch (const InputError& error) {
    EXPECT_EQ(error.path(), path.string());
    return error.what();
  }
  return "";
}

TEST(VdbIo, ComesBackAsItWas) {
  const TemporaryFolder folder;
  const LevelSet sphere = MakeLevelSet(Sphere());
  WriteVdb(folder / "new/a.vdb", sphere);
  const LevelSet read = ReadVdb(folder / "new/a.vdb");
  EXPECT_EQ(read.voxel_size(), sphere.voxel_size());
  EXPECT_EQ(read.num_active_voxels(), sphere.num_active_voxels());
  EXPECT_EQ(read.half_width_voxels(), sphere.half_width_voxels());
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d x(0.2 + 1.5 * std::sin(i), 1.5 * std::cos(i) * 0.5, -1 + 0.7 * std::cos(3 * i));
    EXPECT_EQ(read.Value(x), sphere.Value(x));
  }
  EXPECT_EQ(read.impl().grid->getName(), "surface");
  EXPECT_EQ(read.impl().grid->getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_EQ(sphere.impl().grid->getName(), "");  // the caller's grid is left alone
}

TEST(VdbIo, SameLevelSetSameBytes) {
  const TemporaryFolder folder;
  WriteVdb(folder / "a.vdb", MakeLevelSet(Sphere()));
  WriteVdb(folder / "b.vdb", MakeLevelSet(Sphere()));
  EXPECT_EQ(ReadText(folder / "a.vdb"), ReadText(folder / "b.vdb"));
}

TEST(VdbIo, TheUsualNameIsPreferredAndTheChoiceIsSaid) {
  const TemporaryFolder folder;
  const auto other = Sphere(), usual = Sphere(), fog = Sphere();
  other->setName("alpha");
  usual->setName("surface");
  fog->setName("density");
  fog->setGridClass(openvdb::GRID_FOG_VOLUME);
  WriteGrids(folder / "one.vdb", {fog, other});
  std::vector<std::string> notes;
  EXPECT_EQ(ReadVdb(folder / "one.vdb", &notes).impl().grid->getName(), "alpha");
  EXPECT_THAT(notes, testing::IsEmpty());
  WriteGrids(folder / "two.vdb", {other, usual});
  EXPECT_EQ(ReadVdb(folder / "two.vdb", &notes).impl().grid->getName(), "surface");
  EXPECT_THAT(notes, testing::ElementsAre(HasSubstr("took 'surface'")));
}

TEST(VdbIo, WhatIsNoLevelSetIsRefused) {
  const TemporaryFolder folder;
  const auto fog = Sphere();
  fog->setName("density");
  fog->setGridClass(openvdb::GRID_FOG_VOLUME);
  WriteGrids(folder / "fog.vdb", {fog});
  EXPECT_THAT(ErrorOf(folder / "fog.vdb"), HasSubstr("found 'density' (fog volume grid of float)"));
  WriteGrids(folder / "vectors.vdb", {openvdb::Vec3SGrid::create()});
  EXPECT_THAT(ErrorOf(folder / "vectors.vdb"), HasSubstr("grid of vec3s"));
  WriteGrids(folder / "none.vdb", {});
  EXPECT_THAT(ErrorOf(folder / "none.vdb"), HasSubstr("found none"));
}

TEST(VdbIo, ValuesAndVoxelsAreChecked) {
  const TemporaryFolder folder;
  const auto holed = Sphere();
  holed->tree().setValueOn(openvdb::Coord(1, 2, 3), std::nanf(""));
  WriteGrids(folder / "nan.vdb", {holed});
  EXPECT_THAT(ErrorOf(folder / "nan.vdb"), HasSubstr("found nan at voxel (1, 2, 3)"));
  const auto stretched = Sphere();
  stretched->transform().preScale(openvdb::Vec3d(1, 2, 1));
  WriteGrids(folder / "stretched.vdb", {stretched});
  EXPECT_THAT(ErrorOf(folder / "stretched.vdb"), HasSubstr("expected cubic voxels"));
  const auto inverted = Sphere();
  inverted->tree().root().setBackground(-0.3f, false);
  WriteGrids(folder / "background.vdb", {inverted});
  EXPECT_THAT(ErrorOf(folder / "background.vdb"), HasSubstr("expected a positive background"));
}

TEST(VdbIo, CutAndForeignFilesAreErrors) {
  const TemporaryFolder folder;
  WriteVdb(folder / "a.vdb", MakeLevelSet(Sphere()));
  const std::string bytes = ReadText(folder / "a.vdb");
  for (size_t size = 0; size < bytes.size(); size += 1 + size / 7) {
    WriteFile(folder / "cut.vdb", bytes.substr(0, size));
    EXPECT_NE(ErrorOf(folder / "cut.vdb"), "") << size;
  }
  WriteFile(folder / "cut.vdb", bytes.substr(0, bytes.size() - 1));
  EXPECT_THAT(ErrorOf(folder / "cut.vdb"), HasSubstr("the file is cut"));
  WriteFile(folder / "text.vdb", "this is a text and no grid at all, not even nearly");
  EXPECT_THAT(ErrorOf(folder / "text.vdb"), HasSubstr("expected an OpenVDB file"));
  EXPECT_THAT(ErrorOf(folder / "missing.vdb"), HasSubstr("found none"));
}

}  // namespace
}  // namespace glint
