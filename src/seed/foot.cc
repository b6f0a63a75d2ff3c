#include "seed/foot.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "geometry/edge_topology.h"
#include "geometry/pseudo_normals.h"
#include "seed/convex_hull.h"

namespace glint {
namespace {

constexpr int kBaseGrid = 24;         // points across the foot
constexpr double kFootHeight = 0.12;  // of the object's height: points lower than this show where its foot is
constexpr size_t kMinFootPoints = 3;
// What of the seed is on the ground: so near it, of the diagonal, and facing it so much.
constexpr double kOnGroundRel = 0.01;
constexpr double kFacingGround = 0.7;

// Where the object stands: the part of the ground below its lowest points.
class Foot {
 public:
  Foot(const Scene& scene, const ObjectChoice& choice) {
    if (!choice.ground) return;
    plane_ = choice.ground->plane;
    u_ = plane_.normal().unitOrthogonal();
    v_ = plane_.normal().cross(u_);
    double height = 0;
    for (size_t i = 0; i < scene.points.size(); ++i)
      if (choice.role[i] == PointRole::kObject)
        height = std::max(height, plane_.signedDistance(scene.points[i].position));
    std::vector<Eigen::Vector2d> low;
    for (size_t i = 0; i < scene.points.size(); ++i)
      if (choice.role[i] == PointRole::kObject &&
          plane_.signedDistance(scene.points[i].position) < kFootHeight * height)
        low.push_back(OnPlane(scene.points[i].position));
    if (low.size() < kMinFootPoints) return;
    outline_ = ConvexHull(low);
  }

  // Its outline and a grid that covers it, on the plane.
  std::vector<Eigen::Vector3d> Points() const {
    std::vector<Eigen::Vector3d> points;
    const Eigen::Vector3d origin = -plane_.offset() * plane_.normal();
    auto add = [&](const Eigen::Vector2d& at) { points.push_back(origin + at.x() * u_ + at.y() * v_); };
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& p : outline_) {
      box.extend(p);
      add(p);
    }
    const double step = box.isEmpty() ? 0 : box.sizes().maxCoeff() / kBaseGrid;
    for (int i = 0; step > 0 && i <= kBaseGrid; ++i)
      for (int j = 0; j <= kBaseGrid; ++j) {
        const Eigen::Vector2d at = box.min() + step * Eigen::Vector2d(i + (j % 2) * 0.5, j);
        if (DistanceToConvex(outline_, at) == 0) add(at);
      }
    return points;
  }

 private:
  Eigen::Vector2d OnPlane(const Eigen::Vector3d& x) const { return {x.dot(u_), x.dot(v_)}; }

  Eigen::Hyperplane<double, 3> plane_;
  Eigen::Vector3d u_ = Eigen::Vector3d::UnitX(), v_ = Eigen::Vector3d::UnitY();
  std::vector<Eigen::Vector2d> outline_;  // convex, counter-clockwise; empty: the object shows no foot
};

}  // namespace

void MarkFoot(const GroundPlane& ground, TriangleMesh& seed) {
  const std::vector<Eigen::Vector3d> normals = ComputePseudoNormals(seed, BuildEdgeTopology(seed)).vertex;
  const double near = kOnGroundRel * Diagonal(seed);
  std::vector<float> foot(seed.vertices.size());
  for (size_t v = 0; v < foot.size(); ++v)
    foot[v] =
        ground.plane.signedDistance(seed.vertices[v]) < near && normals[v].dot(ground.plane.normal()) < -kFacingGround
            ? 1.0F
            : 0.0F;
  seed.scalars.emplace_back(kFootScalar, std::move(foot));
}

std::vector<Eigen::Vector3d> FootPoints(const Scene& scene, const ObjectChoice& choice) {
  return Foot(scene, choice).Points();
}

}  // namespace glint
