// Which sparse points belong to the object: the user wants the vase, not the table.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "colmap/scene.h"
#include "core/options.h"
#include "core/progress.h"
#include "io/image_source.h"
#include "seed/reliable_points.h"
#include "seed/scene_layout.h"
#include "seed/visibility_cut.h"

namespace glint {

struct ObjectOptions {
  std::vector<double> box;      // centre x y z, size x y z, in the world; empty: the object is found
  std::string ground = "auto";  // "auto" or "none"

  void Visit(OptionVisitor& v);
};

// kContext: reliable points that are not the object's; their lines of sight still carve.
enum class PointRole : uint8_t { kUnused, kObject, kGround, kContext };

struct ObjectChoice {
  std::vector<PointRole> role;  // per scene point
  Focus focus;
  std::optional<GroundPlane> ground;
  std::string chosen_by;  // "box", "masks", "ground and focus", "focus"
};

// With a box: the points in it but those on the ground. With masks: the points most of whose observations lie on them.
// Otherwise the sparse surface of all that surrounds the focus is made, cut off at the ground, and the piece of it
// taken that has the most volume near the focus, without what lies apart from the rest of it. Throws InputError for a
// box that is not six numbers with positive sizes.
ObjectChoice ChooseObject(const Scene& scene, const PointReliability& reliability, const ObjectOptions& options,
                          const CutOptions& cut, const ImageSource* masks, Progress& progress);

}  // namespace glint
