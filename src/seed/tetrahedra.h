// A 3D Delaunay triangulation as plain arrays.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace glint {

inline constexpr int kInfiniteVertex = -1;

// The corners of the facet opposite to corner k, counter-clockwise seen from outside of the cell.
inline constexpr std::array<std::array<int, 3>, 4> kOutwardFacet = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

// Cells cover all of space: the infinite ones (one corner is kInfiniteVertex) stand outside of the convex hull.
// neighbors[c][k] is the cell across the facet opposite to corner k. Finite cells are positively oriented:
// det(v1 - v0, v2 - v0, v3 - v0) > 0.
struct Tetrahedra {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<int, 4>> cells;
  std::vector<std::array<int, 4>> neighbors;
  std::vector<int> vertex_of_point;  // the point that stands for it: itself unless it duplicates another
  std::vector<int> cell_of_point;    // one cell that has the point; -1 for a duplicate

  bool IsInfinite(int cell) const;
  int CornerOf(int cell, int point) const;  // -1 if the cell has no such corner
  Eigen::Vector3d Corner(int cell, int k) const { return points[cells[cell][k]]; }
  double Volume(int cell) const;                  // 0 for an infinite cell
  Eigen::Vector3d Centroid(int cell) const;       // of a finite cell
  Eigen::Vector3d Circumcenter(int cell) const;   // of a finite cell
  std::vector<int> CellsAround(int point) const;  // in a deterministic order
};

// Exact predicates. Fewer than four points, or all of them in one plane: no cells.
Tetrahedra DelaunayTetrahedra(const std::vector<Eigen::Vector3d>& points);

}  // namespace glint
