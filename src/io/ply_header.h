// The header of a PLY file. Internal to io/.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace glint::internal {

enum class PlyType { kInt8, kUInt8, kInt16, kUInt16, kInt32, kUInt32, kFloat32, kFloat64 };

struct PlyProperty {
  std::string name;
  PlyType type;  // of the value, or of the list's entries
  bool is_list = false;
  PlyType count_type = PlyType::kUInt8;  // of a list's length
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyEncoding { kAscii, kLittleEndian, kBigEndian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  size_t num_bytes = 0;  // of the header, with its last line's end
  uint64_t num_lines = 0;
};

size_t PlyTypeSize(PlyType type);
PlyHeader ParsePlyHeader(std::string_view bytes, const std::filesystem::path& path);

}  // namespace glint::internal
