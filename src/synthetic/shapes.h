// Analytic implicit shapes, smooth and closed, about one unit in radius, z up.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace glint {

// Negative inside. |Value| never exceeds the distance to the surface (its Lipschitz constant is at most one inside the
// bounding sphere), so that a ray may always step that far. Gradient is that of Value: outward, not of unit length.
class ImplicitShape {
 public:
  virtual ~ImplicitShape() = default;
  virtual double Value(const Eigen::Vector3d& x) const = 0;
  virtual Eigen::Vector3d Gradient(const Eigen::Vector3d& x) const = 0;

  Eigen::Vector3d Normal(const Eigen::Vector3d& x) const { return Gradient(x).normalized(); }

  // A sphere around everything inside.
  const Eigen::Vector3d& center() const { return center_; }
  double radius() const { return radius_; }

 protected:
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  double radius_ = 1;
};

// "sphere", "ellipsoid", "torus", "hood", "blob", "pane", "touching", "bowl".
const std::vector<std::string_view>& ShapeNames();

// The seed varies the free-form shapes, and proportions of ellipsoid, torus and bowl; the sphere is always the unit
// sphere. Throws InputError for an unknown name.
std::unique_ptr<ImplicitShape> MakeShape(std::string_view name, uint64_t seed);

// The box below the "pane", `depth` deep at its middle.
std::unique_ptr<ImplicitShape> MakePaneInterior(double depth);

// x_in_b = scale * (rotation * x_in_a) + translation.
struct Similarity {
  double scale = 1;
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return scale * (rotation * x) + translation; }
  Eigen::Vector3d InverseOf(const Eigen::Vector3d& x) const { return rotation.conjugate() * (x - translation) / scale; }
};

// A shape seen from another frame; values are lengths in that frame.
std::unique_ptr<ImplicitShape> PlaceShape(std::shared_ptr<const ImplicitShape> shape,
                                          const Similarity& world_from_shape);

// The outline of the "pane": a superellipse |x/length|⁴ + |y/width|⁴ = 1.
inline constexpr double kPaneHalfLength = 1.0, kPaneHalfWidth = 0.72;

struct ShapeHit {
  double t;  // along the unit direction
  Eigen::Vector3d position;
  Eigen::Vector3d normal;  // unit, outward
};

// First crossing from outside to inside with t in (t_min, t_max) by sphere tracing, polished by Newton's method to
// about 1e-9 radii. `direction` must be of unit length.
std::optional<ShapeHit> TraceRay(const ImplicitShape& shape, const Eigen::Vector3d& origin,
                                 const Eigen::Vector3d& direction, double t_min, double t_max);

// True if the shape lies on the ray within (t_min, t_max).
bool RayMeets(const ImplicitShape& shape, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double t_min,
              double t_max);

// The surface point that Newton's method along the gradient reaches from x (which should be near the surface).
Eigen::Vector3d ProjectToSurface(const ImplicitShape& shape, const Eigen::Vector3d& x);

}  // namespace glint
