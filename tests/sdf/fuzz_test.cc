// Nothing that a mesh can be brings the module down or makes it lie. Ten seconds of one core by default, twenty in
// .ci/run, two minutes in scripts/check --all; for longer:
//   GLINT_FUZZ_SECONDS=600 GLINT_FUZZ_SEED=7 sdf_test --gtest_filter='Fuzz.*'
#include <gtest/gtest.h>
#include <time.h>

#include <cmath>
#include <cstdlib>
#include <iostream>

#include "core/error.h"
#include "core/parallel.h"
#include "geometry/clean_mesh.h"
#include "geometry/mesh_checks.h"
#include "sdf/dense_distance.h"
#include "sdf/extract_mesh.h"
#include "sdf/level_set_impl.h"
#include "sdf/mesh_to_level_set.h"
#include "sdf/signed_distance.h"
#include "tests/sdf/brute_force.h"
#include "tests/sdf/nasty_meshes.h"

namespace glint {
namespace {

constexpr const char* kSigns[] = {"auto", "auto", "pseudonormal", "winding", "unsigned"};

double Number(const char* name, double fallback) {
  const char* text = std::getenv(name);
  return text ? std::atof(text) : fallback;
}

double CpuSeconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// One mesh through everything, compared with the slow truth at a few places.
class Case {
 public:
  explicit Case(unsigned seed) : random_(seed), nasty_(random_.Make()), sign_(kSigns[random_.Below(5)]) {
    const double sizes[] = {20, 30, 12, 3, 0.5};
    if (nasty_.usable) diagonal_ = Diagonal(Clean(nasty_.mesh).mesh);
    voxel_ = diagonal_ / sizes[random_.Below(5)];
  }

  std::string Story() const {
    return nasty_.story + ", sign " + sign_ + ", diagonals a voxel " + std::to_string(diagonal_ / voxel_);
  }

  void Run() {
    CheckMeshSoundness(nasty_.mesh);
    if (!nasty_.usable) {
      EXPECT_THROW(MeshToLevelSet(nasty_.mesh, 1), InputError);
      EXPECT_THROW(SignedDistance(nasty_.mesh, {{0, 0, 0}}), InputError);
      return;
    }
    for (double bad : {0.0, -1.0, 1e-13 * diagonal_, 1e300}) {
      try {
        MeshToLevelSet(nasty_.mesh, bad, {.max_memory_gb = 0.5});
        EXPECT_GT(bad, diagonal_);  // one huge voxel is a grid
      } catch (const InputError&) {
      }
    }
    try {
      CheckBand();
    } catch (const InputError& e) {  // voxels too small for OpenVDB
      EXPECT_LT(voxel_, kSmallestVoxelWorld) << e.what();
    }
    CheckPoints();
  }

 private:
  // Whether p is inside by the truth that the mesh allows.
  void CheckSign(const Eigen::Vector3d& p, double value, double distance, const std::string& method) {
    if (!nasty_.sound || method == "unsigned" || distance < 1e-5 * voxel_ + 1e-9 * diagonal_) return;
    // All meshes called sound are turned outward.
    EXPECT_EQ(value<0, std::lround(std::abs(ExactWindingNumber(nasty_.mesh, p)))> 0) << method;
  }

  void CheckBand() {
    const double width = 1 + 4 * random_.Uniform();
    SdfSummary summary;
    const LevelSet level_set = MeshToLevelSet(
        nasty_.mesh, voxel_, {.half_width_voxels = width, .sign = sign_, .max_memory_gb = 0.5}, &summary);
    const openvdb::FloatGrid& grid = *level_set.impl().grid;
    EXPECT_GT(summary.active_voxels, 0u);
    openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    box.expand(2);
    const uint64_t step = 1 + static_cast<uint64_t>(box.volume()) / 200;
    uint64_t n = 0;
    for (auto it = box.begin(); it; ++it) {
      if (n++ % step != 0) continue;
      const Eigen::Vector3d p = FromVdb(grid.indexToWorld(*it));
      const double value = grid.tree().getValue(*it), d = testing::BruteDistance(Used(), p);
      if (grid.tree().isValueOn(*it)) {
        EXPECT_NEAR(std::abs(value), d, 1e-4 * voxel_ + 1e-7 * diagonal_);
      } else {
        EXPECT_GE(d, (width - 1e-3) * voxel_ * (1 - 1e-6) - 1e-7 * diagonal_);
      }
      CheckSign(p, value, d, summary.sign);
    }
    const TriangleMesh surface = ExtractMesh(level_set);
    for (const Eigen::Vector3d& v : surface.vertices) ASSERT_TRUE(v.allFinite());
  }

  void CheckPoints() {
    const Eigen::AlignedBox3d box = BoundingBox(Used());
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 30; ++i) points.push_back(box.center() + 2 * diagonal_ * random_.Direction());
    points.push_back(Used().vertices[0]);
    SdfSummary summary;
    const std::vector<double> values = SignedDistance(nasty_.mesh, points, sign_, &summary);
    for (size_t i = 0; i < points.size(); ++i) {
      const double d = testing::BruteDistance(Used(), points[i]);
      EXPECT_NEAR(std::abs(values[i]), d, 1e-9 * diagonal_);
      CheckSign(points[i], values[i], d, summary.sign);
    }
    Eigen::Affine3d frame = Eigen::Affine3d::Identity();
    frame.linear() *= diagonal_ / 7;
    frame.translation() = box.min();
    const DenseField field = DenseSignedDistance(nasty_.mesh, frame, {9, 7, 8}, sign_, &summary);
    for (int i = 0; i < 9; ++i) {
      const Eigen::Vector3d p = frame * Eigen::Vector3d(i, i % 7, 7 - i % 8);
      const double d = testing::BruteDistance(Used(), p);
      EXPECT_NEAR(std::abs(field(i, i % 7, 7 - i % 8)), d, 1e-5 * diagonal_);
      CheckSign(p, field(i, i % 7, 7 - i % 8), d, summary.sign);
    }
  }

  // The mesh without collapsed faces and unused vertices.
  const TriangleMesh& Used() {
    if (used_.empty()) used_ = Clean(nasty_.mesh).mesh;
    return used_;
  }

  testing::NastyMeshes random_;
  testing::NastyMesh nasty_;
  TriangleMesh used_;
  std::string sign_;
  double diagonal_ = 1, voxel_ = 1;
};

TEST(Fuzz, NastyMeshes) {
  const double seconds = Number("GLINT_FUZZ_SECONDS", 3), begin = CpuSeconds();
  const unsigned first = static_cast<unsigned>(Number("GLINT_FUZZ_SEED", 1));
  const ThreadLimit one_core(1);
  unsigned seed = first;
  for (; CpuSeconds() - begin < seconds; ++seed) {
    Case fuzz(seed);
    SCOPED_TRACE("GLINT_FUZZ_SEED=" + std::to_string(seed) + ": " + fuzz.Story());
    fuzz.Run();
    if (HasFailure()) break;  // one report is enough
  }
  std::cout << "  " << seed - first << " meshes\n";
  EXPECT_GT(seed - first, 10u);
}

}  // namespace
}  // namespace glint
