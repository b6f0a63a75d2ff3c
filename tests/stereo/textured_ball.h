// Photographs of a unit ball from a dome, small ones.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <random>
#include <vector>

#include "core/parallel.h"
#include "tests/seed/simulated_scene.h"

namespace glint::testing {

// What a view sees of the ball.
using Look = std::function<Eigen::Vector3d(const Eigen::Vector3d& x, const Eigen::Vector3d& to_eye)>;

// Waves of a few pixels' length.
inline Eigen::Vector3d Texture(const Eigen::Vector3d& x, const Eigen::Vector3d&) {
  const double value = std::sin(71 * x.x() + 7 * std::sin(5 * x.y())) + std::sin(69 * x.y() + 31 * x.z()) +
                       std::sin(73 * x.z() - 37 * x.x());
  return Eigen::Vector3d(110, 120, 130) + 22 * value * Eigen::Vector3d(1, 0.8, 0.6);
}

inline Eigen::Vector3d Plain(const Eigen::Vector3d&, const Eigen::Vector3d&) { return {110, 120, 130}; }

inline Scene BallScene(int num_views) {
  Scene scene = DomeScene(num_views, 4);
  for (View& view : scene.views) view.camera = {1, CameraModel::kPinhole, 320, 240, {360, 360, 160, 120}};
  return scene;
}

inline cv::Mat Photograph(const View& view, unsigned noise_seed, const Look& look) {
  cv::Mat image(240, 320, CV_8UC3, cv::Scalar(90, 90, 90));
  const Eigen::Vector3d eye = view.Center();
  std::mt19937 random(noise_seed);
  std::normal_distribution<double> noise(0, 1);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      const Eigen::Vector3d direction = *view.RayThrough({x + 0.5, y + 0.5});
      const double along = -direction.dot(eye), across2 = eye.squaredNorm() - along * along;
      if (across2 >= 1) continue;
      const Eigen::Vector3d at = eye + (along - std::sqrt(1 - across2)) * direction;
      const Eigen::Vector3d color = look(at, -direction);
      for (int c = 0; c < 3; ++c) image.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<uint8_t>(color[c] + noise(random));
    }
  return image;
}

inline std::vector<cv::Mat> Photographs(const Scene& scene, const Look& look) {
  std::vector<cv::Mat> images(scene.views.size());
  ParallelFor(images.size(), 1,
              [&](size_t v) { images[v] = Photograph(scene.views[v], static_cast<unsigned>(v), look); });
  return images;
}

}  // namespace glint::testing
