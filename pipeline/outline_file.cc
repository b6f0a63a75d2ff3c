#include "pipeline/outline_file.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "core/atomic_file.h"
#include "core/error.h"

namespace glint {
namespace {

constexpr const char* kHeader = "# view px.x px.y ray.x ray.y ray.z normal.x normal.y normal.z depth near far sigma";
constexpr double kUnitTolerance = 1e-6;

bool Sound(const OutlineSample& s, size_t num_views) {
  const auto unit = [](const Eigen::Vector3d& v) { return std::abs(v.norm() - 1) < kUnitTolerance; };
  return s.view < num_views && s.px.allFinite() && unit(s.ray) && unit(s.normal) && std::isfinite(s.far) &&
         0 < s.near && s.near <= s.depth && s.depth <= s.far && s.sigma > 0 && std::isfinite(s.sigma);
}

}  // namespace

void WriteOutline(const std::filesystem::path& path, const std::vector<OutlineSample>& outline) {
  WriteFileAtomically(path, [&](std::ostream& out) {
    out << kHeader << '\n';
    for (const OutlineSample& s : outline)
      out << fmt::format("{} {} {} {} {} {} {} {} {} {} {} {} {}\n", s.view, s.px.x(), s.px.y(), s.ray.x(), s.ray.y(),
                         s.ray.z(), s.normal.x(), s.normal.y(), s.normal.z(), s.depth, s.near, s.far, s.sigma);
  });
}

std::vector<OutlineSample> ReadOutline(const std::filesystem::path& path, size_t num_views) {
  std::ifstream in(path);
  std::string line;
  if (!std::getline(in, line) || line != kHeader)
    throw InputError(path.string(), "line 1", "expected the outlines that an earlier run leaves");
  std::vector<OutlineSample> outline;
  for (size_t number = 2; std::getline(in, line); ++number) {
    std::istringstream text(line);
    OutlineSample s;
    text >> s.view >> s.px.x() >> s.px.y() >> s.ray.x() >> s.ray.y() >> s.ray.z() >> s.normal.x() >> s.normal.y() >>
        s.normal.z() >> s.depth >> s.near >> s.far >> s.sigma;
    if (!text || (text >> std::ws, !text.eof()) || !Sound(s, num_views))
      throw InputError(
          path.string(), fmt::format("line {}", number),
          fmt::format("expected a view of {}, px, unit ray and normal, near <= depth <= far, sigma > 0", num_views));
    outline.push_back(s);
  }
  return outline;
}

}  // namespace glint
