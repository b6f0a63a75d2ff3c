#include "synthetic/shapes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "core/error.h"
#include "synthetic/random.h"
#include "synthetic/waves.h"

namespace glint {
namespace {

using Eigen::Vector3d;

class Sphere : public ImplicitShape {
 public:
  double Value(const Vector3d& x) const override { return x.norm() - 1; }
  Vector3d Gradient(const Vector3d& x) const override { return x.normalized(); }
};

class Ellipsoid : public ImplicitShape {
 public:
  explicit Ellipsoid(uint64_t seed) {
    Random random({seed, 11});
    semi_axes_ = {random.Uniform(1.0, 1.15), random.Uniform(0.75, 0.9), random.Uniform(0.6, 0.75)};
    radius_ = semi_axes_.maxCoeff();
  }
  double Value(const Vector3d& x) const override {
    return (x.cwiseQuotient(semi_axes_).norm() - 1) * semi_axes_.minCoeff();
  }
  Vector3d Gradient(const Vector3d& x) const override {
    const Vector3d scaled = x.cwiseQuotient(semi_axes_);
    return scaled.normalized().cwiseQuotient(semi_axes_) * semi_axes_.minCoeff();
  }

 private:
  Vector3d semi_axes_;
};

class Torus : public ImplicitShape {
 public:
  explicit Torus(uint64_t seed) {
    Random random({seed, 12});
    tube_ = random.Uniform(0.27, 0.33);
    ring_ = 1 - tube_;
    const double tilt = random.Uniform(0.05, 0.35), turn = random.Uniform(0, 2 * std::numbers::pi);
    axis_ = {std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt)};
  }
  double Value(const Vector3d& x) const override {
    const double along = axis_.dot(x), across = (x - along * axis_).norm() - ring_;
    return std::hypot(along, across) - tube_;
  }
  Vector3d Gradient(const Vector3d& x) const override {
    const double along = axis_.dot(x);
    const Vector3d in_plane = x - along * axis_;
    const double distance = in_plane.norm();
    return (along * axis_ + (distance - ring_) * in_plane / distance).normalized();
  }

 private:
  double ring_, tube_;
  Vector3d axis_;
};

// |x| - 1 - waves: star-shaped, and so a single closed surface, since the waves' slopes sum to less than one.
class Blob : public ImplicitShape {
 public:
  explicit Blob(uint64_t seed) {
    Random random({seed, 13});
    waves_ = Waves(random, 6, 2.6, 5.0, 0.14, false);
    lipschitz_ = 1 + waves_.slope_bound();
    radius_ = 1 + waves_.amplitude_bound();
  }
  double Value(const Vector3d& x) const override { return (x.norm() - 1 - waves_.Value(x)) / lipschitz_; }
  Vector3d Gradient(const Vector3d& x) const override { return (x.normalized() - waves_.Gradient(x)) / lipschitz_; }

 private:
  Waves waves_;
  double lipschitz_ = 1;
};

// A maximum that is smooth (twice differentiable) where a and b differ by less than `width`, else exact; never less
// than the maximum. `weight_a`: its derivative by a, in [0, 1]; that by b is the rest.
double SmoothMax(double a, double b, double width, double* weight_a = nullptr) {
  const double overlap = std::max(1 - std::abs(a - b) / width, 0.0);
  if (weight_a) *weight_a = a > b ? 1 - 0.5 * overlap * overlap : 0.5 * overlap * overlap;
  return std::max(a, b) + width / 6 * overlap * overlap * overlap;
}

// A slab between two height fields with the outline of a superellipse (exponent 4), all edges rounded.
class Slab : public ImplicitShape {
 public:
  struct Form {
    double half_length, half_width;  // of the outline, along x and y
    double curve_x, curve_y;         // top: -curve_x x² - curve_y y²
    double bottom;                   // height of the bottom's middle below the top's
    double bottom_curve;             // of the bottom, as a fraction of the top's
    double rounding;                 // difference of distances over which faces blend
  };
  Slab(const Form& form, const Waves& waves) : form_(form), waves_(waves) {
    const double a2 = form.half_length * form.half_length, b2 = form.half_width * form.half_width;
    const double low = -form.bottom - form.bottom_curve * (form.curve_x * a2 + form.curve_y * b2);
    const double high = waves.amplitude_bound();
    center_ = Vector3d(0, 0, 0.5 * (low + high));
    // The superellipse reaches as far as (a⁴ + b⁴)^¼.
    radius_ = std::hypot(std::sqrt(std::hypot(a2, b2)), 0.5 * (high - low));
    const double slope = 2 * radius_ * std::max(form.curve_x, form.curve_y) + waves.slope_bound();
    scale_ = 1 / std::hypot(1, slope);
    per_length_ = 1 / form.half_length;
    per_width_ = 1 / form.half_width;
    outline_scale_ = std::min(form.half_length, form.half_width);
  }
  double Value(const Vector3d& x) const override {
    const auto [top, bottom] = Heights(x);
    const double height = SmoothMax(top, bottom, form_.rounding);
    const double u = x.x() * per_length_, v = x.y() * per_width_, fourth = u * u * u * u + v * v * v * v;
    // Roots only where the outline matters.
    const double least = std::max(1 + (height - form_.rounding) / outline_scale_, 0.0);
    if (fourth <= least * least * least * least) return height;
    return SmoothMax(height, (std::sqrt(std::sqrt(fourth)) - 1) * outline_scale_, form_.rounding);
  }
  Vector3d Gradient(const Vector3d& x) const override {
    const auto [top_value, bottom_value] = Heights(x);
    const double u = x.x() * per_length_, v = x.y() * per_width_;
    const double norm = std::max(std::sqrt(std::sqrt(u * u * u * u + v * v * v * v)), 1e-9);
    double top_weight, height_weight;
    const double height = SmoothMax(top_value, bottom_value, form_.rounding, &top_weight);
    SmoothMax(height, (norm - 1) * outline_scale_, form_.rounding, &height_weight);
    const Vector3d crown(-2 * form_.curve_x * x.x(), -2 * form_.curve_y * x.y(), 0);
    const Vector3d top = Vector3d::UnitZ() - crown - waves_.Gradient(x);
    const Vector3d bottom = form_.bottom_curve * crown - Vector3d::UnitZ();
    const Vector3d side = Vector3d(u * u * u * per_length_, v * v * v * per_width_, 0) / (norm * norm * norm);
    return height_weight * scale_ * (top_weight * top + (1 - top_weight) * bottom) +
           (1 - height_weight) * outline_scale_ * side;
  }

