// Load: many large photographs, many points and highlights, many runs in one process. Each line says the time and the
// peak of the memory since the line before.
//   load images --images 1000 --size 4000x3000 --folder DIR: photographs streamed through detection and the gate's maps
//   load model --points 5000000 --highlights 20000 --folder DIR: a model read, and its highlights refined
//   load soak --project PROJECT --lights FILE --runs 20 --folder DIR: whole runs, one after the other
//   load project --images 1000 --points 20000 --folder DIR: makes a project for the program (scripts/load)
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <random>
#include <string>
#include <vector>

#include "colmap/model.h"
#include "core/square.h"
#include "highlights/view_brightness.h"
#include "io/mesh_io.h"
#include "io/project_images.h"
#include "light/light_io.h"
#include "pipeline/config.h"
#include "pipeline/image_stages.h"
#include "pipeline/run.h"
#include "pipeline/terminal.h"
#include "refine/refine.h"
#include "tests/support/ellipsoid_scene.h"
#include "tests/support/shapes.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

// A number of /proc/self/status in MiB.
double Memory(const std::string& key) {
  std::ifstream in("/proc/self/status");
  for (std::string word; in >> word;)
    if (word == key && in >> word) return std::stod(word) / 1024;
  return 0;
}

// Time and peak memory from its beginning to its end.
class Meter {
 public:
  Meter() : start_(std::chrono::steady_clock::now()) { std::ofstream("/proc/self/clear_refs") << "5"; }
  double Seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  static double PeakMib() { return Memory("VmHWM:"); }

 private:
  std::chrono::steady_clock::time_point start_;
};

void PrintLine(const std::string& what, size_t count, const Meter& meter, const std::string& more = "") {
  fmt::print("{:<28} {:>9} {:>9.1f} s {:>10.3f} ms each {:>8.0f} MiB peak  {}\n", what, count, meter.Seconds(),
             1000 * meter.Seconds() / static_cast<double>(std::max<size_t>(count, 1)), Meter::PeakMib(), more);
  std::fflush(stdout);
}

// A dim rough surface with `num_blobs` bright ones on it.
cv::Mat Photograph(int width, int height, int num_blobs, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  cv::Mat image(height, width, CV_8UC3);
  cv::RNG noise(seed);
  noise.fill(image, cv::RNG::UNIFORM, 60, 76);
  for (int b = 0; b < num_blobs; ++b) {
    const double cx = width * (0.05 + 0.9 * uniform(random)), cy = height * (0.05 + 0.9 * uniform(random));
    const double sigma = width * (0.001 + 0.002 * uniform(random));
    const int reach = static_cast<int>(4 * sigma) + 1;
    for (int y = std::max(0, static_cast<int>(cy) - reach); y < std::min(height, static_cast<int>(cy) + reach); ++y)
      for (int x = std::max(0, static_cast<int>(cx) - reach); x < std::min(width, static_cast<int>(cx) + reach); ++x) {
        const double glow = 300 * std::exp(-0.5 * (Square(x - cx) + Square(y - cy)) / (sigma * sigma));
        for (int c = 0; c < 3; ++c) {
          uchar& value = image.at<cv::Vec3b>(y, x)[c];
          value = cv::saturate_cast<uchar>(value + glow);
        }
      }
  }
  return image;
}

// A few files under many names, so that the disk does not have to hold them all.
Scene MakePhotographs(const fs::path& folder, size_t count, int width, int height) {
  constexpr size_t kDifferent = 4;
  const auto cameras = testing::DomeViews(static_cast<int>(count));
  Scene scene;
  for (size_t i = 0; i < count; ++i) {
    View& view = scene.views.emplace_back();
    view.name = fmt::format("view_{:05}.jpg", i);
    view.camera = {1,
                   CameraModel::kPinhole,
                   static_cast<uint64_t>(width),
                   static_cast<uint64_t>(height),
                   {1.2 * width, 1.2 * width, 0.5 * width, 0.5 * height}};
    view.cam_from_world = cameras[i];
    const fs::path file = folder / "images" / view.name;
    fs::remove(file);
    if (i < kDifferent)
      WriteImageJpeg(file, Photograph(width, height, 20, static_cast<unsigned>(i)));
    else
      fs::create_hard_link(folder / "images" / scene.views[i % kDifferent].name, file);
  }
  return scene;
}

