// What the scenes' tables say of a surface, against the truth.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap/scene.h"
#include "geometry/ray_caster.h"
#include "geometry/triangle_mesh.h"
#include "metrics/compare.h"

namespace glint::benchmark {

struct Measured {
  ErrorStats normal_in, distance_in, normal_out, distance_out, normal_seen, distance_seen;
  ErrorStats normal_near;  // where highlights pass and the surface is there at all, within kNearRel
};

// Of the truth's vertices: where highlights pass, elsewhere, and what of that a camera sees.
struct Regions {
  std::vector<uint8_t> swept, rest, seen;
};

// The mesh with normals, in the truth's frame.
Measured Measure(const TriangleMesh& mesh, const TriangleMesh& truth, const Regions& regions);

void PrintHeader();
void PrintRow(const std::string& scene, const std::string& surface, const Measured& m, double seconds);

Eigen::Vector3d InterpolatedNormal(const TriangleMesh& mesh, const RayHit& hit);

struct ContactErrors {
  ErrorStats half_deg, result_deg, depth_rel;
};

// The accepted highlights of a run against the truth (in the project's frame): how far the half vector is from the true
// normal where the ray meets the true surface (what limits everything), the same of the result, and how far apart ray
// meets result and truth.
ContactErrors MeasureContacts(const Scene& views, const std::filesystem::path& out, const TriangleMesh& truth);
void PrintContacts(const std::string& scene, const ContactErrors& errors);

struct Honesty {
  double position = 0, normal = 0;  // shares of 1
};

// Shares of the truth's vertices in a region where the mesh is within twice the standard deviation that it states there
// (about 95 % are if it is honest), and the deviations' medians;
// prints them, too.
Honesty MeasureHonesty(const std::string& scene, const std::string& where, const TriangleMesh& mesh,
                       const TriangleMesh& truth, const std::vector<uint8_t>& region);

}  // namespace glint::benchmark
