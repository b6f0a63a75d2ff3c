// The smallest scene that a whole run has a result of, in half a second: eight small photographs of a ball, and a mesh
// to start from.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "tests/pipeline/program.h"
#include "tests/support/shared_folder.h"

namespace glint {

class SmallScene : public ProgramTest {
 protected:
  SmallScene() {
    std::filesystem::copy(testing_support::SharedFolder("small_scene", Make), folder_ / "p",
                          std::filesystem::copy_options::recursive);
    Write("c.yaml", "seed:\n  smooth:\n    edge_rel: 0.03\nrefine:\n  voxel_rel: 0.03\n  levels: 1\n");
    Write("ball.off", CoarseBall());
  }

  ProgramResult Run(const std::string& out, const std::vector<std::string>& more = {},
                    const std::string& prefix = "") const {
    std::vector<std::string> arguments = {"run",      Path("p"),        "-o",       Path(out),
                                          "--mesh",   Path("ball.off"), "--lights", Path("p/truth/lights.json"),
                                          "--config", Path("c.yaml")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunGlint(arguments, prefix);
  }

 private:
  static void Make(const std::filesystem::path& folder) {
    const ProgramResult synth =
        RunGlint({"synth", "sphere", "-o", folder.string(), "--views", "8", "--size", "160x120", "--no-place", "-q"});
    EXPECT_EQ(synth.exit_code, 0) << synth.err;
  }

  // An octahedron, each face in 16 triangles, on the sphere that the scene shows.
  static std::string CoarseBall() {
    constexpr int kSteps = 4;
    std::string vertices, faces;
    size_t count = 0;
    for (int octant = 0; octant < 8; ++octant) {
      const Eigen::Vector3d sign(octant & 1 ? -1 : 1, octant & 2 ? -1 : 1, octant & 4 ? -1 : 1);
      const auto corner = [&](int i, int j) {
        const Eigen::Vector3d x = sign.cwiseProduct(Eigen::Vector3d(i, j, kSteps - i - j)).normalized();
        vertices += fmt::format("{} {} {}\n", x.x(), x.y(), x.z());
        return count++;
      };
      const auto face = [&](size_t a, size_t b, size_t c) {
        if (sign.prod() < 0) std::swap(b, c);
        faces += fmt::format("3 {} {} {}\n", a, b, c);
      };
      for (int i = 0; i < kSteps; ++i)
        for (int j = 0; i + j < kSteps; ++j) {
          face(corner(i, j), corner(i + 1, j), corner(i, j + 1));
          if (i + j + 2 <= kSteps) face(corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
        }
    }
    return fmt::format("OFF\n{} {} 0\n{}{}", count, count / 3, vertices, faces);
  }
};

}  // namespace glint
