#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

#include "core/error.h"
#include "io/mesh_formats.h"
#include "io/ply_header.h"
#include "io/text_scanner.h"

namespace glint::internal {
namespace {

static_assert(std::endian::native == std::endian::little);

// Reads values one after the other, of any encoding, as doubles (exact for all of PLY's types).
class PlyBody {
 public:
  PlyBody(std::string_view bytes, const PlyHeader& header, const std::filesystem::path& path)
      : encoding_(header.encoding), rest_(bytes.substr(header.num_bytes)), path_(path), text_(rest_, path, '\0') {}

  void BeginRecord(std::string_view kind, uint64_t index) { kind_ = kind, index_ = index; }

  double Read(PlyType type) {
    if (encoding_ == PlyEncoding::kAscii) {
      const std::string_view word = text_.NextWord();
      if (word.empty()) Fail("expected a number, found the end of the file");
      // Integer lists are the bulk of a file: the same parser reads both.
      double value = 0;
      const char* begin = word.data() + (word.front() == '+' ? 1 : 0);
      const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
      if (error == std::errc::result_out_of_range) return 0;
      if (error != std::errc() || end != word.data() + word.size()) {
        Fail(fmt::format("expected a number, found '{}'", word.substr(0, 60)));
      }
      return value;
    }
    const size_t size = PlyTypeSize(type);
    if (size > rest_.size()) Fail(fmt::format("expected {} more bytes, found {}: the file is cut", size, rest_.size()));
    std::array<char, 8> bytes = {};
    for (size_t i = 0; i < size; ++i) {
      bytes[encoding_ == PlyEncoding::kBigEndian ? size - 1 - i : i] = rest_[i];
    }
    rest_.remove_prefix(size);
    return FromBytes(type, bytes);
  }

  uint64_t ReadListLength(const PlyProperty& property) {
    const double length = Read(property.count_type);
    if (!(length >= 0) || length != std::floor(length) || length > static_cast<double>(Remaining())) {
      Fail(fmt::format("expected a list that fits into the file, found one of {} entries", length));
    }
    return static_cast<uint64_t>(length);
  }

  // The file must be able to hold the element's records: checked before anything is allocated for them.
  void RequireRoomFor(const PlyElement& element) {
    size_t min_bytes = 0;
    for (const PlyProperty& property : element.properties) {
      const size_t binary = PlyTypeSize(property.is_list ? property.count_type : property.type);
      min_bytes += encoding_ == PlyEncoding::kAscii ? 1 : binary;
    }
    if (min_bytes == 0 || element.count <= Remaining() / min_bytes) return;
    throw InputError(path_.string(), fmt::format("element {}", element.name),
                     fmt::format("expected {} records of at least {} bytes each, found {} bytes: the file is cut",
                                 element.count, min_bytes, Remaining()));
  }

  [[noreturn]] void Fail(std::string_view what) const {
    throw InputError(path_.string(), fmt::format("{} {}", kind_, index_), what);
  }

 private:
  static double FromBytes(PlyType type, const std::array<char, 8>& bytes) {
    const auto as = [&](auto value) {
      std::memcpy(&value, bytes.data(), sizeof(value));
      return static_cast<double>(value);
    };
    switch (type) {
      case PlyType::kInt8:
        return as(int8_t{});
      case PlyType::kUInt8:
        return as(uint8_t{});
      case PlyType::kInt16:
        return as(int16_t{});
      case PlyType::kUInt16:
        return as(uint16_t{});
      case PlyType::kInt32:
        return as(int32_t{});
      case PlyType::kUInt32:
        return as(uint32_t{});
      case PlyType::kFloat32:
        return as(float{});
      case PlyType::kFloat64:
        return as(double{});
    }
    return 0;
  }
  size_t Remaining() const { return encoding_ == PlyEncoding::kAscii ? text_.remaining() : rest_.size(); }

