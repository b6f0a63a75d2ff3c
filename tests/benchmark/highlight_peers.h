// What others would take for highlights, to be measured on the same images.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "highlights/brightness.h"

namespace glint {

struct Peak {
  Eigen::Vector2d px;  // COLMAP's frame
  double area_px = 0;
};

// Centroids of the pieces of a mask, weighed by `weight` (CV_32F).
inline std::vector<Peak> Pieces(const cv::Mat& mask, const cv::Mat& weight) {
  cv::Mat labels;
  const int count = cv::connectedComponents(mask, labels, 8, CV_32S);
  std::vector<Eigen::Vector4d> sums(static_cast<size_t>(count), Eigen::Vector4d::Zero());
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x) {
      const double w = weight.at<float>(y, x);
      sums[static_cast<size_t>(labels.at<int>(y, x))] += Eigen::Vector4d(w * (x + 0.5), w * (y + 0.5), w, 1);
    }
  std::vector<Peak> peaks;
  for (size_t k = 1; k < sums.size(); ++k)
    if (sums[k][2] > 0 && sums[k][3] >= 4) peaks.push_back({sums[k].head<2>() / sums[k][2], sums[k][3]});
  return peaks;
}

inline std::vector<Peak> PlainThreshold(const cv::Mat& image) {
  cv::Mat map;
  LinearMinChannel(image).convertTo(map, CV_32F, 1 / 65535.0);
  return Pieces(map > 0.8, map);
}

// Shen, Zheng, Real-time highlight removal using intensity ratio, Applied Optics 52, 2013: pixels are grouped by the
// minimum and maximum of their pseudo-chromaticity; in a group the ratio of maximum to range is that of the diffuse
// part (median); what exceeds it is specular.
inline std::vector<Peak> ShenZheng(const cv::Mat& image) {
  constexpr int kBins = 12;
  const cv::Size size = image.size();
  cv::Mat low(size, CV_32F), high(size, CV_32F), group(size, CV_32S), specular = cv::Mat::zeros(size, CV_32F);
  double mean_low = 0;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const auto& p = image.at<cv::Vec3b>(y, x);
      const auto [a, b] = std::minmax({p[0], p[1], p[2]});
      low.at<float>(y, x) = a, high.at<float>(y, x) = b;
      mean_low += a / double(size.area());
    }
  std::vector<std::vector<float>> ratios(kBins * kBins);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const auto& p = image.at<cv::Vec3b>(y, x);
      const double a = low.at<float>(y, x), b = high.at<float>(y, x);
      const double sum = p[0] + p[1] + p[2] - 3 * a + 3 * mean_low;  // pseudo specular-free
      const int i = std::min(kBins - 1, int(kBins * 3 * mean_low / std::max(sum, 1e-6)));
      const int j = std::min(kBins - 1, int(kBins * (b - a + mean_low) / std::max(sum, 1e-6)));
      group.at<int>(y, x) = i * kBins + j;
      if (a > mean_low && b > a) ratios[static_cast<size_t>(i * kBins + j)].push_back(float(b / (b - a)));
    }
  std::vector<double> ratio(ratios.size(), 0);
  for (size_t k = 0; k < ratios.size(); ++k) {
    if (ratios[k].empty()) continue;
    auto middle = ratios[k].begin() + static_cast<long>(ratios[k].size() / 2);
    std::nth_element(ratios[k].begin(), middle, ratios[k].end());
    ratio[k] = *middle;
  }
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double a = low.at<float>(y, x), b = high.at<float>(y, x);
      if (a <= mean_low) continue;
      const double diffuse = ratio[static_cast<size_t>(group.at<int>(y, x))] * (b - a);
      specular.at<float>(y, x) = static_cast<float>(std::clamp((b - diffuse) / 255, 0.0, 1.0));
    }
  return Pieces(specular > 0.3, specular);
}

}  // namespace glint