void LoadImages(const fs::path& folder, size_t count, int width, int height) {
  const Scene all = MakePhotographs(folder, count, width, height);
  ProjectPaths paths;
  paths.root = folder;
  paths.images = folder / "images";
  for (const size_t num_views : {count / 4, count / 2, count}) {
    Scene scene;
    scene.views.assign(all.views.begin(), all.views.begin() + static_cast<std::ptrdiff_t>(num_views));
    const ProjectImages images(scene, paths);
    const Meter detection;
    const auto highlights = DetectInAllViews(scene, images, DetectOptions(), Progress::Silent());
    PrintLine("detect", num_views, detection, fmt::format("{} candidates", highlights.size()));
    const Meter maps;
    const ViewBrightness brightness(images, size_t{512} << 20, Progress::Silent());
    PrintLine("brightness maps (512 MiB)", num_views, maps);
    const Meter drawing;
    WriteOverlays(scene, images, highlights, 1600, folder / "overlays", Progress::Silent());
    PrintLine("draw", num_views, drawing);
  }
}

// Views of an ellipsoid with one exact highlight for each of a few lights.
struct EllipsoidModel {
  Model model;
  std::vector<Highlight> highlights;
  std::vector<Light> lights;
};

EllipsoidModel MakeEllipsoidModel(size_t num_points, size_t num_highlights) {
  EllipsoidModel made;
  const testing::Ellipsoid shape;
  for (int l = 0; l < 20; ++l)
    made.lights.push_back(testing::DistantLight(std::cos(2.4 * l), std::sin(2.4 * l), 0.3 + 0.08 * l));
  const size_t num_views = std::max<size_t>(num_highlights / made.lights.size(), 8);
  const auto found = testing::MakeEllipsoidContacts(shape, made.lights, static_cast<int>(num_views), 0);
  Model& model = made.model;
  model.cameras[1] = {1, CameraModel::kPinhole, 4000, 3000, {4800, 4800, 2000, 1500}};
  const auto cameras = testing::DomeViews(static_cast<int>(num_views));
  for (size_t i = 0; i < num_views; ++i) {
    Image& image = model.images.emplace_back();
    image.id = static_cast<uint32_t>(i + 1);
    image.name = fmt::format("view_{:05}.jpg", i);
    image.camera_id = 1;
    image.cam_from_world = cameras[i];
  }
  for (const Contact& contact : found.contacts) {
    Highlight& h = made.highlights.emplace_back();
    h.view = contact.view;
    h.light = contact.light;
    h.px = *ProjectToPixel(model.cameras[1], contact.cam_from_world * contact.Position());
    h.covariance_px = 0.25 * Eigen::Matrix2d::Identity();
    h.moments_px = 400 * Eigen::Matrix2d::Identity();
  }
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (size_t p = 0; p < num_points; ++p) {
    Point3D& point = model.points.emplace_back();
    point.id = p + 1;
    const Eigen::Vector3d direction(normal(random), normal(random), normal(random));
    point.xyz = shape.PointWithNormal(direction.normalized());
    point.error_px = 0.5;
    for (size_t k = 0; k < 3; ++k) {
      Image& image = model.images[(p * 7 + k * num_views / 3) % num_views];
      point.track.push_back({image.id, static_cast<uint32_t>(image.points2d.size())});
      const auto px = ProjectToPixel(model.cameras[1], image.cam_from_world * point.xyz);
      image.points2d.push_back({px.value_or(Eigen::Vector2d(1, 1)), point.id});
    }
  }
  return made;
}

