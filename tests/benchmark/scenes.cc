// The main job measured: synthetic scenes and, where it is there, the path-traced vase. One row a scene: the sparse
// surface (seed.ply), the same flow with the highlights switched off, and the result, against the truth. Column "< 2
// %": mean normal error of those of the truth's vertices that have the surface within 2 % of the diagonal.
//   scenes [--out DIR] [--scenes a,b] [--lights 1,2] [--views N] [--seed S] [--unknown] [--vase DIR] ...
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>

#include "colmap/project.h"
#include "colmap/scene.h"
#include "core/error.h"
#include "io/mesh_io.h"
#include "light/light_io.h"
#include "metrics/compare.h"
#include "metrics/swept_region.h"
#include "pipeline/comparison.h"
#include "pipeline/run.h"
#include "pipeline/terminal.h"
#include "synthetic/write_project.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

struct Measured {
  ErrorStats normal_in, distance_in, normal_out, distance_out;
  ErrorStats normal_near;  // where highlights pass and the surface is there at all, within kNearRel
};

constexpr double kNearRel = 0.02;

Measured Measure(const TriangleMesh& mesh, const TriangleMesh& truth, const std::vector<uint8_t>& region,
                 const std::vector<uint8_t>& rest) {
  const MeshComparison c = CompareMeshes(mesh, truth);
  std::vector<uint8_t> near = region;
  for (size_t v = 0; v < near.size(); ++v)
    near[v] = near[v] && c.reference_distance[v] < kNearRel * c.reference_diagonal;
  return {NormalStats(c, region), DistanceStatsRel(c, region), NormalStats(c, rest), DistanceStatsRel(c, rest),
          NormalStats(c, near)};
}

void PrintHeader() {
  fmt::print("{:<22} {:<12} {:>9} {:>8} {:>8} {:>8} {:>10} {:>9} {:>9} {:>10} {:>9}\n", "scene", "surface", "normals",
             "median", "95 %", "< 2 %", "distance", "95 %", "normals", "distance", "seconds");
  fmt::print("{:<22} {:<12} {:>57} {:>20}\n", "", "", "---- where highlights pass (deg, % diag) ----",
             "---- elsewhere ----");
}

void PrintRow(const std::string& scene, const std::string& surface, const Measured& m, double seconds) {
  fmt::print("{:<22} {:<12} {:>9.3f} {:>8.3f} {:>8.3f} {:>8.3f} {:>10.4f} {:>9.4f} {:>9.3f} {:>10.4f} {:>9.1f}\n",
             scene, surface, m.normal_in.mean, m.normal_in.median, m.normal_in.p95, m.normal_near.mean,
             100 * m.distance_in.mean, 100 * m.distance_in.p95, m.normal_out.mean, 100 * m.distance_out.mean, seconds);
  std::fflush(stdout);
}

double Seconds(const RunSummary& run) {
  double sum = 0;
  for (const StageTime& t : run.times) sum += t.seconds;
  return sum;
}

struct Case {
  std::string name;
  fs::path project, lights, out;
  const TriangleMesh& truth;
  std::vector<uint8_t> region, rest;
  Eigen::Affine3d truth_from_project = Eigen::Affine3d::Identity();
};

void MeasureCase(const Case& c) {
  Config config;
  config.output.overlays = false;
  const auto run = [&](bool highlights, const fs::path& out) {
    config.refine.use_highlights = highlights;
    Terminal quiet(Verbosity::kQuiet);
    RunArguments arguments;
    arguments.project = c.project;
    arguments.lights = c.lights;
    arguments.out = out;
    return Seconds(Run(arguments, config, quiet));
  };
  const auto measure = [&](const fs::path& file) {
    TriangleMesh mesh = ReadMesh(file);
    Transform(c.truth_from_project, mesh);
    EnsureNormals(mesh);
    return Measure(mesh, c.truth, c.region, c.rest);
  };
  try {
    const double without_s = run(false, c.out / "without");
    const double with_s = run(true, c.out / "with");
    PrintRow(c.name, "seed", measure(c.out / "with" / "seed.ply"), 0);
    PrintRow(c.name, "faired seed", measure(c.out / "with" / "stages" / "start.ply"), 0);
    PrintRow(c.name, "without", measure(c.out / "without" / "mesh.ply"), without_s);
    PrintRow(c.name, "glint", measure(c.out / "with" / "mesh.ply"), with_s);
  } catch (const Error& error) {
    fmt::print("{:<22} {}\n", c.name, error.what());
  }
}

