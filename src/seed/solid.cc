#include "seed/solid.h"

#include <algorithm>
#include <array>
#include <utility>

namespace glint {
namespace {

// The claim of matter on every cell, as a share of the lines of sight of a point: none, as published, unless that
// leaves many points without a surface. Few points, or those of thin walls, are corners of long cells that reach across
// the free space beside the matter; the lines through that space then take all of it away.
constexpr std::array<double, 4> kClaims = {0, 0.25, 1, 4};
constexpr double kEnoughPoints = 0.95;  // share of the object's points that the solid explains
constexpr double kManyMore = 0.1;       // of the points: what a larger claim must win

// Space that the object encloses entirely is matter: nobody has looked in.
void FillCavities(const Tetrahedra& t, std::vector<uint8_t>& labels) {
  std::vector<uint8_t> empty(labels.size());
  for (size_t c = 0; c < labels.size(); ++c) empty[c] = 1 - labels[c];
  const CellComponents spaces = ConnectedCells(t, empty);
  std::vector<uint8_t> open(spaces.count, 0);
  for (int c = 0; c < static_cast<int>(labels.size()); ++c)
    if (spaces.component[c] >= 0 && t.IsInfinite(c)) open[spaces.component[c]] = 1;
  for (size_t c = 0; c < labels.size(); ++c)
    if (spaces.component[c] >= 0 && !open[spaces.component[c]]) labels[c] = 1;
}

// How many of the object's points the solid explains: fully those on its surface, half those within it, which more or
// better views may yet uncover, not at all those outside.
double PointsExplained(const SparseCells& cells, const std::vector<uint8_t>& labels) {
  const Tetrahedra& t = cells.tetrahedra;
  std::vector<uint8_t> matter(t.points.size(), 0), space(t.points.size(), 0);
  for (int c = 0; c < static_cast<int>(t.cells.size()); ++c)
    for (const int v : t.cells[c])
      if (v >= 0) (labels[c] ? matter : space)[v] = 1;
  double explained = 0;
  for (size_t v = 0; v < matter.size(); ++v)
    if (cells.scene_point[v] >= 0 && matter[v]) explained += space[v] ? 1 : 0.5;
  return explained;
}

// How many points' lines of sight end behind matter.
double PointsHidden(const SparseCells& cells, const std::vector<uint8_t>& labels, double views) {
  const Tetrahedra& t = cells.tetrahedra;
  int64_t votes = 0;
  for (size_t c = 0; c < labels.size(); ++c)
    for (int k = 0; k < 4 && labels[c]; ++k)
      if (!labels[t.neighbors[c][k]]) votes += cells.votes.facets[c][k];
  return static_cast<double>(votes) / static_cast<double>(kVote) / std::max(views, 1.0);
}

}  // namespace

std::vector<uint8_t> Permitted(const SparseCells& cells, const ObjectChoice& choice) {
  const Tetrahedra& t = cells.tetrahedra;
  std::vector<uint8_t> permitted(t.cells.size(), 0);
  for (int c = 0; c < static_cast<int>(t.cells.size()); ++c) {
    if (t.IsInfinite(c)) continue;
    const bool object = std::any_of(t.cells[c].begin(), t.cells[c].end(), [&](int v) {
      return cells.scene_point[v] >= 0 || cells.scene_point[v] <= kFirstRimVertex;
    });
    permitted[c] = object && (!choice.ground || choice.ground->plane.signedDistance(t.Centroid(c)) > 0);
  }
  return permitted;
}

void KeepLargest(const Tetrahedra& t, std::vector<uint8_t>& labels) {
  const CellComponents pieces = ConnectedCells(t, labels);
  std::vector<double> volume(pieces.count, 0.0);
  for (int c = 0; c < static_cast<int>(labels.size()); ++c)
    if (pieces.component[c] >= 0) volume[pieces.component[c]] += t.Volume(c);
  if (volume.empty()) return;
  const int largest = static_cast<int>(std::max_element(volume.begin(), volume.end()) - volume.begin());
  for (size_t c = 0; c < labels.size(); ++c) labels[c] = pieces.component[c] == largest;
}

Solid BestSolid(const SparseCells& cells, const ObjectChoice& choice, const CutOptions& options, double num_points,
                double views_per_point) {
  const Tetrahedra& t = cells.tetrahedra;
  const std::vector<uint8_t> permitted = Permitted(cells, choice);
  Solid best;
  for (const double claim : kClaims) {
    std::vector<uint8_t> labels = CutCells(t, cells.votes, permitted, options, claim * views_per_point);
    KeepLargest(t, labels);
    FillCavities(t, labels);
    const double explained = PointsExplained(cells, labels);
    if (!best.labels.empty() && explained < best.explained + kManyMore * num_points) continue;
    best = {std::move(labels), explained, 0};
    if (explained >= kEnoughPoints * num_points) break;
  }
  best.hidden = PointsHidden(cells, best.labels, views_per_point);
  return best;
}

}  // namespace glint
