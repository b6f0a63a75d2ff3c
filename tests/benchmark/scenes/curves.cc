// How the error of the main job goes with the size of the voxels, with the number of photographs, and with how far off
// the seed is (its basin of attraction): a table and a plot (PNG) each.
//   curves [--out DIR] [--scenes a,b] [--lights N] [--voxels 32,64,128,256] [--views 6,12,24,48,96]
//          [--seeds 0,0.1,0.2,0.4,0.6,0.8,1] [--set KEY=VALUE] ...
// --voxels: a diagonal is so many voxels on the finest level. --seeds: the seed is given, the true surface drawn
// towards a sphere about its middle by that share; 1 is a sphere that knows nothing of the object.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/mesh_io.h"
#include "io/project_images.h"
#include "tests/benchmark/scenes/case.h"

namespace glint::benchmark {
namespace {

namespace fs = std::filesystem;

struct Curve {
  std::string name;
  std::vector<double> x, normal_deg, distance;  // where highlights pass; the distance in % of the diagonal
};

constexpr int kWidth = 640, kHeight = 480, kMargin = 64;

// Logarithmic; x as it is where it has a zero.
class Plot {
 public:
  Plot(const std::vector<Curve>& curves, std::string x_label, std::string y_label, std::vector<double> Curve::*y)
      : curves_(curves), x_label_(std::move(x_label)), y_label_(std::move(y_label)), y_(y) {
    for (const Curve& c : curves)
      for (size_t i = 0; i < c.x.size(); ++i) {
        Grow(c.x[i], x_low_, x_high_);
        if ((c.*y)[i] > 0) Grow((c.*y)[i], y_low_, y_high_);
      }
    y_low_ /= 1.3;
    y_high_ *= 1.3;
  }

  cv::Mat Draw() const {
    cv::Mat image(kHeight, kWidth, CV_8UC3, cv::Scalar::all(255));
    const cv::Scalar black = cv::Scalar::all(40);
    cv::rectangle(image, {kMargin, kMargin / 2}, {kWidth - kMargin / 2, kHeight - kMargin}, black);
    const auto text = [&](const std::string& s, cv::Point at, const cv::Scalar& color) {
      cv::putText(image, s, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, color, 1, cv::LINE_AA);
    };
    for (const double y : {y_low_, std::sqrt(y_low_ * y_high_), y_high_})
      text(fmt::format("{:.3g}", y), {6, At(x_low_, y).y + 4}, black);
    for (const Curve& c : curves_)
      for (const double x : c.x) text(fmt::format("{:g}", x), {At(x, y_low_).x - 8, kHeight - kMargin + 18}, black);
    text(x_label_, {kWidth / 2 - 60, kHeight - 16}, black);
    text(y_label_, {kMargin, 20}, black);
    static const std::vector<cv::Scalar> kColors = {{180, 90, 20}, {30, 120, 230}, {60, 150, 60}, {160, 60, 160}};
    for (size_t k = 0; k < curves_.size(); ++k) {
      const Curve& c = curves_[k];
      const cv::Scalar& color = kColors[k % kColors.size()];
      for (size_t i = 0; i < c.x.size(); ++i) {
        cv::circle(image, At(c.x[i], (c.*y_)[i]), 4, color, cv::FILLED, cv::LINE_AA);
        if (i > 0) cv::line(image, At(c.x[i - 1], (c.*y_)[i - 1]), At(c.x[i], (c.*y_)[i]), color, 2, cv::LINE_AA);
      }
      text(c.name, {kWidth - 160, kMargin / 2 + 20 + 18 * static_cast<int>(k)}, color);
    }
    return image;
  }

 private:
  static void Grow(double value, double& low, double& high) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  cv::Point At(double x, double y) const {
    const auto share = [](double v, double low, double high) {
      if (high <= low) return 0.5;
      return low > 0 ? std::log(v / low) / std::log(high / low) : (v - low) / (high - low);
    };
    const double u = share(x, x_low_, x_high_), v = share(std::max(y, y_low_), y_low_, y_high_);
    return {static_cast<int>(kMargin + 10 + u * (kWidth - 1.5 * kMargin - 20)),
            static_cast<int>(kHeight - kMargin - v * (kHeight - 1.5 * kMargin))};
  }

