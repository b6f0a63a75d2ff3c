// A calibration ball: a sphere of known place that shows where the light comes from.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "colmap/camera.h"

namespace glint {

// A sphere of radius one in the camera's frame (x right, y down, z forward): how large it is can not be seen, and does
// not matter for a distant light.
struct Ball {
  Eigen::Vector3d center;
};

// From pixels on its outline (COLMAP's frame): the rays that touch a sphere form a circular cone, d·a = cos α for every
// unit ray d, which is linear in a / cos α; robust to stray pixels. The image of the outline is an ellipse, which
// perspective draws out away from the image's middle. nullopt: fewer than 5 pixels, or no cone.
std::optional<Ball> BallFromOutline(const Camera& camera, const std::vector<Eigen::Vector2d>& outline_px);

// From the circle that somebody has drawn around it.
std::optional<Ball> BallFromCircle(const Camera& camera, const Eigen::Vector2d& center_px, double radius_px);

// Outward normal of the ball where the ray through a pixel meets it; nullopt where it passes by.
std::optional<Eigen::Vector3d> BallNormal(const Camera& camera, const Ball& ball, const Eigen::Vector2d& px);

// Unit direction to a distant light, camera's frame, that a mirror ball shows at the pixel: l = 2 (n·v) n − v.
std::optional<Eigen::Vector3d> MirroredDirection(const Camera& camera, const Ball& ball, const Eigen::Vector2d& px);

struct ShadedPixel {
  Eigen::Vector3d normal;
  double brightness;  // linear
};

struct ShadingFit {
  Eigen::Vector3d direction;  // unit, to the light, camera's frame
  double sigma_deg = 0;
  double ambient = 0;   // brightness without the light, as a share of its own
  double residual = 0;  // rms, the same
};

// A distant light from a diffuse ball: brightness = ambient + albedo max(0, n·l) (Lambert), by iterated least squares
// over the pixels that the light reaches, with robust weights: a gloss or a speck does not count. nullopt: fewer than
// 50 pixels are lit, or nothing varies.
std::optional<ShadingFit> LightFromShading(const std::vector<ShadedPixel>& pixels);

}  // namespace glint
