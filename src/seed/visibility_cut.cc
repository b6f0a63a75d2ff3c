#include "seed/visibility_cut.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "seed/min_cut.h"

namespace glint {
namespace {

// Cosine of the angle between the facet's plane and the cell's circumsphere, negative where the centre lies beyond
// the facet: the flatter the sphere meets the facet, the less the facet looks like a piece of surface.
double CosToCircumsphere(const Tetrahedra& t, int cell, int facet) {
  const Eigen::Vector3d a = t.Corner(cell, kOutwardFacet[facet][0]);
  const Eigen::Vector3d n =
      (t.Corner(cell, kOutwardFacet[facet][1]) - a).cross(t.Corner(cell, kOutwardFacet[facet][2]) - a).normalized();
  const Eigen::Vector3d center = t.Circumcenter(cell);
  const double radius = (center - a).norm();
  const double cosine = (a - center).dot(n) / radius;
  return std::isfinite(cosine) ? std::clamp(cosine, -1.0, 1.0) : 0;  // a cell flat up to rounding
}

double FacetCost(const Tetrahedra& t, int cell, int facet, int other, int other_facet) {
  double worst = 1;
  if (!t.IsInfinite(cell)) worst = std::min(worst, CosToCircumsphere(t, cell, facet));
  if (!t.IsInfinite(other)) worst = std::min(worst, CosToCircumsphere(t, other, other_facet));
  return 1 - worst;
}

}  // namespace

void CutOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "quality",
           .help = "Cost of a badly shaped facet of the sparse surface",
           .unit = "lines of sight",
           .min = 0,
           .max = 1e3},
          quality);
  v.Field({.name = "fill",
           .help = "How strongly space that no line of sight crosses is taken for matter",
           .unit = "lines of sight",
           .min = 0,
           .max = 1e3},
          fill);
  v.Field(
      {.name = "see_through",
       .help = "The object is of glass: lines of sight end behind it, so its surface is the convex hull of its points"},
      see_through);
}

std::vector<uint8_t> CutCells(const Tetrahedra& tetrahedra, const RayVotes& votes,
                              const std::vector<uint8_t>& may_be_inside, const CutOptions& options, double claim) {
  const size_t num_cells = tetrahedra.cells.size();
  GLINT_CHECK_EQ(may_be_inside.size(), num_cells);
  if (num_cells == 0) return {};
  CutGraph graph;
  graph.source_capacity.assign(num_cells, 0);
  graph.sink_capacity.assign(num_cells, 0);
  int64_t everything = 1;  // more than any cut that respects it can cost
  const int64_t fill = std::llround(options.fill * kVote), any = std::llround(claim * kVote);
  for (size_t c = 0; c < num_cells; ++c) {
    const bool unseen = votes.crossed[c] == 0 && votes.outside[c] == 0;
    graph.source_capacity[c] = votes.outside[c];
    graph.sink_capacity[c] = votes.inside[c] + (unseen ? fill : 0) + any;
    everything += graph.sink_capacity[c];
  }
  for (size_t c = 0; c < num_cells; ++c)
    if (!may_be_inside[c] || tetrahedra.IsInfinite(static_cast<int>(c))) graph.source_capacity[c] = everything;
  for (int c = 0; c < static_cast<int>(num_cells); ++c)
    for (int k = 0; k < 4; ++k) {
      const int next = tetrahedra.neighbors[c][k];
      if (next < c) continue;
      int back = 0;
      while (back < 3 && tetrahedra.neighbors[next][back] != c) ++back;
      // Lines that go from c into next have their camera on next's side: they forbid next outside, c inside.
      const int64_t quality = std::llround(options.quality * kVote * FacetCost(tetrahedra, c, k, next, back));
      graph.edges.push_back({c, next, votes.facets[next][back] + quality, votes.facets[c][k] + quality});
    }
  std::vector<uint8_t> labels = MinCut(graph);
  for (size_t c = 0; c < num_cells; ++c) {
    labels[c] = 1 - labels[c];
    GLINT_CHECK(may_be_inside[c] || !labels[c]);
    GLINT_CHECK(!labels[c] || !tetrahedra.IsInfinite(static_cast<int>(c)));
  }
  return labels;
}

CellComponents ConnectedCells(const Tetrahedra& tetrahedra, const std::vector<uint8_t>& labels) {
  CellComponents out;
  out.component.assign(labels.size(), -1);
  std::vector<int> stack;
  for (size_t seed = 0; seed < labels.size(); ++seed) {
    if (!labels[seed] || out.component[seed] >= 0) continue;
    stack.assign(1, static_cast<int>(seed));
    out.component[seed] = out.count;
    while (!stack.empty()) {
      const int c = stack.back();
      stack.pop_back();
      for (int next : tetrahedra.neighbors[c])
        if (labels[next] && out.component[next] < 0) {
          out.component[next] = out.count;
          stack.push_back(next);
        }
    }
    ++out.count;
  }
  return out;
}

}  // namespace glint
