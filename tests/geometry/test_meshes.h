// Meshes for the tests of distances and signs: clean ones, spiky ones, and the sins that meshes commit.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "geometry/triangle_mesh.h"
#include "tests/support/shapes.h"

namespace glint::testing {

// Axis-aligned box, 12 faces, oriented outward.
inline TriangleMesh Box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back(i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]);
  mesh.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

// A closed star-shaped mesh with very sharp and very obtuse vertices: the vertices of an icosphere pushed in and out
// by random factors in [1 − depth, 1 + depth].
inline TriangleMesh SpikySphere(int subdivisions, double depth, unsigned seed) {
  TriangleMesh mesh = Icosphere(subdivisions);
  std::mt19937 random(seed);
  for (Eigen::Vector3d& v : mesh.vertices) v *= 1 + depth * (2.0 * random() / 4294967295.0 - 1);
  return mesh;
}

inline TriangleMesh Transformed(TriangleMesh mesh, double scale, const Eigen::Vector3d& offset) {
  for (Eigen::Vector3d& v : mesh.vertices) v = scale * v + offset;
  return mesh;
}

inline TriangleMesh Inverted(TriangleMesh mesh) {
  for (Eigen::Vector3i& f : mesh.faces) std::swap(f[1], f[2]);
  return mesh;
}

inline TriangleMesh Joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh mesh = a;
  mesh.vertices.insert(mesh.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const Eigen::Vector3i& f : b.faces)
    mesh.faces.push_back(f + Eigen::Vector3i::Constant(static_cast<int>(a.vertices.size())));
  return mesh;
}

// Every face with vertices of its own, as STL files have them.
inline TriangleMesh Soup(const TriangleMesh& mesh) {
  TriangleMesh out;
  for (const Eigen::Vector3i& f : mesh.faces) {
    const int n = static_cast<int>(out.vertices.size());
    for (int k = 0; k < 3; ++k) out.vertices.push_back(mesh.vertices[f[k]]);
    out.faces.emplace_back(n, n + 1, n + 2);
  }
  return out;
}

}  // namespace glint::testing
