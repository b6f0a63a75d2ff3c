// The main job measured: synthetic scenes and, where it is there, the path-traced vase. One row a scene: the sparse
// surface (seed.ply), the same flow with the highlights switched off, and the result, against the truth. Column "< 2
// %": mean normal error of those of the truth's vertices that have the surface within 2 % of the diagonal.
//   scenes [--out DIR] [--scenes a,b] [--lights 1,2] [--views N] [--seed S] [--unknown] [--vase DIR] [--set KEY=VALUE]
//   ...
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/core.hpp>
#include <random>
#include <string>
#include <vector>

#include "colmap/project.h"
#include "colmap/scene.h"
#include "core/error.h"
#include "core/parallel.h"
#include "geometry/closest_point.h"
#include "geometry/ray_caster.h"
#include "io/mesh_io.h"
#include "io/project_images.h"
#include "light/light_io.h"
#include "metrics/compare.h"
#include "metrics/swept_region.h"
#include "pipeline/artifacts.h"
#include "pipeline/comparison.h"
#include "pipeline/run.h"
#include "pipeline/similarity.h"
#include "pipeline/terminal.h"
#include "synthetic/write_project.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

struct Measured {
  ErrorStats normal_in, distance_in, normal_out, distance_out, normal_seen, distance_seen;
  ErrorStats normal_near;  // where highlights pass and the surface is there at all, within kNearRel
};

constexpr double kNearRel = 0.02;

// How every case is run.
struct Plan {
  fs::path out = "build/measured";
  bool unknown = false;
  bool without = true;          // also with the highlights switched off
  std::string from;             // empty: the first stage that is not done yet
  double normal_maps_deg = -1;  // with normal maps of the truth that are so far off; negative: without
  std::vector<std::string> settings;
};

Measured Measure(const TriangleMesh& mesh, const TriangleMesh& truth, const std::vector<uint8_t>& region,
                 const std::vector<uint8_t>& rest, const std::vector<uint8_t>& seen) {
  const MeshComparison c = CompareMeshes(mesh, truth);
  std::vector<uint8_t> near = region;
  for (size_t v = 0; v < near.size(); ++v)
    near[v] = near[v] && c.reference_distance[v] < kNearRel * c.reference_diagonal;
  return {NormalStats(c, region), DistanceStatsRel(c, region), NormalStats(c, rest), DistanceStatsRel(c, rest),
          NormalStats(c, seen),   DistanceStatsRel(c, seen),   NormalStats(c, near)};
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

// The accepted highlights against the truth: how far the half vector is from the true normal where the ray meets the
// true surface (what limits everything), the same of the result, and how far apart ray meets result and truth (% diag).
void PrintContacts(const std::string& scene, const Scene& views, const fs::path& out, const TriangleMesh& truth) {
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
    depth.push_back(100 * std::abs(a->t - b->t) / diagonal);
  }
  const ErrorStats d = StatsOf(data), r = StatsOf(result), z = StatsOf(depth);
  fmt::print(
      "{:<22} {:<12} {} highlights: half vector {:.3f} median {:.3f} 95 %, result there {:.3f}, {:.3f} deg; "
      "depth {:.4f}, {:.4f} % diag\n",
      scene, "contacts", d.count, d.median, d.p95, r.median, r.p95, z.median, z.p95);
}

// Shares of the truth's vertices in a region where the mesh is within twice the standard deviation that it states there
// (about 95 % are if it is honest), and the deviations' medians.
void PrintHonesty(const std::string& scene, const std::string& where, const TriangleMesh& mesh,
                  const TriangleMesh& truth, const std::vector<uint8_t>& region) {
  const std::vector<float>*position_rel = nullptr, *normal_deg = nullptr;
  for (const auto& [name, values] : mesh.scalars) {
    if (name == "sigma_position_rel") position_rel = &values;
    if (name == "sigma_normal_deg") normal_deg = &values;
  }
  if (!position_rel || !normal_deg) return;
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
    return 100.0 * static_cast<double>(std::count_if(off.begin(), off.end(), [](double o) { return o < 2; })) /
           static_cast<double>(std::max<size_t>(off.size(), 1));
  };
  fmt::print(
      "{:<22} {:<12} {:<16} within 2 sigma: position {:.1f} %, normal {:.1f} %; median sigma {:.4f} % diag, {:.3f} "
      "deg; median error in sigmas {:.2f}, {:.2f}\n",
      scene, "honesty", where, share(off_position), share(off_normal), 100 * StatsOf(position).median,
      StatsOf(normal).median, StatsOf(off_position).median, StatsOf(off_normal).median);
}

double Seconds(const RunSummary& run) {
  double sum = 0;
  for (const StageTime& t : run.times) sum += t.seconds;
  return sum;
}

