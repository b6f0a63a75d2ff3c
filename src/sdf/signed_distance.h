// Signed distance to a triangle mesh at single points.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/closest_point.h"
#include "geometry/triangle_mesh.h"
#include "sdf/mesh_to_level_set.h"

namespace glint {

// Distance ‖r‖ sign(r·N) of points in double [BA05], negative inside. `sign` as in SdfOptions. Keeps its own copy of
// the mesh. Queries are thread-safe. Throws InputError for bad meshes, and for points that are not finite.
class SignedDistanceQuery {
 public:
  SignedDistanceQuery(const TriangleMesh& mesh, const std::string& sign);
  ~SignedDistanceQuery();
  SignedDistanceQuery(SignedDistanceQuery&&) noexcept;

  // Nothing beyond max_distance.
  std::optional<double> Find(const Eigen::Vector3d& p,
                             double max_distance = std::numeric_limits<double>::infinity()) const;

  // The closest point with its face (of the mesh given), feature and distance.
  struct Result {
    double distance;
    MeshPoint closest;
    Eigen::Vector3d barycentric;
  };
  Result FindClosest(const Eigen::Vector3d& p) const;

  bool Inside(const Eigen::Vector3d& p) const;  // by the chosen method

  // Of many points; any of them may be far from any other.
  std::vector<double> Distances(const std::vector<Eigen::Vector3d>& points) const;

  const std::string& method() const { return summary().sign; }
  const SdfSummary& summary() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Signed distances of many points, in parallel: each search starts from what a point nearby has found.
std::vector<double> SignedDistance(const TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& points,
                                   const std::string& sign = "auto", SdfSummary* summary = nullptr);

}  // namespace glint
