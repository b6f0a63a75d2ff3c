// Places that a surface should pass, and where on it they are attached.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace glint {

// A place that the surface should pass, with its standard deviation (world units). `credit` widens (> 1) or narrows
// the range in which it is believed against its neighbours.
struct Attachment {
  Eigen::Vector3d position;
  double sigma;
  double credit = 1;
  int point = -1;      // the caller's name for it
  bool extra = false;  // no sparse point: how far the surface may bend is not for it to say
};

// Where an attachment holds the surface: a point of a face by its barycentric weights, `distance` (world units) away.
struct AttachedPoint {
  Eigen::Vector3i face;  // vertices
  Eigen::Vector3d weights;
  double distance;
};

// The closest point of the mesh to each.
std::vector<AttachedPoint> AttachTo(const TriangleMesh& mesh, const std::vector<Attachment>& attachments);

}  // namespace glint
