#include "photometry/materials.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/median.h"

namespace glint {
namespace {

constexpr double kCell = 0.02;    // of the histogram
constexpr double kRadius = 0.05;  // of a material in chromaticity: its shadows take the colour of the surroundings
constexpr double kLeastShare = 0.05;

using Cell = std::pair<int, int>;

Eigen::Vector2d Chromaticity(const SurfacePatch& patch) {
  Eigen::Array3d rgb;
  for (int c = 0; c < 3; ++c) {
    std::vector<double> values;
    for (const PatchLook& look : patch.looks) values.push_back(look.rgb[c]);
    rgb[c] = Median(values);
  }
  const double sum = std::max(rgb.sum(), 1e-9);
  return {rgb[0] / sum, rgb[1] / sum};
}

Cell CellOf(const Eigen::Vector2d& chromaticity) {
  return {static_cast<int>(std::floor(chromaticity.x() / kCell)),
          static_cast<int>(std::floor(chromaticity.y() / kCell))};
}

// The mean chromaticity about the fullest place of the histogram.
Eigen::Vector2d Mode(const std::vector<std::pair<size_t, Eigen::Vector2d>>& left) {
  std::map<Cell, int> count;
  for (const auto& [patch, chromaticity] : left)
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j) {
        const Cell cell = CellOf(chromaticity);
        ++count[{cell.first + i, cell.second + j}];
      }
  const auto fullest =
      std::max_element(count.begin(), count.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  const Eigen::Vector2d middle((fullest->first.first + 0.5) * kCell, (fullest->first.second + 0.5) * kCell);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int members = 0;
  for (const auto& [patch, chromaticity] : left)
    if ((chromaticity - middle).norm() < kRadius) sum += chromaticity, ++members;
  return members > 0 ? Eigen::Vector2d(sum / members) : middle;
}

}  // namespace

std::vector<std::vector<size_t>> SortIntoMaterials(const std::vector<SurfacePatch>& patches) {
  std::vector<std::pair<size_t, Eigen::Vector2d>> left;
  for (size_t i = 0; i < patches.size(); ++i)
    if (!patches[i].looks.empty()) left.emplace_back(i, Chromaticity(patches[i]));
  const auto least = static_cast<size_t>(kLeastShare * static_cast<double>(left.size()));
  std::vector<std::vector<size_t>> materials;
  while (left.size() > least) {
    const Eigen::Vector2d mode = Mode(left);
    std::vector<size_t> material;
    std::vector<std::pair<size_t, Eigen::Vector2d>> rest;
    for (const auto& entry : left) {
      if ((entry.second - mode).norm() < kRadius)
        material.push_back(entry.first);
      else
        rest.push_back(entry);
    }
    if (material.size() <= least) break;
    materials.push_back(std::move(material));
    left = std::move(rest);
  }
  return materials;
}

}  // namespace glint
