#include "tests/benchmark/sdf/field_check.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "sdf/level_set_impl.h"

namespace glint::benchmark {

namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;

// Every k-th leaf, so that about `wanted` voxels are among them.
std::vector<const Leaf*> SomeLeaves(const LevelSet& field, double wanted) {
  std::vector<const Leaf*> all, some;
  field.impl().grid->tree().getNodes(all);
  if (!(wanted >= 1)) return some;
  const size_t step = std::max<size_t>(1, static_cast<size_t>(512.0 * static_cast<double>(all.size()) / wanted));
  for (size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
  return some;
}

}  // namespace

FieldErrors operator+(const FieldErrors& a, const FieldErrors& b) {
  return {a.distances + b.distances,
          std::max(a.worst_rel, b.worst_rel),
          std::max(a.worst_voxels, b.worst_voxels),
          a.missing + b.missing,
          a.signs + b.signs,
          a.wrong_signs + b.wrong_signs,
          a.on_surface + b.on_surface};
}

FieldErrors CheckField(const TriangleMesh& mesh, const LevelSet& field, const BruteForce& brute,
                       const ExactSides* sides, double pairs, size_t max_signs) {
  const openvdb::FloatGrid& grid = *field.impl().grid;
  const double h = field.voxel_size(), width = h * field.half_width_voxels(), diagonal = Diagonal(mesh);
  double largest = 0;
  for (const Eigen::Vector3d& v : mesh.vertices) largest = std::max(largest, v.cwiseAbs().maxCoeff());
  const double rounding = 4e-16 * largest;
  std::vector<FieldErrors> parts;
  // Distances: one voxel in eight of the leaves chosen, another place in each row.
  const double per_voxel = static_cast<double>(mesh.faces.size());
  const std::vector<const Leaf*> for_distances = SomeLeaves(field, 16 * pairs / per_voxel);
  parts.resize(for_distances.size());
  ParallelFor(for_distances.size(), 1, [&](size_t i) {
    const Leaf& leaf = *for_distances[i];
    FieldErrors& e = parts[i];
    for (openvdb::Index n = static_cast<openvdb::Index>(i % 8); n < 512; n += 7) {
      const bool on = leaf.isValueOn(n);
      if (!on && n % 3 != 0) continue;
      const double d = brute.Distance(FromVdb(grid.indexToWorld(leaf.offsetToGlobalCoord(n))));
      ++e.distances;
      if (!on) {
        e.missing += d < width - 1e-4 * h;
        continue;
      }
      const double error = std::abs(std::abs(static_cast<double>(leaf.getValue(n))) - d);
      e.worst_rel = std::max(e.worst_rel, error / diagonal);
      e.worst_voxels = std::max(e.worst_voxels, error / h);
    }
  });
  FieldErrors sum;
  for (const FieldErrors& e : parts) sum = sum + e;
  if (sides == nullptr) return sum;
  const std::vector<const Leaf*> for_signs = SomeLeaves(field, static_cast<double>(max_signs));
  parts.assign(for_signs.size(), {});
  ParallelFor(for_signs.size(), 1, [&](size_t i) {
    const Leaf& leaf = *for_signs[i];
    FieldErrors& e = parts[i];
    for (int column = 0; column < 64; ++column) {
      double z[8];
      int winding[8];
      openvdb::Vec3d at;
      for (int k = 0; k < 8; ++k) {
        at = grid.indexToWorld(leaf.offsetToGlobalCoord(static_cast<openvdb::Index>(8 * column + k)));
        z[k] = at[2];
      }
      sides->Column(at[0], at[1], z, 8, winding);
      for (int k = 0; k < 8; ++k) {
        const bool negative = std::signbit(leaf.getValue(static_cast<openvdb::Index>(8 * column + k)));
        const bool surface = winding[k] >= ExactSides::kOnSurface / 2;
        ++e.signs;
        if (!surface && negative == (winding[k] > 0)) continue;
        at[2] = z[k];
        if (surface || brute.Distance(FromVdb(at)) <= rounding)
          ++e.on_surface;
        else
          ++e.wrong_signs;
      }
    }
  });
  for (const FieldErrors& e : parts) sum = sum + e;
  return sum;
}

}  // namespace glint::benchmark