// Maps as a network makes them: right in detail, each turned and bent in its own way.
void WriteNormalMaps(const Scene& scene, const TriangleMesh& truth, double off_deg, uint64_t seed,
                     const fs::path& folder) {
  const RayCaster caster(truth);
  for (size_t v = 0; v < scene.views.size(); ++v) {
    const View& view = scene.views[v];
    std::mt19937_64 random(seed * 1000 + v);
    std::normal_distribution<double> error(0, off_deg * M_PI / 180 / std::sqrt(2.0));
    const Eigen::Vector3d turn(error(random), error(random), error(random));
    const Eigen::Vector3d bend(error(random), error(random), error(random));
    const auto width = static_cast<int>(view.camera.width) / 2, height = static_cast<int>(view.camera.height) / 2;
    cv::Mat map(height, width, CV_8UC3, cv::Scalar::all(0));
    ParallelFor(height, 4, [&](size_t row) {
      const auto y = static_cast<int>(row);
      for (int x = 0; x < width; ++x) {
        const auto ray = view.RayThrough({2 * x + 1.0, 2 * y + 1.0});
        const auto hit = ray ? caster.Intersect(view.Center(), *ray) : std::nullopt;
        if (!hit) continue;
        const double wave = std::sin(6.0 * x / width + 4.0 * y / height + static_cast<double>(v));
        const Eigen::Vector3d n = (InterpolatedNormal(truth, *hit) + turn + wave * bend).normalized();
        const Eigen::Vector3d in_camera = view.cam_from_world.rotation * n;
        const auto code = [](double c) { return static_cast<uchar>(std::lround(127.5 * (1 + c))); };
        map.at<cv::Vec3b>(y, x) = {code(-in_camera.z()), code(-in_camera.y()), code(in_camera.x())};
      }
    });
    WriteImagePng(folder / (view.name + ".png"), map);
  }
}

struct Case {
  std::string name;
  fs::path project, lights, normals, out;
  const TriangleMesh& truth;
  std::vector<uint8_t> region, rest, seen;  // where highlights pass, elsewhere, and what of that a camera sees
  Eigen::Affine3d truth_from_project = Eigen::Affine3d::Identity();
};

void MeasureCase(const Case& c, const Plan& plan) {
  Config config = ResolveConfig({}, plan.settings);
  config.output.overlays = false;
  const auto run = [&](bool highlights, const fs::path& out) {
    config.refine.use_highlights = highlights;
    Terminal quiet(Verbosity::kQuiet);
    RunArguments arguments;
    arguments.project = c.project;
    arguments.lights = c.lights;
    arguments.out = out;
    arguments.normals = c.normals;
    if (!plan.from.empty()) {
      const auto from = std::find(kRunStageNames.begin(), kRunStageNames.end(), plan.from);
      arguments.stages.from = static_cast<RunStage>(from - kRunStageNames.begin());
    }
    return Seconds(Run(arguments, config, quiet));
  };
  const auto measure = [&](const fs::path& file) {
    TriangleMesh mesh = ReadMesh(file);
    Transform(c.truth_from_project, mesh);
    EnsureNormals(mesh);
    return Measure(mesh, c.truth, c.region, c.rest, c.seen);
  };
  try {
    const double without_s = plan.without ? run(false, c.out / "without") : 0;
    const double with_s = run(true, c.out / "with");
    PrintRow(c.name, "seed", measure(c.out / "with" / "seed.ply"), 0);
    PrintRow(c.name, "faired seed", measure(c.out / "with" / "stages" / "start.ply"), 0);
    if (plan.without) PrintRow(c.name, "without", measure(c.out / "without" / "mesh.ply"), without_s);
    PrintRow(c.name, "glint", measure(c.out / "with" / "mesh.ply"), with_s);
    TriangleMesh result = ReadMesh(c.out / "with" / "mesh.ply");
    Transform(c.truth_from_project, result);
    PrintHonesty(c.name, "highlights pass", result, c.truth, c.region);
    PrintHonesty(c.name, "elsewhere", result, c.truth, c.rest);
    TriangleMesh truth = c.truth;
    Transform(c.truth_from_project.inverse(), truth);
    PrintContacts(c.name, MakeScene(ReadModel(FindProject(c.project).model)), c.out / "with", truth);
  } catch (const Error& error) {
    fmt::print("{:<22} {}\n", c.name, error.what());
  }
}

std::vector<uint8_t> Complement(std::vector<uint8_t> mask) {
  for (uint8_t& m : mask) m = !m;
  return mask;
}

