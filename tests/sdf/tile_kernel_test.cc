// The same answers from every instruction set that this machine has.
#include "sdf/tile_kernel.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <iostream>
#include <set>
#include <string>

#include "sdf/level_set_impl.h"
#include "sdf/mesh_to_level_set.h"
#include "tests/geometry/test_meshes.h"

namespace glint {
namespace {

// Makes the kernel use one instruction set only.
class OnTarget {
 public:
  explicit OnTarget(int64_t target) { Use(target); }
  ~OnTarget() { Use(0); }

 private:
  static void Use(int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

std::vector<int64_t> Targets() {
  std::vector<int64_t> targets;
  for (int64_t bits = hwy::SupportedTargets(); bits != 0; bits &= bits - 1) targets.push_back(bits & -bits);
  return targets;
}

struct Difference {
  size_t active = 0, states = 0, signs = 0;
  double worst_voxels = 0;
};

Difference Compare(const LevelSet& a, const LevelSet& b) {
  Difference difference;
  const double h = a.voxel_size(), width = a.half_width_voxels();
  const auto& other = b.impl().grid->tree();
  for (auto it = a.impl().grid->cbeginValueAll(); it; ++it) {
    if (!it.isVoxelValue()) continue;
    const float value = other.getValue(it.getCoord());
    const bool on = other.isValueOn(it.getCoord());
    difference.signs += std::signbit(value) != std::signbit(*it);
    difference.active += it.isValueOn();
    if (on && it.isValueOn()) difference.worst_voxels = std::max(difference.worst_voxels, std::abs(value - *it) / h);
    // At the very rim of the band rounding decides.
    if (on != it.isValueOn()) difference.states += std::abs(std::abs(on ? value : *it) / h - width) > 1e-5;
  }
  return difference;
}

void ExpectSameOnAllTargets(const TriangleMesh& mesh, double voxel_size, double half_width) {
  const SdfOptions options{.half_width_voxels = half_width, .sign = "pseudonormal"};
  const LevelSet best = MeshToLevelSet(mesh, voxel_size, options);
  std::set<std::string> names;
  for (int64_t target : Targets()) {
    const OnTarget on(target);
    const std::string name = internal::TileKernelTarget();
    if (!names.insert(name).second) continue;
    const Difference d = Compare(best, MeshToLevelSet(mesh, voxel_size, options));
    EXPECT_EQ(d.signs, 0u) << name;
    EXPECT_EQ(d.states, 0u) << name;
    EXPECT_LT(d.worst_voxels, 4e-6 * (half_width + 12)) << name;
    EXPECT_GT(d.active, 1000u);
  }
}

TEST(TileKernel, EveryInstructionSetAgrees) {
  ExpectSameOnAllTargets(testing::SpikySphere(2, 0.7, 1), 0.04, 3);
  ExpectSameOnAllTargets(testing::SpikySphere(4, 0.3, 2), 0.03, 3);
  ExpectSameOnAllTargets(testing::Icosphere(5), 0.1, 5);
  ExpectSameOnAllTargets(testing::Box({-1, -1, -1}, {1, 1, 1}), 0.1, 4);  // voxels on faces, edges and corners
  ExpectSameOnAllTargets(testing::Transformed(testing::SpikySphere(2, 0.5, 4), 1, {1e6, -7e5, 3e5}), 0.08, 3);
}

// The same binary runs everywhere: a vector-less or SSE path is always among those compiled.
TEST(TileKernel, BaselineIsThere) {
  std::set<std::string> names;
  for (int64_t target : Targets()) {
    const OnTarget on(target);
    names.insert(internal::TileKernelTarget());
  }
  EXPECT_TRUE(names.contains("SSE4") || names.contains("SSSE3") || names.contains("SSE2") || names.contains("EMU128") ||
              names.contains("SCALAR") || names.size() == 1);
  for (const std::string& name : names) std::cout << "  " << name << "\n";
}

}  // namespace
}  // namespace glint
