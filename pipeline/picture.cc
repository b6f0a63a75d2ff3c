#include "pipeline/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/check.h"
#include "core/parallel.h"
#include "geometry/ray_caster.h"

namespace glint {
namespace {

constexpr int kSamples = 2;       // a side: rays a pixel are its square
constexpr int kPanelWidth = 400;  // px
constexpr int kTitleHeight = 26;  // px
constexpr int kScaleHeight = 40;  // px, the colours and their numbers
constexpr double kStripesPerTurn = 28;
const cv::Scalar kInk(60, 60, 60);

template <class T>
Eigen::Vector3d Interpolated(const TriangleMesh& mesh, const RayHit& hit, const std::vector<T>& values) {
  const auto at = [&](int corner) {
    const T& value = values[static_cast<size_t>(mesh.faces[static_cast<size_t>(hit.face)][corner])];
    return Eigen::Vector3d(value[0], value[1], value[2]);
  };
  return (1 - hit.u - hit.v) * at(0) + hit.u * at(1) + hit.v * at(2);
}

// Soft black and white stripes over the elevation of the mirrored ray.
double Stripe(const Eigen::Vector3d& normal, const Eigen::Vector3d& ray, const Eigen::Vector3d& up) {
  const Eigen::Vector3d mirrored = ray - 2 * ray.dot(normal) * normal;
  const double angle = std::acos(std::clamp(mirrored.dot(up), -1.0, 1.0));
  return std::clamp(0.5 + 1.6 * std::sin(kStripesPerTurn * angle), 0.0, 1.0);
}

// BGR in [0, 255] of what a ray meets.
Eigen::Vector3d Shade(const TriangleMesh& mesh, const RayHit& hit, const Eigen::Vector3d& ray,
                      const Eigen::Vector3d& up, const std::vector<std::array<uint8_t, 3>>& colors) {
  Eigen::Vector3d normal = Interpolated(mesh, hit, mesh.normals).normalized();
  if (normal.dot(ray) > 0) normal = -normal;
  const double clay = 0.35 + 0.65 * std::abs(normal.dot(ray));
  if (!colors.empty()) {
    const Eigen::Vector3d rgb = Interpolated(mesh, hit, colors);
    return clay * Eigen::Vector3d(rgb[2], rgb[1], rgb[0]);
  }
  return clay * (Eigen::Vector3d(150, 130, 110) + 90 * Stripe(normal, ray, up) * Eigen::Vector3d::Ones());
}

cv::Mat Fitted(const cv::Mat& image, int width, int height) {
  cv::Mat resized;
  cv::resize(image, resized, cv::Size(width, height), 0, 0, cv::INTER_AREA);
  return resized;
}

void PutTitle(cv::Mat& sheet, int x, int y, const std::string& text) {
  cv::putText(sheet, text, cv::Point(x + 6, y + kTitleHeight - 8), cv::FONT_HERSHEY_SIMPLEX, 0.5, kInk, 1, cv::LINE_AA);
}

void PutScale(cv::Mat& sheet, const cv::Rect& where, double largest_deg) {
  for (int x = 0; x < where.width; ++x) {
    const auto [r, g, b] = ErrorColor(largest_deg * x / where.width, largest_deg);
    cv::line(sheet, cv::Point(where.x + x, where.y), cv::Point(where.x + x, where.y + where.height),
             cv::Scalar(b, g, r));
  }
  PutTitle(sheet, where.x - 6, where.y + where.height, "0");
  PutTitle(sheet, where.x + where.width - 60, where.y + where.height, fmt::format("{:g} deg", largest_deg));
}

}  // namespace

cv::Mat RenderMesh(const TriangleMesh& mesh, const View& view, int width,
                   const std::vector<std::array<uint8_t, 3>>& colors) {
  GLINT_CHECK_EQ(mesh.normals.size(), mesh.vertices.size());
  const double scale = static_cast<double>(width) / static_cast<double>(view.camera.width);
  const int height = static_cast<int>(std::lround(scale * static_cast<double>(view.camera.height)));
  const RayCaster caster(mesh);
  const Eigen::Vector3d origin = view.Center();
  const Eigen::Vector3d up = view.cam_from_world.rotation.conjugate() * -Eigen::Vector3d::UnitY();
  cv::Mat image(height, width, CV_8UC3);
  ParallelFor(static_cast<size_t>(height), 4, [&](size_t y) {
    for (int x = 0; x < width; ++x) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (int s = 0; s < kSamples * kSamples; ++s) {
        const int column = s % kSamples, row = s / kSamples;
        const Eigen::Vector2d px((x + (column + 0.5) / kSamples) / scale,
                                 (static_cast<double>(y) + (row + 0.5) / kSamples) / scale);
        const auto ray = view.RayThrough(px);
        const auto hit = ray ? caster.Intersect(origin, *ray) : std::nullopt;
        sum += hit ? Shade(mesh, *hit, *ray, up, colors) : Eigen::Vector3d(255, 255, 255);
      }
      sum /= kSamples * kSamples;
      image.at<cv::Vec3b>(static_cast<int>(y), x) = cv::Vec3b(
          cv::saturate_cast<uint8_t>(sum[0]), cv::saturate_cast<uint8_t>(sum[1]), cv::saturate_cast<uint8_t>(sum[2]));
    }
  });
  return image;
}