void MeasureSynthetic(const SyntheticOptions& options, const Plan& plan) {
  const std::string name = fmt::format("{} {}x{}{}", options.scene, options.lights, options.light_kind,
                                       options.seed == 1 ? "" : fmt::format(" s{}", options.seed));
  const fs::path project = plan.out / fmt::format("{}-{}-{}-{}-{}", options.scene, options.lights, options.light_kind,
                                                  options.views, options.seed);
  if (!fs::exists(project / "truth" / "mesh.ply")) WriteSyntheticProject(SynthesizeScene(options), project);
  const TriangleMesh truth = ReadMesh(project / "truth" / "mesh.ply");
  const Scene scene = MakeScene(ReadModel(FindProject(project).model));
  const std::vector<Light> lights = ReadLights(project / "truth" / "lights.json");
  std::vector<uint8_t> region = SweptRegion(truth, scene, lights);
  const std::vector<uint8_t> rest = Complement(region);
  const std::vector<uint16_t> views = VisibleViews(truth, scene);
  std::vector<uint8_t> seen = rest;
  for (size_t v = 0; v < seen.size(); ++v) seen[v] = seen[v] && views[v] > 0;
  fs::path normals;
  if (plan.normal_maps_deg >= 0) {
    normals = project / "normals";
    fs::create_directories(normals);
    WriteNormalMaps(scene, truth, plan.normal_maps_deg, options.seed, normals);
  }
  MeasureCase({name, project, plan.unknown ? fs::path() : project / "truth" / "lights.json", normals, project / "glint",
               truth, std::move(region), rest, seen},
              plan);
}

// Where highlights pass: nhl > 0; elsewhere: the rest of what at least one camera sees.
void MeasureVase(const fs::path& vase, const Plan& plan) {
  const TriangleMesh truth = ReadMesh(vase / "truth" / "gt_mesh.ply");
  std::vector<uint8_t> region(truth.vertices.size()), rest(truth.vertices.size());
  for (const auto& [name, values] : truth.scalars)
    for (size_t v = 0; v < values.size(); ++v) {
      if (name == "nhl") region[v] = values[v] > 0;
      if (name == "nviews") rest[v] = values[v] > 0;
    }
  for (size_t v = 0; v < rest.size(); ++v) rest[v] = rest[v] && !region[v];
  const Eigen::Affine3d similarity = ReadSimilarity(vase / "truth" / "sim3_colmap_to_gt.json");
  TriangleMesh colmap = ReadMesh(vase / "colmap-delaunay-sparse.ply");
  Transform(similarity, colmap);
  EnsureNormals(colmap);
  PrintRow("vase", "COLMAP", Measure(colmap, truth, region, rest, rest), 0);
  MeasureCase({"vase",
               vase / "project",
               plan.unknown ? fs::path() : vase / "lights.json",
               {},
               plan.out / "vase",
               truth,
               region,
               rest,
               rest,
               similarity},
              plan);
}

int Main(int argc, char** argv) {
  CLI::App app("The main job measured on synthetic scenes and the vase");
  fs::path vase;
  Plan plan;
  std::vector<std::string> scenes = {"sphere", "blob", "torus", "hood"};
  std::vector<int> lights = {1, 2};
  SyntheticOptions options;
  app.add_option("--out", plan.out, "folder for the scenes and results");
  app.add_option("--scenes", scenes, "scenes to measure; 'none' for none")->delimiter(',');
  app.add_option("--lights", lights, "numbers of lights")->delimiter(',');
  app.add_option("--kind", options.light_kind, "kind of the lights");
  app.add_option("--views", options.views, "views");
  app.add_option("--width", options.width, "px");
  app.add_option("--height", options.height, "px");
  app.add_option("--seed", options.seed, "random seed of the scenes");
  app.add_option("--roughness", options.roughness, "GGX alpha");
  app.add_option("--base", options.base, "base colour");
  app.add_flag("--unknown", plan.unknown, "do not give the lights");
  app.add_flag("!--no-without", plan.without, "leave out the run without highlights");
  app.add_option("--normal-maps", plan.normal_maps_deg, "with normal maps, so many degrees off");
  app.add_option("--from", plan.from, "go on from this stage of an earlier call")
      ->check(CLI::IsMember(std::vector<std::string>(kRunStageNames.begin(), kRunStageNames.end())));
  app.add_option("--set", plan.settings, "change one option: section.option=value")->allow_extra_args(false);
  app.add_option("--vase", vase, "folder of the vase");
  CLI11_PARSE(app, argc, argv);
  PrintHeader();
  for (const std::string& scene : scenes)
    for (int count : lights) {
      if (scene == "none") continue;
      options.scene = scene;
      options.lights = count;
      MeasureSynthetic(options, plan);
    }
  if (!vase.empty()) MeasureVase(vase, plan);
  return 0;
}

}  // namespace
}  // namespace glint

int main(int argc, char** argv) { return glint::Main(argc, argv); }
