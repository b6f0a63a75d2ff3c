#include "photometry/normal_maps.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <optional>

#include "core/median.h"
#include "core/parallel.h"

namespace glint {
namespace {

constexpr double kMaxViewsApart = 4;
constexpr double kLeastScatter = 0.2 * M_PI / 180;
constexpr double kAgreeing = 3;  // scatters
// Of the components of an isotropic error, the length of whose two-dimensional vector has this median.
constexpr double kMedianLength = 1.1774;

double Angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

// The mean of the map's normals about a place; nothing where most of the pixels have none.
std::optional<Eigen::Vector3d> MeanNormal(const cv::Mat& map, const Eigen::Vector2d& at, double radius) {
  const double r = std::max(radius, 0.5);
  const int x0 = std::max(0, static_cast<int>(std::ceil(at.x() - 0.5 - r)));
  const int x1 = std::min(map.cols - 1, static_cast<int>(std::floor(at.x() - 0.5 + r)));
  const int y0 = std::max(0, static_cast<int>(std::ceil(at.y() - 0.5 - r)));
  const int y1 = std::min(map.rows - 1, static_cast<int>(std::floor(at.y() - 0.5 + r)));
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const auto& n = map.at<cv::Vec3f>(y, x);
      sum += Eigen::Vector3d(n[0], n[1], n[2]);
    }
  const int count = std::max(0, x1 - x0 + 1) * std::max(0, y1 - y0 + 1);
  if (count == 0 || sum.norm() < 0.5 * count) return std::nullopt;
  return sum.normalized();
}

using Normals = std::vector<Eigen::Vector3d>;

// In the world, of all views, each of which is read once. In the order of the views.
std::vector<Normals> NormalsOfPatches(const NormalSource& maps, const Scene& scene,
                                      const std::vector<SurfacePatch>& patches) {
  struct Seen {
    size_t patch;
    const PatchView* in;
  };
  std::vector<std::vector<Seen>> of_view(scene.views.size());
  for (size_t i = 0; i < patches.size(); ++i)
    for (const PatchView& in : patches[i].views) of_view[in.view].push_back({i, &in});
  std::vector<Normals> found(scene.views.size());
  ParallelFor(scene.views.size(), 1, [&](size_t v) {
    cv::Mat map;
    found[v].assign(of_view[v].size(), Eigen::Vector3d::Zero());
    if (!of_view[v].empty() && maps.LoadNormals(v, map)) {
      const View& view = scene.views[v];
      const double scale = map.cols / static_cast<double>(view.camera.width);
      for (size_t k = 0; k < of_view[v].size(); ++k) {
        const PatchView& in = *of_view[v][k].in;
        if (const auto n = MeanNormal(map, scale * in.px.cast<double>(), scale * in.radius_px))
          found[v][k] = view.cam_from_world.Inverse().rotation * *n;
      }
    }
  });
  std::vector<Normals> by_patch(patches.size());
  for (size_t v = 0; v < of_view.size(); ++v)
    for (size_t k = 0; k < of_view[v].size(); ++k)
      if (!found[v][k].isZero()) by_patch[of_view[v][k].patch].push_back(found[v][k]);
  return by_patch;
}

const Eigen::Vector3d& MiddleOne(const Normals& normals) {
  const auto sum = [&](const Eigen::Vector3d& n) {
    double angles = 0;
    for (const Eigen::Vector3d& other : normals) angles += Angle(n, other);
    return angles;
  };
  size_t best = 0;
  for (size_t i = 1; i < normals.size(); ++i)
    if (sum(normals[i]) < sum(normals[best])) best = i;
  return normals[best];
}

// The scatter's standard deviation a component, from patches that several views see.
double Scatter(const std::vector<Normals>& by_patch) {
  std::vector<double> off;
  for (const Normals& normals : by_patch) {
    if (normals.size() < 3) continue;
    const Eigen::Vector3d& middle = MiddleOne(normals);
    for (const Eigen::Vector3d& n : normals)
      if (&n != &middle) off.push_back(Angle(n, middle));
  }
  return std::max(Median(off) / kMedianLength, kLeastScatter);
}

}  // namespace

GivenNormals TiltsFromNormalMaps(const NormalSource& maps, const Scene& scene,
                                 const std::vector<SurfacePatch>& patches) {
  const std::vector<Normals> by_patch = NormalsOfPatches(maps, scene, patches);
  const double scatter = Scatter(by_patch);
  GivenNormals given;
  given.scatter_deg = scatter * 180 / M_PI;
  for (size_t i = 0; i < patches.size(); ++i) {
    if (by_patch[i].empty()) continue;
    const Eigen::Vector3d& middle = MiddleOne(by_patch[i]);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
    for (const Eigen::Vector3d& n : by_patch[i])
      if (Angle(n, middle) < kAgreeing * scatter) sum += n, ++count;
    // A map that turns its back to the surface is of something else.
    if (sum.dot(patches[i].normal) <= 0) continue;
    const Eigen::Vector3d normal = sum.normalized(), side = normal.unitOrthogonal();
    Tilt tilt;
    tilt.position = patches[i].position;
    tilt.sigma = scatter / std::sqrt(std::min<double>(count, kMaxViewsApart));
    tilt.radius_world = patches[i].radius_world;
    for (const Eigen::Vector3d& direction : {side, Eigen::Vector3d(normal.cross(side))}) {
      tilt.direction = direction;
      given.tilts.push_back(tilt);
    }
    ++given.num_patches;
  }
  return given;
}

}  // namespace glint