std::array<uint8_t, 3> ErrorColor(double error, double largest) {
  if (error < 0) return {170, 170, 170};
  static constexpr double kStops[5][3] = {
      {49, 84, 166}, {70, 170, 200}, {150, 205, 120}, {245, 215, 90}, {200, 50, 40}};
  const double position = 4 * std::clamp(error / largest, 0.0, 1.0);
  const int below = std::min(static_cast<int>(position), 3);
  std::array<uint8_t, 3> color{};
  for (int c = 0; c < 3; ++c)
    color[static_cast<size_t>(c)] = static_cast<uint8_t>(
        std::lround(kStops[below][c] + (position - below) * (kStops[below + 1][c] - kStops[below][c])));
  return color;
}

cv::Mat ComparisonSheet(const cv::Mat& photograph, const std::string& photograph_title,
                        const std::vector<PictureColumn>& columns, const TriangleMesh& reference, const View& view,
                        double largest_error_deg) {
  const int height = static_cast<int>(kPanelWidth * view.camera.height / view.camera.width);
  const int cell = height + kTitleHeight;
  cv::Mat sheet(2 * cell + kScaleHeight, kPanelWidth * (1 + static_cast<int>(columns.size())), CV_8UC3,
                cv::Scalar::all(255));
  const auto place = [&](int column, int row, const cv::Mat& panel, const std::string& title) {
    PutTitle(sheet, column * kPanelWidth, row * cell, title);
    panel.copyTo(sheet(cv::Rect(column * kPanelWidth, row * cell + kTitleHeight, kPanelWidth, height)));
  };
  place(0, 0, Fitted(photograph, kPanelWidth, height), photograph_title);
  for (size_t c = 0; c < columns.size(); ++c) {
    const int column = static_cast<int>(c) + 1;
    place(column, 0, RenderMesh(*columns[c].mesh, view, kPanelWidth), columns[c].title + ": reflection lines");
    std::vector<std::array<uint8_t, 3>> colors;
    for (float error : columns[c].normal_error_deg) colors.push_back(ErrorColor(error, largest_error_deg));
    place(column, 1, RenderMesh(reference, view, kPanelWidth, colors), columns[c].title + ": error of the normals");
  }
  place(0, 1, RenderMesh(reference, view, kPanelWidth), "truth: reflection lines");
  PutScale(sheet, cv::Rect(kPanelWidth * 3 / 2, 2 * cell + 4, kPanelWidth, kScaleHeight - kTitleHeight - 4),
           largest_error_deg);
  return sheet;
}

size_t MostTellingView(const Scene& scene, const TriangleMesh& reference, const std::vector<uint8_t>& mask) {
  size_t best = 0, best_count = 0;
  for (size_t v = 0; v < scene.views.size(); ++v) {
    const View& view = scene.views[v];
    const Eigen::Vector3d center = view.Center();
    size_t count = 0;
    for (size_t i = 0; i < reference.vertices.size(); ++i) {
      if (!mask.empty() && !mask[i]) continue;
      const Eigen::Vector3d to_camera = (center - reference.vertices[i]).normalized();
      if (reference.normals[i].dot(to_camera) < 0.3) continue;
      const auto px = view.Project(reference.vertices[i]);
      count += px && view.Contains(*px);
    }
    if (count > best_count) {
      best = v;
      best_count = count;
    }
  }
  return best;
}

}  // namespace glint
