#include "pipeline/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "geometry/edge_topology.h"
#include "geometry/pseudo_normals.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

// One row of the table, a value for each candidate.
void AppendRow(std::string& out, const std::string& name, const std::vector<std::string>& values) {
  out += fmt::format("{:<34}", name);
  for (const std::string& value : values) out += fmt::format(" {:>22}", value);
  out += "\n";
}

template <class Format>
std::vector<std::string> ForEach(const std::vector<Candidate>& candidates, const Format& format) {
  std::vector<std::string> values;
  for (const Candidate& c : candidates) values.push_back(format(c));
  return values;
}

std::string Percent(const ErrorStats& rel) { return fmt::format("{:.4f} / {:.4f} %", 100 * rel.mean, 100 * rel.p95); }

std::string Degrees(const ErrorStats& deg) { return fmt::format("{:.2f} / {:.2f} deg", deg.mean, deg.median); }

Json ToJson(const ErrorStats& s) {
  return {{"count", s.count}, {"mean", s.mean}, {"rms", s.rms}, {"median", s.median}, {"p95", s.p95}, {"max", s.max}};
}

// As ReadSimilarity() reads it.
Json ToJson(const Eigen::Affine3d& similarity) {
  const double scale = std::cbrt(similarity.linear().determinant());
  Json json = {{"scale", scale}, {"R", Json::array()}, {"t", Json::array()}};
  for (int r = 0; r < 3; ++r) {
    json["R"].push_back(Json::array());
    for (int c = 0; c < 3; ++c) json["R"].back().push_back(similarity.linear()(r, c) / scale);
    json["t"].push_back(similarity.translation()[r]);
  }
  return json;
}

Json ToJson(const Candidate& c, const std::vector<Region>& regions) {
  const MeshComparison& m = c.comparison;
  Json json = {{"mesh", c.name},
               {"vertices", c.mesh.vertices.size()},
               {"faces", c.mesh.faces.size()},
               {"accuracy_rel", ToJson(m.accuracy_rel)},
               {"completeness_rel", ToJson(m.completeness_rel)},
               {"chamfer_rel", m.chamfer_rel},
               {"normal_deg", ToJson(m.normal_deg)}};
  json["f_scores"] = Json::array();
  for (const FScore& f : m.f_scores)
    json["f_scores"].push_back(
        {{"threshold_rel", f.threshold_rel}, {"precision", f.precision}, {"recall", f.recall}, {"f", f.f}});
  json["histogram"] = {{"from_rel", -c.histogram.largest_rel},
                       {"to_rel", c.histogram.largest_rel},
                       {"shares", c.histogram.shares},
                       {"below", c.histogram.below},
                       {"above", c.histogram.above}};
  json["regions"] = Json::object();
  for (const Region& region : regions)
    json["regions"][region.name] = {{"distance_rel", ToJson(DistanceStatsRel(m, region.mask))},
                                    {"normal_deg", ToJson(NormalStats(m, region.mask))}};
  return json;
}

}  // namespace

void EnsureNormals(TriangleMesh& mesh) {
  if (!mesh.normals.empty()) return;
  const PseudoNormals pseudo = ComputePseudoNormals(mesh, BuildEdgeTopology(mesh));
  for (const Eigen::Vector3d& n : pseudo.vertex) mesh.normals.push_back(n.normalized());
}

std::string ComparisonTable(const std::vector<Candidate>& candidates, const std::vector<Region>& regions) {
  std::string out;
  AppendRow(out, "", ForEach(candidates, [](const Candidate& c) {
              return c.name.size() <= 22 ? c.name : "..." + c.name.substr(c.name.size() - 19);
            }));
  AppendRow(out, "faces", ForEach(candidates, [](const Candidate& c) { return std::to_string(c.mesh.faces.size()); }));
  AppendRow(out, "accuracy (mean / 95 %)",
            ForEach(candidates, [](const Candidate& c) { return Percent(c.comparison.accuracy_rel); }));
  AppendRow(out, "completeness (mean / 95 %)",
            ForEach(candidates, [](const Candidate& c) { return Percent(c.comparison.completeness_rel); }));
  AppendRow(out, "Chamfer distance", ForEach(candidates, [](const Candidate& c) {
              return fmt::format("{:.4f} %", 100 * c.comparison.chamfer_rel);
            }));
  for (size_t i = 0; i < candidates.front().comparison.f_scores.size(); ++i)
    AppendRow(
        out, fmt::format("F-score at {:g} %", 100 * candidates.front().comparison.f_scores[i].threshold_rel),
        ForEach(candidates, [i](const Candidate& c) { return fmt::format("{:.3f}", c.comparison.f_scores[i].f); }));
  AppendRow(out, "normals (mean / median)",
            ForEach(candidates, [](const Candidate& c) { return Degrees(c.comparison.normal_deg); }));
  for (const Region& region : regions) {
    const auto count = region.mask.size() - std::count(region.mask.begin(), region.mask.end(), 0);
    out += fmt::format("{} ({} of {} vertices of the reference)\n", region.name, count, region.mask.size());
    AppendRow(out, "  distance (mean / 95 %)", ForEach(candidates, [&](const Candidate& c) {
                return Percent(DistanceStatsRel(c.comparison, region.mask));
              }));
    AppendRow(out, "  normals (mean / median)",
              ForEach(candidates, [&](const Candidate& c) { return Degrees(NormalStats(c.comparison, region.mask)); }));
  }
  return out;
}

std::string ComparisonJson(const std::vector<Candidate>& candidates, const std::vector<Region>& regions,
                           const Eigen::Affine3d& reference_from_mesh) {
  Json json = {{"reference_diagonal", candidates.front().comparison.reference_diagonal},
               {"reference_from_mesh", ToJson(reference_from_mesh)}};
  json["candidates"] = Json::array();
  for (const Candidate& c : candidates) json["candidates"].push_back(ToJson(c, regions));
  return json.dump(2) + "\n";
}

}  // namespace glint
