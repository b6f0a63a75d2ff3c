#include "seed/cell_surface.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "core/check.h"

namespace glint {
namespace {

constexpr double kPullRel = 1e-3;  // of the shortest edge

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

// The border facets with what joins them. Half edge 3 f + i runs from corner i of facet f to corner i + 1.
struct Border {
  std::vector<Facet> facets;
  std::vector<std::array<int, 3>> points;  // of each facet, counter-clockwise from outside
  std::vector<int> mate;                   // per half edge: the one that runs back along it on the next facet
};

Border FindBorder(const Tetrahedra& t, const std::vector<uint8_t>& labels) {
  Border border;
  std::vector<std::array<int, 4>> facet_of(labels.size(), {-1, -1, -1, -1});
  for (int c = 0; c < static_cast<int>(labels.size()); ++c)
    for (int k = 0; k < 4; ++k) {
      if (!labels[c] || labels[t.neighbors[c][k]]) continue;
      facet_of[c][k] = static_cast<int>(border.facets.size());
      border.facets.push_back({c, k});
      const auto& corner = kOutwardFacet[k];
      border.points.push_back({t.cells[c][corner[0]], t.cells[c][corner[1]], t.cells[c][corner[2]]});
    }
  border.mate.resize(3 * border.facets.size());
  for (size_t f = 0; f < border.facets.size(); ++f)
    for (int i = 0; i < 3; ++i) {
      const int p = border.points[f][i], q = border.points[f][(i + 1) % 3];
      const Facet next = NextAcrossEdge(t, labels, border.facets[f], p, q);
      const int g = facet_of[next.cell][next.corner];
      int j = 0;
      while (border.points[g][j] != q) ++j;
      border.mate[3 * f + i] = 3 * g + j;
    }
  return border;
}

// Vertices of the border: corners of facets that are joined around a point are one.
std::vector<int> NumberVertices(const Border& border, std::vector<int>& point_of_vertex) {
  const int num_corners = static_cast<int>(border.mate.size());
  auto next = [](int h) { return h - h % 3 + (h + 1) % 3; };
  CornerSets corners(num_corners);
  for (int h = 0; h < num_corners; ++h) corners.Join(h, next(border.mate[h]));
  std::vector<int> vertex(num_corners, -1), number(num_corners, -1);
  for (int h = 0; h < num_corners; ++h) {
    int& v = number[corners.Find(h)];
    if (v < 0) {
      v = static_cast<int>(point_of_vertex.size());
      point_of_vertex.push_back(border.points[h / 3][h % 3]);
    }
    vertex[h] = v;
  }
  return vertex;
}

// Per half edge: a new vertex in its middle where the surface runs along the same edge more than once, else −1. Without
// it four faces or more would share an edge of the same two vertices.
std::vector<int> SplitRepeatedEdges(const Border& border, const std::vector<int>& vertex, int num_vertices) {
  const int num_corners = static_cast<int>(border.mate.size());
  std::vector<std::array<int, 3>> edges;  // both ends, and the lower half edge of the pair
  for (int h = 0; h < num_corners; ++h) {
    if (h > border.mate[h]) continue;
    const int a = vertex[h], b = vertex[border.mate[h]];
    edges.push_back({std::min(a, b), std::max(a, b), h});
  }
  std::sort(edges.begin(), edges.end());
  std::vector<int> middle(num_corners, -1);
  for (size_t e = 0; e < edges.size(); ++e) {
    auto same = [&](size_t o) { return edges[o][0] == edges[e][0] && edges[o][1] == edges[e][1]; };
    if (!(e > 0 && same(e - 1)) && !(e + 1 < edges.size() && same(e + 1))) continue;
    middle[edges[e][2]] = middle[border.mate[edges[e][2]]] = num_vertices++;
  }
  return middle;
}

// The triangles of a face with vertices v some of whose edges have a vertex m in the middle (−1: none).
void AddSplitFace(std::array<int, 3> v, std::array<int, 3> m, std::vector<Eigen::Vector3i>& faces) {
  const int count = (m[0] >= 0) + (m[1] >= 0) + (m[2] >= 0);
  if (count == 0) {
    faces.emplace_back(v[0], v[1], v[2]);
    return;
  }
  if (count == 3) {
    for (int i = 0; i < 3; ++i) faces.emplace_back(v[i], m[i], m[(i + 2) % 3]);
    faces.emplace_back(m[0], m[1], m[2]);
    return;
  }
  while (m[0] < 0 || (count == 2 && m[1] < 0)) {
    std::rotate(v.begin(), v.begin() + 1, v.end());
    std::rotate(m.begin(), m.begin() + 1, m.end());
  }
  faces.emplace_back(v[0], m[0], v[2]);
  if (count == 1) {
    faces.emplace_back(m[0], v[1], v[2]);
  } else {
    faces.emplace_back(m[0], v[1], m[1]);
    faces.emplace_back(m[0], m[1], v[2]);
  }
}

// Moves vertices that share a point (or the middle of an edge: −1) a little into their own side, so that readers that
// weld equal positions do not fuse the sheets again.
void PullCopiesApart(const std::vector<Eigen::Vector3d>& points, const std::vector<int>& point_of_vertex,
                     TriangleMesh& mesh) {
  std::vector<int> copies(points.size(), 0);
  for (int p : point_of_vertex)
    if (p >= 0) ++copies[p];
  std::vector<Eigen::Vector3d> inward(mesh.vertices.size(), Eigen::Vector3d::Zero());
  std::vector<double> shortest(mesh.vertices.size(), std::numeric_limits<double>::infinity());
  for (size_t f = 0; f < mesh.faces.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int v = mesh.faces[f][k];
      inward[v] -= FaceNormal(mesh, f);
      shortest[v] = std::min(shortest[v], (mesh.vertices[mesh.faces[f][(k + 1) % 3]] - mesh.vertices[v]).norm());
    }
  for (size_t v = 0; v < mesh.vertices.size(); ++v)
    if (point_of_vertex[v] < 0 || copies[point_of_vertex[v]] > 1)
      mesh.vertices[v] += kPullRel * shortest[v] * inward[v].normalized();
}

}  // namespace

TriangleMesh CellSurface(const Tetrahedra& tetrahedra, const std::vector<uint8_t>& labels,
                         std::vector<int>* vertex_point) {
  GLINT_CHECK_EQ(labels.size(), tetrahedra.cells.size());
  const Border border = FindBorder(tetrahedra, labels);
  std::vector<int> point_of_vertex;
  const std::vector<int> vertex = NumberVertices(border, point_of_vertex);
  const std::vector<int> middle = SplitRepeatedEdges(border, vertex, static_cast<int>(point_of_vertex.size()));
  TriangleMesh mesh;
  for (int p : point_of_vertex) mesh.vertices.push_back(tetrahedra.points[p]);
  for (size_t f = 0; f < border.facets.size(); ++f) {
    for (size_t h = 3 * f; h < 3 * f + 3; ++h) {
      if (middle[h] < 0) continue;
      const size_t needed = static_cast<size_t>(middle[h]) + 1;
      if (mesh.vertices.size() < needed) {
        mesh.vertices.resize(needed);
        point_of_vertex.resize(needed, -1);
      }
      mesh.vertices[middle[h]] = 0.5 * (mesh.vertices[vertex[h]] + mesh.vertices[vertex[border.mate[h]]]);
    }
    AddSplitFace({vertex[3 * f], vertex[3 * f + 1], vertex[3 * f + 2]},
                 {middle[3 * f], middle[3 * f + 1], middle[3 * f + 2]}, mesh.faces);
  }
  PullCopiesApart(tetrahedra.points, point_of_vertex, mesh);
  if (vertex_point) *vertex_point = point_of_vertex;
  return mesh;
}

}  // namespace glint
