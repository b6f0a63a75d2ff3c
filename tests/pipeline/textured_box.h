// Photographs that the real COLMAP registers: a box on a floor, both full of detail.
#pragma once

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace glint {

class TexturedBox {
 public:
  TexturedBox() {
    cv::theRNG().state = 5;
    const auto square = [&](cv::Vec3d corner, cv::Vec3d u, cv::Vec3d v, int texels) {
      cv::Mat noise(texels, texels, CV_8UC3), picture;
      cv::randu(noise, 0, 255);
      cv::resize(noise, picture, {8 * texels, 8 * texels}, 0, 0, cv::INTER_CUBIC);
      squares_.push_back({corner, u, v, picture});
    };
    square({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, 80);  // the floor is behind everything
    square({-1, -1, 0}, {2, 0, 0}, {0, 0, 2}, 24);
    square({1, -1, 0}, {0, 2, 0}, {0, 0, 2}, 24);
    square({1, 1, 0}, {-2, 0, 0}, {0, 0, 2}, 24);
    square({-1, 1, 0}, {0, -2, 0}, {0, 0, 2}, 24);
    square({-1, -1, 2}, {2, 0, 0}, {0, 2, 0}, 24);
  }

  // From a circle around it.
  cv::Mat Photograph(double azimuth_deg, int width, int height) const {
    const double a = azimuth_deg * CV_PI / 180;
    const cv::Vec3d eye(6 * std::cos(a), 6 * std::sin(a), 4), target(0, 0, 0.8);
    const cv::Vec3d z = cv::normalize(target - eye), x = cv::normalize(z.cross(cv::Vec3d(0, 0, 1))), y = z.cross(x);
    const double focal = 1.2 * width;
    const auto project = [&](const cv::Vec3d& p) {
      const cv::Vec3d d = p - eye;
      return cv::Point2f(static_cast<float>(focal * d.dot(x) / d.dot(z) + width / 2.0),
                         static_cast<float>(focal * d.dot(y) / d.dot(z) + height / 2.0));
    };
    cv::Mat image(height, width, CV_8UC3, cv::Scalar::all(128));
    for (const Square& s : squares_) {
      if (s.u.cross(s.v).dot(eye - s.corner) <= 0) continue;  // seen from behind
      const float n = static_cast<float>(s.picture.cols);
      const std::vector<cv::Point2f> from = {{0, 0}, {n, 0}, {n, n}, {0, n}};
      const std::vector<cv::Point2f> to = {project(s.corner), project(s.corner + s.u), project(s.corner + s.u + s.v),
                                           project(s.corner + s.v)};
      cv::warpPerspective(s.picture, image, cv::getPerspectiveTransform(from, to), image.size(), cv::INTER_AREA,
                          cv::BORDER_TRANSPARENT);
    }
    return image;
  }

 private:
  struct Square {
    cv::Vec3d corner, u, v;
    cv::Mat picture;
  };
  std::vector<Square> squares_;
};

}  // namespace glint
