// Given lights against what the highlights themselves say.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"
#include "light/found_light.h"
#include "light/light.h"

namespace glint {

// Mean angle over the views between the directions from `center` to two lights, degrees.
double MeanAngleDeg(const Light& a, const Light& b, const std::vector<View>& views, const Eigen::Vector3d& center);

// Whether the light is a point inside the closed mesh, where it could light nothing.
bool InsideObject(const Light& light, const TriangleMesh& mesh);

// One sentence for each given light that FindLights() (`found`) contradicts: a found light is near it but not the same,
// or none is; and for each found one that no given light explains. Found lights are only as good as the seed:
// differences within three standard deviations and kTrustDeg say nothing. Empty where nothing was found.
std::vector<std::string> Contradictions(const std::vector<Light>& given, const std::vector<FoundLight>& found,
                                        const std::vector<View>& views, const Eigen::Vector3d& center);

}  // namespace glint
