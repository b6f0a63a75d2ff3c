#include "io/ply_header.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <utility>

#include "core/error.h"
#include "io/text_scanner.h"

namespace glint::internal {
namespace {

std::optional<PlyType> TypeFromName(std::string_view name) {
  constexpr std::pair<std::string_view, PlyType> kNames[] = {
      {"char", PlyType::kInt8},      {"int8", PlyType::kInt8},       {"uchar", PlyType::kUInt8},
      {"uint8", PlyType::kUInt8},    {"short", PlyType::kInt16},     {"int16", PlyType::kInt16},
      {"ushort", PlyType::kUInt16},  {"uint16", PlyType::kUInt16},   {"int", PlyType::kInt32},
      {"int32", PlyType::kInt32},    {"uint", PlyType::kUInt32},     {"uint32", PlyType::kUInt32},
      {"float", PlyType::kFloat32},  {"float32", PlyType::kFloat32}, {"double", PlyType::kFloat64},
      {"float64", PlyType::kFloat64}};
  for (const auto& [known, type] : kNames) {
    if (known == name) return type;
  }
  return std::nullopt;
}

// The words of one line, at most 6.
std::vector<std::string_view> Words(std::string_view line) {
  std::vector<std::string_view> words;
  for (size_t i = 0; i < line.size() && words.size() < 6;) {
    const size_t end = std::min(line.find_first_of(" \t\r", i), line.size());
    if (end > i) words.push_back(line.substr(i, end - i));
    i = end + 1;
  }
  return words;
}

}  // namespace

size_t PlyTypeSize(PlyType type) {
  constexpr std::array<size_t, 8> kSizes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<size_t>(type)];
}

PlyHeader ParsePlyHeader(std::string_view bytes, const std::filesystem::path& path) {
  PlyHeader header;
  TextScanner scanner(bytes, path, '\0');
  std::string_view line;
  bool has_format = false;
  const auto fail = [&](std::string_view what) {
    throw InputError(path.string(), fmt::format("line {}", scanner.line() - 1), what);
  };
  const auto type = [&](std::string_view name) {
    const auto found = TypeFromName(name);
    if (!found) fail(fmt::format("expected a PLY type such as float or uchar, found '{}'", name.substr(0, 60)));
    return *found;
  };
  scanner.NextLine(line);
  if (line != "ply") throw InputError(path.string(), "line 1", "expected 'ply'");
  while (true) {
    if (scanner.line() > 10000 || !scanner.NextLine(line)) {
      throw InputError(path.string(), "header", "expected 'end_header', found the end of the file");
    }
    const auto words = Words(line);
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "end_header") break;
    if (words[0] == "format" && words.size() >= 2) {
      has_format = true;
      if (words[1] == "ascii") {
        header.encoding = PlyEncoding::kAscii;
      } else if (words[1] == "binary_little_endian") {
        header.encoding = PlyEncoding::kLittleEndian;
      } else if (words[1] == "binary_big_endian") {
        header.encoding = PlyEncoding::kBigEndian;
      } else {
        fail("expected the format ascii, binary_little_endian or binary_big_endian");
      }
    } else if (words[0] == "element" && words.size() == 3) {
      header.elements.push_back(
          {std::string(words[1]), scanner.ParseNumber<uint64_t>(words[2], "an element count"), {}});
    } else if (words[0] == "property" && !header.elements.empty() && words.size() == 3) {
      header.elements.back().properties.push_back({std::string(words[2]), type(words[1])});
    } else if (words[0] == "property" && !header.elements.empty() && words.size() == 5 && words[1] == "list") {
      const PlyType count_type = type(words[2]);
      if (count_type == PlyType::kFloat32 || count_type == PlyType::kFloat64) {
        fail("expected a list whose length is an integer");
      }
      header.elements.back().properties.push_back({std::string(words[4]), type(words[3]), true, count_type});
    } else {
      fail(fmt::format("expected a line of a PLY header, found '{}'", line.substr(0, 80)));
    }
  }
  if (!has_format) throw InputError(path.string(), "header", "expected a line 'format ...', found none");
  header.num_bytes = bytes.size() - scanner.remaining();
  header.num_lines = scanner.line() - 1;
  return header;
}

}  // namespace glint::internal