// A quarter of it, a half and the whole, or the whole alone.
void LoadModel(const fs::path& folder, size_t num_points, size_t num_highlights, bool whole) {
  for (const size_t part : {4, 2, 1}) {
    if (whole && part > 1) continue;
    const EllipsoidModel made = MakeEllipsoidModel(num_points / part, num_highlights / part);
    WriteModel(made.model, folder / "model");
    const Meter reading;
    const Scene scene = MakeScene(ReadModel(folder / "model"));
    PrintLine("read model: points", scene.points.size(), reading, fmt::format("{} views", scene.views.size()));
    const testing::Ellipsoid shape;
    TriangleMesh seed = testing::Icosphere(5);
    for (Eigen::Vector3d& v : seed.vertices) v = 1.02 * shape.PointWithNormal(v);
    const RefineInput input{scene, seed, std::vector<uint8_t>(scene.points.size(), 1), made.highlights, made.lights};
    RefineOptions options;
    options.voxel_rel = 1.0 / 96;
    options.levels = 2;
    options.max_iterations = 2;
    const Meter refining;
    const RefineResult result = Refine(input, options);
    PrintLine("refine: highlights", made.highlights.size(), refining,
              fmt::format("{} contacts, {} points", result.summary.num_contacts, result.summary.num_points));
  }
}

// A project of photographs of 12 megapixels, a few files under many names, with its mesh and lights.
void MakeProject(const fs::path& folder, size_t num_images, size_t num_points) {
  constexpr size_t kLights = 20;  // that MakeEllipsoidModel has
  const EllipsoidModel made = MakeEllipsoidModel(num_points, kLights * num_images);
  WriteModel(made.model, folder / "sparse/0");
  MakePhotographs(folder, made.model.images.size(), 4000, 3000);
  TriangleMesh mesh = testing::Icosphere(4);
  for (Eigen::Vector3d& v : mesh.vertices) v = testing::Ellipsoid().PointWithNormal(v);
  WriteMesh(folder / "mesh.ply", mesh);
  WriteLights(folder / "lights.json", {made.lights.front()});
}

void Soak(const RunArguments& given, int num_runs) {
  Config config;
  config.refine.voxel_rel = 0.02;
  config.refine.levels = 1;
  config.output.overlays = false;
  for (int run = 0; run < num_runs; ++run) {
    const Meter meter;
    Terminal terminal(Verbosity::kQuiet);
    const RunSummary summary = Run(given, config, terminal);
    PrintLine("run", 1, meter, fmt::format("{:.0f} MiB after it, {}", Memory("VmRSS:"), summary.outcome));
  }
}

}  // namespace
}  // namespace glint

int main(int argc, char** argv) {
  CLI::App app("Load: images, model, project, soak");
  app.require_subcommand(1);
  std::string folder, size = "4000x3000";
  size_t num_images = 1000, num_points = 5'000'000, num_highlights = 20'000;
  int num_runs = 20;
  bool whole = false;
  glint::RunArguments run;
  const auto add = [&](const char* name, const char* help) {
    CLI::App* command = app.add_subcommand(name, help);
    command->add_option("--folder", folder, "Folder for what is made")->required();
    return command;
  };
  CLI::App* images = add("images", "Photographs streamed");
  images->add_option("--images", num_images);
  images->add_option("--size", size);
  CLI::App* model = add("model", "Points and highlights");
  model->add_option("--points", num_points);
  model->add_option("--highlights", num_highlights);
  model->add_flag("--whole", whole, "Not a quarter and a half of it before");
  CLI::App* project = add("project", "A project for the program");
  project->add_option("--images", num_images);
  project->add_option("--points", num_points);
  CLI::App* soak = add("soak", "Many runs in one process");
  soak->add_option("--project", run.project)->required();
  soak->add_option("--mesh", run.mesh);
  soak->add_option("--lights", run.lights);
  soak->add_option("--runs", num_runs);
  CLI11_PARSE(app, argc, argv);

  cv::setNumThreads(1);
  if (*images) {
    const size_t x = size.find('x');
    glint::LoadImages(folder, num_images, std::stoi(size.substr(0, x)), std::stoi(size.substr(x + 1)));
  }
  if (*project) glint::MakeProject(folder, num_images, num_points);
  if (*model) glint::LoadModel(folder, num_points, num_highlights, whole);
  if (*soak) {
    run.out = folder;
    glint::Soak(run, num_runs);
  }
  return 0;
}
