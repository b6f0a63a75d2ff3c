// Which contacts and surface points are tied by chords.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace glint {

struct NeighborOptions {
  int count = 12;                 // at most, a contact; spread over the directions of the tangent plane
  double max_normal_angle = 0.6;  // radians
  double max_chord_angle = 0.5;   // radians between a chord and the plane across the mean normal
};

// For every query the indices of up to `count` targets near it, spread over six sectors of its tangent plane so that
// separate tracks of highlights are tied to each other. A target that coincides with its query is left out.
std::vector<std::vector<int>> SectorNeighbors(const std::vector<Eigen::Vector3d>& query_positions,
                                              const std::vector<Eigen::Vector3d>& query_normals,
                                              const std::vector<Eigen::Vector3d>& target_positions,
                                              const std::vector<Eigen::Vector3d>& target_normals,
                                              const NeighborOptions& options);

// Each unordered pair once, sorted.
std::vector<std::pair<int, int>> UniquePairs(const std::vector<std::vector<int>>& neighbors);

}  // namespace glint
