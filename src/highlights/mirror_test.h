// What the seed, put right where one highlight is, says of the same light elsewhere.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "colmap/scene.h"
#include "highlights/highlight.h"
#include "highlights/seed_surface.h"
#include "light/light.h"

namespace glint {

// How much brighter a lobe's peak is at this incidence than straight on: Fresnel's factor of a dielectric (Schlick)
// over the cosine. Of a metal it is a little less.
double PeakGain(double cos_incidence);

// The seed's normals are corrected by what the one at the highlight, which mirrors the light, is off.
class MirrorTest {
 public:
  MirrorTest(const View& own, const SeedSurface& surface, const Light& light, const Highlight& highlight,
             const SurfaceSample& at);

  // By how much the normal turns against the half vector from the lobe's peak to half its height; mean of the axes.
  double WidthDeg() const { return width_deg_; }

  // Half vectors that are farther than that from the normal see next to nothing of the lobe.
  double DarkDeg() const;

  // By how much the image's peak lies off the mirror point, pixels: gloss mirrors more the more aslant one looks at it
  // (radiance goes with 1 / n·v across a lobe), which draws the peak of a broad lobe towards the silhouette.
  Eigen::Vector2d PeakShift() const { return peak_shift_px_; }

  // Angle between half vector and normal where the view's ray meets the seed.
  std::optional<double> OffDeg(const View& view, const Eigen::Vector2d& px) const;

 private:
  struct Place {
    double off_deg;
    double view_cos;
  };
  std::optional<Place> Look(const View& view, const Eigen::Vector2d& px) const;

  const SeedSurface& surface_;
  const Light light_;
  Eigen::Vector3d correction_;
  double width_deg_;
  Eigen::Vector2d peak_shift_px_ = Eigen::Vector2d::Zero();
};

}  // namespace glint