std::vector<uint8_t> Complement(std::vector<uint8_t> mask) {
  for (uint8_t& m : mask) m = !m;
  return mask;
}

void MeasureSynthetic(const SyntheticOptions& options, const fs::path& out, bool unknown) {
  const std::string name = fmt::format("{} {}x{}{}", options.scene, options.lights, options.light_kind,
                                       options.seed == 1 ? "" : fmt::format(" s{}", options.seed));
  const fs::path project = out / fmt::format("{}-{}-{}-{}-{}", options.scene, options.lights, options.light_kind,
                                             options.views, options.seed);
  if (!fs::exists(project / "truth" / "mesh.ply")) WriteSyntheticProject(SynthesizeScene(options), project);
  const TriangleMesh truth = ReadMesh(project / "truth" / "mesh.ply");
  const Scene scene = MakeScene(ReadModel(FindProject(project).model));
  const std::vector<Light> lights = ReadLights(project / "truth" / "lights.json");
  std::vector<uint8_t> region = SweptRegion(truth, scene, lights);
  std::vector<uint8_t> rest = Complement(region);
  MeasureCase({name, project, unknown ? fs::path() : project / "truth" / "lights.json", project / "glint", truth,
               std::move(region), std::move(rest)});
}

// Where highlights pass: nhl > 0; elsewhere: the rest of what at least one camera sees.
void MeasureVase(const fs::path& vase, const fs::path& out, bool unknown) {
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
  PrintRow("vase", "COLMAP", Measure(colmap, truth, region, rest), 0);
  MeasureCase({"vase", vase / "project", unknown ? fs::path() : vase / "lights.json", out / "vase", truth, region, rest,
               similarity});
}

int Main(int argc, char** argv) {
  CLI::App app("The main job measured on synthetic scenes and the vase");
  fs::path out = "build/measured", vase;
  std::vector<std::string> scenes = {"sphere", "blob", "torus", "hood"};
  std::vector<int> lights = {1, 2};
  SyntheticOptions options;
  bool unknown = false;
  app.add_option("--out", out, "folder for the scenes and results");
  app.add_option("--scenes", scenes, "scenes to measure; 'none' for none")->delimiter(',');
  app.add_option("--lights", lights, "numbers of lights")->delimiter(',');
  app.add_option("--kind", options.light_kind, "kind of the lights");
  app.add_option("--views", options.views, "views");
  app.add_option("--width", options.width, "px");
  app.add_option("--height", options.height, "px");
  app.add_option("--seed", options.seed, "random seed of the scenes");
  app.add_option("--roughness", options.roughness, "GGX alpha");
  app.add_option("--base", options.base, "base colour");
  app.add_flag("--unknown", unknown, "do not give the lights");
  app.add_option("--vase", vase, "folder of the vase");
  CLI11_PARSE(app, argc, argv);
  PrintHeader();
  for (const std::string& scene : scenes)
    for (int count : lights) {
      if (scene == "none") continue;
      options.scene = scene;
      options.lights = count;
      MeasureSynthetic(options, out, unknown);
    }
  if (!vase.empty()) MeasureVase(vase, out, unknown);
  return 0;
}

}  // namespace
}  // namespace glint

int main(int argc, char** argv) { return glint::Main(argc, argv); }
