// The size of a highlight is data too. Around its peak the surface normal turns away from the half vector; the blob
// ends where the turn has reached the width of the lobe, which is the same everywhere on one material.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "constraints/contact.h"
#include "geometry/ray_caster.h"
#include "geometry/triangle_mesh.h"
#include "light/light.h"

namespace glint {

// A highlight's blob laid on the current surface.
struct Lobe {
  // Column k: how far the normal turns against the half vector along axis k of the blob, from its centre to one
  // standard deviation; radians, in two tangents of the surface at the peak.
  Eigen::Matrix2d turn;
  Eigen::Matrix<double, 3, 2> tangents;
  // Where the rays through the ends of the axes (+a, -a, +b, -b) meet the surface, and the half vectors there.
  std::array<Eigen::Vector3d, 4> position, half;

  double Width() const { return std::sqrt(std::abs(turn.determinant())); }

  // The normals at the four ends if the lobe is round and `width` wide: the turn becomes the closest one that takes
  // both axes equally far. Each end says how curved the surface is along its axis.
  std::array<Eigen::Vector3d, 4> NormalsAtEnds(double width) const;
};

// nullopt where a ray through an end of the blob misses the surface. The contact's prior depth is on it. `surface`
// needs vertex normals; the caster is over the same mesh.
std::optional<Lobe> LayLobe(const Contact& contact, const Light& light, const TriangleMesh& surface,
                            const RayCaster& caster);

}  // namespace glint
