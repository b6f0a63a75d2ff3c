// Pictures of meshes seen through a project's camera, and the sheet that compares them: what the README shows.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "colmap/scene.h"
#include "geometry/triangle_mesh.h"

namespace cv {
class Mat;
}

namespace glint {

// A mesh as `view` sees it, `width` pixels wide (CV_8UC3, white where it is not). Shaded as clay with reflection
// lines: stripes at equal angles of the mirrored viewing ray, in which a wrong normal shows as a kink or a wobble.
// `colors`: empty, or one a vertex (sRGB), which replace the stripes. `mesh` needs vertex normals.
cv::Mat RenderMesh(const TriangleMesh& mesh, const View& view, int width,
                   const std::vector<std::array<uint8_t, 3>>& colors = {});

// Colour of an error from 0 (blue) over green and yellow to `largest` and beyond (red); grey for a negative one.
std::array<uint8_t, 3> ErrorColor(double error, double largest);

// One mesh of the sheet and its error in degrees or world units, a vertex of the reference.
struct PictureColumn {
  std::string title;
  const TriangleMesh* mesh;             // in the view's frame
  std::vector<float> normal_error_deg;  // per vertex of the reference, negative: none
};

// The photograph with its title, the meshes, and the normal error of each mesh drawn on the reference's surface with
// the scale of its colours.
cv::Mat ComparisonSheet(const cv::Mat& photograph, const std::string& photograph_title,
                        const std::vector<PictureColumn>& columns, const TriangleMesh& reference, const View& view,
                        double largest_error_deg);

// The view that sees most of the vertices with a non-zero mask (all of them if it is empty).
size_t MostTellingView(const Scene& scene, const TriangleMesh& reference, const std::vector<uint8_t>& mask);

}  // namespace glint
