// The lights file:
//   {"lights": [{"type": "distant", "frame": "world", "direction_to_light": [x, y, z], "sigma_deg": 0.5},
//               {"type": "point", "frame": "camera", "position": [x, y, z], "sigma": 0.01}]}
// Directions need not be of unit length; `sigma_deg` (degrees) and `sigma` (units of the model) may be left out.
// Lights that Glint found also say "covariance" [xx, xy, xz, yy, yz, zz] of the vector (radians² or units²), "support"
// (highlights) and "conditioning"; those that could not be determined are in a list "undetermined" beside "lights",
// each with "why", and are not read back as lights.
#pragma once

#include <filesystem>
#include <vector>

#include "light/found_light.h"
#include "light/light.h"

namespace glint {

// Throws InputError naming file and record: unreadable or malformed file, unknown or missing key, unknown type or
// frame, a direction of zero length, a number that is not finite, an empty list.
std::vector<Light> ReadLights(const std::filesystem::path& path);

// The same file with what is said of found lights, undetermined ones last. `lights` may be an empty list here.
std::vector<FoundLight> ReadFoundLights(const std::filesystem::path& path);

// Replaces the file as a whole or leaves it alone. Throws InputError if it cannot be written.
void WriteLights(const std::filesystem::path& path, const std::vector<Light>& lights);
void WriteFoundLights(const std::filesystem::path& path, const std::vector<FoundLight>& lights);

}  // namespace glint