 private:
  // Signed distances, not exceeded, to the top and the bottom.
  std::pair<double, double> Heights(const Vector3d& x) const {
    const double crown = -form_.curve_x * x.x() * x.x() - form_.curve_y * x.y() * x.y();
    return {(x.z() - crown - waves_.Value(x)) * scale_, (form_.bottom_curve * crown - form_.bottom - x.z()) * scale_};
  }

  Form form_;
  Waves waves_;
  double scale_, per_length_, per_width_, outline_scale_;
};

// A car hood: thick, its crown convex with gentle swells.
std::unique_ptr<ImplicitShape> MakeHood(uint64_t seed) {
  Random random({seed, 14});
  // The swells' curvature stays below the crown's, so that the top is convex.
  const Waves swells(random, 3, 2.0, 3.2, 0.03, true);
  return std::make_unique<Slab>(Slab::Form{random.Uniform(0.95, 1.05), random.Uniform(0.72, 0.8),
                                           random.Uniform(0.16, 0.2), random.Uniform(0.22, 0.28), 0.36, 0.0, 0.2},
                                swells);
}

// A thin curved pane, like a windscreen.
std::unique_ptr<ImplicitShape> MakePane(uint64_t seed) {
  Random random({seed, 15});
  const Waves swells(random, 2, 1.5, 2.2, 0.01, true);
  return std::make_unique<Slab>(Slab::Form{kPaneHalfLength, kPaneHalfWidth, random.Uniform(0.2, 0.26),
                                           random.Uniform(0.1, 0.16), 0.07, 0.9, 0.06},
                                swells);
}

// Two bumpy balls, blended where they touch by a smooth minimum.
class Touching : public ImplicitShape {
 public:
  explicit Touching(uint64_t seed) {
    Random random({seed, 16});
    const double small = random.Uniform(0.4, 0.45), angle = random.Uniform(0, 2 * std::numbers::pi);
    const Vector3d axis(std::cos(angle), std::sin(angle), 0);
    for (int i = 0; i < 2; ++i) {
      Ball& ball = balls_[i];
      ball.radius = i == 0 ? 1 - small : small;
      // The balls' surfaces meet up to the waves' amplitude; the smaller one sits lower, as on a table.
      ball.center = (i == 0 ? -small : 1 - small) * 0.98 * axis - Vector3d(0, 0, i == 0 ? 0 : 1 - 2 * small);
      ball.waves = Waves(random, 3, 2.2 / ball.radius, 3.5 / ball.radius, 0.07, false);
      lipschitz_ = std::max(lipschitz_, 1 + ball.waves.slope_bound());
    }
    radius_ = 1.15;
  }
  double Value(const Vector3d& x) const override {
    return -SmoothMax(-BallValue(0, x), -BallValue(1, x), kBlend) / lipschitz_;
  }
  Vector3d Gradient(const Vector3d& x) const override {
    double weight;
    SmoothMax(-BallValue(0, x), -BallValue(1, x), kBlend, &weight);
    return (weight * BallGradient(0, x) + (1 - weight) * BallGradient(1, x)) / lipschitz_;
  }

