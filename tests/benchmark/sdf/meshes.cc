#include "tests/benchmark/sdf/meshes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>

#include "core/error.h"
#include "geometry/clean_mesh.h"
#include "io/mesh_io.h"
#include "tests/support/shapes.h"

namespace glint::benchmark {

namespace {

// The icosahedron with every face cut into n² triangles, on the unit sphere.
TriangleMesh Geodesic(size_t num_triangles) {
  const int n = std::max(1, static_cast<int>(std::lround(std::sqrt(num_triangles / 20.0))));
  const TriangleMesh ico = testing::Icosphere(0);
  TriangleMesh soup;
  // Sums in the order of the corners' numbers: the same point from either side of an edge.
  const auto point = [&](const Eigen::Vector3i& face, int i, int j) {
    std::array<std::pair<int, int>, 3> terms{{{face[0], n - i - j}, {face[1], i}, {face[2], j}}};
    std::sort(terms.begin(), terms.end());
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& [corner, weight] : terms)
      if (weight > 0) sum += weight * ico.vertices[corner];
    return Eigen::Vector3d(sum.normalized());
  };
  const auto add = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    const int first = static_cast<int>(soup.vertices.size());
    soup.vertices.insert(soup.vertices.end(), {a, b, c});
    soup.faces.emplace_back(first, first + 1, first + 2);
  };
  for (const Eigen::Vector3i& face : ico.faces)
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        add(point(face, i, j), point(face, i + 1, j), point(face, i, j + 1));
        if (i + j + 1 < n) add(point(face, i + 1, j), point(face, i + 1, j + 1), point(face, i, j + 1));
      }
  return Clean(soup).mesh;
}

// Bumps of a few wavelengths: the shape of an object rather than of a sphere.
double Bumps(const Eigen::Vector3d& n) {
  return 0.12 * std::sin(5 * n[0] + 1) * std::sin(4 * n[1]) + 0.06 * std::sin(11 * n[2] + 3 * n[0]) +
         0.02 * std::sin(31 * n[1] - 17 * n[2]);
}

}  // namespace

TriangleMesh MakeMesh(const std::string& name, const std::filesystem::path& folder) {
  const size_t colon = name.find(':');
  const std::string kind = name.substr(0, colon);
  if (colon == std::string::npos || (kind != "smooth" && kind != "scan" && kind != "spiky"))
    return ReadMesh(std::filesystem::exists(name) ? std::filesystem::path(name) : folder / name);
  const size_t count = std::strtoul(name.c_str() + colon + 1, nullptr, 10);
  if (count < 16 || count > 100'000'000) throw InputError("", name, "expected 16 to 100000000 triangles");
  TriangleMesh mesh = Geodesic(count);
  std::mt19937 random(1);
  const auto uniform = [&] { return 2.0 * random() / 4294967295.0 - 1; };
  const double edge = std::sqrt(4 * std::numbers::pi / static_cast<double>(count));
  for (Eigen::Vector3d& v : mesh.vertices) {  // star-shaped: no faces pass through each other
    if (kind == "scan") v = (v + 0.2 * edge * Eigen::Vector3d(uniform(), uniform(), uniform())).normalized();
    v *= kind == "spiky" ? 1 + 0.3 * uniform() : 1 + Bumps(v);
    if (kind == "scan") v *= 1 + 0.3 * edge * uniform();
  }
  return mesh;
}

}  // namespace glint::benchmark
