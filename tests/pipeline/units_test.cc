// COLMAP's unit and origin are arbitrary: the whole run, from files to files, gives the same surface in any of them.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "colmap/model.h"
#include "io/mesh_io.h"
#include "metrics/compare.h"
#include "tests/pipeline/shared_run.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

struct Units {
  const char* name;
  double scale;
  double offset;  // of the origin, in the new unit
};

// The lights are distant: their directions hold in any unit.
class InOtherUnits : public SharedRun, public ::testing::WithParamInterface<Units> {};

TEST_P(InOtherUnits, TheSameSurface) {
  const Eigen::Vector3d offset = GetParam().offset * Eigen::Vector3d(1, -1, 0.5);
  Model model = ReadModel(shared_ / "p/sparse/0");
  for (Point3D& point : model.points) point.xyz = GetParam().scale * point.xyz + offset;
  for (Image& image : model.images) {
    Rigid3d& pose = image.cam_from_world;
    pose.translation = GetParam().scale * pose.translation - pose.rotation * offset;
  }
  WriteModel(model, folder_ / "p/sparse/0");
  fs::create_directory_symlink(shared_ / "p/images", folder_ / "p/images");
  const ProgramResult run = RunGlint(ArgumentsFor(Path("p"), Path("out"), {"--set", "output.overlays=false"}));
  ASSERT_EQ(run.exit_code, 0) << run.err;

  const TriangleMesh expected = ReadMesh(shared_ / "out/mesh.ply");
  TriangleMesh found = ReadMesh(folder_ / "out/mesh.ply");
  for (Eigen::Vector3d& v : found.vertices) v = (v - offset) / GetParam().scale;
  if (GetParam().offset == 0) {
    // The unit is a power of two: no rounding differs, and no constant may have a length in it.
    EXPECT_TRUE(found.vertices == expected.vertices);
    EXPECT_TRUE(found.faces == expected.faces);
    return;
  }
  // Far away the seed is the same to what rounding leaves: of the float numbers that it is stored in at the origin.
  const TriangleMesh expected_seed = ReadMesh(shared_ / "out/seed.ply"), seed = ReadMesh(folder_ / "out/seed.ply");
  ASSERT_EQ(seed.vertices.size(), expected_seed.vertices.size());
  EXPECT_TRUE(seed.faces == expected_seed.faces);
  for (size_t i = 0; i < seed.vertices.size(); ++i) {
    const Eigen::Vector3d& x = expected_seed.vertices[i];
    constexpr double kFloat = 0x1p-24, kDouble = 0x1p-52;
    const double rounding = kFloat * x.cwiseAbs().maxCoeff() + 8 * kDouble * offset.norm();
    EXPECT_LT((seed.vertices[i] - offset - x).cwiseAbs().maxCoeff(), rounding) << i;
  }
  // The voxels lie elsewhere: a surface is told to no more than half of one.
  const MeshComparison comparison = CompareMeshes(found, expected);
  EXPECT_LT(comparison.accuracy_rel.p95, 0.5 * kVoxelRel);
  EXPECT_LT(comparison.completeness_rel.p95, 0.5 * kVoxelRel);
}

INSTANTIATE_TEST_SUITE_P(Units, InOtherUnits,
                         ::testing::Values(Units{"Micro", 0x1p-20, 0}, Units{"Mega", 0x1p20, 0},
                                           Units{"FarAway", 1, 1e6}),
                         [](const auto& unit) { return std::string(unit.param.name); });

}  // namespace
}  // namespace glint
