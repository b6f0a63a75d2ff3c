#include "seed/tetrahedra.h"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>

namespace glint {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<int, Kernel>;
using CellBase =
    CGAL::Triangulation_cell_base_with_info_3<int, Kernel, CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
using Delaunay = CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<VertexBase, CellBase>>;

}  // namespace

bool Tetrahedra::IsInfinite(int cell) const { return CornerOf(cell, kInfiniteVertex) >= 0; }

int Tetrahedra::CornerOf(int cell, int point) const {
  for (int k = 0; k < 4; ++k)
    if (cells[cell][k] == point) return k;
  return -1;
}

double Tetrahedra::Volume(int cell) const {
  if (IsInfinite(cell)) return 0;
  const Eigen::Vector3d a = Corner(cell, 0);
  return (Corner(cell, 1) - a).cross(Corner(cell, 2) - a).dot(Corner(cell, 3) - a) / 6;
}

Eigen::Vector3d Tetrahedra::Centroid(int cell) const {
  return (Corner(cell, 0) + Corner(cell, 1) + Corner(cell, 2) + Corner(cell, 3)) / 4;
}

Eigen::Vector3d Tetrahedra::Circumcenter(int cell) const {
  const Eigen::Vector3d a = Corner(cell, 0);
  const Eigen::Vector3d b = Corner(cell, 1) - a, c = Corner(cell, 2) - a, d = Corner(cell, 3) - a;
  const double volume6 = b.cross(c).dot(d);
  if (!(volume6 > 0)) return Centroid(cell);
  return a +
         (b.squaredNorm() * c.cross(d) + c.squaredNorm() * d.cross(b) + d.squaredNorm() * b.cross(c)) / (2 * volume6);
}

std::vector<int> Tetrahedra::CellsAround(int point) const {
  std::vector<int> around;
  if (cell_of_point[point] < 0) return around;
  around.push_back(cell_of_point[point]);
  for (size_t i = 0; i < around.size(); ++i) {
    const int cell = around[i];
    for (int k = 0; k < 4; ++k) {
      const int next = neighbors[cell][k];
      if (cells[cell][k] == point || std::find(around.begin(), around.end(), next) != around.end()) continue;
      around.push_back(next);
    }
  }
  return around;
}

Tetrahedra DelaunayTetrahedra(const std::vector<Eigen::Vector3d>& points) {
  Tetrahedra out;
  out.points = points;
  out.vertex_of_point.assign(points.size(), -1);
  out.cell_of_point.assign(points.size(), -1);

  std::vector<std::pair<Kernel::Point_3, int>> input;
  for (size_t i = 0; i < points.size(); ++i)
    input.emplace_back(Kernel::Point_3(points[i].x(), points[i].y(), points[i].z()), static_cast<int>(i));
  // Of equal points the first stays: CGAL would keep the index it happens to insert last.
  std::stable_sort(input.begin(), input.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (size_t i = 0; i < input.size(); ++i)
    out.vertex_of_point[input[i].second] =
        i > 0 && input[i].first == input[i - 1].first ? out.vertex_of_point[input[i - 1].second] : input[i].second;
  std::erase_if(input, [&](const auto& p) { return out.vertex_of_point[p.second] != p.second; });

  const Delaunay delaunay(input.begin(), input.end());
  if (delaunay.dimension() < 3) return out;
  int index = 0;
  for (const auto& cell : delaunay.all_cell_handles()) cell->info() = index++;
  out.cells.resize(index);
  out.neighbors.resize(index);
  for (const auto& cell : delaunay.all_cell_handles()) {
    const int c = cell->info();
    for (int k = 0; k < 4; ++k) {
      const auto vertex = cell->vertex(k);
      out.cells[c][k] = delaunay.is_infinite(vertex) ? kInfiniteVertex : vertex->info();
      out.neighbors[c][k] = cell->neighbor(k)->info();
    }
    for (int v : out.cells[c])
      if (v >= 0 && out.cell_of_point[v] < 0) out.cell_of_point[v] = c;
  }
  return out;
}

}  // namespace glint
