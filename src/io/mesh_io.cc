#include "io/mesh_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string>

#include "core/atomic_file.h"
#include "core/check.h"
#include "core/error.h"
#include "io/mesh_formats.h"

namespace glint {
namespace internal {

bool FloatsSuffice(const TriangleMesh& mesh) {
  constexpr double kHalfUlp = 1.0 / (1 << 24), kTolerance = 1e-6;
  double largest = 0;
  for (const Eigen::Vector3d& v : mesh.vertices) largest = std::max(largest, v.cwiseAbs().maxCoeff());
  // Beyond the range of floats, doubles are needed whatever the size; near its lower end floats lose digits.
  if (largest > 1e37 || largest < 1e-30) return mesh.vertices.empty() || largest == 0;
  return largest * kHalfUlp <= kTolerance * Diagonal(mesh);
}

}  // namespace internal

namespace {

std::string Extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

std::string ReadFile(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw InputError(path.string(), "",
                     std::filesystem::is_directory(path, error) ? "expected a mesh file, found a folder"
                                                                : "expected a mesh file, found nothing");
  }
  std::ifstream in(path, std::ios::binary);
  std::string bytes(std::filesystem::file_size(path), '\0');
  if (!in || !in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    throw InputError(path.string(), "", "cannot be read");
  }
  return bytes;
}

TriangleMesh Parse(const std::filesystem::path& path) {
  const std::string bytes = ReadFile(path);
  const std::string extension = Extension(path);
  const std::string_view head = std::string_view(bytes).substr(0, 6);
  if (head.starts_with("ply\n") || head.starts_with("ply\r")) return internal::ParsePly(bytes, path);
  if (head.starts_with("OFF") || (extension == ".off" && head.find("OFF") != std::string_view::npos)) {
    return internal::ParseOff(bytes, path);
  }
  if (extension == ".stl") return internal::ParseStl(bytes, path);
  if (extension == ".obj") return internal::ParseObj(bytes, path);
  if (extension == ".ply") return internal::ParsePly(bytes, path);  // says what it misses
  if (extension == ".off") return internal::ParseOff(bytes, path);
  throw InputError(path.string(), "", "expected a PLY, OBJ, OFF or STL file");
}

void NormalizeNormals(std::vector<Eigen::Vector3d>& normals) {
  for (Eigen::Vector3d& normal : normals) {
    const double length = normal.norm();
    normal = std::isfinite(length) && length > 0 ? Eigen::Vector3d(normal / length) : Eigen::Vector3d::Zero();
  }
}

void CheckAttributes(const TriangleMesh& mesh) {
  const size_t n = mesh.vertices.size();
  const auto fits = [&](size_t size) { return size == 0 || size == n; };
  GLINT_CHECK(fits(mesh.normals.size()));
  GLINT_CHECK(fits(mesh.colors.size()));
  GLINT_CHECK(fits(mesh.confidence.size()));
  for (const auto& [name, values] : mesh.scalars) {
    GLINT_CHECK_EQ(values.size(), n);
    GLINT_CHECK(!name.empty() && name.find_first_of(" \t\r\n") == std::string::npos);
  }
}

}  // namespace

TriangleMesh ReadMesh(const std::filesystem::path& path) {
  TriangleMesh mesh = Parse(path);
  if (mesh.faces.empty()) {
    throw InputError(path.string(), "",
                     fmt::format("expected a mesh, found no face ({} vertices)", mesh.vertices.size()));
  }
  NormalizeNormals(mesh.normals);
  return mesh;
}

PointCloud ReadPointCloud(const std::filesystem::path& path) {
  TriangleMesh mesh = Parse(path);
  if (mesh.vertices.empty()) throw InputError(path.string(), "", "expected a point cloud, found no point");
  NormalizeNormals(mesh.normals);
  return {std::move(mesh.vertices), std::move(mesh.normals), std::move(mesh.colors)};
}

void WriteMesh(const std::filesystem::path& path, const TriangleMesh& mesh) {
  CheckAttributes(mesh);
  const std::string extension = Extension(path);
  using Writer = void (*)(const TriangleMesh&, std::ostream&);
  const Writer write = extension == ".ply"   ? internal::WritePly
                       : extension == ".obj" ? internal::WriteObj
                       : extension == ".glb" ? internal::WriteGlb
                                             : Writer{nullptr};
  if (!write) throw InputError(path.string(), "", "expected a file name that ends in .ply, .obj or .glb");
  WriteFileAtomically(path, [&](std::ostream& out) { write(mesh, out); });
}

}  // namespace glint
