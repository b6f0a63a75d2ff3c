// Calibration balls measured on photographs: the chrome and gray spheres with reference directions, and the two mirror
// balls that one camera saw under twelve lights.
//   balls FOLDER
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "core/error.h"
#include "highlights/ball_image.h"
#include "io/project_images.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using Directions = std::vector<Eigen::Vector3d>;

// Uncompressed 24-bit Targa, rows from the bottom.
cv::Mat ReadTarga(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<unsigned char> head(18);
  file.read(reinterpret_cast<char*>(head.data()), 18);
  if (!file || head[2] != 2 || head[16] != 24)
    throw InputError(path.string(), "", "expected an uncompressed 24-bit TGA");
  file.ignore(head[0]);
  cv::Mat image(head[14] + 256 * head[15], head[12] + 256 * head[13], CV_8UC3);
  file.read(reinterpret_cast<char*>(image.data), static_cast<std::streamsize>(image.total() * 3));
  if (!(head[17] & 0x20)) cv::flip(image, image, 0);
  return image;
}

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI;
}

double Quantile(std::vector<double> v, double q) {
  std::sort(v.begin(), v.end());
  return v.empty() ? 0 : v[std::min(v.size() - 1, static_cast<size_t>(q * v.size()))];
}

struct Shot {
  Directions directions;
  Directions places;  // on the ball's surface, in radii
  BallCircle circle;
};

Shot Measure(const std::vector<cv::Mat>& images, double focal_px, const Eigen::Vector2d& principal_point,
             const std::function<std::optional<BallCircle>(const cv::Mat&)>& find_circle, BallKind kind) {
  cv::Mat sum, as_float;
  for (const cv::Mat& image : images) {
    image.convertTo(as_float, CV_32F);
    sum = sum.empty() ? as_float.clone() : cv::Mat(sum + as_float);
  }
  const auto circle = find_circle(sum);
  if (!circle) throw NoResultError("no ball found");
  Camera camera;
  camera.width = static_cast<uint64_t>(images[0].cols);
  camera.height = static_cast<uint64_t>(images[0].rows);
  camera.params = {focal_px, principal_point.x(), principal_point.y()};
  const auto ball = BallFromCircle(camera, circle->center_px, circle->radius_px);
  Shot shot{{}, {}, *circle};
  for (const cv::Mat& image : images) {
    const BallLightResult result = LightOfBall(image, camera, *ball, *circle, kind);
    shot.directions.push_back(result.light ? result.light->direction : Eigen::Vector3d::Zero());
    const auto normal = result.light ? BallNormal(camera, *ball, result.light->px) : std::nullopt;
    shot.places.push_back(normal ? Eigen::Vector3d(ball->center + *normal) : ball->center);
  }
  return shot;
}

// The angle by which two rays miss the lamp that is nearest to both; they are as far apart as the balls are, which are
// of one size.
double MissDeg(const Shot& a, const Shot& b, size_t i) {
  const Eigen::Vector3d &p = a.places[i], &q = b.places[i], &u = a.directions[i], &v = b.directions[i];
  Eigen::Matrix<double, 3, 2> rays;
  rays << u, -v;
  const Eigen::Vector2d t = rays.colPivHouseholderQr().solve(q - p);
  if (t.minCoeff() <= 0) return AngleDeg(u, v) / 2;
  const Eigen::Vector3d lamp = 0.5 * (p + t[0] * u + q + t[1] * v);
  return std::max(AngleDeg(u, lamp - p), AngleDeg(v, lamp - q));
}

bool IsThere(const fs::path& folder) {
  if (fs::exists(folder)) return true;
  fmt::print("{} is not there: not measured\n", folder.string());
  return false;
}

