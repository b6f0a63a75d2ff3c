// The main job measured: synthetic scenes and, where it is there, the path-traced vase. One row a scene: the sparse
// surface (seed.ply), the same flow with the highlights switched off, and the result, against the truth. Column "< 2
// %": mean normal error of those of the truth's vertices that have the surface within 2 % of the diagonal.
//   scenes [--out DIR] [--scenes a,b] [--lights 1,2] [--views N,M] [--seed S,T] [--lights-are given,unknown]
//          [--vase DIR] [--set KEY=VALUE] ...
// Ends with a table of all synthetic scenes: a row for each number of views and of lights, given and unknown.
// --baselines: also the seed smoothed (by the Laplacian and by mean curvature, each with the number of rounds that is
// best against the truth, which nobody could know), CGAL's Poisson surface of the same points, and the papers' flow.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include "colmap/project.h"
#include "colmap/scene.h"
#include "core/error.h"
#include "io/mesh_io.h"
#include "pipeline/artifacts.h"
#include "pipeline/comparison.h"
#include "pipeline/run.h"
#include "pipeline/similarity.h"
#include "tests/benchmark/scenes/baselines.h"
#include "tests/benchmark/scenes/case.h"
#include "tests/benchmark/scenes/summary.h"

namespace glint::benchmark {
namespace {

namespace fs = std::filesystem;

void PrintBest(const Case& c, const std::string& surface, const std::vector<TriangleMesh>& meshes) {
  if (meshes.empty()) return;
  Measured best;
  for (size_t i = 0; i < meshes.size(); ++i) {
    const Measured m = MeasureMesh(c, meshes[i]);
    if (i == 0 || m.normal_in.mean < best.normal_in.mean) best = m;
  }
  PrintRow(c.name, surface, best, 0);
}

void MeasureBaselines(const Case& c, const Plan& plan) {
  const TriangleMesh seed = ReadMesh(c.out / "with" / "seed.ply");
  PrintBest(c, "Laplacian", LaplacianSmoothed(seed));
  PrintBest(c, "curvature", CurvatureFlowed(seed, 1.0 / 128));
  const Scene scene = MakeScene(ReadModel(FindProject(c.project).model));
  const TriangleMesh poisson =
      Poisson(scene, ReadFlags(c.out / "with" / "stages" / "points_on_object.txt", scene.points.size()));
  if (poisson.faces.empty())
    fmt::print("{:<22} {:<12} fails\n", c.name, "Poisson");
  else
    PrintBest(c, "Poisson", {poisson});
  const double seconds = RunCase(c, plan, {"refine.method=flow"}, c.out / "flow");
  PrintRow(c.name, "flow", MeasureFile(c, c.out / "flow" / "mesh.ply"), seconds);
}

void MeasureCase(const Case& c, const Plan& plan, Summary& summary) {
  const fs::path with = c.out / "with", without = c.out / "without";
  try {
    const double without_s =
        plan.without ? RunCase(c, plan, {"refine.use_highlights=false", "refine.tilts.use_shading=false"}, without) : 0;
    const double with_s = RunCase(c, plan, {}, with);
    PrintRow(c.name, "seed", MeasureFile(c, with / "seed.ply"), 0);
    Outcome outcome;
    outcome.start = MeasureFile(c, with / "stages" / "start.ply");
    PrintRow(c.name, "faired seed", outcome.start, 0);
    if (plan.baselines) MeasureBaselines(c, plan);
    if (plan.without) {
      outcome.without = MeasureFile(c, without / "mesh.ply");
      PrintRow(c.name, "without", *outcome.without, without_s);
    }
    outcome.result = MeasureFile(c, with / "mesh.ply");
    PrintRow(c.name, "glint", outcome.result, with_s);
    TriangleMesh result = ReadMesh(with / "mesh.ply");
    Transform(c.truth_from_project, result);
    outcome.honesty = MeasureHonesty(c.name, "highlights pass", result, c.truth, c.regions.swept);
    MeasureHonesty(c.name, "elsewhere", result, c.truth, c.regions.rest);
    TriangleMesh truth = c.truth;
    Transform(c.truth_from_project.inverse(), truth);
    outcome.contacts = MeasureContacts(MakeScene(ReadModel(FindProject(c.project).model)), with, truth);
    PrintContacts(c.name, outcome.contacts);
    summary.Add(c, plan.unknown, outcome);
  } catch (const Error& error) {
    fmt::print("{:<22} {}\n", c.name, error.what());
    summary.AddFailure(c, plan.unknown);
  }
}

using Cell = std::tuple<std::string, uint64_t, int, int>;

std::vector<Cell> Product(const std::vector<std::string>& scenes, const std::vector<uint64_t>& seeds,
                          const std::vector<int>& views, const std::vector<int>& lights) {
  std::vector<Cell> cells;
  for (const std::string& scene : scenes)
    for (const uint64_t seed : seeds)
      for (const int v : views)
        for (const int l : lights) cells.emplace_back(scene, seed, v, l);
  return cells;
}

int Main(int argc, char** argv) {
  CLI::App app("The main job measured on synthetic scenes and the vase");
  fs::path vase;
  Plan plan;
  std::vector<std::string> scenes = {"sphere", "blob", "torus", "hood"};
  std::vector<int> lights = {1, 2}, views = {48};
  std::vector<uint64_t> seeds = {1};
  std::vector<std::string> lights_are = {"given"};
  SyntheticOptions options;
  app.add_option("--out", plan.out, "folder for the scenes and results");
  app.add_option("--scenes", scenes, "scenes to measure; 'none' for none")->delimiter(',');
  app.add_option("--lights", lights, "numbers of lights")->delimiter(',');
  app.add_option("--kind", options.light_kind, "kind of the lights");
  app.add_option("--views", views, "numbers of views")->delimiter(',');
  app.add_option("--width", options.width, "px");
  app.add_option("--height", options.height, "px");
  app.add_option("--seed", seeds, "random seeds of the scenes")->delimiter(',');
  app.add_option("--roughness", options.roughness, "GGX alpha");
  app.add_option("--base", options.base, "base colour");
  app.add_option("--lights-are", lights_are, "given, unknown")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>{"given", "unknown"}));
  app.add_flag("!--no-without", plan.without, "leave out the run without highlights");
  app.add_flag("--baselines", plan.baselines, "also what there is without Glint");
  app.add_option("--normal-maps", plan.normal_maps_deg, "with normal maps, so many degrees off");
  app.add_option("--from", plan.from, "go on from this stage of an earlier call")
      ->check(CLI::IsMember(std::vector<std::string>(kRunStageNames.begin(), kRunStageNames.end())));
  app.add_option("--set", plan.settings, "change one option: section.option=value")->allow_extra_args(false);
  app.add_option("--vase", vase, "folder of the vase");
  CLI11_PARSE(app, argc, argv);
  PrintHeader();
  Summary summary;
  if (scenes != std::vector<std::string>{"none"})
    for (const auto& [scene, seed, count, lights_count] : Product(scenes, seeds, views, lights))
      for (const std::string& are : lights_are) {
        options.scene = scene;
        options.seed = seed;
        options.views = count;
        options.lights = lights_count;
        plan.unknown = are == "unknown";
        MeasureCase(SyntheticCase(options, plan), plan, summary);
      }
  for (const std::string& are : lights_are) {
    if (vase.empty()) break;
    plan.unknown = are == "unknown";
    const Case c = VaseCase(vase, plan);
    PrintRow(c.name, "COLMAP", MeasureFile(c, vase / "colmap-delaunay-sparse.ply"), 0);
    MeasureCase(c, plan, summary);
  }
  summary.Print();
  return 0;
}

}  // namespace
}  // namespace glint::benchmark

int main(int argc, char** argv) { return glint::benchmark::Main(argc, argv); }
