// A mesh against the truth, as a whole and by regions: what `glint compare` prints.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/triangle_mesh.h"
#include "metrics/compare.h"
#include "pipeline/error_map.h"

namespace glint {

// A part of the reference, one flag a vertex.
struct Region {
  std::string name;
  std::vector<uint8_t> mask;
};

// A mesh that is measured: `mesh` as given, or the seed it came from.
struct Candidate {
  std::string name;
  TriangleMesh mesh;
  MeshComparison comparison;
  ErrorHistogram histogram;  // of the signed distances of its vertices
};

// Unit vertex normals weighted by the incident angles, where the mesh has none of its own.
void EnsureNormals(TriangleMesh& mesh);

// A table for people: every candidate a column, every measure a row, lengths in % of the reference's diagonal.
std::string ComparisonTable(const std::vector<Candidate>& candidates, const std::vector<Region>& regions);

// The same for programs, with the similarity that the candidates have been brought into the reference's frame by.
std::string ComparisonJson(const std::vector<Candidate>& candidates, const std::vector<Region>& regions,
                           const Eigen::Affine3d& reference_from_mesh);

}  // namespace glint
