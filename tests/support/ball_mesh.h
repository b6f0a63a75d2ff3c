// A closed ball, oriented outward.
#pragma once

#include <cmath>

#include "geometry/triangle_mesh.h"

namespace glint::testing {

inline TriangleMesh BallMesh(const Eigen::Vector3d& center, double radius, int rings) {
  const int sectors = 2 * rings;
  TriangleMesh mesh;
  const auto at = [&](double a, double b) {
    return Eigen::Vector3d(center +
                           radius * Eigen::Vector3d(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)));
  };
  mesh.vertices.push_back(at(0, 0));
  for (int i = 1; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) mesh.vertices.push_back(at(M_PI * i / rings, 2 * M_PI * j / sectors));
  mesh.vertices.push_back(at(M_PI, 0));
  const int last = static_cast<int>(mesh.vertices.size()) - 1;
  const auto index = [&](int i, int j) { return i == 0 ? 0 : i == rings ? last : 1 + (i - 1) * sectors + j % sectors; };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      if (i > 0) mesh.faces.emplace_back(index(i, j), index(i + 1, j), index(i, j + 1));
      if (i + 1 < rings) mesh.faces.emplace_back(index(i, j + 1), index(i + 1, j), index(i + 1, j + 1));
    }
  return mesh;
}

}  // namespace glint::testing
