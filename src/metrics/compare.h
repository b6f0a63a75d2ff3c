// How far a mesh is from a reference: distances both ways, F-scores, normals.
#pragma once

#include <cstdint>
#include <vector>

#include "core/options.h"
#include "core/progress.h"
#include "geometry/triangle_mesh.h"

namespace glint {

struct CompareOptions {
  int num_samples = 100000;                              // on each surface
  std::vector<double> f_thresholds_rel = {0.005, 0.01};  // fractions of the reference's diagonal

  void Visit(OptionVisitor& v);
};

// Of a set of non-negative values (distances in world units, or angles in degrees). All 0 where count is 0.
struct ErrorStats {
  size_t count = 0;
  double mean = 0;
  double rms = 0;
  double median = 0;
  double p95 = 0;
  double max = 0;
};

ErrorStats StatsOf(std::vector<double> values);

// Every length multiplied by `factor`, for example 1/diagonal to get `_rel`.
ErrorStats Scaled(const ErrorStats& stats, double factor);

struct FScore {
  double threshold_rel = 0;
  double precision = 0;  // share of the mesh's samples closer to the reference than the threshold
  double recall = 0;     // share of the reference's samples closer to the mesh
  double f = 0;          // their harmonic mean
};

struct MeshComparison {
  double reference_diagonal = 0;  // world units: the unit of every `_rel`
  ErrorStats accuracy;            // mesh -> reference, world units, area-weighted samples
  ErrorStats completeness;        // reference -> mesh
  ErrorStats accuracy_rel;
  ErrorStats completeness_rel;
  double chamfer = 0;  // mean of the two means, world units
  double chamfer_rel = 0;
  std::vector<FScore> f_scores;
  ErrorStats normal_deg;  // at the reference's vertices (in the mask) that have a normal

  // Per vertex of the reference, for colour maps and for other masks: distance to the mesh (world units), and the
  // angle between the normals (degrees; -1 where one of them is undefined).
  std::vector<float> reference_distance;
  std::vector<float> reference_normal_deg;
  std::vector<float> mesh_distance;  // per vertex of the mesh: distance to the reference
};

// Both meshes in the same frame, both with at least one face. Distances are taken at low-discrepancy samples of equal
// area; normals at the reference's vertices (its own, else angle-weighted ones) against the closest point of the mesh
// (its vertex normals interpolated, else the normal of the face). `reference_mask`: empty, or per vertex of the
// reference, non-zero where to measure; then samples of the reference count where the nearest corner of their face is
// in the mask, samples of the mesh where that holds for their closest point.
MeshComparison CompareMeshes(const TriangleMesh& mesh, const TriangleMesh& reference,
                             const CompareOptions& options = {}, const std::vector<uint8_t>& reference_mask = {},
                             Progress& progress = Progress::Silent());

// Stats of the normal error over another mask on the same comparison.
ErrorStats NormalStats(const MeshComparison& comparison, const std::vector<uint8_t>& reference_mask);

// Stats of the distance from the reference's vertices to the mesh over a mask, in fractions of the diagonal.
ErrorStats DistanceStatsRel(const MeshComparison& comparison, const std::vector<uint8_t>& reference_mask);

}  // namespace glint
