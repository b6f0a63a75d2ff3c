// A ring on which only the outside has points, as simulated cameras see it.
#pragma once

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "geometry/triangle_mesh.h"
#include "tests/seed/simulated_scene.h"

namespace glint {

struct RingScene {
  static constexpr double kMajor = 1, kMinor = 0.33;

  Scene scene = DomeScene(24, 5);
  std::vector<cv::Mat> masks;

  RingScene() {
    for (View& v : scene.views) {
      v.camera = {1, CameraModel::kPinhole, 400, 300, {450, 450, 200, 150}};
      masks.push_back(MaskOf(v));
    }
    for (int i = 0; i < 60; ++i)
      for (int j = 0; j < 5; ++j) {
        const double a = 2 * M_PI * (i + 0.5 * (j % 2)) / 60, b = M_PI * (-0.2 + 0.2 * j);
        const Eigen::Vector3d n(std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b));
        const Eigen::Vector3d x = kMajor * Eigen::Vector3d(std::cos(a), std::sin(a), 0) + kMinor * n;
        AddPoint(scene, x, [&](const Eigen::Vector3d& eye) { return n.dot(eye - x) > 0.3 * (eye - x).norm(); });
      }
  }

  static double Distance(const Eigen::Vector3d& x) { return std::hypot(x.head<2>().norm() - kMajor, x.z()) - kMinor; }

  // What a surface through the points makes of it: the hole is spanned.
  static TriangleMesh Disc() {
    constexpr int kRings = 24, kSectors = 48;
    TriangleMesh mesh;
    for (int i = 0; i <= kRings; ++i)
      for (int j = 0; j < kSectors; ++j) {
        const double a = M_PI * i / kRings, b = 2 * M_PI * j / kSectors, across = kMajor + kMinor * std::sin(a);
        mesh.vertices.emplace_back(across * std::cos(b), across * std::sin(b), kMinor * std::cos(a));
      }
    for (int i = 0; i < kRings; ++i)
      for (int j = 0; j < kSectors; ++j) {
        const int p = i * kSectors + j, q = i * kSectors + (j + 1) % kSectors;
        mesh.faces.emplace_back(p, p + kSectors, q);
        mesh.faces.emplace_back(q, p + kSectors, q + kSectors);
      }
    for (int j = 1; j + 1 < kSectors; ++j) {
      const int last = kRings * kSectors;
      mesh.faces.emplace_back(0, j, j + 1);
      mesh.faces.emplace_back(last, last + j + 1, last + j);
    }
    return mesh;
  }

 private:
  static cv::Mat MaskOf(const View& view) {
    cv::Mat mask(static_cast<int>(view.camera.height), static_cast<int>(view.camera.width), CV_8U, cv::Scalar(0));
    for (int y = 0; y < mask.rows; ++y)
      for (int x = 0; x < mask.cols; ++x) {
        const Eigen::Vector3d ray = *view.RayThrough({x + 0.5, y + 0.5});
        double t = 3, d = 1;
        while (t < 7 && d > 1e-3) d = Distance(view.Center() + t * ray), t += std::max(d, 1e-3);
        if (d <= 1e-3) mask.at<uint8_t>(y, x) = 255;
      }
    return mask;
  }
};

}  // namespace glint
