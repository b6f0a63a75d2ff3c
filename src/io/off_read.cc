#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/mesh_formats.h"
#include "io/text_scanner.h"

namespace glint::internal {

// Geomview's OFF: [C][N]OFF, counts, vertices, faces; what follows on a line is left out.
TriangleMesh ParseOff(std::string_view bytes, const std::filesystem::path& path) {
  TextScanner in(bytes, path, '#');
  const std::string_view magic = in.NextWord();
  if (!magic.ends_with("OFF")) in.Fail(fmt::format("expected 'OFF', found '{}'", magic.substr(0, 40)));
  const std::string_view kind = magic.substr(0, magic.size() - 3);
  if (!kind.empty() && kind != "C" && kind != "N" && kind != "CN" && kind != "ST" && kind != "STC") {
    in.Fail(fmt::format("expected OFF, COFF or NOFF, found '{}'", magic.substr(0, 40)));
  }
  const bool has_normals = kind.ends_with("N"), has_colors = kind.find('C') != std::string_view::npos;

  const std::string_view first = in.NextWord();
  if (first == "BINARY") in.Fail("expected an ASCII OFF file, found a binary one");
  const uint64_t num_vertices = in.ParseNumber<uint64_t>(first, "the number of vertices");
  const uint64_t num_faces = in.Number<uint64_t>("the number of faces");
  in.SkipLine();
  // A vertex takes at least "0 0 0" and a line end, a face "3 0 0 0".
  if (num_vertices > in.remaining() / 6 + 1 || num_faces > in.remaining() / 8 + 1) {
    in.Fail(fmt::format("expected {} vertices and {} faces, found {} bytes: the file is cut", num_vertices, num_faces,
                        in.remaining()));
  }
  TriangleMesh mesh;
  for (uint64_t i = 0; i < num_vertices; ++i) {
    Eigen::Vector3d& v = mesh.vertices.emplace_back();
    for (double& value : v) value = in.Number<double>("a vertex");
    if (!v.allFinite()) in.Fail("expected finite coordinates");
    if (has_normals) {
      for (double& value : mesh.normals.emplace_back()) value = in.Number<double>("a normal");
    }
    if (has_colors) {
      for (uint8_t& value : mesh.colors.emplace_back()) {
        const std::string_view word = in.NextWordInLine();
        const double scale = word.find('.') == std::string_view::npos ? 1 : 255;
        const double color = std::round(scale * in.ParseNumber<double>(word, "a colour"));
        value = static_cast<uint8_t>(std::isnan(color) ? 0 : std::clamp(color, 0.0, 255.0));
      }
    }
    in.SkipLine();
  }
  std::vector<int> polygon;
  for (uint64_t f = 0; f < num_faces; ++f) {
    const uint64_t n = in.Number<uint64_t>("the number of a face's vertices");
    if (n > in.remaining())
      in.Fail(fmt::format("expected a face that fits into the file, found one of {} vertices", n));
    polygon.clear();
    for (uint64_t k = 0; k < n; ++k) polygon.push_back(in.Number<int>("a vertex index"));
    AppendCheckedPolygon(mesh, polygon, path, "line", in.line());
    in.SkipLine();
  }
  return mesh;
}

}  // namespace glint::internal
