#include <fmt/format.h>

#include <array>
#include <cstring>
#include <unordered_map>

#include "core/error.h"
#include "io/mesh_formats.h"
#include "io/text_scanner.h"

namespace glint::internal {
namespace {

constexpr size_t kHeaderBytes = 84, kTriangleBytes = 50;

// STL repeats a vertex for every triangle that uses it: equal coordinates are one vertex.
class VertexMerger {
 public:
  explicit VertexMerger(TriangleMesh& mesh) : mesh_(mesh) {}
  int Index(const std::array<double, 3>& xyz) {
    Key key;
    for (int k = 0; k < 3; ++k) key[k] = xyz[k] == 0 ? 0 : xyz[k];  // -0 is 0
    const auto [found, is_new] = index_.emplace(key, static_cast<int>(mesh_.vertices.size()));
    if (is_new) mesh_.vertices.emplace_back(key[0], key[1], key[2]);
    return found->second;
  }

 private:
  using Key = std::array<double, 3>;
  struct Hash {
    size_t operator()(const Key& key) const {
      uint64_t hash = 0;
      for (const double value : key) {
        uint64_t bits;
        std::memcpy(&bits, &value, sizeof(bits));
        hash = (hash ^ bits) * 0x9E3779B97F4A7C15u;
        hash ^= hash >> 32;
      }
      return hash;
    }
  };
  TriangleMesh& mesh_;
  std::unordered_map<Key, int, Hash> index_;
};

TriangleMesh ParseBinary(std::string_view bytes, uint32_t num_triangles, const std::filesystem::path& path) {
  TriangleMesh mesh;
  mesh.faces.reserve(num_triangles);
  VertexMerger merger(mesh);
  for (uint32_t i = 0; i < num_triangles; ++i) {
    const char* triangle = bytes.data() + kHeaderBytes + size_t{i} * kTriangleBytes + 3 * sizeof(float);
    std::vector<int> corners;
    for (int k = 0; k < 3; ++k, triangle += 3 * sizeof(float)) {
      std::array<float, 3> xyz;
      std::memcpy(xyz.data(), triangle, sizeof(xyz));
      for (const float value : xyz) {
        if (!std::isfinite(value))
          throw InputError(path.string(), fmt::format("triangle {}", i), "expected finite coordinates");
      }
      corners.push_back(merger.Index({xyz[0], xyz[1], xyz[2]}));
    }
    mesh.faces.emplace_back(corners[0], corners[1], corners[2]);
  }
  return mesh;
}

TriangleMesh ParseAscii(std::string_view bytes, const std::filesystem::path& path) {
  TriangleMesh mesh;
  VertexMerger merger(mesh);
  TextScanner in(bytes, path, '\0');
  in.SkipLine();  // "solid NAME"
  std::vector<int> corners;
  bool in_facet = false, ended = false;
  for (std::string_view word = in.NextWord(); !word.empty(); word = in.NextWord()) {
    if (word == "facet") {
      in_facet = true;
      corners.clear();
    } else if (word == "vertex") {
      std::array<double, 3> xyz;
      for (double& value : xyz) value = in.Number<double>("a vertex");
      for (const double value : xyz) {
        if (!std::isfinite(value)) in.Fail("expected finite coordinates");
      }
      corners.push_back(merger.Index(xyz));
    } else if (word == "endfacet") {
      if (!in_facet || corners.size() != 3)
        in.Fail(fmt::format("expected a facet of 3 vertices, found {}", corners.size()));
      mesh.faces.emplace_back(corners[0], corners[1], corners[2]);
      in_facet = false;
    } else if (word == "endsolid") {
      ended = true;
      in.SkipLine();
    } else if (word == "solid") {
      in.SkipLine();
    }
  }
  if (in_facet || !ended) in.Fail("expected 'endsolid', found the end of the file: the file is cut");
  return mesh;
}

}  // namespace

TriangleMesh ParseStl(std::string_view bytes, const std::filesystem::path& path) {
  uint32_t num_triangles = 0;
  if (bytes.size() >= kHeaderBytes) std::memcpy(&num_triangles, bytes.data() + 80, sizeof(num_triangles));
  const uint64_t expected = kHeaderBytes + uint64_t{num_triangles} * kTriangleBytes;
  // Binary files may begin with "solid", too: the size decides.
  if (bytes.size() >= kHeaderBytes && bytes.size() == expected) return ParseBinary(bytes, num_triangles, path);
  const std::string_view head = bytes.substr(0, 1000);
  if (bytes.starts_with("solid") &&
      (head.find("facet") != std::string_view::npos || head.find("endsolid") != std::string_view::npos)) {
    return ParseAscii(bytes, path);
  }
  if (bytes.size() < kHeaderBytes) {
    throw InputError(path.string(), "", fmt::format("expected an STL file, found {} bytes", bytes.size()));
  }
  if (bytes.size() > expected && num_triangles > 0) return ParseBinary(bytes, num_triangles, path);
  throw InputError(path.string(), "",
                   fmt::format("expected {} bytes for the {} triangles of a binary STL file, found {}: the file is cut",
                               expected, num_triangles, bytes.size()));
}

}  // namespace glint::internal