  PlyEncoding encoding_;
  std::string_view rest_;
  std::filesystem::path path_;
  TextScanner text_;
  std::string_view kind_;
  uint64_t index_ = 0;
};

// Which attribute a vertex property feeds, and its component there.
struct Target {
  enum Kind { kPosition, kNormal, kColor, kScalar, kIgnored } kind;
  int index;
};

// The three properties of one vector attribute. They count only together: a lone "b" is a scalar.
struct Triple {
  std::array<std::string_view, 3> names;
  Target::Kind kind;
};
constexpr std::array<Triple, 5> kTriples = {{{{"x", "y", "z"}, Target::kPosition},
                                             {{"nx", "ny", "nz"}, Target::kNormal},
                                             {{"red", "green", "blue"}, Target::kColor},
                                             {{"diffuse_red", "diffuse_green", "diffuse_blue"}, Target::kColor},
                                             {{"r", "g", "b"}, Target::kColor}}};

std::vector<Target> FindTargets(const PlyElement& element) {
  const auto find = [&](std::string_view name) {
    const auto& properties = element.properties;
    const auto found = std::find_if(properties.begin(), properties.end(),
                                    [&](const PlyProperty& p) { return p.name == name && !p.is_list; });
    return static_cast<size_t>(found - properties.begin());
  };
  std::vector<Target> targets(element.properties.size(), Target{Target::kIgnored, 0});
  std::array<bool, 4> is_taken = {};
  for (const Triple& triple : kTriples) {
    std::array<size_t, 3> at;
    for (int k = 0; k < 3; ++k) at[k] = find(triple.names[k]);
    if (is_taken[triple.kind] || *std::max_element(at.begin(), at.end()) == targets.size()) continue;
    is_taken[triple.kind] = true;
    for (int k = 0; k < 3; ++k) targets[at[k]] = {triple.kind, k};
  }
  int num_scalars = 0;
  for (size_t p = 0; p < targets.size(); ++p) {
    if (targets[p].kind != Target::kIgnored || element.properties[p].is_list) continue;
    targets[p] = {Target::kScalar, num_scalars++};
  }
  return targets;
}

uint8_t ColorByte(double value, PlyType type) {
  if (type == PlyType::kFloat32 || type == PlyType::kFloat64) value *= 255;
  if (type == PlyType::kUInt16) value /= 257;
  return static_cast<uint8_t>(std::clamp(std::isfinite(value) ? std::round(value) : 0, 0.0, 255.0));
}

void ReadVertices(const PlyElement& element, PlyBody& body, const std::filesystem::path& path, TriangleMesh& mesh) {
  const std::vector<Target> targets = FindTargets(element);
  const auto has = [&](Target::Kind kind) {
    return std::any_of(targets.begin(), targets.end(), [&](const Target& target) { return target.kind == kind; });
  };
  if (!has(Target::kPosition)) throw InputError(path.string(), "element vertex", "expected the properties x, y and z");
  mesh.vertices.assign(element.count, Eigen::Vector3d::Zero());
  if (has(Target::kNormal)) mesh.normals.assign(element.count, Eigen::Vector3d::Zero());
  if (has(Target::kColor)) mesh.colors.assign(element.count, {0, 0, 0});
  for (size_t p = 0; p < targets.size(); ++p) {
    if (targets[p].kind != Target::kScalar) continue;
    mesh.scalars.emplace_back(element.properties[p].name, std::vector<float>(element.count));
  }

  for (uint64_t i = 0; i < element.count; ++i) {
    body.BeginRecord("vertex", i);
    for (size_t p = 0; p < targets.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (property.is_list) {
        for (uint64_t n = body.ReadListLength(property); n > 0; --n) body.Read(property.type);
        continue;
      }
      const double value = body.Read(property.type);
      const Target target = targets[p];
      if (target.kind == Target::kPosition) mesh.vertices[i][target.index] = value;
      if (target.kind == Target::kNormal) mesh.normals[i][target.index] = value;
      if (target.kind == Target::kColor) mesh.colors[i][target.index] = ColorByte(value, property.type);
      if (target.kind == Target::kScalar) mesh.scalars[target.index].second[i] = static_cast<float>(value);
    }
    if (!mesh.vertices[i].allFinite()) body.Fail("expected finite coordinates");
  }
}

// Triangles from lists of vertex indices; they are checked and triangulated once all vertices are known.
void ReadFaces(const PlyElement& element, PlyBody& body, std::vector<int>& lengths, std::vector<int>& indices) {
  if (element.properties.empty()) return;  // takes no room in the file, whatever the count
  for (uint64_t i = 0; i < element.count; ++i) {
    body.BeginRecord("face", i);
    for (const PlyProperty& property : element.properties) {
      const bool is_face = property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index");
      const uint64_t length = property.is_list ? body.ReadListLength(property) : 1;
      for (uint64_t k = 0; k < length; ++k) {
        const double value = body.Read(property.type);
        if (!is_face) continue;
        if (!(value >= 0 && value <= 2147483647.0)) body.Fail(fmt::format("expected a vertex index, found {}", value));
        indices.push_back(static_cast<int>(value));
      }
      if (is_face) lengths.push_back(static_cast<int>(length));
    }
  }
}

void SkipElement(const PlyElement& element, PlyBody& body) {
  if (element.properties.empty()) return;
  for (uint64_t i = 0; i < element.count; ++i) {
    body.BeginRecord(element.name, i);
    for (const PlyProperty& property : element.properties) {
      for (uint64_t n = property.is_list ? body.ReadListLength(property) : 1; n > 0; --n) body.Read(property.type);
    }
  }
}

// `confidence` has its own place as long as it is one.
void TakeConfidence(TriangleMesh& mesh) {
  for (auto it = mesh.scalars.begin(); it != mesh.scalars.end(); ++it) {
    if (it->first != "confidence") continue;
    for (const float value : it->second) {
      if (!(value >= 0 && value <= 1)) return;
    }
    mesh.confidence = std::move(it->second);
    mesh.scalars.erase(it);
    return;
  }
}

}  // namespace

TriangleMesh ParsePly(std::string_view bytes, const std::filesystem::path& path) {
  const PlyHeader header = ParsePlyHeader(bytes, path);
  PlyBody body(bytes, header, path);
  TriangleMesh mesh;
  std::vector<int> lengths, indices;
  bool has_vertices = false;
  for (const PlyElement& element : header.elements) {
    body.RequireRoomFor(element);
    if (element.name == "vertex" && !has_vertices) {
      ReadVertices(element, body, path, mesh);
      has_vertices = true;
    } else if (element.name == "face") {
      ReadFaces(element, body, lengths, indices);
    } else {
      SkipElement(element, body);
    }
  }
  if (!has_vertices) throw InputError(path.string(), "header", "expected 'element vertex', found none");
  TakeConfidence(mesh);
  std::vector<int> polygon;
  size_t first = 0;
  for (size_t f = 0; f < lengths.size(); ++f) {
    polygon.assign(indices.begin() + static_cast<std::ptrdiff_t>(first),
                   indices.begin() + static_cast<std::ptrdiff_t>(first + lengths[f]));
    first += lengths[f];
    AppendCheckedPolygon(mesh, polygon, path, "face", f);
  }
  return mesh;
}

}  // namespace glint::internal
