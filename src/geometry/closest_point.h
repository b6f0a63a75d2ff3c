// The closest point of a triangle or a mesh, and the feature it lies on, from one routine: nothing is classified again
// by an epsilon afterwards, so the pseudo-normal that goes with the feature is the right one.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "geometry/bvh.h"
#include "geometry/triangle_mesh.h"

namespace glint {

enum class Feature : uint8_t { kFace, kEdge, kVertex };

// `corner` k in 0..2 names the edge from vertex k to vertex k + 1 (mod 3), or the vertex k; 0 for the face.
struct TrianglePoint {
  Eigen::Vector3d point;
  double squared_distance;
  Feature feature;
  int corner;
};

// Closest point of the triangle abc to p. Triangles without area are the segments or the point that they cover; their
// feature is never kFace.
TrianglePoint ClosestOnTriangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                                const Eigen::Vector3d& p);

// Barycentric weights of x, a point of the triangle abc; they sum to 1.
Eigen::Vector3d Barycentric(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                            const Eigen::Vector3d& x);

struct MeshPoint : TrianglePoint {
  int face;
};

// Closest points of a mesh by a bounding volume hierarchy, in double. Keeps references: the mesh must outlive it.
// Queries are thread-safe. Of equally close faces the one of lowest index is returned.
class ClosestPointQuery {
 public:
  explicit ClosestPointQuery(const TriangleMesh& mesh) : mesh_(&mesh), bvh_(mesh) {}

  // Nothing if the mesh is empty or nothing lies within max_distance. Faster if `near_face` is a face near p, such as
  // the closest of a neighbouring point.
  std::optional<MeshPoint> Find(const Eigen::Vector3d& p, double max_distance = std::numeric_limits<double>::infinity(),
                                int near_face = -1) const;

  const Bvh& bvh() const { return bvh_; }

 private:
  const TriangleMesh* mesh_;
  Bvh bvh_;
};

}  // namespace glint
