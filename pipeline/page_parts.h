// The parts of report.html's data, as JSON. Internal to the page.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "colmap/scene.h"
#include "constraints/contact.h"
#include "core/progress.h"
#include "geometry/triangle_mesh.h"
#include "highlights/highlight.h"
#include "io/image_source.h"
#include "light/found_light.h"

namespace glint {

using Json = nlohmann::ordered_json;

// The page's frame: the object's bounding box about the origin, its diagonal one.
struct PageFrame {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double diagonal = 1;
  Eigen::Vector3d FromWorld(const Eigen::Vector3d& x_in_world) const { return (x_in_world - center) / diagonal; }
};

std::string Base64(std::string_view bytes);

// A mesh as little-endian arrays in base64: positions of 16 bits in their box, octahedral normals of 16 bits,
// indices, colours of 8 bits, and attributes of 16 bits in their range: those of the mesh, "moved_rel" (signed distance
// to `other`, in diagonals; left out where `other` is empty) and "curvature" (mean curvature times the diagonal).
// Meshes of more than `max_faces` are simplified.
Json PageMesh(const TriangleMesh& mesh, const TriangleMesh& other, const PageFrame& frame, size_t max_faces);

// Cameras as centre and four corner rays, what is up, and the view that sees most accepted highlights.
Json PageViews(const Scene& scene, const std::vector<Highlight>& highlights, const PageFrame& frame);

// Accepted contacts with their normals; lights in the page's frame: directions and positions, one, or for a light in
// the camera's frame one a view.
Json PageContacts(const std::vector<Contact>& contacts, const std::vector<Light>& lights, const PageFrame& frame);
Json PageLights(const std::vector<FoundLight>& lights, const Scene& scene, const PageFrame& frame);

// Photographs, scaled down, as JPEG in base64, with their highlights as ellipses in the photographs' pixels.
Json PagePhotos(const Scene& scene, const ImageSource& images, const std::vector<Highlight>& highlights, int max_photos,
                int max_side_px, Progress& progress);

}  // namespace glint
