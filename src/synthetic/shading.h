// How surfaces look: Lambert and GGX under the stage's lights.
#pragma once

#include "synthetic/stage.h"

namespace glint {

struct Shading {
  Eigen::Array3d radiance = Eigen::Array3d::Zero();  // times the exposure: 1 is sensor white
  double specular = 0;                               // of it, the lights' mirror lobes on the object (largest channel)
};

// What the camera of `view` sees along `direction` (unit, in the stage) where the ray from its centre met `hit`.
// `sample` varies the sampling of soft shadows.
Shading Shade(const Stage& stage, const StageView& view, const SurfaceHit& hit, const Eigen::Vector3d& direction,
              uint64_t sample);

// Radiance of one light's GGX lobe on the object (Smith's masking with correlated heights, Schlick's Fresnel term)
// times the exposure, without shadows; `to_viewer` unit.
Eigen::Array3d SpecularLobe(const Stage& stage, size_t light, const Rigid3d& cam_from_stage, const Eigen::Vector3d& x,
                            const Eigen::Vector3d& normal, const Eigen::Vector3d& to_viewer);

}  // namespace glint
