#include "highlights/check_lights.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"
#include "geometry/winding_number.h"

namespace glint {
namespace {

constexpr double kTrustDeg = 5;
constexpr double kSameLampDeg = 40;

struct Nearest {
  const FoundLight* light = nullptr;
  double angle_deg = std::numeric_limits<double>::infinity();
};

double SigmaDeg(const FoundLight& found, const std::vector<View>& views, const Eigen::Vector3d& center) {
  if (found.light.type == LightType::kDistant) return found.light.sigma;
  double distance = 0;
  for (const View& view : views)
    distance += (found.light.vector - (found.light.frame == LightFrame::kWorld ? center : view.cam_from_world * center))
                    .norm() /
                static_cast<double>(views.size());
  return found.light.sigma / std::max(distance, 1e-300) * 180 / M_PI;
}

}  // namespace

double MeanAngleDeg(const Light& a, const Light& b, const std::vector<View>& views, const Eigen::Vector3d& center) {
  double sum = 0;
  for (const View& view : views) {
    const Eigen::Vector3d l = DirectionToLight(a, view.cam_from_world, center);
    const Eigen::Vector3d m = DirectionToLight(b, view.cam_from_world, center);
    sum += std::atan2(l.cross(m).norm(), l.dot(m)) * 180 / M_PI;
  }
  return views.empty() ? 0 : sum / static_cast<double>(views.size());
}

bool InsideObject(const Light& light, const TriangleMesh& mesh) {
  return light.type == LightType::kPoint && light.frame == LightFrame::kWorld &&
         ExactWindingNumber(mesh, light.vector) > 0.5;
}

std::vector<std::string> Contradictions(const std::vector<Light>& given, const std::vector<FoundLight>& found,
                                        const std::vector<View>& views, const Eigen::Vector3d& center) {
  std::vector<std::string> sentences;
  std::vector<const FoundLight*> determined, explained;
  for (const FoundLight& f : found)
    if (f.determined) determined.push_back(&f);
  if (determined.empty()) return sentences;
  for (size_t k = 0; k < given.size(); ++k) {
    Nearest nearest;
    for (const FoundLight* f : determined) {
      const double angle_deg = MeanAngleDeg(given[k], f->light, views, center);
      if (angle_deg < nearest.angle_deg) nearest = {f, angle_deg};
    }
    GLINT_CHECK(nearest.light != nullptr);  // lights are finite, so there is an angle between them
    const double limit_deg = kTrustDeg + 3 * SigmaDeg(*nearest.light, views, center);
    if (nearest.angle_deg <= limit_deg) {
      explained.push_back(nearest.light);
    } else if (nearest.angle_deg <= kSameLampDeg) {
      explained.push_back(nearest.light);
      sentences.push_back(
          fmt::format("given light {} seems wrong: {:.0f} highlights point to a light {:.1f} deg away "
                      "from it (leave --lights out to use that)",
                      k, nearest.light->support, nearest.angle_deg));
    } else {
      sentences.push_back(fmt::format("no highlights speak for given light {}", k));
    }
  }
  for (const FoundLight* f : determined)
    if (std::find(explained.begin(), explained.end(), f) == explained.end())
      sentences.push_back(
          fmt::format("{:.0f} highlights point to a light that is not among the given ones", f->support));
  return sentences;
}

}  // namespace glint
