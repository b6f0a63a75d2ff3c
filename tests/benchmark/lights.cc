// Unknown lights measured: rendered scenes with one to three lights of every kind and, where it is there, the
// path-traced vase. One row a scene: what is there, what was found, how far off, and how far off it says it may be.
//   lights [--out DIR] [--scenes a,b] [--lights 1,2,3] [--kinds distant,point,flash,camera] [--seeds N] [--refine]
//          [--vase DIR] ...
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "colmap/project.h"
#include "core/error.h"
#include "highlights/find_lights.h"
#include "io/mesh_io.h"
#include "io/project_images.h"
#include "light/light_covariance.h"
#include "light/light_io.h"
#include "pipeline/artifacts.h"
#include "pipeline/image_stages.h"
#include "pipeline/run.h"
#include "pipeline/seed_stage.h"
#include "pipeline/terminal.h"
#include "synthetic/write_project.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

struct Settings {
  fs::path out = "build/measured";
  bool refine = false;
  bool verbose = false;
};

struct Tally {
  int scenes = 0, right_number = 0, right_kind = 0, failed = 0;
  std::vector<double> errors_deg, errors_sigmas;
};

// Mean angle over the views between the directions to two lights from `center`, degrees.
double AngleDeg(const Light& a, const Light& b, const Scene& scene, const Eigen::Vector3d& center) {
  double sum = 0;
  for (const View& view : scene.views) {
    const Eigen::Vector3d l = DirectionToLight(a, view.cam_from_world, center);
    const Eigen::Vector3d m = DirectionToLight(b, view.cam_from_world, center);
    sum += std::atan2(l.cross(m).norm(), l.dot(m)) * 180 / M_PI;
  }
  return sum / scene.views.size();
}

// The largest standard deviation of the direction to the light from `center`, degrees; how far away it is does not
// count if its covariance is known.
double SigmaDeg(const FoundLight& found, const Scene& scene, const Eigen::Vector3d& center) {
  if (found.light.type == LightType::kDistant) return found.light.sigma;
  double sum = 0;
  for (const View& view : scene.views) {
    const Eigen::Vector3d to_light =
        found.light.vector - (found.light.frame == LightFrame::kWorld ? center : view.cam_from_world * center);
    const double distance = to_light.norm();
    const Eigen::Matrix3d across =
        Eigen::Matrix3d::Identity() - to_light * to_light.transpose() / (distance * distance);
    const bool known = found.covariance.trace() > 0;
    sum += (known ? LargestSigma(across * found.covariance * across, found.light) : found.light.sigma) / distance;
  }
  return sum / scene.views.size() * 180 / M_PI;
}

std::string KindName(const Light& light) {
  return fmt::format("{}{}", light.type == LightType::kDistant ? "distant" : "point",
                     light.frame == LightFrame::kWorld ? "" : "/camera");
}

// Seed and candidates, kept in `work` between calls.
std::vector<FoundLight> Find(const fs::path& project, const fs::path& work, const Settings& settings,
                             FindLightsSummary& summary) {
  const Config config;
  Terminal quiet(Verbosity::kQuiet);
  const ProjectPaths paths = FindProject(project);
  const Scene scene = MakeScene(ReadModel(paths.model));
  const ProjectImages images(scene, paths, quiet);
  if (!fs::exists(work / "start.ply")) {
    const SeedStageResult seed = RunSeedStage(scene, images, "", config, quiet);
    if (seed.start.empty()) return {};
    WriteMesh(work / "start.ply", seed.start);
  }
  if (!fs::exists(work / "candidates.json"))
    WriteHighlights(work / "candidates.json", DetectInAllViews(scene, images, config.detect, quiet));
  const auto found = FindLights(scene, images, ReadMesh(work / "start.ply"), config.gate, config.lights,
                                ReadHighlights(work / "candidates.json", scene.views.size()), &summary);
  if (settings.verbose) fmt::print("    {}\n", summary.BriefReport());
  return found;
}

std::vector<FoundLight> RunAll(const fs::path& project, const fs::path& work) {
  Config config;
  config.output.overlays = false;
  Terminal quiet(Verbosity::kQuiet);
  RunArguments arguments;
  arguments.project = project;
  arguments.out = work;
  Run(arguments, config, quiet);
  return ReadFoundLights(work / "lights.json");
}

void Compare(const std::string& name, const std::vector<Light>& truth, std::vector<FoundLight> found,
             const Scene& scene, const Eigen::Vector3d& center, Tally& tally) {
  std::erase_if(found, [](const FoundLight& f) { return !f.determined; });
  std::vector<std::string> parts;
  bool kinds = truth.size() == found.size();
  for (const Light& t : truth) {
    const auto nearest = std::min_element(found.begin(), found.end(), [&](const FoundLight& a, const FoundLight& b) {
      return AngleDeg(a.light, t, scene, center) < AngleDeg(b.light, t, scene, center);
    });
    if (nearest == found.end()) {
      parts.push_back("none");
      kinds = false;
      continue;
    }
    const double error = AngleDeg(nearest->light, t, scene, center);
    const double sigma = SigmaDeg(*nearest, scene, center);
    tally.errors_deg.push_back(error);
    tally.errors_sigmas.push_back(error / std::max(sigma, 1e-9));
    kinds = kinds && nearest->light.type == t.type && nearest->light.frame == t.frame;
    parts.push_back(fmt::format("{} {:.2f} deg (sigma {:.2f}, {:.0f} highlights)", KindName(nearest->light), error,
                                sigma, nearest->support));
  }
  ++tally.scenes;
  tally.right_number += truth.size() == found.size();
  tally.right_kind += kinds;
  fmt::print("{:<30} {} of {} {:<5} {}\n", name, found.size(), truth.size(), kinds ? "ok" : "WRONG",
             fmt::join(parts, "; "));
  std::fflush(stdout);
}

