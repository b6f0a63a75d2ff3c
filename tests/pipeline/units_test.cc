// COLMAP's unit and origin are arbitrary: the whole run, from files to files, gives the same surface in any of them.
#include <gmock/gmock.h>

#include "colmap/model.h"
#include "io/mesh_io.h"
#include "metrics/compare.h"
#include "tests/pipeline/program.h"
#include "tests/support/shared_folder.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

struct Units {
  const char* name;
  double scale;
  double offset;  // of the origin, in the new unit
};

class InOtherUnits : public ProgramTest, public ::testing::WithParamInterface<Units> {
 protected:
  static void SetUpTestSuite() { shared_ = testing_support::SharedFolder("units_test", Make); }
  static void Make(const fs::path& folder) {
    shared_ = folder;
    const ProgramResult synth =
        RunGlint({"synth", "ellipsoid", "-o", (folder / "p").string(), "--views", "16", "--size", "240x180", "-q"});
    ASSERT_EQ(synth.exit_code, 0) << synth.err;
    const ProgramResult run = RunGlint(Arguments(folder / "p", folder / "out"));
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }

  // The lights are distant: their directions hold in any unit.
  static std::vector<std::string> Arguments(const fs::path& project, const fs::path& out) {
    return {"run",      project.string(),
            "-o",       out.string(),
            "--lights", (shared_ / "p/truth/lights.json").string(),
            "--set",    "refine.voxel_rel=0.02",
            "--set",    "output.overlays=false"};
  }

  static inline fs::path shared_;
};

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
  const ProgramResult run = RunGlint(Arguments(folder_ / "p", folder_ / "out"));
  ASSERT_EQ(run.exit_code, 0) << run.err;

  const TriangleMesh expected = ReadMesh(shared_ / "out/mesh.ply");
  TriangleMesh found = ReadMesh(folder_ / "out/mesh.ply");
  for (Eigen::Vector3d& v : found.vertices) v = (v - offset) / GetParam().scale;
  const MeshComparison comparison = CompareMeshes(found, expected);
  // Other roundings decide ties of the seed's cut otherwise and lay the voxels elsewhere: parts of a voxel, no more.
  constexpr double kVoxelRel = 0.02;
  EXPECT_LT(comparison.chamfer_rel, kVoxelRel / 10);
  EXPECT_LT(comparison.accuracy_rel.p95, kVoxelRel / 3);
  EXPECT_LT(comparison.normal_deg.p95, 3);
}

INSTANTIATE_TEST_SUITE_P(Units, InOtherUnits,
                         ::testing::Values(Units{"Micro", 1e-6, 0}, Units{"Mega", 1e6, 0}, Units{"FarAway", 1, 1e6}),
                         [](const auto& unit) { return std::string(unit.param.name); });

}  // namespace
}  // namespace glint
