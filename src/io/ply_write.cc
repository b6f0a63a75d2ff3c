#include <fmt/format.h>

#include <string>

#include "core/check.h"
#include "io/mesh_formats.h"

namespace glint::internal {
namespace {

class LittleEndianWriter {
 public:
  explicit LittleEndianWriter(std::ostream& out) : out_(out) {}
  ~LittleEndianWriter() { Flush(); }
  template <class T>
  void Write(T value) {
    buffer_.append(reinterpret_cast<const char*>(&value), sizeof(T));
    if (buffer_.size() > (size_t{1} << 20)) Flush();
  }
  void WriteText(std::string_view text) { buffer_.append(text); }

 private:
  void Flush() {
    out_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
  }
  std::ostream& out_;
  std::string buffer_;
};

std::string Header(const TriangleMesh& mesh, bool use_floats) {
  const std::string_view real = use_floats ? "float" : "double";
  std::string header =
      fmt::format("ply\nformat binary_little_endian 1.0\ncomment Glint\nelement vertex {}\n", mesh.vertices.size());
  for (const char* name : {"x", "y", "z"}) header += fmt::format("property {} {}\n", real, name);
  if (!mesh.normals.empty()) header += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!mesh.colors.empty()) header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (!mesh.confidence.empty()) header += "property float confidence\n";
  for (const auto& [name, values] : mesh.scalars) header += fmt::format("property float {}\n", name);
  return header +
         fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n", mesh.faces.size());
}

}  // namespace

void WritePly(const TriangleMesh& mesh, std::ostream& stream) {
  const bool use_floats = FloatsSuffice(mesh);
  LittleEndianWriter out(stream);
  out.WriteText(Header(mesh, use_floats));
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    for (const double value : mesh.vertices[i]) {
      if (use_floats) {
        out.Write(static_cast<float>(value));
      } else {
        out.Write(value);
      }
    }
    if (!mesh.normals.empty()) {
      for (const double value : mesh.normals[i]) out.Write(static_cast<float>(value));
    }
    if (!mesh.colors.empty()) {
      for (const uint8_t value : mesh.colors[i]) out.Write(value);
    }
    if (!mesh.confidence.empty()) out.Write(mesh.confidence[i]);
    for (const auto& [name, values] : mesh.scalars) out.Write(values[i]);
  }
  for (const Eigen::Vector3i& face : mesh.faces) {
    out.Write(uint8_t{3});
    for (const int index : face) out.Write(static_cast<int32_t>(index));
  }
}

}  // namespace glint::internal
