// The object's points to a closed surface, sparse and smooth.
#pragma once

#include <string>
#include <vector>

#include "colmap/scene.h"
#include "core/progress.h"
#include "geometry/components.h"
#include "geometry/triangle_mesh.h"
#include "seed/fair.h"
#include "seed/object_choice.h"
#include "seed/reliable_points.h"
#include "seed/rim_points.h"
#include "seed/sparse_surface.h"
#include "seed/visibility_cut.h"

namespace glint {

// How a surface came out of fairing.
enum class Fairing {
  kSmooth,
  kMended,  // it passed through itself, and its inside was taken, or its facets
  kFolded,  // not even they bound a solid
};

struct Shape {
  SparseSurface sparse;  // empty if the points enclose nothing
  TriangleMesh smooth;   // the same, faired through the points
  Fairing fairing = Fairing::kSmooth;
};

// Takes points out of the object that the smooth surface disbelieves, which it notes in `reliability` and `choice`, and
// makes it anew without them.
Shape MakeShape(const Scene& scene, PointReliability& reliability, ObjectChoice& choice, const RimEvidence& rim,
                const CutOptions& cut, const FairOptions& fair, Progress& progress);

// One of the mesh's connected pieces, and the one with the most volume.
TriangleMesh PieceOf(const TriangleMesh& mesh, const Components& pieces, size_t k);
TriangleMesh LargestPiece(const TriangleMesh& mesh);

// Sum over the pieces; the mesh is closed and manifold.
long GenusOf(const TriangleMesh& mesh);

}  // namespace glint
