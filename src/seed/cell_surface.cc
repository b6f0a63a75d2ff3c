#include "seed/cell_surface.h"

#include <numeric>

#include "core/check.h"

namespace glint {
namespace {

struct Facet {
  int cell, corner;  // the inside cell, and its corner opposite to the facet
};

// Union-find over the corners of the faces (3 a face): corners of one fan become one vertex.
class CornerSets {
 public:
  explicit CornerSets(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  int Find(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  // The smaller index stays the root, so that the result does not depend on the order of joining.
  void Join(int a, int b) {
    a = Find(a);
    b = Find(b);
    if (a < b)
      parent_[b] = a;
    else
      parent_[a] = b;
  }

 private:
  std::vector<int> parent_;
};

// Turns around the edge (p, q) from a border facet through inside cells to the next border facet.
Facet NextAcrossEdge(const Tetrahedra& t, const std::vector<uint8_t>& labels, Facet facet, int p, int q) {
  for (size_t guard = 0; guard <= t.cells.size(); ++guard) {
    // The other facet of this cell that has the edge lies opposite to the corner that is on neither.
    int other = 0;
    while (other == facet.corner || t.cells[facet.cell][other] == p || t.cells[facet.cell][other] == q) ++other;
    // `other` is the facet's own third corner: the facet opposite to it holds p, q and the old opposite corner.
    const int next = t.neighbors[facet.cell][other];
    if (!labels[next]) return {facet.cell, other};
    int back = 0;
    while (t.neighbors[next][back] != facet.cell) ++back;
    facet = {next, back};
  }
  GLINT_CHECK(false);
  return facet;
}

}  // namespace

TriangleMesh CellSurface(const Tetrahedra& tetrahedra, const std::vector<uint8_t>& labels,
                         std::vector<int>* vertex_point) {
  GLINT_CHECK_EQ(labels.size(), tetrahedra.cells.size());
  std::vector<Facet> facets;
  std::vector<std::array<int, 4>> face_of(labels.size(), {-1, -1, -1, -1});
  for (int c = 0; c < static_cast<int>(labels.size()); ++c)
    for (int k = 0; k < 4; ++k)
      if (labels[c] && !labels[tetrahedra.neighbors[c][k]]) {
        face_of[c][k] = static_cast<int>(facets.size());
        facets.push_back({c, k});
      }
  auto point_at = [&](int face, int i) {
    return tetrahedra.cells[facets[face].cell][kOutwardFacet[facets[face].corner][i]];
  };
  CornerSets corners(3 * facets.size());
  for (int f = 0; f < static_cast<int>(facets.size()); ++f)
    for (int i = 0; i < 3; ++i) {
      const int p = point_at(f, i), q = point_at(f, (i + 1) % 3);
      const Facet mate = NextAcrossEdge(tetrahedra, labels, facets[f], p, q);
      const int g = face_of[mate.cell][mate.corner];
      for (int j = 0; j < 3; ++j) {
        if (point_at(g, j) == p) corners.Join(3 * f + i, 3 * g + j);
        if (point_at(g, j) == q) corners.Join(3 * f + (i + 1) % 3, 3 * g + j);
      }
    }
  TriangleMesh mesh;
  if (vertex_point) vertex_point->clear();
  std::vector<int> vertex_of(3 * facets.size(), -1);
  for (int f = 0; f < static_cast<int>(facets.size()); ++f) {
    Eigen::Vector3i face;
    for (int i = 0; i < 3; ++i) {
      int& vertex = vertex_of[corners.Find(3 * f + i)];
      if (vertex < 0) {
        vertex = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(tetrahedra.points[point_at(f, i)]);
        if (vertex_point) vertex_point->push_back(point_at(f, i));
      }
      face[i] = vertex;
    }
    mesh.faces.push_back(face);
  }
  return mesh;
}

}  // namespace glint
