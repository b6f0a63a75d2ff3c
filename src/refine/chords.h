// Which contacts and points are tied to each other by the chord rule, and how tightly.
#pragma once

#include <vector>

#include "refine/bundle.h"

namespace glint {

struct Chord {
  int a, b;       // indices of a contact, and of another or of a point
  double sigma;   // standard deviation of ChordResidual, world units
  double offset;  // of the current surface, see ChordResidual
};

struct Chords {
  std::vector<Chord> between;    // contacts
  std::vector<Chord> to_points;  // from a contact each
};

// Of what lies near and faces alike, in every direction, on one sheet of `surface` (null: not asked). `diagonal`: the
// object's, world units. A chord is as sure as its normals and the rule itself: the peak's uncertainty in the image
// becomes one of the normal through the curvature that the chords show, and where curvature changes along a chord the
// rule is off by a share of the squared angle between its normals, of which the current surface's own offset takes off
// the most.
Chords MakeChords(const std::vector<Contact*>& contacts, const std::vector<Light>& lights,
                  const std::vector<SurfacePoint>& points, double diagonal, const BundleOptions& options,
                  const SurfaceQuery* surface);

}  // namespace glint
