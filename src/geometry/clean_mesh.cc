#include "geometry/clean_mesh.h"

#include <fmt/format.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "core/parallel.h"

namespace glint {

namespace {

uint64_t Hash(const Eigen::Vector3d& v) {
  uint64_t hash = 0x9e3779b97f4a7c15ull;
  for (int k = 0; k < 3; ++k) {
    const double x = v[k] + 0.0;  // -0 becomes 0
    uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    hash = (hash ^ bits) * 0xff51afd7ed558ccdull;
    hash ^= hash >> 32;
  }
  return hash;
}

// For every vertex the lowest vertex at exactly its position.
std::vector<uint32_t> Representatives(const std::vector<Eigen::Vector3d>& vertices) {
  std::vector<std::pair<uint64_t, uint32_t>> order(vertices.size());
  ParallelFor(vertices.size(), 8192, [&](size_t v) { order[v] = {Hash(vertices[v]), static_cast<uint32_t>(v)}; });
  tbb::parallel_sort(order.begin(), order.end());
  std::vector<uint32_t> representative(vertices.size());
  for (size_t begin = 0; begin < order.size();) {
    size_t end = begin;
    while (end < order.size() && order[end].first == order[begin].first) ++end;
    for (size_t i = begin; i < end; ++i) {
      size_t j = begin;
      while (j < i && vertices[order[j].second] != vertices[order[i].second]) ++j;  // NaN differs from itself
      representative[order[i].second] = order[j].second;
    }
    begin = end;
  }
  return representative;
}

}  // namespace

void CheckMesh(const TriangleMesh& mesh) {
  if (mesh.faces.empty()) throw InputError("", "mesh", "expected at least one triangle, found none");
  const int num_vertices = static_cast<int>(mesh.vertices.size());
  for (size_t f = 0; f < mesh.faces.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int v = mesh.faces[f][k];
      if (v < 0 || v >= num_vertices)
        throw InputError("", fmt::format("face {}", f),
                         fmt::format("expected vertex indices in 0 … {}, found {}", num_vertices - 1, v));
      const Eigen::Vector3d& x = mesh.vertices[v];
      if (!x.allFinite() || x.cwiseAbs().maxCoeff() > 1e100)
        throw InputError("", fmt::format("vertex {}", v),
                         fmt::format("expected finite coordinates, found ({}, {}, {})", x[0], x[1], x[2]));
    }
}

CleanMesh Clean(const TriangleMesh& mesh) {
  CheckMesh(mesh);
  CleanMesh out;
  const std::vector<uint32_t> representative = Representatives(mesh.vertices);
  std::vector<int> new_index(mesh.vertices.size(), -1);
  for (size_t v = 0; v < mesh.vertices.size(); ++v) out.welded_vertices += representative[v] != v;
  out.mesh.faces.reserve(mesh.faces.size());
  out.source_face.reserve(mesh.faces.size());
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    Eigen::Vector3i face;
    for (int k = 0; k < 3; ++k) face[k] = static_cast<int>(representative[mesh.faces[f][k]]);
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) {
      ++out.collapsed_faces;
      continue;
    }
    out.mesh.faces.push_back(face);
    out.source_face.push_back(static_cast<uint32_t>(f));
    for (int k = 0; k < 3; ++k) new_index[face[k]] = 0;
  }
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (new_index[v] < 0) continue;
    new_index[v] = static_cast<int>(out.mesh.vertices.size());
    out.mesh.vertices.push_back(mesh.vertices[v]);
  }
  for (Eigen::Vector3i& face : out.mesh.faces)
    for (int k = 0; k < 3; ++k) face[k] = new_index[face[k]];
  return out;
}

}  // namespace glint
