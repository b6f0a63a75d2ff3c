#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

#include "io/mesh_formats.h"

namespace glint::internal {
namespace {

using nlohmann::json;

// glTF 2.0's codes.
constexpr int kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125, kArrayBuffer = 34962, kIndexBuffer = 34963;

// sRGB to linear, as glTF's vertex colours are.
uint16_t LinearColor(uint8_t srgb) {
  const double s = srgb / 255.0;
  const double linear = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  return static_cast<uint16_t>(std::lround(65535 * linear));
}

// The binary chunk and the JSON that describes it.
class GlbBuilder {
 public:
  // A new buffer view and accessor of `count` items; what is written next by Put() belongs to them.
  int BeginAccessor(int component_type, const char* type, size_t count, int target) {
    views_.push_back({{"buffer", 0}, {"byteOffset", bytes_.size()}, {"target", target}});
    accessors_.push_back(
        {{"bufferView", views_.size() - 1}, {"componentType", component_type}, {"count", count}, {"type", type}});
    return static_cast<int>(accessors_.size()) - 1;
  }
  template <class T>
  void Put(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  void EndAccessor() {
    views_.back()["byteLength"] = bytes_.size() - views_.back()["byteOffset"].get<size_t>();
    bytes_.resize((bytes_.size() + 3) / 4 * 4, '\0');
  }
  json& accessor(int i) { return accessors_[i]; }

  void Write(json document, std::ostream& out) {
    document["bufferViews"] = views_;
    document["accessors"] = accessors_;
    document["buffers"] = {{{"byteLength", bytes_.size()}}};
    std::string text = document.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto put = [&](uint32_t value) { out.write(reinterpret_cast<const char*>(&value), sizeof(value)); };
    put(0x46546C67);  // "glTF"
    put(2);
    put(static_cast<uint32_t>(12 + 8 + text.size() + 8 + bytes_.size()));
    put(static_cast<uint32_t>(text.size()));
    put(0x4E4F534A);  // "JSON"
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
    put(static_cast<uint32_t>(bytes_.size()));
    put(0x004E4942);  // "BIN"
    out.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
  }

 private:
  std::string bytes_;
  json views_ = json::array(), accessors_ = json::array();
};

// Application-specific attributes begin with an underscore.
std::string AttributeName(std::string_view name) {
  std::string out = "_";
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    out += std::isalnum(u) ? static_cast<char>(std::toupper(u)) : '_';
  }
  return out;
}

int AddPositions(const TriangleMesh& mesh, const Eigen::Vector3d& origin, GlbBuilder& glb) {
  const int positions = glb.BeginAccessor(kFloat, "VEC3", mesh.vertices.size(), kArrayBuffer);
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    const Eigen::Vector3f v = (vertex - origin).cast<float>();
    box.extend(v);
    for (const float value : v) glb.Put(value);
  }
  glb.EndAccessor();
  if (!mesh.vertices.empty()) {
    glb.accessor(positions)["min"] = {box.min().x(), box.min().y(), box.min().z()};
    glb.accessor(positions)["max"] = {box.max().x(), box.max().y(), box.max().z()};
  }
  return positions;
}

int AddNormals(const TriangleMesh& mesh, GlbBuilder& glb) {
  const int normals = glb.BeginAccessor(kFloat, "VEC3", mesh.normals.size(), kArrayBuffer);
  for (const Eigen::Vector3d& normal : mesh.normals) {
    // glTF asks for unit length, also where there is no direction.
    const Eigen::Vector3d n = normal.norm() > 0 ? normal.normalized() : Eigen::Vector3d::UnitZ();
    for (const double value : n) glb.Put(static_cast<float>(value));
  }
  glb.EndAccessor();
  return normals;
}

int AddColors(const TriangleMesh& mesh, GlbBuilder& glb) {
  const int colors = glb.BeginAccessor(kUnsignedShort, "VEC4", mesh.colors.size(), kArrayBuffer);
  glb.accessor(colors)["normalized"] = true;
  for (const auto& color : mesh.colors) {
    for (const uint8_t value : color) glb.Put(LinearColor(value));
    glb.Put(uint16_t{65535});
  }
  glb.EndAccessor();
  return colors;
}

int AddScalars(const std::vector<float>& values, GlbBuilder& glb) {
  const int scalars = glb.BeginAccessor(kFloat, "SCALAR", values.size(), kArrayBuffer);
  for (const float value : values) glb.Put(value);
  glb.EndAccessor();
  return scalars;
}

int AddIndices(const TriangleMesh& mesh, GlbBuilder& glb) {
  const int indices = glb.BeginAccessor(kUnsignedInt, "SCALAR", 3 * mesh.faces.size(), kIndexBuffer);
  for (const Eigen::Vector3i& face : mesh.faces) {
    for (const int index : face) glb.Put(static_cast<uint32_t>(index));
  }
  glb.EndAccessor();
  return indices;
}

}  // namespace

void WriteGlb(const TriangleMesh& mesh, std::ostream& out) {
  const Eigen::Vector3d origin =
      FloatsSuffice(mesh) ? Eigen::Vector3d::Zero().eval() : BoundingBox(mesh).center().eval();
  GlbBuilder glb;
  json attributes = {{"POSITION", AddPositions(mesh, origin, glb)}};
  if (!mesh.normals.empty()) attributes["NORMAL"] = AddNormals(mesh, glb);
  if (!mesh.colors.empty()) attributes["COLOR_0"] = AddColors(mesh, glb);
  if (!mesh.confidence.empty()) attributes["_CONFIDENCE"] = AddScalars(mesh.confidence, glb);
  for (const auto& [name, values] : mesh.scalars) attributes[AttributeName(name)] = AddScalars(values, glb);

  json node = {{"mesh", 0}, {"name", "surface"}};
  if (!origin.isZero()) node["translation"] = {origin.x(), origin.y(), origin.z()};
  json document;
  document["asset"] = {{"version", "2.0"}, {"generator", "Glint"}};
  document["scene"] = 0;
  document["scenes"] = {{{"nodes", {0}}}};
  document["nodes"] = {node};
  document["materials"] = {
      {{"pbrMetallicRoughness", {{"metallicFactor", 0.0}, {"roughnessFactor", 0.3}}}, {"doubleSided", true}}};
  document["meshes"] = {
      {{"primitives", {{{"attributes", attributes}, {"indices", AddIndices(mesh, glb)}, {"material", 0}}}}}};
  glb.Write(std::move(document), out);
}

}  // namespace glint::internal
