// What the views see of places on a surface, and behind it. Only for .cc files of this module.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "colmap/scene.h"
#include "geometry/ray_caster.h"
#include "geometry/triangle_mesh.h"
#include "highlights/sight_colors.h"

namespace glint::internal {

inline constexpr double kLeastCosine = 0.3;  // of the incidence: flatter, gloss mirrors the surroundings
inline constexpr double kSightMarginRel = 1e-3;

using Colors = std::vector<Eigen::Array3f>;

class Judge {
 public:
  Judge(const Scene& scene, const SightColors& colors, const TriangleMesh& mesh)
      : scene_(scene), colors_(colors), caster_(mesh), margin_(kSightMarginRel * Diagonal(mesh)) {
    for (const View& view : scene.views) centers_.push_back(view.Center());
  }

  // What the views see of a place on the surface.
  Colors OnSurface(const Eigen::Vector3d& x, const Eigen::Vector3d& normal) const {
    return Look(x, [&](const Eigen::Vector3d& eye) {
      const Eigen::Vector3d to_eye = eye - x;
      return normal.dot(to_eye) > kLeastCosine * to_eye.norm() && !caster_.Occluded(x, eye, 10 * margin_);
    });
  }

  // And of one behind it, where the faces in `open` are not there.
  Colors Through(const Eigen::Vector3d& x, const std::vector<uint8_t>& open) const {
    return Look(x, [&](const Eigen::Vector3d& eye) {
      const double distance = (x - eye).norm();
      const Eigen::Vector3d direction = (x - eye) / distance;
      const auto first = caster_.Intersect(eye, direction, 0, distance - margin_);
      if (!first) return true;
      return open[first->face] && !caster_.Intersect(eye, direction, first->t + margin_, distance - margin_);
    });
  }

 private:
  template <class Sees>
  Colors Look(const Eigen::Vector3d& x, const Sees& sees) const {
    Colors colors;
    for (uint32_t v = 0; v < centers_.size(); ++v) {
      if (!colors_.Has(v)) continue;
      const auto px = scene_.views[v].Project(x);
      if (!px || !scene_.views[v].Contains(*px) || !sees(centers_[v])) continue;
      const auto color = colors_.At(v, *px);
      if (!color) continue;
      colors.push_back(*color);
    }
    return colors;
  }

  const Scene& scene_;
  const SightColors& colors_;
  RayCaster caster_;
  double margin_;
  std::vector<Eigen::Vector3d> centers_;
};

}  // namespace glint::internal
