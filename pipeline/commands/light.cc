// glint light: lights from photographs of a calibration ball.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "colmap/project.h"
#include "colmap/scene.h"
#include "core/error.h"
#include "highlights/ball_image.h"
#include "io/project_images.h"
#include "light/light_io.h"
#include "pipeline/commands/command.h"
#include "pipeline/terminal.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::vector<std::string> images;
  std::string out, project, mask, kind = "auto";
  std::vector<double> circle, principal_point;
  double focal_px = 0;
};

struct Photograph {
  std::string name;
  cv::Mat image;
  Camera camera;
  const View* view = nullptr;  // where the project knows it
};

Camera GuessedCamera(const Arguments& arguments, const cv::Mat& image) {
  Camera camera;
  camera.model = CameraModel::kSimplePinhole;
  camera.width = static_cast<uint64_t>(image.cols);
  camera.height = static_cast<uint64_t>(image.rows);
  // COLMAP's guess where nothing is known.
  const double focal = arguments.focal_px > 0 ? arguments.focal_px : 1.2 * std::max(image.cols, image.rows);
  camera.params = {focal, 0.5 * image.cols, 0.5 * image.rows};
  if (!arguments.principal_point.empty())
    std::copy(arguments.principal_point.begin(), arguments.principal_point.end(), camera.params.begin() + 1);
  return camera;
}

// The first view whose image has the file's name, in whatever folder.
const View* FindView(const Scene& scene, const fs::path& file) {
  for (const View& view : scene.views)
    if (fs::path(view.name).filename() == file.filename()) return &view;
  return nullptr;
}

std::vector<Photograph> ReadAll(const Arguments& arguments, const Scene& scene) {
  std::vector<Photograph> photographs;
  for (const std::string& name : arguments.images) {
    Photograph& p = photographs.emplace_back();
    p.name = name;
    ReadImage(name, p.image);
    if (!arguments.project.empty()) {
      p.view = FindView(scene, name);
      if (!p.view) throw InputError(name, "", "no view of the project has this name");
      if (p.view->camera.width != static_cast<uint64_t>(p.image.cols) ||
          p.view->camera.height != static_cast<uint64_t>(p.image.rows))
        throw InputError(name, "", "has another size than its camera in the project");
    }
    p.camera = p.view ? p.view->camera : GuessedCamera(arguments, p.image);
  }
  return photographs;
}

// A camera that stands still sees the ball at one place, and the mean of its photographs shows it best.
cv::Mat MeanImage(const std::vector<Photograph>& photographs) {
  cv::Mat sum, as_float;
  for (const Photograph& p : photographs) {
    if (p.image.size() != photographs[0].image.size())
      throw InputError(p.name, "", "expected images of one size, from a camera that stands still, or --project");
    p.image.convertTo(as_float, CV_32F);
    sum = sum.empty() ? as_float.clone() : cv::Mat(sum + as_float);
  }
  return sum;
}

BallCircle Circle(const Arguments& arguments, const cv::Mat& image, const std::string& name) {
  if (!arguments.circle.empty()) return {{arguments.circle[0], arguments.circle[1]}, arguments.circle[2]};
  if (!arguments.mask.empty()) {
    cv::Mat mask;
    ReadImage(arguments.mask, mask);
    cv::extractChannel(mask, mask, 0);
    const auto circle = CircleOfMask(mask);
    if (!circle) throw InputError(arguments.mask, "", "the mask is empty");
    return *circle;
  }
  const auto circle = FindBallCircle(image);
  if (!circle) throw NoResultError(fmt::format("{}: no ball found; give its outline with --circle X,Y,RADIUS", name));
  return *circle;
}

