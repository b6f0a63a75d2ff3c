#include "tests/benchmark/sdf/workloads.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <random>

#include "core/error.h"
#include "core/parallel.h"
#include "geometry/clean_mesh.h"
#include "geometry/edge_topology.h"
#include "sdf/dense_distance.h"
#include "sdf/level_set_impl.h"
#include "sdf/mesh_to_level_set.h"
#include "sdf/signed_distance.h"
#include "sdf/tile_kernel.h"
#include "tests/benchmark/sdf/field_check.h"
#include "tests/benchmark/sdf/measure.h"
#include "tests/benchmark/sdf/peers.h"

namespace glint::benchmark {

namespace {

constexpr const char* kRow =
    "| {:18} | {:>8} | {:14} | {:>9} | {:20} | {:>8} | {:>8} | {:>9} | {:>6} | {:>7} | {:>8} | {:>16} | {:>8} |\n";

// A mesh with what the peers and the checks need of it; welded, as Glint does for itself.
struct Subject {
  std::string name;
  TriangleMesh given, mesh;
  PseudoNormals normals;
  BruteForce brute;
  std::optional<ExactSides> sides;  // of closed meshes
  std::vector<std::unique_ptr<PointPeer>> peers;

  Subject(const std::string& mesh_name, TriangleMesh mesh_given)
      : name(mesh_name),
        given(std::move(mesh_given)),
        mesh(Clean(given).mesh),
        normals(ComputePseudoNormals(mesh, BuildEdgeTopology(mesh))),
        brute(mesh) {
    if (EdgesBalanced(mesh)) sides.emplace(mesh);
  }
};

struct Row {
  std::string method;
  double items = 0;  // that it did
  Cost cost;
  std::optional<FieldErrors> errors;
  std::string note;
};

std::string Compact(size_t n) {
  if (n >= 10'000'000) return fmt::format("{:.1f} M", static_cast<double>(n) / 1e6);
  if (n >= 1'000'000) return fmt::format("{:.2f} M", static_cast<double>(n) / 1e6);
  return n >= 10'000 ? fmt::format("{:.0f} k", static_cast<double>(n) / 1e3) : fmt::format("{}", n);
}

// The first row is Glint's.
void PrintRows(const Subject& subject, const std::string& work, size_t items, const std::vector<Row>& rows) {
  const auto nanoseconds = [](const Row& row) { return 1e9 * row.cost.cpu_s / row.items; };
  for (const Row& row : rows) {
    const bool checked = row.errors && row.errors->distances > 0, sides = row.errors && row.errors->signs > 0;
    fmt::print(kRow, subject.name, Compact(subject.mesh.faces.size()), work, Compact(items), row.method,
               fmt::format("{:.3f}", row.cost.wall_s * static_cast<double>(items) / row.items),
               fmt::format("{:.3f}", row.cost.cpu_s * static_cast<double>(items) / row.items),
               fmt::format("{:.1f}", nanoseconds(row)),
               fmt::format("{:.2f}", nanoseconds(row) / nanoseconds(rows.front())),
               row.cost.peak_bytes > 0 ? fmt::format("{:.1f}", row.cost.peak_bytes / 1e6) : "",
               checked ? fmt::format("{:.1e}", row.errors->worst_rel) : "",
               sides ? fmt::format("{} / {}", row.errors->wrong_signs, Compact(row.errors->signs)) : "",
               checked ? fmt::format("{}", row.errors->missing) : "");
  }
  std::fflush(stdout);
}

FieldErrors Check(const Subject& subject, const LevelSet& field, const RunOptions& options) {
  return CheckField(subject.mesh, field, subject.brute,
                    subject.sides && options.check_signs > 0 ? &*subject.sides : nullptr, options.check_pairs,
                    options.check_signs);
}

// The peer's distances at the active voxels of every k-th leaf, into a copy of those leaves.
Row RunPeerOnField(const Subject& subject, const PointPeer& peer, const LevelSet& field, const RunOptions& options) {
  using Leaf = openvdb::FloatTree::LeafNodeType;
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
  Row row{peer.Name(), static_cast<double>(copy->activeVoxelCount()), {}, {}, ""};
  row.cost = Measure(
      1,
      [&] {
        ParallelFor(leaves.size(), 4, [&](size_t i) {
          // Along the rows to and fro, so that a point is near the one before.
          std::vector<Eigen::Vector3d> points;
          std::vector<openvdb::Index> offsets;
          for (openvdb::Index y = 0; y < 64; ++y)
            for (openvdb::Index k = 0; k < 8; ++k) {
              const openvdb::Index n = 8 * y + (y % 2 == 0 ? k : 7 - k);
              if (!leaves[i]->isValueOn(n)) continue;
              offsets.push_back(n);
              points.push_back(FromVdb(grid.indexToWorld(leaves[i]->offsetToGlobalCoord(n))));
            }
          std::vector<float> values(points.size());
          double longest = 0;
          for (size_t k = 1; k < points.size(); ++k) longest = std::max(longest, (points[k] - points[k - 1]).norm());
          peer.Distances(points.data(), points.size(), std::max(longest, h) * (1 + 1e-9), reach, values.data());
          for (size_t k = 0; k < offsets.size(); ++k) leaves[i]->setValueOnly(offsets[k], values[k]);
        });
      },
      [] {});
  // Inactive voxels keep Glint's signs: only active ones tell of the peer.
  row.errors = Check(subject, MakeLevelSet(copy), options);
  return row;
}

void RunBand(Subject& subject, const std::string& work, int resolution, double half_width, const RunOptions& options) {
  const double h = BoundingBox(subject.mesh).sizes().maxCoeff() / resolution;
  std::vector<Row> rows;
  LevelSet field;
  for (const char* sign : {"pseudonormal", "auto"}) {
    LevelSet made;
    SdfSummary summary;
    Row row{std::string("Glint ") + sign, 0, {}, {}, ""};
    row.cost = Measure(
        options.repeats,
        [&] { made = MeshToLevelSet(subject.given, h, {.half_width_voxels = half_width, .sign = sign}, &summary); },
        [&] { made = LevelSet(); });
    row.items = static_cast<double>(made.num_active_voxels());
    if (rows.empty()) {
      row.errors = Check(subject, made, options);
      field = made;
    } else if (summary.sign != "pseudonormal") {
      row.method += " = " + summary.sign;
      row.errors = Check(subject, made, options);
    }
    rows.push_back(row);
  }
  const size_t active = field.num_active_voxels();
  for (const std::string& name : options.peers) {
    if (name != "openvdb") continue;
    LevelSet made;
    Row row{"OpenVDB", 0, {}, {}, ""};
    row.cost = Measure(
        options.repeats, [&] { made = OpenVdbLevelSet(subject.mesh, h, half_width); }, [&] { made = LevelSet(); });
    row.items = static_cast<double>(active);  // those of the exact band: it has others
    row.errors = Check(subject, made, options);
    rows.push_back(row);
  }
  for (const auto& peer : subject.peers) rows.push_back(RunPeerOnField(subject, *peer, field, options));
  PrintRows(subject, work, active, rows);
}

// Distances of points in the mesh's box, half as large again, by all methods.
void RunPoints(Subject& subject, const std::string& work, const std::vector<Eigen::Vector3d>& points, double step,
               const std::function<std::vector<float>()>& glint, const RunOptions& options) {
  const double diagonal = Diagonal(subject.mesh);
  std::vector<float> values;
  const auto errors = [&](size_t stride) {
    FieldErrors e;
    const size_t wanted = static_cast<size_t>(options.check_pairs / static_cast<double>(subject.mesh.faces.size()));
    const size_t every = stride * std::max<size_t>(1, points.size() / stride / std::max<size_t>(1, wanted));
    std::vector<double> distances(points.size() / every + 1);
    ParallelFor(distances.size(), 16, [&](size_t i) {
      if (i * every < points.size()) distances[i] = subject.brute.Distance(points[i * every]);
    });
    for (size_t i = 0; i < points.size(); i += every) {
      ++e.distances;
      e.worst_rel = std::max(e.worst_rel, std::abs(std::abs(values[i]) - distances[i / every]) / diagonal);
    }
    if (!subject.sides || options.check_signs == 0) return e;
    for (size_t i = 0; i < std::min(points.size(), options.check_signs); i += stride) {
      int winding;
      subject.sides->Column(points[i][0], points[i][1], &points[i][2], 1, &winding);
      ++e.signs;
      if (winding >= ExactSides::kOnSurface / 2) continue;
      e.wrong_signs += (values[i] < 0) != (winding > 0);
    }
    return e;
  };
  std::vector<Row> rows;
  Row ours{"Glint", static_cast<double>(points.size()), {}, {}, ""};
  ours.cost = Measure(
      options.repeats, [&] { values = glint(); }, [&] { values = {}; });
  ours.errors = errors(1);
  rows.push_back(ours);
  for (const auto& peer : subject.peers) {
    // Runs of 512 points, every k-th of them.
    const size_t runs = (points.size() + 511) / 512;
    const size_t every = std::max<size_t>(1, points.size() / std::max<size_t>(1, options.peer_voxels));
    values.assign(points.size(), 0);
    double items = 0;
    for (size_t r = 0; r < runs; r += every)
      items += static_cast<double>(std::min<size_t>(512, points.size() - 512 * r));
    Row row{peer->Name(), items, {}, {}, ""};
    row.cost = Measure(
        1,
        [&] {
          ParallelFor((runs + every - 1) / every, 1, [&](size_t i) {
            const size_t begin = 512 * i * every, end = std::min(points.size(), begin + 512);
            peer->Distances(points.data() + begin, end - begin, step, 1e300, values.data() + begin);
          });
        },
        [] {});
    if (every == 1) row.errors = errors(1);
    rows.push_back(row);
  }
  PrintRows(subject, work, points.size(), rows);
}

void RunScattered(Subject& subject, const std::string& work, size_t count, const RunOptions& options) {
  const Eigen::AlignedBox3d box = BoundingBox(subject.mesh);
  std::mt19937 random(7);
  std::vector<Eigen::Vector3d> points(count);
  for (Eigen::Vector3d& p : points)
    for (int k = 0; k < 3; ++k) p[k] = box.center()[k] + 0.75 * (2.0 * random() / 4294967295.0 - 1) * box.sizes()[k];
  RunPoints(
      subject, work, points, 1e300,
      [&] {
        const std::vector<double> d = SignedDistance(subject.given, points, "pseudonormal");
        return std::vector<float>(d.begin(), d.end());
      },
      options);
}

void RunDense(Subject& subject, const std::string& work, int n, const RunOptions& options) {
  const Eigen::AlignedBox3d box = BoundingBox(subject.mesh);
  const double h = 1.1 * box.sizes().maxCoeff() / n;
  Eigen::Affine3d world_from_index = Eigen::Affine3d::Identity();
  world_from_index.linear() *= h;
  world_from_index.translation() = box.center() - 0.5 * h * Eigen::Vector3d::Constant(n - 1.0);
  std::vector<Eigen::Vector3d> points;
  points.reserve(static_cast<size_t>(n) * static_cast<size_t>(n) * static_cast<size_t>(n));
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z) points.push_back(world_from_index * Eigen::Vector3d(x, y, z));
  RunPoints(
      subject, work, points, h * n * 2,
      [&] {
        return DenseSignedDistance(subject.given, world_from_index, Eigen::Vector3i::Constant(n), "pseudonormal")
            .values;
      },
      options);
}

}  // namespace

