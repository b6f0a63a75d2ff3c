// A smooth surface through sparse points: bends as little as the points allow.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/options.h"
#include "geometry/triangle_mesh.h"

namespace glint {

struct FairOptions {
  double edge_rel = 0.015;
  double smoothing = 0.2;
  double stay = 0.0002;
  int rounds = 6;

  void Visit(OptionVisitor& v);
};

// A place that the surface should pass, with its standard deviation (world units). `credit` widens (> 1) or narrows
// the range in which it is believed against its neighbours.
struct Attachment {
  Eigen::Vector3d position;
  double sigma;
  double credit = 1;
};

struct FairResult {
  TriangleMesh mesh;
  // Per attachment: how much of its weight it kept, 0 … 1; low for those that disagree with the surface that the
  // others make.
  std::vector<double> trust;
};

// Minimises (sparse Cholesky; remeshed evenly, attached again and robustly weighted each round)
//   λ ∫‖Δx‖² + Σᵢ wᵢ ‖x(attached point of i) − pᵢ‖² + stay · (such springs all over, to where the round began)
// with λ set so that the surface bends over `smoothing` times the spacing of the attachments. The thin-plate energy is
// the linearised Willmore energy, whose closed minimisers are spheres: between points a convex body bulges as it
// should, where flat facets cut 2–3 % off. The rounds go from stiff to soft, so that points which disagree with their
// neighbourhood lose their weight before the surface could bend to them. The mesh must be closed and manifold; topology
// is kept.
FairResult FairThroughPoints(const TriangleMesh& mesh, const std::vector<Attachment>& attachments,
                             const FairOptions& options);

}  // namespace glint