FoundLight ToLight(const Photograph& p, const BallLight& ball) {
  FoundLight found;
  found.light.type = LightType::kDistant;
  found.light.frame = p.view ? LightFrame::kWorld : LightFrame::kCamera;
  found.light.vector =
      p.view ? Eigen::Vector3d(p.view->cam_from_world.rotation.conjugate() * ball.direction) : ball.direction;
  found.light.sigma = ball.sigma_deg;
  found.support = 1;
  return found;
}

void FindBallLights(const Arguments& arguments, Terminal& terminal) {
  Scene scene;
  if (!arguments.project.empty()) scene = MakeScene(ReadModel(FindProject(arguments.project).model));
  const std::vector<Photograph> photographs = ReadAll(arguments, scene);
  if (arguments.project.empty() && arguments.focal_px <= 0)
    terminal.Warn("the focal length is not known (--focal-px, or --project): 1.2 times the longer side is taken");
  std::optional<BallCircle> common;
  if (arguments.project.empty()) common = Circle(arguments, MeanImage(photographs), photographs[0].name);
  std::vector<FoundLight> lights;
  for (const Photograph& p : photographs) {
    const BallCircle circle = common ? *common : Circle(arguments, p.image, p.name);
    const auto ball = BallFromCircle(p.camera, circle.center_px, circle.radius_px);
    if (!ball) throw InputError(p.name, "circle", "is not the outline of a ball in front of the camera");
    const BallKind kind = arguments.kind == "chrome" ? BallKind::kChrome
                          : arguments.kind == "gray" ? BallKind::kGray
                                                     : GuessBallKind(p.image, circle);
    const BallLightResult result = LightOfBall(p.image, p.camera, *ball, circle, kind);
    if (!result.light) {
      terminal.Warn(fmt::format("{}: {}", p.name, result.why));
      continue;
    }
    lights.push_back(ToLight(p, *result.light));
    const Eigen::Vector3d& l = lights.back().light.vector;
    terminal.Info(fmt::format(
        "{}: {} ball at ({:.1f}, {:.1f}), radius {:.1f} px; light ({:.4f}, {:.4f}, {:.4f}) in the "
        "{}'s frame, sigma {:.2f} deg{}",
        p.name, kind == BallKind::kChrome ? "chrome" : "gray", circle.center_px.x(), circle.center_px.y(),
        circle.radius_px, l.x(), l.y(), l.z(), p.view ? "world" : "camera", result.light->sigma_deg,
        result.light->angular_size_deg > 0 ? fmt::format(", {:.1f} deg across", result.light->angular_size_deg) : ""));
  }
  if (lights.empty()) throw NoResultError("no photograph shows a light on a ball");
  WriteFoundLights(arguments.out, lights);
}

}  // namespace

void AddLightCommand(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("light", "Lights from photographs of a chrome or gray ball, one an image");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("BALL_IMAGES", arguments->images, "Photographs of the ball")->required();
  command->add_option("-o,--out", arguments->out, "Lights file to write")->required();
  command->add_option("--project", arguments->project,
                      "COLMAP project that the photographs belong to: its cameras and poses are used, and the lights "
                      "are in its world; otherwise one camera that stands still is taken for granted");
  command->add_option("--circle", arguments->circle, "Outline of the ball: X,Y,RADIUS in pixels; else it is looked for")
      ->delimiter(',')
      ->expected(3);
  command->add_option("--mask", arguments->mask, "Image that is white on the ball, in place of --circle");
  command->add_option("--kind", arguments->kind, "Of the ball")
      ->check(CLI::IsMember({"auto", "chrome", "gray"}))
      ->capture_default_str();
  command->add_option("--focal-px", arguments->focal_px, "Focal length in pixels")->check(CLI::PositiveNumber);
  command->add_option("--principal-point", arguments->principal_point, "X,Y in pixels; else the image's middle")
      ->delimiter(',')
      ->expected(2);
  AddCommonOptions(*command, line);
  command->callback(
      [arguments, &line] { line.action = [arguments](Terminal& terminal) { FindBallLights(*arguments, terminal); }; });
}

}  // namespace glint