void PrintHeader() {
  fmt::print("tile kernel: {}; {} threads\n", internal::TileKernelTarget(), NumThreads());
  fmt::print(
      "Exact peers: trees built beforehand, distances at the voxels of Glint's field. CPU ns a voxel; × of Glint "
      "pseudonormal.\n\n");
  fmt::print(kRow, "mesh", "faces", "work", "voxels", "method", "wall s", "CPU s", "ns/voxel", "×", "MB", "error/dg",
             "wrong signs", "missing");
  fmt::print(kRow, "-", "-:", "-", "-:", "-", "-:", "-:", "-:", "-:", "-:", "-:", "-:", "-:");
}

void RunMesh(const std::string& name, TriangleMesh mesh, const std::vector<std::string>& work,
             const RunOptions& options) {
  const double diagonal = Diagonal(mesh);
  for (Eigen::Vector3d& v : mesh.vertices)
    v = options.scale * v + options.scale * options.offset_diagonals * diagonal * Eigen::Vector3d(1, -0.7, 0.3);
  Subject subject(name, std::move(mesh));
  for (const std::string& peer : options.peers) {
    if (peer == "embree") subject.peers.push_back(MakeEmbreePeer(subject.mesh, subject.normals));
    if (peer == "cgal") subject.peers.push_back(MakeCgalPeer(subject.mesh, subject.normals));
  }
  for (const std::string& w : work) {
    int n = 0;
    double half_width = 3;
    if (std::sscanf(w.c_str(), "band:%d:%lf", &n, &half_width) == 2 && n > 0) {
      RunBand(subject, w, n, half_width, options);
    } else if (std::sscanf(w.c_str(), "dense:%d", &n) == 1 && n > 0) {
      RunDense(subject, w, n, options);
    } else if (std::sscanf(w.c_str(), "points:%d", &n) == 1 && n > 0) {
      RunScattered(subject, w, static_cast<size_t>(n), options);
    } else {
      throw InputError("", w, "expected band:RESOLUTION:HALF_WIDTH, dense:N or points:N");
    }
  }
}

}  // namespace glint::benchmark
