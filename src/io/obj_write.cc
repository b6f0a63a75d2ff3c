#include <fmt/format.h>

#include <iterator>

#include "io/mesh_formats.h"

namespace glint::internal {

void WriteObj(const TriangleMesh& mesh, std::ostream& out) {
  const bool use_floats = FloatsSuffice(mesh);
  fmt::memory_buffer text;
  const auto flush = [&](size_t threshold) {
    if (text.size() <= threshold) return;
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    text.clear();
  };
  constexpr size_t kChunk = size_t{1} << 20;
  auto end = std::back_inserter(text);
  fmt::format_to(end, "# Glint\n");
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    fmt::format_to(end, "v");
    // The shortest decimals that read back as the same number.
    for (const double value : mesh.vertices[i]) {
      if (use_floats) {
        fmt::format_to(end, " {}", static_cast<float>(value));
      } else {
        fmt::format_to(end, " {}", value);
      }
    }
    if (!mesh.colors.empty()) {
      for (const uint8_t value : mesh.colors[i]) fmt::format_to(end, " {:.5g}", value / 255.0);
    }
    fmt::format_to(end, "\n");
    flush(kChunk);
  }
  for (const Eigen::Vector3d& n : mesh.normals) {
    fmt::format_to(end, "vn {:.6g} {:.6g} {:.6g}\n", n.x(), n.y(), n.z());
    flush(kChunk);
  }
  for (const Eigen::Vector3i& face : mesh.faces) {
    const Eigen::Vector3i f = face.array() + 1;
    if (mesh.normals.empty()) {
      fmt::format_to(end, "f {} {} {}\n", f.x(), f.y(), f.z());
    } else {
      fmt::format_to(end, "f {0}//{0} {1}//{1} {2}//{2}\n", f.x(), f.y(), f.z());
    }
    flush(kChunk);
  }
  flush(0);
}

}  // namespace glint::internal
