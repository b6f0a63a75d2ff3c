// Points that belong together by how densely they lie.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace glint {

// Per point the number of its cluster, 0 for the largest. Neighbours are in one cluster where they are at most `reach`
// times as far apart as either has its fourth neighbour.
std::vector<int> DenseClusters(const std::vector<Eigen::Vector3d>& points, double reach);

// Points of the smaller clusters that lie farther out than nearly all of the largest, if that has most of the points:
// what was seen behind an object, through its handle or beside it.
std::vector<uint8_t> LieApart(const std::vector<Eigen::Vector3d>& points);

}  // namespace glint
