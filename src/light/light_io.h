// The lights file:
//   {"lights": [{"type": "distant", "frame": "world", "direction_to_light": [x, y, z], "sigma_deg": 0.5},
//               {"type": "point", "frame": "camera", "position": [x, y, z], "sigma": 0.01}]}
// Directions need not be of unit length; `sigma_deg` (degrees) and `sigma` (units of the model) may be left out.
#pragma once

#include <filesystem>
#include <vector>

#include "light/light.h"

namespace glint {

// Throws InputError naming file and record: unreadable or malformed file, unknown or missing key, unknown type or
// frame, a direction of zero length, a number that is not finite, an empty list.
std::vector<Light> ReadLights(const std::filesystem::path& path);

// Replaces the file as a whole or leaves it alone. Throws InputError if it cannot be written.
void WriteLights(const std::filesystem::path& path, const std::vector<Light>& lights);

}  // namespace glint
