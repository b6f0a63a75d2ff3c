// The photograph of a calibration ball.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "colmap/camera.h"
#include "light/ball.h"

namespace cv {
class Mat;
}

namespace glint {

struct BallCircle {
  Eigen::Vector2d center_px;  // COLMAP's frame
  double radius_px = 0;
};

// The most circular outline in the image (any depth and number of channels): Hough's transform, then a robust fit to
// the strongest edges along its radii. For photographs of one ball under changing light their mean shows it best.
std::optional<BallCircle> FindBallCircle(const cv::Mat& image);

// The circle around what a mask shows (CV_8UC1): the circle of its area about its centroid. nullopt: an empty mask.
std::optional<BallCircle> CircleOfMask(const cv::Mat& mask);

enum class BallKind { kChrome, kGray };

// A chrome ball is dark but for the lamp's image; a gray one is bright over the side that is lit.
BallKind GuessBallKind(const cv::Mat& image, const BallCircle& circle);

struct BallLight {
  Eigen::Vector3d direction;  // unit, to the light, camera's frame
  double sigma_deg = 0;
  double angular_size_deg = 0;                   // of the lamp, from the size of its image on a mirror; 0: not known
  Eigen::Vector2d px = Eigen::Vector2d::Zero();  // of the lamp's image on a mirror
};

struct BallLightResult {
  std::optional<BallLight> light;
  std::string why;  // there is none
};

// The brightest of the lamp's images on a mirror ball (the other, smaller ones are reflections of reflections), or
// LightFromShading() of a gray one.
BallLightResult LightOfBall(const cv::Mat& image, const Camera& camera, const Ball& ball, const BallCircle& circle,
                            BallKind kind);

}  // namespace glint