void Measure(const std::string& name, const fs::path& project, const fs::path& truth_file, const fs::path& work,
             const Settings& settings, Tally& votes, Tally& refined) {
  try {
    const Scene scene = MakeScene(ReadModel(FindProject(project).model));
    const std::vector<Light> truth = ReadLights(truth_file);
    FindLightsSummary summary;
    const auto found = Find(project, work, settings, summary);
    const Eigen::Vector3d center = BoundingBox(ReadMesh(work / "start.ply")).center();
    Compare(name, truth, found, scene, center, votes);
    if (settings.refine) Compare("  refined", truth, RunAll(project, work / "run"), scene, center, refined);
  } catch (const Error& error) {
    fmt::print("{:<30} {}\n", name, error.what());
    ++votes.failed;
  }
}

double Quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<size_t>(q * values.size()))];
}

void PrintTally(const std::string& name, const Tally& t) {
  if (t.scenes == 0) return;
  const auto within = std::count_if(t.errors_sigmas.begin(), t.errors_sigmas.end(), [](double e) { return e <= 2; });
  fmt::print(
      "{}: {} scenes, right number in {:.0f} %, right kinds in {:.0f} %; direction error median {:.2f} deg, 95 % "
      "{:.2f} "
      "deg; within 2 sigma {:.0f} %; {} failed\n",
      name, t.scenes, 100.0 * t.right_number / t.scenes, 100.0 * t.right_kind / t.scenes, Quantile(t.errors_deg, 0.5),
      Quantile(t.errors_deg, 0.95), 100.0 * within / std::max<size_t>(t.errors_sigmas.size(), 1), t.failed);
}

int Main(int argc, char** argv) {
  CLI::App app("Unknown lights measured on rendered scenes and the vase");
  std::vector<std::string> scenes = {"sphere", "blob", "torus", "hood", "ellipsoid"};
  std::vector<std::string> kinds = {"distant", "point", "flash", "camera"};
  std::vector<int> counts = {1, 2, 3};
  int seeds = 1;
  fs::path vase;
  Settings settings;
  SyntheticOptions options;
  options.views = 32;
  options.width = 480;
  options.height = 360;
  app.add_option("--out", settings.out, "folder for the scenes");
  app.add_option("--scenes", scenes, "scenes to measure; 'none' for none")->delimiter(',');
  app.add_option("--kinds", kinds, "kinds of lights")->delimiter(',');
  app.add_option("--lights", counts, "numbers of lights")->delimiter(',');
  app.add_option("--seeds", seeds, "random seeds of every scene");
  app.add_option("--views", options.views, "views");
  app.add_option("--width", options.width, "px");
  app.add_option("--height", options.height, "px");
  app.add_option("--roughness", options.roughness, "GGX alpha");
  app.add_option("--base", options.base, "base colour");
  app.add_flag("--refine", settings.refine, "also run to the end, for the lights of the bundle");
  app.add_flag("--verbose", settings.verbose, "what the finder says");
  app.add_option("--vase", vase, "folder of the vase");
  CLI11_PARSE(app, argc, argv);
  Tally votes, refined;
  for (const std::string& scene : scenes)
    for (const std::string& kind : kinds)
      for (int count : counts)
        for (int seed = 1; seed <= seeds; ++seed) {
          // There is one flash.
          if (scene == "none" || (kind == "flash" && count > 1)) continue;
          options.scene = scene;
          options.light_kind = kind;
          options.lights = count;
          options.seed = seed;
          const std::string name = fmt::format("{} {}x{} s{}", scene, count, kind, seed);
          const fs::path project =
              settings.out / fmt::format("lights-{}-{}-{}-{}-{}-{}x{}-{}-{}", scene, count, kind, seed, options.views,
                                         options.width, options.height, options.roughness, options.base);
          if (!fs::exists(project / "truth" / "highlights.json"))
            WriteSyntheticProject(SynthesizeScene(options), project);
          Measure(name, project, project / "truth" / "lights.json", project / "work", settings, votes, refined);
        }
  if (!vase.empty())
    Measure("vase", vase / "project", vase / "lights.json", settings.out / "lights-vase", settings, votes, refined);
  PrintTally("found", votes);
  PrintTally("refined", refined);
  return 0;
}

}  // namespace
}  // namespace glint

int main(int argc, char** argv) { return glint::Main(argc, argv); }
