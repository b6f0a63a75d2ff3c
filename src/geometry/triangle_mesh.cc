#include "geometry/triangle_mesh.h"

namespace glint {

Eigen::AlignedBox3d BoundingBox(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& v : mesh.vertices) box.extend(v);
  return box;
}

double Diagonal(const TriangleMesh& mesh) { return mesh.vertices.empty() ? 0.0 : BoundingBox(mesh).diagonal().norm(); }

namespace {

Eigen::Vector3d AreaVector(const TriangleMesh& mesh, size_t f) {
  const Eigen::Vector3i& face = mesh.faces[f];
  const Eigen::Vector3d& a = mesh.vertices[face[0]];
  return 0.5 * (mesh.vertices[face[1]] - a).cross(mesh.vertices[face[2]] - a);
}

}  // namespace

Eigen::Vector3d FaceNormal(const TriangleMesh& mesh, size_t f) {
  const Eigen::Vector3d n = AreaVector(mesh, f);
  const double length = n.norm();
  return length > 0 ? Eigen::Vector3d(n / length) : Eigen::Vector3d::Zero();
}

double SurfaceArea(const TriangleMesh& mesh) {
  double area = 0;
  for (size_t f = 0; f < mesh.faces.size(); ++f) area += AreaVector(mesh, f).norm();
  return area;
}

double SignedVolume(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return 0;
  const Eigen::Vector3d origin = BoundingBox(mesh).center();  // keeps digits for meshes far from zero
  double volume = 0;
  for (size_t f = 0; f < mesh.faces.size(); ++f)
    volume += AreaVector(mesh, f).dot(mesh.vertices[mesh.faces[f][0]] - origin) / 3;
  return volume;
}

TriangleMesh WithoutUnusedVertices(const TriangleMesh& mesh) {
  std::vector<int> new_index(mesh.vertices.size(), -1);
  TriangleMesh out;
  std::vector<size_t> kept;
  for (const Eigen::Vector3i& face : mesh.faces) {
    Eigen::Vector3i mapped;
    for (int k = 0; k < 3; ++k) {
      int& index = new_index[face[k]];
      if (index < 0) {
        index = static_cast<int>(kept.size());
        kept.push_back(face[k]);
      }
      mapped[k] = index;
    }
    out.faces.push_back(mapped);
  }
  const auto pick = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.reserve(kept.size());
    for (size_t v : kept) to.push_back(from[v]);
  };
  pick(mesh.vertices, out.vertices);
  pick(mesh.normals, out.normals);
  pick(mesh.colors, out.colors);
  pick(mesh.confidence, out.confidence);
  for (const auto& [name, values] : mesh.scalars)
    pick(values, out.scalars.emplace_back(name, std::vector<float>()).second);
  return out;
}

}  // namespace glint