  const std::vector<Curve>& curves_;
  const std::string x_label_, y_label_;
  std::vector<double> Curve::*const y_;
  double x_low_ = 1e300, x_high_ = -1e300, y_low_ = 1e300, y_high_ = 1e-300;
};

struct Setting {
  std::vector<std::string> scenes = {"hood", "blob"};
  std::vector<double> voxels, views, seeds;
  SyntheticOptions options;
  Plan plan;
};

// The true surface, drawn towards a sphere of the same mean radius.
TriangleMesh DrawnToSphere(const Case& c, double share) {
  TriangleMesh mesh{c.truth.vertices, c.truth.faces, {}, {}, {}, {}};
  const Eigen::Vector3d center = BoundingBox(mesh).center();
  double radius = 0;
  for (const Eigen::Vector3d& v : mesh.vertices) radius += (v - center).norm();
  radius /= static_cast<double>(mesh.vertices.size());
  for (Eigen::Vector3d& v : mesh.vertices) v = (1 - share) * v + share * (center + radius * (v - center).normalized());
  return mesh;
}

template <class Run>
void Measure(const Setting& setting, const std::string& what, const std::string& label, const std::vector<double>& at,
             const Run& run) {
  if (at.empty()) return;
  std::vector<Curve> curves;
  fmt::print("\n{:<10} {:>12} {:>14} {:>16}\n", "scene", what, "normals (deg)", "distance (% d.)");
  for (const std::string& scene : setting.scenes) {
    Curve curve;
    curve.name = scene;
    for (const double x : at) {
      SyntheticOptions options = setting.options;
      options.scene = scene;
      try {
        const Measured m = run(options, x);
        curve.x.push_back(x);
        curve.normal_deg.push_back(m.normal_in.mean);
        curve.distance.push_back(100 * m.distance_in.mean);
        fmt::print("{:<10} {:>12g} {:>14.3f} {:>16.4f}\n", scene, x, m.normal_in.mean, 100 * m.distance_in.mean);
      } catch (const Error& error) {
        fmt::print("{:<10} {:>12g} {}\n", scene, x, error.what());
      }
      std::fflush(stdout);
    }
    curves.push_back(curve);
  }
  const fs::path normals = setting.plan.out / (what + "-normals.png"),
                 distances = setting.plan.out / (what + "-distances.png");
  WriteImagePng(normals, Plot(curves, label, "mean normal error, deg", &Curve::normal_deg).Draw());
  WriteImagePng(distances, Plot(curves, label, "mean distance, % of the diagonal", &Curve::distance).Draw());
  fmt::print("{}, {}\n", normals.string(), distances.string());
}

// The coarsest level stays at about 1/64, where there is one.
std::vector<std::string> VoxelSettings(double voxels) {
  const int levels = std::max(1, static_cast<int>(std::lround(std::log2(voxels / 64))) + 1);
  return {fmt::format("refine.voxel_rel={:.10f}", 1 / voxels), fmt::format("refine.levels={}", levels)};
}

void MeasureAll(const Setting& setting) {
  const Plan& plan = setting.plan;
  Measure(setting, "voxels", "voxels a diagonal", setting.voxels, [&](const SyntheticOptions& options, double voxels) {
    const Case c = SyntheticCase(options, plan);
    const fs::path out = c.out / "voxels";
    RunCase(c, plan, VoxelSettings(voxels), out);
    return MeasureFile(c, out / "mesh.ply");
  });
  Measure(setting, "views", "photographs", setting.views, [&](SyntheticOptions options, double views) {
    options.views = static_cast<int>(views);
    const Case c = SyntheticCase(options, plan);
    RunCase(c, plan, {}, c.out / "views");
    return MeasureFile(c, c.out / "views" / "mesh.ply");
  });
  Measure(setting, "seeds", "share of a sphere in the seed", setting.seeds,
          [&](const SyntheticOptions& options, double share) {
            Case c = SyntheticCase(options, plan);
            c.mesh = c.project / "drawn_to_sphere.ply";
            WriteMesh(c.mesh, DrawnToSphere(c, share));
            RunCase(c, plan, {}, c.out / "seeds");
            return MeasureFile(c, c.out / "seeds" / "mesh.ply");
          });
}

int Main(int argc, char** argv) {
  CLI::App app("How the error goes with voxels, photographs and the seed");
  Setting setting;
  setting.plan.out = "build/curves";
  app.add_option("--out", setting.plan.out, "folder for the scenes, results and plots");
  app.add_option("--scenes", setting.scenes, "scenes to measure")->delimiter(',');
  app.add_option("--lights", setting.options.lights, "number of lights");
  app.add_option("--voxels", setting.voxels, "voxels a diagonal")->delimiter(',');
  app.add_option("--views", setting.views, "numbers of photographs")->delimiter(',');
  app.add_option("--seeds", setting.seeds, "shares of a sphere in the seed")->delimiter(',');
  app.add_option("--set", setting.plan.settings, "change one option: section.option=value")->allow_extra_args(false);
  CLI11_PARSE(app, argc, argv);
  if (setting.voxels.empty() && setting.views.empty() && setting.seeds.empty()) {
    setting.voxels = {32, 64, 128, 256};
    setting.views = {6, 12, 24, 48, 96};
    setting.seeds = {0, 0.1, 0.2, 0.4, 0.6, 0.8, 1};
  }
  MeasureAll(setting);
  return 0;
}

}  // namespace
}  // namespace glint::benchmark

int main(int argc, char** argv) { return glint::benchmark::Main(argc, argv); }
