#include "silhouette/lab.h"

#include <opencv2/imgproc.hpp>

namespace glint::internal {
namespace {

cv::Mat Convert(const cv::Mat& image) {
  cv::Mat lab;
  image.convertTo(lab, CV_32F, 1.0 / 255);
  cv::cvtColor(lab, lab, cv::COLOR_BGR2Lab);
  return lab;
}

}  // namespace

cv::Mat ToLab(const cv::Mat& image) {
  // OpenCV 4.6 makes its tables at the first conversion, without a lock: two threads that come first both make them,
  // one set is lost (4.7 MB), and which one is in use changes meanwhile. So the first conversion is over before the
  // others.
  static const cv::Mat first = Convert(cv::Mat(1, 1, CV_8UC3, cv::Scalar(0, 0, 0)));
  return Convert(image);
}

}  // namespace glint::internal
