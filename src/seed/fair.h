// A smooth surface through sparse points: bends as little as the points allow.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "core/options.h"
#include "geometry/triangle_mesh.h"
#include "seed/attachment.h"

namespace glint {

struct FairOptions {
  double edge_rel = 0.015;
  double smoothing = 0.18;
  double stay = 0.002;
  int rounds = 6;

  void Visit(OptionVisitor& v);
};

// What is known besides the points.
struct FairContext {
  std::vector<Eigen::Vector3d> eyes;                        // of the cameras
  std::optional<Eigen::Hyperplane<double, 3>> ground = {};  // the object is on its positive side
  bool even_walls = true;  // not if backs were put behind the points: those say nothing of how thick a wall is
};

struct FairResult {
  TriangleMesh mesh;
  // Per attachment: how much of its weight it kept, 0 … 1; low for those that disagree with the surface that the
  // others make.
  std::vector<double> trust;
};

// Minimises (sparse Cholesky; remeshed evenly, attached again and robustly weighted each round)
//   λ ∫‖Δx − r‖² + Σᵢ wᵢ ‖x(attached point of i) − pᵢ‖² + stay · (such springs, to the sparse surface, where no eye
//   sees it)
// with λ set so that the surface bends over `smoothing` times the spacing of the attachments, and r the curvature
// normal of the round before with its curvature evened out, and continued into what no point holds: a plate bent by
// nature, which spheres (and, between points, any body of slowly changing curvature) cost nothing; flat facets cut
// 2–3 % off a convex body. With a ground, what is unseen below closes itself by that curvature, down to the ground,
// instead of staying with the sparse surface. A thin wall whose one side no point holds is as thick as beside there
// (seed/wall_thickness). The rounds go from stiff to soft, so that points which disagree with
// their neighbourhood lose their weight before the surface could bend to them. The mesh must be closed and manifold;
// topology is kept.
FairResult FairThroughPoints(const TriangleMesh& mesh, const std::vector<Attachment>& attachments,
                             const FairContext& context, const FairOptions& options);

}  // namespace glint
