// Points and dense grids.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "core/parallel.h"
#include "sdf/dense_distance.h"
#include "sdf/signed_distance.h"
#include "tests/benchmark/sdf/workloads.h"

namespace glint::benchmark {

namespace {

// Distances of the points, signed as asked.
using Glint = std::function<std::vector<float>(const std::string& sign, SdfSummary& summary)>;

constexpr size_t kRun = 512;  // points that a peer does one after another

// Every k-th of `count`, about `wanted` of them, in no step with rows or columns.
size_t Every(size_t count, double wanted) {
  if (!(wanted >= 1)) return count + 1;
  const size_t every = std::max<size_t>(1, static_cast<size_t>(static_cast<double>(count) / wanted));
  return every == 1 ? 1 : every | 1;
}

FieldErrors Check(const Subject& subject, const std::vector<Eigen::Vector3d>& points, const std::vector<float>& values,
                  const RunOptions& options) {
  FieldErrors e;
  const size_t end = points.size();
  const double diagonal = Diagonal(subject.mesh), faces = static_cast<double>(subject.mesh.faces.size());
  const size_t every = Every(end, std::min(options.check_pairs / faces, 1e6));
  std::vector<double> distances((end + every - 1) / every);
  if (every <= end)
    ParallelFor(distances.size(), 16, [&](size_t i) { distances[i] = subject.brute.Distance(points[i * every]); });
  for (size_t i = 0; i < end && every <= end; i += every) {
    ++e.distances;
    const double error = std::abs(std::abs(static_cast<double>(values[i])) - distances[i / every]);
    e.worst_rel = std::max(e.worst_rel, error / diagonal);
  }
  if (!subject.sides) return e;
  const size_t every_sign = Every(end, static_cast<double>(options.check_signs));
  for (size_t i = 0; i < end && every_sign <= end; i += every_sign) {
    int winding;
    subject.sides->Column(points[i][0], points[i][1], &points[i][2], 1, &winding);
    if (winding >= ExactSides::kOnSurface / 2) continue;
    ++e.signs;
    e.wrong_signs += (values[i] < 0) != (winding > 0);
  }
  return e;
}

// Runs of points, every k-th of them, for as many as the peer is given.
Row RunPeer(const Subject& subject, const PointPeer& peer, const std::vector<Eigen::Vector3d>& points, double step,
            const RunOptions& options) {
  const size_t runs = (points.size() + kRun - 1) / kRun;
  const size_t every = std::max<size_t>(1, points.size() / std::max<size_t>(1, options.peer_voxels));
  std::vector<Eigen::Vector3d> chosen;
  for (size_t r = 0; r < runs; r += every)
    chosen.insert(chosen.end(), points.begin() + static_cast<std::ptrdiff_t>(r * kRun),
                  points.begin() + static_cast<std::ptrdiff_t>(std::min(points.size(), (r + 1) * kRun)));
  std::vector<float> values(chosen.size());
  Row row{Method::kExactPeer, peer.Name(), static_cast<double>(chosen.size()), {}, {}};
  row.cost = Measure(
      1,
      [&] {
        ParallelFor((chosen.size() + kRun - 1) / kRun, 1, [&](size_t r) {
          const size_t begin = r * kRun, end = std::min(chosen.size(), begin + kRun);
          peer.Distances(chosen.data() + begin, end - begin, step, 1e300, values.data() + begin);
        });
      },
      [] {});
  RunOptions few = options;
  few.check_pairs *= 0.1;
  few.check_signs /= 4;
  row.errors = Check(subject, chosen, values, few);
  return row;
}

Work Run(const Subject& subject, const std::string& name, const std::vector<Eigen::Vector3d>& points, double step,
         const Glint& glint, const RunOptions& options) {
  Work work{subject.name, name, subject.mesh.faces.size(), points.size(), false, {}};
  for (const bool automatic : {false, true}) {
    std::vector<float> values;
    SdfSummary summary;
    const std::string sign = automatic ? "auto" : "pseudonormal";
    Row row{
        automatic ? Method::kAuto : Method::kPseudoNormal, "Glint " + sign, static_cast<double>(points.size()), {}, {}};
    row.cost = Measure(
        automatic ? 1 : options.repeats, [&] { values = glint(sign, summary); }, [&] { values = {}; });
    if (summary.sign != sign && summary.sign != "pseudonormal") row.name += " = " + summary.sign;
    if (!automatic || summary.sign != "pseudonormal") row.errors = Check(subject, points, values, options);
    work.rows.push_back(row);
  }
  for (const auto& peer : subject.peers) work.rows.push_back(RunPeer(subject, *peer, points, step, options));
  return work;
}

}  // namespace

Work RunScattered(const Subject& subject, size_t count, const RunOptions& options) {
  const Eigen::AlignedBox3d box = BoundingBox(subject.mesh);
  std::mt19937 random(7);
  std::vector<Eigen::Vector3d> points(count);
  for (Eigen::Vector3d& p : points)  // in the mesh's box, half as large again
    for (int k = 0; k < 3; ++k) p[k] = box.center()[k] + 0.75 * (2.0 * random() / 4294967295.0 - 1) * box.sizes()[k];
  return Run(
      subject, fmt::format("points:{}", count), points, 1e300,
      [&](const std::string& sign, SdfSummary& summary) {
        const std::vector<double> d = SignedDistance(subject.given, points, sign, &summary);
        return std::vector<float>(d.begin(), d.end());
      },
      options);
}

Work RunDense(const Subject& subject, int n, const RunOptions& options) {
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
  return Run(
      subject, fmt::format("dense:{}", n), points, h * n * 2,
      [&](const std::string& sign, SdfSummary& summary) {
        return DenseSignedDistance(subject.given, world_from_index, Eigen::Vector3i::Constant(n), sign, &summary)
            .values;
      },
      options);
}

}  // namespace glint::benchmark
