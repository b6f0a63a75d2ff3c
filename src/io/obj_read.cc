#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "io/mesh_formats.h"
#include "io/text_scanner.h"

namespace glint::internal {
namespace {

// An OBJ index counts from 1, or backwards from the last one read so far.
int ResolveIndex(std::string_view text, size_t count, std::string_view kind, const TextScanner& in) {
  const int64_t index = in.ParseNumber<int64_t>(text, fmt::format("the index of a {}", kind));
  const int64_t resolved = index < 0 ? index + static_cast<int64_t>(count) : index - 1;
  if (index == 0 || resolved < 0 || resolved >= static_cast<int64_t>(count)) {
    in.Fail(fmt::format("expected the index of one of the {} {} so far, found {}", count,
                        kind == "vertex" ? "vertices" : "normals", index));
  }
  return static_cast<int>(resolved);
}

class ObjParser {
 public:
  ObjParser(std::string_view bytes, const std::filesystem::path& path) : in_(bytes, path, '#'), path_(path) {}

  TriangleMesh Parse() {
    while (in_.remaining() > 0) {
      const std::string_view keyword = in_.NextWordInLine();
      if (keyword == "v") ReadVertex();
      if (keyword == "vn") normals_.push_back(ReadVector("a normal"));
      if (keyword == "f") ReadFace();
      in_.SkipLine();
    }
    TakeColors();
    TakeNormals();
    return std::move(mesh_);
  }

 private:
  // A line that ends in a backslash goes on in the next.
  std::string_view Word() {
    std::string_view word = in_.NextWordInLine();
    while (word == "\\") {
      in_.SkipLine();
      word = in_.NextWordInLine();
    }
    return word;
  }

  Eigen::Vector3d ReadVector(std::string_view what) {
    Eigen::Vector3d v;
    for (double& value : v) {
      const std::string_view word = Word();
      if (word.empty()) in_.Fail(fmt::format("expected three numbers for {}, found the end of the line", what));
      value = in_.ParseNumber<double>(word, what);
    }
    if (!v.allFinite()) in_.Fail(fmt::format("expected finite numbers for {}", what));
    return v;
  }

  void ReadVertex() {
    mesh_.vertices.push_back(ReadVector("a vertex"));
    std::array<double, 4> extra = {};
    size_t num_extra = 0;
    for (std::string_view word = Word(); !word.empty() && num_extra < 4; word = Word()) {
      extra[num_extra++] = in_.ParseNumber<double>(word, "a vertex's colour");
    }
    // One more number is a weight, three are a colour.
    if (num_extra >= 3) colors_.emplace_back(extra[0], extra[1], extra[2]);
  }

  void ReadFace() {
    polygon_.clear();
    for (std::string_view word = Word(); !word.empty(); word = Word()) {
      const size_t slash = std::min(word.find('/'), word.size());
      const int vertex = ResolveIndex(word.substr(0, slash), mesh_.vertices.size(), "vertex", in_);
      polygon_.push_back(vertex);
      const size_t second = word.find('/', slash + 1);
      if (second == std::string_view::npos || second + 1 == word.size()) continue;
      NoteNormal(vertex, ResolveIndex(word.substr(second + 1), normals_.size(), "normal", in_));
    }
    AppendCheckedPolygon(mesh_, polygon_, path_, "line", in_.line());
  }

  // A vertex keeps its normal only if all of its corners agree on it.
  void NoteNormal(int vertex, int normal) {
    if (normal_of_vertex_.size() < mesh_.vertices.size()) normal_of_vertex_.resize(mesh_.vertices.size(), kUnset);
    int& known = normal_of_vertex_[vertex];
    if (known == kUnset) {
      known = normal;
    } else if (known != normal && normals_[known] != normals_[normal]) {
      normals_agree_ = false;
    }
  }

  void TakeNormals() {
    if (!normals_agree_ || normal_of_vertex_.size() != mesh_.vertices.size()) return;
    if (std::find(normal_of_vertex_.begin(), normal_of_vertex_.end(), kUnset) != normal_of_vertex_.end()) return;
    for (const int normal : normal_of_vertex_) mesh_.normals.push_back(normals_[normal]);
  }

  void TakeColors() {
    if (colors_.empty() || colors_.size() != mesh_.vertices.size()) return;
    double largest = 0;
    for (const auto& color : colors_) largest = std::max(largest, color.maxCoeff());
    const double scale = largest > 1 ? 1 : 255;
    for (const auto& color : colors_) {
      auto& out = mesh_.colors.emplace_back();
      for (int k = 0; k < 3; ++k) {
        out[k] =
            static_cast<uint8_t>(std::clamp(std::isfinite(color[k]) ? std::round(scale * color[k]) : 0, 0.0, 255.0));
      }
    }
  }

  static constexpr int kUnset = -1;
  TextScanner in_;
  std::filesystem::path path_;
  TriangleMesh mesh_;
  std::vector<Eigen::Vector3d> normals_, colors_;
  std::vector<int> polygon_, normal_of_vertex_;
  bool normals_agree_ = true;
};

}  // namespace

TriangleMesh ParseObj(std::string_view bytes, const std::filesystem::path& path) {
  return ObjParser(bytes, path).Parse();
}

}  // namespace glint::internal