void MeasureUw(const fs::path& folder) {
  if (!IsThere(folder)) return;
  Directions truth;
  std::ifstream file(folder / "lights.txt");
  int count = 0;
  if (!(file >> count) || count < 1) throw InputError((folder / "lights.txt").string(), "", "expected their number");
  for (int i = 0; i < count; ++i) {
    double x, y, z;
    file >> x >> y >> z;
    truth.push_back(Eigen::Vector3d(x, -y, -z).normalized());
  }
  for (const std::string name : {"chrome", "gray"}) {
    std::vector<cv::Mat> images;
    for (int i = 0; i < count; ++i) images.push_back(ReadTarga(folder / name / fmt::format("{}.{}.tga", name, i)));
    const fs::path mask_path = folder / name / (name + ".mask.tga");
    for (const bool with_mask : {true, false}) {
      if (with_mask && !fs::exists(mask_path)) continue;
      // The focal length is not known: the usual guess, and an orthographic camera for comparison.
      for (const double focal : {1.2 * images[0].cols, 100.0 * images[0].cols}) {
        const auto find = [&](const cv::Mat& mean) {
          if (!with_mask) return FindBallCircle(mean);
          cv::Mat channel;
          cv::extractChannel(ReadTarga(mask_path), channel, 0);
          return CircleOfMask(channel);
        };
        try {
          const Shot shot = Measure(images, focal, {0.5 * images[0].cols, 0.5 * images[0].rows}, find,
                                    name == "chrome" ? BallKind::kChrome : BallKind::kGray);
          std::vector<double> errors;
          for (int i = 0; i < count; ++i) errors.push_back(AngleDeg(shot.directions[i], truth[i]));
          fmt::print(
              "uw {:<6} circle {:<5} focal {:>5.1f} widths: ({:.1f}, {:.1f}) r {:.1f}; error median {:.2f} deg, "
              "largest {:.2f} deg\n",
              name, with_mask ? "mask" : "found", focal / images[0].cols, shot.circle.center_px.x(),
              shot.circle.center_px.y(), shot.circle.radius_px, Quantile(errors, 0.5), Quantile(errors, 1));
        } catch (const Error& e) {
          fmt::print("uw {:<6} circle {:<5}: {}\n", name, with_mask ? "mask" : "found", e.what());
        }
      }
    }
  }
}

// The two crops of one photograph: where each begins in it comes from probes_bbox.txt. Rows there and in the circles
// count from the bottom, from 1.
void MeasurePsbox(const fs::path& folder) {
  if (!IsThere(folder)) return;
  constexpr double kFullWidth = 3888, kFullHeight = 2592;
  std::vector<Eigen::Vector2d> corners;
  std::ifstream boxes(folder / "ManualData" / "probes_bbox.txt");
  double x0, x1, y0, y1;
  while (boxes >> x0 >> x1 >> y0 >> y1) corners.emplace_back(x0 - 1, y0 - 1);
  for (const double widths : {1.2, 2.0, 3.0, 5.0, 100.0})
    for (const bool given : {true, false}) {
      Shot shots[2];
      for (int b = 0; b < 2; ++b) {
        const fs::path probe = folder / fmt::format("LightProbe-{}", b + 1);
        std::vector<cv::Mat> images;
        for (int i = 1; i <= 12; ++i) {
          cv::Mat image;
          ReadImage(probe / fmt::format("Image_{:02}.JPG", i), image);
          images.push_back(image);
        }
        const auto find = [&](const cv::Mat& mean) {
          if (!given) return FindBallCircle(mean);
          BallCircle circle;
          std::ifstream file(probe / "circle_data.txt");
          file >> circle.center_px.x() >> circle.center_px.y() >> circle.radius_px;
          circle.center_px = {circle.center_px.x() - 0.5, mean.rows + 0.5 - circle.center_px.y()};
          return std::optional<BallCircle>(circle);
        };
        const Eigen::Vector2d middle = Eigen::Vector2d(kFullWidth / 2, kFullHeight / 2) - corners[b];
        shots[b] = Measure(images, widths * kFullWidth, middle, find, BallKind::kChrome);
      }
      std::vector<double> between, miss;
      for (size_t i = 0; i < 12; ++i) miss.push_back(MissDeg(shots[0], shots[1], i));
      for (size_t i = 0; i < 12; ++i) between.push_back(AngleDeg(shots[0].directions[i], shots[1].directions[i]));
      fmt::print(
          "psbox focal {:>5.1f} widths, circle {:<5}: ({:.1f}, {:.1f}) r {:.1f} and ({:.1f}, {:.1f}) r {:.1f}; "
          "between the balls median {:.2f} deg, largest {:.2f} deg; near lamps missed by {:.2f}, {:.2f} deg\n",
          widths, given ? "given" : "found", shots[0].circle.center_px.x(), shots[0].circle.center_px.y(),
          shots[0].circle.radius_px, shots[1].circle.center_px.x(), shots[1].circle.center_px.y(),
          shots[1].circle.radius_px, Quantile(between, 0.5), Quantile(between, 1), Quantile(miss, 0.5),
          Quantile(miss, 1));
    }
}

}  // namespace
}  // namespace glint

int main(int argc, char** argv) {
  CLI::App app("Photographs of balls with reference directions: how far the lights are off");
  glint::fs::path folder;
  app.add_option("folder", folder, "with uw/, psbox/data/ or both")->required()->check(CLI::ExistingDirectory);
  CLI11_PARSE(app, argc, argv);
  try {
    glint::MeasureUw(folder / "uw");
    glint::MeasurePsbox(folder / "psbox" / "data");
  } catch (const glint::Error& error) {
    return fmt::print(stderr, "{}\n", error.what()), 2;
  }
  return 0;
}
