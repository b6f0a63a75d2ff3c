#include "geometry/picture_view.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"

namespace glint {

namespace {

uint8_t SrgbFromLinear(double x) {
  x = std::clamp(x, 0.0, 1.0);
  const double y = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
  return static_cast<uint8_t>(std::lround(255 * y));
}

}  // namespace

Eigen::Vector3d PictureView::DirectionInWorld(double x_px, double y_px) const {
  const Eigen::Vector3d in_cam((x_px - 0.5 * width) / focal_px, (y_px - 0.5 * height) / focal_px, 1);
  return cam_from_world.rotation.conjugate() * in_cam.normalized();
}

PictureView ViewOfBox(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& direction, const Eigen::Vector3d& up,
                      int width, int height) {
  GLINT_CHECK(!box.isEmpty());
  const Eigen::Vector3d z = direction.normalized();
  Eigen::Vector3d x = z.cross(up);
  if (!(x.norm() > 1e-6)) x = z.unitOrthogonal();
  x.normalize();
  Eigen::Matrix3d cam_from_world;
  cam_from_world << x.transpose(), z.cross(x).transpose(), z.transpose();
  PictureView view;
  view.width = width;
  view.height = height;
  view.focal_px = 2.0 * std::min(width, height);  // 28° across the shorter side
  // Near enough that the corners still fit.
  double distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d p =
        cam_from_world * (box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)) - box.center());
    const double fit = std::max(std::abs(p[0]) / (0.48 * width), std::abs(p[1]) / (0.48 * height)) * view.focal_px;
    distance = std::max(distance, fit - p[2]);
  }
  if (!(distance > 0)) distance = 1;
  view.cam_from_world.rotation = Eigen::Quaterniond(cam_from_world);
  view.cam_from_world.translation = Eigen::Vector3d(0, 0, distance) - cam_from_world * box.center();
  return view;
}

Eigen::Vector3d LinearFromSrgb(const std::array<uint8_t, 3>& color) {
  Eigen::Vector3d linear;
  for (int k = 0; k < 3; ++k) {
    const double y = color[k] / 255.0;
    linear[k] = y <= 0.04045 ? y / 12.92 : std::pow((y + 0.055) / 1.055, 2.4);
  }
  return linear;
}

Eigen::Vector3d Shade(const PictureView& view, const Look& look, const Eigen::Vector3d& direction, const Seen& seen) {
  const bool back = seen.normal.dot(direction) > 0;
  const Eigen::Vector3d n = back ? Eigen::Vector3d(-seen.normal) : seen.normal;
  const Eigen::Vector3d albedo = LinearFromSrgb(back ? look.back_color : seen.color);
  const Eigen::Quaterniond world_from_cam = view.cam_from_world.rotation.conjugate();
  const Eigen::Vector3d key = world_from_cam * Eigen::Vector3d(-0.5, -0.7, -0.6).normalized();
  const Eigen::Vector3d fill = world_from_cam * Eigen::Vector3d(0.8, 0.1, -0.5).normalized();
  const Eigen::Vector3d sky = world_from_cam * Eigen::Vector3d(0, -1, 0);
  const double diffuse =
      seen.open * (0.2 + 0.1 * n.dot(sky)) + 0.85 * std::max(0.0, n.dot(key)) + 0.18 * std::max(0.0, n.dot(fill));
  const Eigen::Vector3d half = (key - direction).normalized();
  const double gloss = 0.15 * std::pow(std::max(0.0, n.dot(half)), 40);
  return diffuse * albedo + Eigen::Vector3d::Constant(gloss);
}

std::vector<uint8_t> RenderPixels(const PictureView& view, const Look& look,
                                  const std::function<Eigen::Vector3d(double x_px, double y_px)>& trace) {
  GLINT_CHECK(view.width > 0 && view.height > 0 && look.samples_a_side > 0);
  std::vector<uint8_t> pixels(3 * static_cast<size_t>(view.width) * static_cast<size_t>(view.height));
  const int n = look.samples_a_side;
  ParallelFor(static_cast<size_t>(view.height), 4, [&](size_t row) {
    for (int column = 0; column < view.width; ++column) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (int i = 0; i < n * n; ++i) {
        const int across = i % n, down = i / n;
        sum += trace(column + (across + 0.5) / n, static_cast<double>(row) + (down + 0.5) / n).cwiseMin(1.0);
      }
      for (int k = 0; k < 3; ++k)
        pixels[3 * (row * static_cast<size_t>(view.width) + static_cast<size_t>(column)) + static_cast<size_t>(k)] =
            SrgbFromLinear(sum[k] / (n * n));
    }
  });
  return pixels;
}

}  // namespace glint
