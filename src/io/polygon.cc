#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "core/error.h"
#include "io/mesh_formats.h"

namespace glint::internal {
namespace {

constexpr size_t kMaxTestsPerVertex = 4000;

// Newell's normal: twice the area vector of the polygon.
Eigen::Vector3d AreaVector(const std::vector<Eigen::Vector3d>& vertices, const std::vector<int>& polygon) {
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  const Eigen::Vector3d& origin = vertices[polygon[0]];
  for (size_t i = 1; i + 1 < polygon.size(); ++i) {
    area += (vertices[polygon[i]] - origin).cross(vertices[polygon[i + 1]] - origin);
  }
  return area;
}

// True if vertex i of the polygon can be cut off: the corner is convex and no other vertex lies in its triangle.
bool IsEar(const std::vector<Eigen::Vector3d>& vertices, const std::vector<int>& polygon, size_t i,
           const Eigen::Vector3d& normal) {
  const size_t n = polygon.size();
  const int corner[3] = {polygon[(i + n - 1) % n], polygon[i], polygon[(i + 1) % n]};
  const auto side = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& x) {
    return (b - a).cross(x - a).dot(normal);
  };
  if (side(vertices[corner[0]], vertices[corner[1]], vertices[corner[2]]) <= 0) return false;
  for (const int other : polygon) {
    if (other == corner[0] || other == corner[1] || other == corner[2]) continue;
    bool inside = true;
    for (int k = 0; k < 3 && inside; ++k) {
      inside = side(vertices[corner[k]], vertices[corner[(k + 1) % 3]], vertices[other]) >= 0;
    }
    if (inside) return false;
  }
  return true;
}

}  // namespace

void AppendPolygon(const std::vector<Eigen::Vector3d>& vertices, const std::vector<int>& indices,
                   std::vector<Eigen::Vector3i>& faces) {
  std::vector<int> rest = indices;
  if (rest.size() == 4) {
    // Of the two diagonals the shorter one whose triangles do not fold over.
    const Eigen::Vector3d normal = AreaVector(vertices, rest);
    const auto worst = [&](int a, int b, int c, int d) {  // split along a-c
      const Eigen::Vector3d &va = vertices[rest[a]], &vc = vertices[rest[c]];
      const double first = (vertices[rest[b]] - va).cross(vc - va).dot(normal);
      const double second = (vc - va).cross(vertices[rest[d]] - va).dot(normal);
      return std::min(first, second);
    };
    const double along_02 = worst(0, 1, 2, 3), along_13 = worst(1, 2, 3, 0);
    const bool both_fold_free = along_02 > 0 && along_13 > 0;
    const bool is_13_shorter =
        (vertices[rest[1]] - vertices[rest[3]]).squaredNorm() < (vertices[rest[0]] - vertices[rest[2]]).squaredNorm();
    const bool use_13 = both_fold_free ? is_13_shorter : along_13 > along_02;
    if (use_13) rest = {rest[1], rest[2], rest[3], rest[0]};
  } else if (rest.size() > 4) {
    const Eigen::Vector3d normal = AreaVector(vertices, rest);
    bool found = true;
    // A file may hold polygons as large as itself: what costs too much becomes a fan.
    size_t num_tests_left = kMaxTestsPerVertex * rest.size();
    while (rest.size() > 3 && found) {
      found = false;
      for (size_t i = 0; i < rest.size() && !found && num_tests_left >= rest.size(); ++i) {
        num_tests_left -= rest.size();
        if (!IsEar(vertices, rest, i, normal)) continue;
        const size_t n = rest.size();
        faces.emplace_back(rest[(i + n - 1) % n], rest[i], rest[(i + 1) % n]);
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
        found = true;
      }
    }
  }
  for (size_t i = 1; i + 1 < rest.size(); ++i) faces.emplace_back(rest[0], rest[i], rest[i + 1]);
}

void AppendCheckedPolygon(TriangleMesh& mesh, const std::vector<int>& indices, const std::filesystem::path& path,
                          std::string_view kind, uint64_t number) {
  for (const int index : indices) {
    if (index < 0 || index >= static_cast<int>(mesh.vertices.size())) {
      throw InputError(path.string(), fmt::format("{} {}", kind, number),
                       fmt::format("expected vertex indices below {}, found {}", mesh.vertices.size(), index));
    }
  }
  if (indices.size() == 3) {
    mesh.faces.emplace_back(indices[0], indices[1], indices[2]);
  } else if (indices.size() > 3) {
    AppendPolygon(mesh.vertices, indices, mesh.faces);
  }
}

}  // namespace glint::internal