 private:
  static constexpr double kBlend = 0.12;
  struct Ball {
    Vector3d center;
    double radius;
    Waves waves;
  };
  double BallValue(int i, const Vector3d& x) const {
    return (x - balls_[i].center).norm() - balls_[i].radius - balls_[i].waves.Value(x);
  }
  Vector3d BallGradient(int i, const Vector3d& x) const {
    return (x - balls_[i].center).normalized() - balls_[i].waves.Gradient(x);
  }
  std::array<Ball, 2> balls_;
  double lipschitz_ = 1;
};

// A thick bowl of revolution with a round lip: all within `half_wall` of a circle's arc turned around the axis.
class Bowl : public ImplicitShape {
 public:
  explicit Bowl(uint64_t seed) {
    Random random({seed, 17});
    half_wall_ = random.Uniform(0.04, 0.06);
    arc_ = random.Uniform(0.86, 0.92);
    const double rim_angle = random.Uniform(1.3, 1.75);  // from the bottom
    rim_ = arc_ * Eigen::Vector2d(std::sin(rim_angle), -std::cos(rim_angle));
    lift_ = 0.5 * (arc_ - rim_.y());  // the middle between bottom and rim is the origin
    radius_ = std::hypot(rim_.x(), rim_.y() + lift_) + half_wall_;
  }
  double Value(const Vector3d& x) const override { return FromArc(x).norm() - half_wall_; }
  Vector3d Gradient(const Vector3d& x) const override {
    const Eigen::Vector2d away = FromArc(x).normalized();
    const double radius = std::max(std::hypot(x.x(), x.y()), 1e-12);
    return {away.x() * x.x() / radius, away.x() * x.y() / radius, away.y()};
  }

 private:
  // From the closest place on the arc, in the half plane through the axis and x.
  Eigen::Vector2d FromArc(const Vector3d& x) const {
    const Eigen::Vector2d q(std::hypot(x.x(), x.y()), x.z() - lift_);
    const bool above_rim = rim_.x() * q.y() > rim_.y() * q.x();
    if (above_rim) return q - rim_;
    const double distance = std::max(q.norm(), 1e-12);
    return q * (1 - arc_ / distance);
  }

  double half_wall_, arc_, lift_;
  Eigen::Vector2d rim_;
};

class PlacedShape : public ImplicitShape {
 public:
  PlacedShape(std::shared_ptr<const ImplicitShape> shape, const Similarity& world_from_shape)
      : shape_(std::move(shape)), world_from_shape_(world_from_shape) {
    center_ = world_from_shape * shape_->center();
    radius_ = world_from_shape.scale * shape_->radius();
  }
  double Value(const Vector3d& x) const override {
    return world_from_shape_.scale * shape_->Value(world_from_shape_.InverseOf(x));
  }
  Vector3d Gradient(const Vector3d& x) const override {
    return world_from_shape_.rotation * shape_->Gradient(world_from_shape_.InverseOf(x));
  }

 private:
  std::shared_ptr<const ImplicitShape> shape_;
  Similarity world_from_shape_;
};

}  // namespace

const std::vector<std::string_view>& ShapeNames() {
  static const std::vector<std::string_view> names = {"sphere", "ellipsoid", "torus",    "hood",
                                                      "blob",   "pane",      "touching", "bowl"};
  return names;
}

std::unique_ptr<ImplicitShape> MakeShape(std::string_view name, uint64_t seed) {
  if (name == "sphere") return std::make_unique<Sphere>();
  if (name == "ellipsoid") return std::make_unique<Ellipsoid>(seed);
  if (name == "torus") return std::make_unique<Torus>(seed);
  if (name == "hood") return MakeHood(seed);
  if (name == "blob") return std::make_unique<Blob>(seed);
  if (name == "pane") return MakePane(seed);
  if (name == "touching") return std::make_unique<Touching>(seed);
  if (name == "bowl") return std::make_unique<Bowl>(seed);
  throw InputError("", "scene", fmt::format("expected one of {}, found \"{}\"", fmt::join(ShapeNames(), ", "), name));
}

std::unique_ptr<ImplicitShape> MakePaneInterior(double depth) {
  // Its top follows the pane's curvature less, at a gap, and its bottom is below the ground.
  const Slab::Form form{0.93 * kPaneHalfLength, 0.93 * kPaneHalfWidth, 0.12, 0.1, depth + 0.5, 0, 0.1};
  return PlaceShape(std::make_shared<Slab>(form, Waves()), {1, Eigen::Quaterniond::Identity(), Vector3d(0, 0, -0.26)});
}

std::unique_ptr<ImplicitShape> PlaceShape(std::shared_ptr<const ImplicitShape> shape,
                                          const Similarity& world_from_shape) {
  return std::make_unique<PlacedShape>(std::move(shape), world_from_shape);
}

}  // namespace glint
