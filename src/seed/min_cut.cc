#include "seed/min_cut.h"

#include <algorithm>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <tuple>
#include <utility>

#include "core/check.h"

namespace glint {
namespace {

using Graph = boost::compressed_sparse_row_graph<boost::directedS, boost::no_property, boost::no_property,
                                                 boost::no_property, int32_t, int32_t>;
using GraphEdge = boost::graph_traits<Graph>::edge_descriptor;

// A directed edge with the index of its reverse.
struct HalfEdge {
  int from, to;
  int64_t capacity;
};

}  // namespace

std::vector<uint8_t> MinCut(const CutGraph& graph) {
  const int n = static_cast<int>(graph.source_capacity.size());
  GLINT_CHECK_EQ(graph.sink_capacity.size(), graph.source_capacity.size());
  const int source = n, sink = n + 1;
  // Half edge 2i and 2i + 1 are each other's reverse.
  std::vector<HalfEdge> half;
  auto add = [&](int from, int to, int64_t forward, int64_t backward) {
    half.push_back({from, to, forward});
    half.push_back({to, from, backward});
  };
  for (int i = 0; i < n; ++i) {
    // What both terminals claim of a node is lost either way: only the difference decides.
    const int64_t common = std::min(graph.source_capacity[i], graph.sink_capacity[i]);
    if (graph.source_capacity[i] > common) add(source, i, graph.source_capacity[i] - common, 0);
    if (graph.sink_capacity[i] > common) add(i, sink, graph.sink_capacity[i] - common, 0);
  }
  for (const CutGraph::Edge& e : graph.edges) add(e.from, e.to, e.forward, e.backward);

  std::vector<int> order(half.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return std::tie(half[a].from, half[a].to, a) < std::tie(half[b].from, half[b].to, b);
  });
  std::vector<int> rank(half.size());
  std::vector<std::pair<int, int>> sorted(half.size());
  std::vector<int64_t> capacity(half.size());
  for (size_t i = 0; i < order.size(); ++i) {
    rank[order[i]] = static_cast<int>(i);
    sorted[i] = {half[order[i]].from, half[order[i]].to};
    capacity[i] = half[order[i]].capacity;
  }
  const Graph g(boost::edges_are_sorted, sorted.begin(), sorted.end(), n + 2);
  std::vector<GraphEdge> reverse(half.size());
  for (size_t i = 0; i < order.size(); ++i) {
    const int r = rank[order[i] ^ 1];
    reverse[i] = GraphEdge(sorted[r].first, r);
  }
  std::vector<int64_t> residual(half.size());
  std::vector<GraphEdge> predecessor(n + 2);
  std::vector<boost::default_color_type> color(n + 2);
  std::vector<long> distance(n + 2);
  const auto edge_index = boost::get(boost::edge_index, g);
  const auto vertex_index = boost::get(boost::vertex_index, g);
  boost::boykov_kolmogorov_max_flow(g, boost::make_iterator_property_map(capacity.begin(), edge_index),
                                    boost::make_iterator_property_map(residual.begin(), edge_index),
                                    boost::make_iterator_property_map(reverse.begin(), edge_index),
                                    boost::make_iterator_property_map(predecessor.begin(), vertex_index),
                                    boost::make_iterator_property_map(color.begin(), vertex_index),
                                    boost::make_iterator_property_map(distance.begin(), vertex_index), vertex_index,
                                    source, sink);
  std::vector<uint8_t> on_source_side(n);
  for (int i = 0; i < n; ++i) on_source_side[i] = color[i] == color[source] ? 1 : 0;
  return on_source_side;
}

}  // namespace glint
