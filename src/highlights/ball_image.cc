#include "highlights/ball_image.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/square.h"
#include "highlights/brightness.h"

namespace glint {
namespace {

constexpr int kRadii = 180;
constexpr double kMinOutline = 0.2;  // see FindBallCircle()

// Stretched so that lamps and their mirror images do not leave the rest in the dark.
cv::Mat Gray8(const cv::Mat& image) {
  cv::Mat gray = image, values;
  if (image.channels() > 1) cv::cvtColor(image, gray, image.channels() == 4 ? cv::COLOR_BGRA2GRAY : cv::COLOR_BGR2GRAY);
  gray.convertTo(gray, CV_32F);
  values = gray.clone().reshape(1, 1);
  float* first = values.ptr<float>();
  const size_t high = values.total() * 95 / 100;
  std::nth_element(first, first + high, first + values.total());
  const double white = std::max(first[high], 1e-6f);
  cv::Mat out;
  gray.convertTo(out, CV_8U, 255 / white);
  return out;
}

// Circle through points by iterated least squares with Cauchy's weights, from a first guess.
std::optional<BallCircle> FitCircle(const std::vector<Eigen::Vector2d>& points, BallCircle circle) {
  for (int round = 0; round < 15; ++round) {
    std::vector<double> errors;
    for (const auto& p : points) errors.push_back(std::abs((p - circle.center_px).norm() - circle.radius_px));
    std::vector<double> sorted = errors;
    std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
    const double scale = std::max(0.5, 2 * sorted[sorted.size() / 2]);
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector2d out = (points[i] - circle.center_px).normalized();
      const Eigen::Vector3d row(out.x(), out.y(), 1);
      const double weight = 1 / (1 + Square(errors[i] / scale));
      a += weight * row * row.transpose();
      b += weight * ((points[i] - circle.center_px).norm() - circle.radius_px) * row;
    }
    const Eigen::Vector3d step = a.ldlt().solve(b);
    if (!step.allFinite()) return std::nullopt;
    circle.center_px += step.head<2>();
    circle.radius_px += step[2];
    if (step.norm() < 1e-4) break;
  }
  return circle.radius_px > 2 ? std::optional<BallCircle>(circle) : std::nullopt;
}

// The strongest edge along each radius near the circle; pixels of the gray image.
std::vector<Eigen::Vector2d> EdgesAlongRadii(const cv::Mat& gray, const BallCircle& circle, double reach) {
  std::vector<Eigen::Vector2d> edges;
  const auto at = [&](const Eigen::Vector2d& p) {
    const int x = std::clamp(static_cast<int>(p.x()), 0, gray.cols - 1);
    const int y = std::clamp(static_cast<int>(p.y()), 0, gray.rows - 1);
    return static_cast<double>(gray.at<uint8_t>(y, x));
  };
  const double step = std::max(1.0, 0.004 * circle.radius_px);
  for (int k = 0; k < kRadii; ++k) {
    const double a = 2 * M_PI * k / kRadii;
    const Eigen::Vector2d out(std::cos(a), std::sin(a));
    double best = 4, best_r = 0;
    for (int half_px = 0; half_px <= 4 * reach * circle.radius_px; ++half_px) {
      const double r = (1 - reach) * circle.radius_px + 0.5 * half_px;
      const Eigen::Vector2d p = circle.center_px + r * out;
      if (p.x() < 2 || p.y() < 2 || p.x() > gray.cols - 2 || p.y() > gray.rows - 2) continue;
      const double rise = std::abs(at(p + step * out) - at(p - step * out));
      if (rise > best) best = rise, best_r = r;
    }
    if (best_r > 0) edges.push_back(circle.center_px + best_r * out);
  }
  return edges;
}

std::optional<BallCircle> RefineCircle(const cv::Mat& gray, BallCircle circle) {
  for (const double reach : {0.12, 0.05, 0.03}) {
    const auto edges = EdgesAlongRadii(gray, circle, reach);
    if (edges.size() < 30) return std::nullopt;
    const auto fitted = FitCircle(edges, circle);
    if (!fitted) return std::nullopt;
    circle = *fitted;
  }
  return circle;
}

// Share of the radii whose strongest edge lies on the circle.
double OutlineSeen(const cv::Mat& gray, const BallCircle& circle) {
  const auto edges = EdgesAlongRadii(gray, circle, 0.15);
  const double near = std::max(1.5, 0.012 * circle.radius_px);
  const auto on = std::count_if(edges.begin(), edges.end(), [&](const Eigen::Vector2d& p) {
    return std::abs((p - circle.center_px).norm() - circle.radius_px) < near;
  });
  return static_cast<double>(on) / kRadii;
}

struct Spot {
  double flux = 0, area = 0;
  Eigen::Vector2d px = Eigen::Vector2d::Zero();
};

// What is brighter than half of the brightest inside the ball, piece by piece; the one with the most light.
Spot BrightestSpot(const cv::Mat& map, const BallCircle& circle) {
  cv::Mat inside = cv::Mat::zeros(map.size(), CV_8U);
  cv::circle(inside, cv::Point(cvRound(circle.center_px.x() - 0.5), cvRound(circle.center_px.y() - 0.5)),
             cvRound(0.97 * circle.radius_px), 255, cv::FILLED);
  double highest = 0;
  cv::minMaxLoc(map, nullptr, &highest, nullptr, nullptr, inside);
  cv::Mat bright = (map > 0.5 * highest) & inside;
  cv::Mat labels;
  const int count = cv::connectedComponents(bright, labels, 8, CV_32S);
  std::vector<Spot> spots(static_cast<size_t>(std::max(count, 1)));
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x)
      if (const int label = labels.at<int>(y, x); label > 0) {
        Spot& spot = spots[static_cast<size_t>(label)];
        const double value = map.at<uint16_t>(y, x) / 65535.0;
        spot.flux += value;
        spot.area += 1;
        spot.px += value * Eigen::Vector2d(x + 0.5, y + 0.5);
      }
  Spot best =
      *std::max_element(spots.begin(), spots.end(), [](const Spot& a, const Spot& b) { return a.flux < b.flux; });
  if (best.flux > 0) best.px /= best.flux;
  return best;
}

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI;
}

