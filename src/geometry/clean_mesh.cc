#include "geometry/clean_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

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

// For every vertex the lowest vertex at exactly its position. Vertices are dealt out to buckets by their hash, in
// order, and compared within them: linear time.
std::vector<uint32_t> Representatives(const std::vector<Eigen::Vector3d>& vertices) {
  struct Entry {
    uint64_t hash;
    uint32_t vertex;
  };
  const size_t count = vertices.size(), num_buckets = std::bit_ceil(count / 512 + 1);
  const int shift = 64 - std::bit_width(num_buckets - 1);
  const auto bucket_of = [&](uint64_t hash) { return num_buckets > 1 ? hash >> shift : 0; };
  const size_t num_chunks = std::clamp<size_t>(count / 65536, 1, 64), chunk = (count + num_chunks - 1) / num_chunks;
  std::vector<uint64_t> hashes(count);
  std::vector<uint32_t> next(num_chunks * num_buckets, 0);  // of each chunk in each bucket: how many, then where
  ParallelFor(num_chunks, 1, [&](size_t c) {
    for (size_t v = c * chunk; v < std::min(count, (c + 1) * chunk); ++v)
      ++next[c * num_buckets + bucket_of(hashes[v] = Hash(vertices[v]))];
  });
  std::vector<uint32_t> first(num_buckets + 1, 0);
  for (size_t b = 0; b < num_buckets; ++b) {
    first[b + 1] = first[b];
    for (size_t c = 0; c < num_chunks; ++c) first[b + 1] += std::exchange(next[c * num_buckets + b], first[b + 1]);
  }
  std::vector<Entry> entries(count);
  ParallelFor(num_chunks, 1, [&](size_t c) {
    for (size_t v = c * chunk; v < std::min(count, (c + 1) * chunk); ++v)
      entries[next[c * num_buckets + bucket_of(hashes[v])]++] = {hashes[v], static_cast<uint32_t>(v)};
  });
  std::vector<uint32_t> representative(count);
  ParallelFor(num_buckets, 16, [&](size_t b) {
    const auto begin = entries.begin() + first[b], end = entries.begin() + first[b + 1];
    std::sort(begin, end,
              [](const Entry& x, const Entry& y) { return x.hash != y.hash ? x.hash < y.hash : x.vertex < y.vertex; });
    auto same = begin;  // the first of this hash
    for (auto i = begin; i != end; ++i) {
      if (i->hash != same->hash) same = i;
      const Eigen::Vector3d& x = vertices[i->vertex];
      auto j = x.hasNaN() ? i : same;  // NaN differs from itself, and from all others
      while (j != i && vertices[j->vertex] != x) ++j;
      representative[i->vertex] = j->vertex;
    }
  });
  return representative;
}

// Whether face f can be used; if `complain`, throws InputError where it cannot.
bool IsSound(const TriangleMesh& mesh, size_t f, bool complain) {
  const int num_vertices = static_cast<int>(mesh.vertices.size());
  for (int k = 0; k < 3; ++k) {
    const int v = mesh.faces[f][k];
    if (v < 0 || v >= num_vertices) {
      if (complain)
        throw InputError("", fmt::format("face {}", f),
                         fmt::format("expected vertex indices in 0 … {}, found {}", num_vertices - 1, v));
      return false;
    }
    const Eigen::Vector3d& x = mesh.vertices[v];
    if (x.allFinite() && x.cwiseAbs().maxCoeff() <= 1e100) continue;
    if (complain)
      throw InputError("", fmt::format("vertex {}", v),
                       fmt::format("expected finite coordinates below 1e100, found ({}, {}, {})", x[0], x[1], x[2]));
    return false;
  }
  return true;
}

}  // namespace

void CheckMesh(const TriangleMesh& mesh) {
  if (mesh.faces.empty()) throw InputError("", "mesh", "expected at least one triangle, found none");
  const size_t bad = ParallelSum(mesh.faces.size(), 16384, size_t{0}, [&](size_t begin, size_t end) {
    size_t part = 0;
    for (size_t f = begin; f < end; ++f) part += !IsSound(mesh, f, false);
    return part;
  });
  for (size_t f = 0; bad > 0 && f < mesh.faces.size(); ++f) IsSound(mesh, f, true);  // names the first
}

CleanMesh Clean(const TriangleMesh& mesh) {
  CheckMesh(mesh);
  CleanMesh out;
  const size_t num_faces = mesh.faces.size(), num_vertices = mesh.vertices.size();
  const std::vector<uint32_t> representative = Representatives(mesh.vertices);
  std::vector<int> new_index(num_vertices, -1);
  for (size_t v = 0; v < num_vertices; ++v) out.welded_vertices += representative[v] != v;
  out.mesh.faces.resize(num_faces);
  out.source_face.resize(num_faces);
  ParallelFor(num_faces, 16384, [&](size_t f) {
    Eigen::Vector3i& face = out.mesh.faces[f];
    for (int k = 0; k < 3; ++k) face[k] = static_cast<int>(representative[mesh.faces[f][k]]);
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) {
      face[0] = -1;  // collapsed
      return;
    }
    for (int k = 0; k < 3; ++k) std::atomic_ref<int>(new_index[face[k]]).store(0, std::memory_order_relaxed);
  });
  size_t kept = 0;
  for (size_t f = 0; f < num_faces; ++f) {
    if (out.mesh.faces[f][0] < 0) continue;
    out.source_face[kept] = static_cast<uint32_t>(f);
    out.mesh.faces[kept++] = out.mesh.faces[f];
  }
  out.mesh.faces.resize(kept);
  out.source_face.resize(kept);
  out.collapsed_faces = num_faces - kept;
  out.mesh.vertices.reserve(num_vertices);
  for (size_t v = 0; v < num_vertices; ++v) {
    if (new_index[v] < 0) continue;
    new_index[v] = static_cast<int>(out.mesh.vertices.size());
    out.mesh.vertices.push_back(mesh.vertices[v]);
  }
  ParallelFor(kept, 16384, [&](size_t f) {
    for (int k = 0; k < 3; ++k) out.mesh.faces[f][k] = new_index[out.mesh.faces[f][k]];
  });
  return out;
}

}  // namespace glint
