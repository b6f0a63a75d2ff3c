#include "tests/benchmark/scenes/measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "geometry/closest_point.h"
#include "io/mesh_io.h"
#include "light/light_io.h"
#include "pipeline/artifacts.h"

namespace glint::benchmark {

namespace {
constexpr double kNearRel = 0.02;
}

Measured Measure(const TriangleMesh& mesh, const TriangleMesh& truth, const Regions& regions) {
  const MeshComparison c = CompareMeshes(mesh, truth);
  std::vector<uint8_t> near = regions.swept;
  for (size_t v = 0; v < near.size(); ++v)
    near[v] = near[v] && c.reference_distance[v] < kNearRel * c.reference_diagonal;
  return {NormalStats(c, regions.swept), DistanceStatsRel(c, regions.swept),
          NormalStats(c, regions.rest),  DistanceStatsRel(c, regions.rest),
          NormalStats(c, regions.seen),  DistanceStatsRel(c, regions.seen),
          NormalStats(c, near)};
}

void PrintHeader() {
  fmt::print("{:<22} {:<12} {:>9} {:>8} {:>8} {:>8} {:>10} {:>9} {:>9} {:>10} {:>9} {:>10} {:>9}\n", "scene", "surface",
             "normals", "median", "95 %", "< 2 %", "distance", "95 %", "normals", "distance", "normals", "distance",
             "seconds");
  fmt::print("{:<22} {:<12} {:>57} {:>20} {:>20}\n", "", "", "---- where highlights pass (deg, % diag) ----",
             "---- elsewhere ----", "-- there, seen --");
}

void PrintRow(const std::string& scene, const std::string& surface, const Measured& m, double seconds) {
  fmt::print(
      "{:<22} {:<12} {:>9.3f} {:>8.3f} {:>8.3f} {:>8.3f} {:>10.4f} {:>9.4f} {:>9.3f} {:>10.4f} {:>9.3f} {:>10.4f} "
      "{:>9.1f}\n",
      scene, surface, m.normal_in.mean, m.normal_in.median, m.normal_in.p95, m.normal_near.mean,
      100 * m.distance_in.mean, 100 * m.distance_in.p95, m.normal_out.mean, 100 * m.distance_out.mean,
      m.normal_seen.mean, 100 * m.distance_seen.mean, seconds);
  std::fflush(stdout);
}

Eigen::Vector3d InterpolatedNormal(const TriangleMesh& mesh, const RayHit& hit) {
  const Eigen::Vector3i& f = mesh.faces[hit.face];
  return ((1 - hit.u - hit.v) * mesh.normals[f[0]] + hit.u * mesh.normals[f[1]] + hit.v * mesh.normals[f[2]])
      .normalized();
}

ContactErrors MeasureContacts(const Scene& views, const std::filesystem::path& out, const TriangleMesh& truth) {
  const std::vector<Light> lights = ReadLights(out / "lights.json");
  TriangleMesh mesh = ReadMesh(out / "mesh.ply");
  const RayCaster on_truth(truth), on_mesh(mesh);
  const double diagonal = Diagonal(truth);
  constexpr double kDegrees = 180 / M_PI;
  std::vector<double> data, result, depth;
  for (const Highlight& h : ReadHighlights(out / "stages" / "highlights.json", views.views.size())) {
    if (h.status != HighlightStatus::kAccepted || h.light < 0 || h.light >= static_cast<int>(lights.size())) continue;
    const View& view = views.views[h.view];
    const auto ray = view.RayThrough(h.px);
    if (!ray) continue;
    const auto a = on_truth.Intersect(view.Center(), *ray), b = on_mesh.Intersect(view.Center(), *ray);
    if (!a || !b) continue;
    const Eigen::Vector3d half = HalfVector(lights[h.light], view.cam_from_world, a->position);
    const Eigen::Vector3d true_normal = InterpolatedNormal(truth, *a);
    data.push_back(kDegrees * std::acos(std::clamp(half.dot(true_normal), -1.0, 1.0)));
    result.push_back(kDegrees * std::acos(std::clamp(InterpolatedNormal(mesh, *b).dot(true_normal), -1.0, 1.0)));
    depth.push_back(std::abs(a->t - b->t) / diagonal);
  }
  return {StatsOf(data), StatsOf(result), StatsOf(depth)};
}

void PrintContacts(const std::string& scene, const ContactErrors& errors) {
  const auto& [half, result, depth] = errors;
  fmt::print(
      "{:<22} {:<12} {} highlights: half vector {:.3f} median {:.3f} 95 %, result there {:.3f}, {:.3f} deg; "
      "depth {:.4f}, {:.4f} % diag\n",
      scene, "contacts", half.count, half.median, half.p95, result.median, result.p95, 100 * depth.median,
      100 * depth.p95);
}

Honesty MeasureHonesty(const std::string& scene, const std::string& where, const TriangleMesh& mesh,
                       const TriangleMesh& truth, const std::vector<uint8_t>& region) {
  const std::vector<float>*position_rel = nullptr, *normal_deg = nullptr;
  for (const auto& [name, values] : mesh.scalars) {
    if (name == "sigma_position_rel") position_rel = &values;
    if (name == "sigma_normal_deg") normal_deg = &values;
  }
  if (!position_rel || !normal_deg) return {};
  const MeshComparison c = CompareMeshes(mesh, truth);
  const ClosestPointQuery query(mesh);
  std::vector<double> position, normal, off_position, off_normal;
  for (size_t v = 0; v < truth.vertices.size(); ++v) {
    if (!region[v] || c.reference_normal_deg[v] < 0) continue;
    const int corner = mesh.faces[query.Find(truth.vertices[v])->face][0];
    position.push_back((*position_rel)[corner]);
    normal.push_back((*normal_deg)[corner]);
    off_position.push_back(c.reference_distance[v] / c.reference_diagonal / position.back());
    off_normal.push_back(c.reference_normal_deg[v] / normal.back());
  }
  const auto share = [](const std::vector<double>& off) {
    return static_cast<double>(std::count_if(off.begin(), off.end(), [](double o) { return o < 2; })) /
           static_cast<double>(std::max<size_t>(off.size(), 1));
  };
  const Honesty honesty{share(off_position), share(off_normal)};
  fmt::print(
      "{:<22} {:<12} {:<16} within 2 sigma: position {:.1f} %, normal {:.1f} %; median sigma {:.4f} % diag, {:.3f} "
      "deg; median error in sigmas {:.2f}, {:.2f}\n",
      scene, "honesty", where, 100 * honesty.position, 100 * honesty.normal, 100 * StatsOf(position).median,
      StatsOf(normal).median, StatsOf(off_position).median, StatsOf(off_normal).median);
  return honesty;
}

}  // namespace glint::benchmark