BallLightResult FromMirror(const cv::Mat& map, const Camera& camera, const Ball& ball, const BallCircle& circle) {
  const Spot spot = BrightestSpot(map, circle);
  if (spot.flux <= 0) return {std::nullopt, "the ball shows no lamp"};
  const double radius = std::sqrt(spot.area / M_PI);
  if (radius > 0.3 * circle.radius_px) return {std::nullopt, "the bright part of the ball is too large for a lamp"};
  const auto direction = MirroredDirection(camera, ball, spot.px);
  if (!direction) return {std::nullopt, "the lamp's image lies outside the ball"};
  BallLight light{*direction, 0, 0, spot.px};
  const Eigen::Vector2d inward = (circle.center_px - spot.px).stableNormalized();
  const auto beside = MirroredDirection(camera, ball, spot.px + radius * inward);
  const double turn_deg = beside ? AngleDeg(*beside, *direction) : 0;  // of the lamp's radius
  light.angular_size_deg = 2 * turn_deg;
  // The spot's centre is known to a tenth of its radius, the circle to about half a pixel.
  const double per_px = turn_deg / std::max(radius, 0.5);
  light.sigma_deg = std::hypot(0.1 * turn_deg, 0.5 * per_px);
  return {light, ""};
}

BallLightResult FromShading(const cv::Mat& map, const Camera& camera, const Ball& ball, const BallCircle& circle) {
  std::vector<ShadedPixel> pixels;
  const double r = 0.95 * circle.radius_px;
  const int step = std::max(1, static_cast<int>(r / 100));
  for (int y = 0; y < map.rows; y += step)
    for (int x = 0; x < map.cols; x += step) {
      const Eigen::Vector2d px(x + 0.5, y + 0.5);
      if ((px - circle.center_px).norm() > r) continue;
      const double value = map.at<uint16_t>(y, x) / 65535.0;
      const auto normal = BallNormal(camera, ball, px);
      if (normal && value < 0.95) pixels.push_back({*normal, value});
    }
  const auto fit = LightFromShading(pixels);
  if (!fit) return {std::nullopt, "the ball's shading shows no light"};
  return {BallLight{fit->direction, fit->sigma_deg, 0, Eigen::Vector2d::Zero()}, ""};
}

}  // namespace

std::optional<BallCircle> FindBallCircle(const cv::Mat& image) {
  constexpr int kWorkSide = 480;
  constexpr size_t kTried = 8;
  const cv::Mat gray = Gray8(image);
  const double scale = std::max(1.0, std::max(gray.cols, gray.rows) / double(kWorkSide));
  cv::Mat small;
  cv::resize(gray, small, {}, 1 / scale, 1 / scale, cv::INTER_AREA);
  cv::GaussianBlur(small, small, {}, 1.5);
  const int side = std::min(small.cols, small.rows);
  std::optional<BallCircle> best;
  double best_score = kMinOutline;
  for (const double canny : {100.0, 60.0, 30.0, 15.0}) {
    std::vector<cv::Vec3f> circles;
    cv::HoughCircles(small, circles, cv::HOUGH_GRADIENT, 1.5, side / 16.0, canny, 25, side / 10, side / 2);
    for (size_t k = 0; k < std::min(circles.size(), kTried); ++k) {
      const cv::Vec3f& c = circles[k];
      const auto refined =
          RefineCircle(gray, {(Eigen::Vector2d(c[0], c[1]) + Eigen::Vector2d(0.5, 0.5)) * scale, c[2] * scale});
      if (!refined) continue;
      // Of circles within each other (the ball mirrors its surroundings) the outline is the large one.
      const double score = OutlineSeen(gray, *refined) * std::sqrt(refined->radius_px / (side * scale));
      if (score > best_score) best_score = score, best = refined;
    }
  }
  return best;
}

std::optional<BallCircle> CircleOfMask(const cv::Mat& mask) {
  const cv::Moments m = cv::moments(mask, true);
  if (m.m00 < 10) return std::nullopt;
  return BallCircle{{m.m10 / m.m00 + 0.5, m.m01 / m.m00 + 0.5}, std::sqrt(m.m00 / M_PI)};
}

BallKind GuessBallKind(const cv::Mat& image, const BallCircle& circle) {
  const cv::Mat map = LinearMinChannel(image);
  const Spot spot = BrightestSpot(map, circle);
  return spot.area < 0.08 * M_PI * circle.radius_px * circle.radius_px ? BallKind::kChrome : BallKind::kGray;
}

BallLightResult LightOfBall(const cv::Mat& image, const Camera& camera, const Ball& ball, const BallCircle& circle,
                            BallKind kind) {
  const cv::Mat map = LinearMinChannel(image);
  return kind == BallKind::kChrome ? FromMirror(map, camera, ball, circle) : FromShading(map, camera, ball, circle);
}

}  // namespace glint
