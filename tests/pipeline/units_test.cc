// COLMAP's unit and origin are arbitrary: the whole run, from files to files, gives the same surface in any of them.
#include <gmock/gmock.h>

#include <algorithm>

#include "colmap/model.h"
#include "core/median.h"
#include "io/mesh_io.h"
#include "metrics/compare.h"
#include "tests/pipeline/shared_run.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

struct Units {
  const char* name;
  double scale;
};

class UnitsTest : public SharedRun {
 protected:
  // The lights are distant: their directions hold in any unit.
  std::vector<std::string> Elsewhere(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"--set", "output.overlays=false"});
    return ArgumentsFor(Path("p"), Path("out"), more);
  }

  // The project, of another size and then elsewhere.
  void WriteProject(double scale, const Eigen::Vector3d& offset) const {
    Model model = ReadModel(shared_ / "p/sparse/0");
    for (Point3D& point : model.points) point.xyz = scale * point.xyz + offset;
    for (Image& image : model.images) {
      Rigid3d& pose = image.cam_from_world;
      pose.translation = scale * pose.translation - pose.rotation * offset;
    }
    WriteModel(model, folder_ / "p/sparse/0");
    fs::create_directory_symlink(shared_ / "p/images", folder_ / "p/images");
  }
};

class InOtherUnits : public UnitsTest, public ::testing::WithParamInterface<Units> {};

TEST_P(InOtherUnits, TheSameSurfaceToTheLastBit) {
  // The scale is a power of two: no rounding differs, and no constant may have a length in it.
  const double scale = GetParam().scale;
  WriteProject(scale, Eigen::Vector3d::Zero());
  const ProgramResult run = RunGlint(Elsewhere());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const TriangleMesh expected = ReadMesh(shared_ / "out/mesh.ply");
  TriangleMesh found = ReadMesh(folder_ / "out/mesh.ply");
  for (Eigen::Vector3d& v : found.vertices) v /= scale;
  EXPECT_TRUE(found.vertices == expected.vertices);
  EXPECT_TRUE(found.faces == expected.faces);
}

INSTANTIATE_TEST_SUITE_P(Units, InOtherUnits, ::testing::Values(Units{"Micro", 0x1p-20}, Units{"Mega", 0x1p20}),
                         [](const auto& unit) { return std::string(unit.param.name); });

constexpr double kFloat = 0x1p-24;  // a rounding of 1

// In the middle to `rounding`, nowhere farther off than `largest`.
void ExpectNear(const TriangleMesh& found, const Eigen::Vector3d& offset, const TriangleMesh& expected, double rounding,
                double largest) {
  ASSERT_EQ(found.vertices.size(), expected.vertices.size());
  EXPECT_TRUE(found.faces == expected.faces);
  std::vector<double> off;
  for (size_t i = 0; i < found.vertices.size(); ++i)
    off.push_back((found.vertices[i] - offset - expected.vertices[i]).cwiseAbs().maxCoeff());
  EXPECT_LT(Median(off), rounding);
  EXPECT_LT(*std::max_element(off.begin(), off.end()), largest);
}

class FarFromTheOrigin : public UnitsTest {};

TEST_F(FarFromTheOrigin, TheSameSurfaceToRounding) {
  const Eigen::Vector3d offset = 1e6 * Eigen::Vector3d(1, -1, 0.5);
  WriteProject(1, offset);
  const fs::path out = folder_ / "out";
  ASSERT_EQ(RunGlint(Elsewhere({"--until", "seed"})).exit_code, 0);

  // What refinement starts from is remeshed, which compares lengths: one that is rounded the other way makes other
  // triangles, all the way from there, and a point on the border of doubt may be left out of the seed or not, which
  // matters where no camera looks. By and large its surface is the same to the resolution that was asked for, a voxel:
  // to the half of one that a grid rounds by.
  const auto expect_alike = [&](const std::string& name) {
    TriangleMesh found = ReadMesh(out / name);
    for (Eigen::Vector3d& v : found.vertices) v -= offset;
    const MeshComparison comparison = CompareMeshes(found, ReadMesh(shared_ / "out" / name));
    EXPECT_LT(comparison.accuracy_rel.median, 0.5 * kVoxelRel) << name;
    EXPECT_LT(comparison.completeness_rel.median, 0.5 * kVoxelRel) << name;
  };
  expect_alike("seed.ply");
  expect_alike("stages/start.ply");

  // From the very same start and points: to the roundings of the float numbers in which a surface lies in its grid,
  // some of them one after the other, and in its file. Between two steps the surface becomes a mesh and a field again,
  // where a decision may fall the other way: around such a place it is off by more, but not by what voxels resolve.
  TriangleMesh start = ReadMesh(shared_ / "out/stages/start.ply");
  const double diagonal = Diagonal(start);
  const double of_a_vertex =
      kFloat * BoundingBox(start).max().cwiseAbs().cwiseMax(BoundingBox(start).min().cwiseAbs()).maxCoeff();
  for (Eigen::Vector3d& v : start.vertices) v += offset;
  WriteMesh(out / "stages/start.ply", start);
  const char* points = "stages/points_on_object.txt";
  fs::copy_file(shared_ / "out" / points, out / points, fs::copy_options::overwrite_existing);
  const ProgramResult run = RunGlint(Elsewhere({"--from", "detect"}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  ExpectNear(ReadMesh(out / "mesh.ply"), offset, ReadMesh(shared_ / "out/mesh.ply"),
             8 * kFloat * diagonal + of_a_vertex, 0.01 * kVoxelRel * diagonal);
}

}  // namespace
}  // namespace glint
