#include "tests/benchmark/sdf/truth.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/closest_point.h"

namespace glint::benchmark {

BruteForce::BruteForce(const TriangleMesh& mesh) : mesh_(mesh) {
  for (const Eigen::Vector3i& f : mesh.faces) {
    const Eigen::Vector3d &a = mesh.vertices[f[0]], &b = mesh.vertices[f[1]], &c = mesh.vertices[f[2]];
    const Eigen::Vector3d m = (a + b + c) / 3;
    x_.push_back(m[0]), y_.push_back(m[1]), z_.push_back(m[2]);
    radius_.push_back(std::max({(a - m).norm(), (b - m).norm(), (c - m).norm()}) + 1e-12 * (1 + m.norm()));
  }
}

double BruteForce::Distance(const Eigen::Vector3d& p) const {
  const auto triangle = [&](size_t f) {
    const Eigen::Vector3i& v = mesh_.faces[f];
    return ClosestOnTriangle(mesh_.vertices[v[0]], mesh_.vertices[v[1]], mesh_.vertices[v[2]], p).squared_distance;
  };
  constexpr size_t kChunk = 512;
  double best = std::numeric_limits<double>::infinity(), limit = best;
  double beyond[kChunk];
  for (size_t begin = 0; begin < radius_.size(); begin += kChunk) {
    const size_t n = std::min(kChunk, radius_.size() - begin);
    for (size_t i = 0; i < n; ++i) {
      const size_t f = begin + i;
      const double dx = x_[f] - p[0], dy = y_[f] - p[1], dz = z_[f] - p[2], reach = limit + radius_[f];
      beyond[i] = dx * dx + dy * dy + dz * dz - reach * reach;
    }
    for (size_t i = 0; i < n; ++i) {
      if (beyond[i] > 0) continue;
      best = std::min(best, triangle(begin + i));
      limit = std::sqrt(best) * (1 + 1e-12);
    }
  }
  return std::sqrt(best);
}

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

struct ExactSides::Impl {
  const TriangleMesh& mesh;
  Eigen::Vector2d low, cell;
  int dim = 1;
  std::vector<size_t> first;
  std::vector<uint32_t> faces;

  int CellOf(double x, int axis) const {
    return static_cast<int>(std::clamp((x - low[axis]) / cell[axis], 0.0, dim - 1.0));
  }

  template <class Visit>
  void ForCells(size_t f, const Visit& visit) const {
    Eigen::AlignedBox3d box;
    for (int k = 0; k < 3; ++k) box.extend(mesh.vertices[mesh.faces[f][k]]);
    for (int i = CellOf(box.min()[0], 0); i <= CellOf(box.max()[0], 0); ++i)
      for (int j = CellOf(box.min()[1], 1); j <= CellOf(box.max()[1], 1); ++j)
        visit(size_t(i) * size_t(dim) + size_t(j));
  }

  // On which side of the line from a to b, both projected, the point (x + ε, y + ε²) is: 0 only if they coincide.
  static int Side(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double x, double y) {
    const int side = CGAL::orientation(Kernel::Point_2(a[0], a[1]), Kernel::Point_2(b[0], b[1]), Kernel::Point_2(x, y));
    if (side != 0) return side;
    if (a[1] != b[1]) return a[1] > b[1] ? 1 : -1;
    return b[0] > a[0] ? 1 : b[0] < a[0] ? -1 : 0;
  }
};

ExactSides::ExactSides(const TriangleMesh& mesh) : impl_(new Impl{mesh, {}, {}, 1, {}, {}}) {
  Impl& self = *impl_;
  const Eigen::AlignedBox3d box = BoundingBox(mesh);
  self.dim = static_cast<int>(std::clamp(std::sqrt(static_cast<double>(mesh.faces.size())), 1.0, 4096.0));
  self.low = box.min().head<2>();
  self.cell = (box.sizes().head<2>() / self.dim).cwiseMax(1e-300);
  self.first.assign(size_t(self.dim) * size_t(self.dim) + 1, 0);
  for (size_t f = 0; f < mesh.faces.size(); ++f) self.ForCells(f, [&](size_t c) { ++self.first[c + 1]; });
  for (size_t c = 1; c < self.first.size(); ++c) self.first[c] += self.first[c - 1];
  self.faces.resize(self.first.back());
  std::vector<size_t> next(self.first.begin(), self.first.end() - 1);
  for (size_t f = 0; f < mesh.faces.size(); ++f)
    self.ForCells(f, [&](size_t c) { self.faces[next[c]++] = static_cast<uint32_t>(f); });
}

ExactSides::~ExactSides() = default;

void ExactSides::Column(double x, double y, const double* z, int count, int* winding) const {
  const Impl& self = *impl_;
  std::fill(winding, winding + count, 0);
  // Beyond the box the cells at its rim are looked at, in vain.
  const size_t cell = size_t(self.CellOf(x, 0)) * size_t(self.dim) + size_t(self.CellOf(y, 1));
  for (size_t i = self.first[cell]; i < self.first[cell + 1]; ++i) {
    const Eigen::Vector3i& v = self.mesh.faces[self.faces[i]];
    const Eigen::Vector3d &a = self.mesh.vertices[v[0]], &b = self.mesh.vertices[v[1]], &c = self.mesh.vertices[v[2]];
    if (x < std::min({a[0], b[0], c[0]}) || x > std::max({a[0], b[0], c[0]}) || y < std::min({a[1], b[1], c[1]}) ||
        y > std::max({a[1], b[1], c[1]}))
      continue;
    const int side = Impl::Side(a, b, x, y);
    if (side == 0 || Impl::Side(b, c, x, y) != side || Impl::Side(c, a, x, y) != side) continue;
    const double top = std::max({a[2], b[2], c[2]}), bottom = std::min({a[2], b[2], c[2]});
    const Kernel::Point_3 pa(a[0], a[1], a[2]), pb(b[0], b[1], b[2]), pc(c[0], c[1], c[2]);
    for (int k = 0; k < count; ++k) {
      if (z[k] > top) continue;
      if (z[k] < bottom) {
        winding[k] += side;
        continue;
      }
      const int above = CGAL::orientation(pa, pb, pc, Kernel::Point_3(x, y, z[k]));
      if (above == 0) winding[k] += kOnSurface;
      if (above == -side) winding[k] += side;
    }
  }
}

}  // namespace glint::benchmark
