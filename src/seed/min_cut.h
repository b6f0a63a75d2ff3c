// Minimum s-t cut of a graph whose inner edges come in pairs.
#pragma once

#include <cstdint>
#include <vector>

namespace glint {

// Nodes 0 … n−1. Cutting costs source_capacity of every node on the sink's side, sink_capacity of every node on the
// source's side, and forward of every edge whose `from` is on the source's side and `to` on the sink's (backward: the
// other way round). Capacities are integers ≥ 0, so that the cut is exact and the same on every machine.
struct CutGraph {
  struct Edge {
    int from, to;
    int64_t forward, backward;
  };
  std::vector<int64_t> source_capacity;
  std::vector<int64_t> sink_capacity;
  std::vector<Edge> edges;  // at most one per pair of nodes
};

// Per node: 1 on the source's side of the minimum cut with the smallest source side, 0 on the sink's.
std::vector<uint8_t> MinCut(const CutGraph& graph);

}  // namespace glint
