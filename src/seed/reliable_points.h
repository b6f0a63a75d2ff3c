// Which sparse points may be believed.
#pragma once

#include <cstdint>
#include <vector>

#include "colmap/scene.h"
#include "core/options.h"

namespace glint {

struct ReliabilityOptions {
  int min_track_length = 2;
  double max_error_px = 4;
  double min_angle_deg = 1.0;  // widest angle between two of its lines of sight
  double max_isolation = 12;   // times the spacing usual in the neighbourhood

  void Visit(OptionVisitor& v);
};

enum class PointStatus : uint8_t {
  kReliable,
  kShortTrack,
  kLargeError,
  kNarrowAngle,
  kIsolated,
  kVirtual,  // seen through the surface that its neighbours make: triangulated on a sliding highlight or a reflection
};

// What is known of every point of the scene. `sigma` (world units): standard deviation of the position across the
// lines of sight and along them, the larger of the two, from the mean reprojection error.
struct PointReliability {
  std::vector<PointStatus> status;
  std::vector<double> sigma;

  std::vector<uint8_t> ReliableMask() const;
  size_t Count(PointStatus s) const;
};

PointReliability JudgePoints(const Scene& scene, const ReliabilityOptions& options);

}  // namespace glint
