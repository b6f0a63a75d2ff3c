// Narrow bands.
#include <fmt/format.h>

#include <algorithm>

#include "core/parallel.h"
#include "sdf/level_set_impl.h"
#include "sdf/mesh_to_level_set.h"
#include "tests/benchmark/sdf/workloads.h"

namespace glint::benchmark {

namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;

// Peers have fewer voxels checked.
FieldErrors Check(const Subject& subject, const LevelSet& field, const RunOptions& options, bool peer) {
  return CheckField(subject.mesh, field, subject.brute,
                    subject.sides && options.check_signs > 0 ? &*subject.sides : nullptr,
                    options.check_pairs * (peer ? 0.1 : 1), options.check_signs / (peer ? 4 : 1));
}

// The active voxels of a leaf along the rows to and fro, so that a point is near the one before.
struct LeafPoints {
  std::vector<Eigen::Vector3d> points;
  std::vector<openvdb::Index> offsets;
  double longest_step = 0;

  LeafPoints(const Leaf& leaf, const openvdb::FloatGrid& grid) {
    for (openvdb::Index y = 0; y < 64; ++y)
      for (openvdb::Index k = 0; k < 8; ++k) {
        const openvdb::Index n = 8 * y + (y % 2 == 0 ? k : 7 - k);
        if (!leaf.isValueOn(n)) continue;
        offsets.push_back(n);
        points.push_back(FromVdb(grid.indexToWorld(leaf.offsetToGlobalCoord(n))));
      }
    for (size_t k = 1; k < points.size(); ++k)
      longest_step = std::max(longest_step, (points[k] - points[k - 1]).norm());
  }
};

// The peer's distances at the active voxels of every k-th leaf, into a copy of those leaves.
Row RunPeerOnField(const Subject& subject, const PointPeer& peer, const LevelSet& field, const RunOptions& options) {
  const openvdb::FloatGrid& grid = *field.impl().grid;
  std::vector<const Leaf*> all;
  grid.tree().getNodes(all);
  const size_t active = field.num_active_voxels();
  const size_t step = std::max<size_t>(1, active / std::max<size_t>(1, options.peer_voxels));
  openvdb::FloatGrid::Ptr copy = openvdb::FloatGrid::create(grid.background());
  copy->setTransform(grid.transform().copy());
  copy->setGridClass(openvdb::GRID_LEVEL_SET);
  for (size_t i = 0; i < all.size(); i += step) copy->tree().addLeaf(new Leaf(*all[i]));
  std::vector<Leaf*> leaves;
  copy->tree().getNodes(leaves);
  const double h = field.voxel_size(), reach = (field.half_width_voxels() + 0.01) * h;
  Row row{Method::kExactPeer, peer.Name(), static_cast<double>(copy->activeVoxelCount()), {}, {}};
  row.cost = Measure(
      1,
      [&] {
        ParallelFor(leaves.size(), 4, [&](size_t i) {
          const LeafPoints at(*leaves[i], grid);
          std::vector<float> values(at.points.size());
          peer.Distances(at.points.data(), at.points.size(), std::max(at.longest_step, h) * (1 + 1e-9), reach,
                         values.data());
          for (size_t k = 0; k < at.offsets.size(); ++k) leaves[i]->setValueOnly(at.offsets[k], values[k]);
        });
      },
      [] {});
  // Inactive voxels keep Glint's signs: only active ones tell of the peer.
  row.errors = Check(subject, MakeLevelSet(copy), options, true);
  return row;
}

Row RunGlint(const Subject& subject, double h, double half_width, bool automatic, const RunOptions& options,
             LevelSet& made) {
  SdfSummary summary;
  const std::string sign = automatic ? "auto" : "pseudonormal";
  Row row{automatic ? Method::kAuto : Method::kPseudoNormal, "Glint " + sign, 0, {}, {}};
  row.cost = Measure(
      options.repeats,
      [&] { made = MeshToLevelSet(subject.given, h, {.half_width_voxels = half_width, .sign = sign}, &summary); },
      [&] { made = LevelSet(); });
  row.items = static_cast<double>(made.num_active_voxels());
  if (automatic && summary.sign == "pseudonormal") return row;  // the same field
  if (automatic) row.name += " = " + summary.sign;
  row.errors = Check(subject, made, options, false);
  return row;
}

}  // namespace

Work RunBand(const Subject& subject, int resolution, double half_width, const RunOptions& options) {
  const double h = BoundingBox(subject.mesh).sizes().maxCoeff() / resolution;
  Work work{subject.name, fmt::format("band:{}:{:g}", resolution, half_width), subject.mesh.faces.size(), 0, true, {}};
  LevelSet field, made;
  work.rows.push_back(RunGlint(subject, h, half_width, false, options, field));
  work.items = field.num_active_voxels();
  work.rows.push_back(RunGlint(subject, h, half_width, true, options, made));
  if (std::count(options.peers.begin(), options.peers.end(), "openvdb") > 0) {
    // Items are those of the exact band: it has others.
    Row row{Method::kOpenVdb, "OpenVDB meshToVolume", static_cast<double>(work.items), {}, {}};
    row.cost = Measure(
        std::min(options.repeats, 2), [&] { made = OpenVdbLevelSet(subject.mesh, h, half_width); },
        [&] { made = LevelSet(); });
    row.errors = Check(subject, made, options, true);
    work.rows.push_back(row);
  }
  for (const auto& peer : subject.peers) work.rows.push_back(RunPeerOnField(subject, *peer, field, options));
  return work;
}

}  // namespace glint::benchmark
