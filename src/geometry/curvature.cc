#include "geometry/curvature.h"

#include "core/check.h"

namespace glint {

std::vector<double> MeanCurvature(const TriangleMesh& mesh) {
  GLINT_CHECK_EQ(mesh.normals.size(), mesh.vertices.size());
  std::vector<double> bend(mesh.vertices.size(), 0), area(mesh.vertices.size(), 0);
  for (const Eigen::Vector3i& face : mesh.faces) {
    const auto corner = [&](int k) -> const Eigen::Vector3d& {
      return mesh.vertices[static_cast<size_t>(face[k % 3])];
    };
    const Eigen::Vector3d cross = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    const double twice_area = cross.norm();
    if (!(twice_area > 0)) continue;
    // The gradient of the weight of corner k is its opposite edge turned by a right angle, over twice the area; the
    // divergence of the interpolated normals is the sum of normal · gradient.
    double divergence = 0;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d gradient = cross.cross(corner(k + 2) - corner(k + 1)) / (twice_area * twice_area);
      divergence += mesh.normals[static_cast<size_t>(face[k])].dot(gradient);
    }
    for (int k = 0; k < 3; ++k) {
      bend[static_cast<size_t>(face[k])] += 0.5 * divergence * twice_area;
      area[static_cast<size_t>(face[k])] += twice_area;
    }
  }
  for (size_t v = 0; v < bend.size(); ++v) bend[v] = area[v] > 0 ? bend[v] / area[v] : 0;
  return bend;
}

}  // namespace glint
