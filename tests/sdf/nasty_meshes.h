// Random meshes from a grammar of nastiness.
#pragma once

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "tests/geometry/test_meshes.h"

namespace glint::testing {

struct NastyMesh {
  TriangleMesh mesh;
  std::string story;   // what was done, for reports
  bool sound = true;   // closed, oriented outward, no self-intersections: pseudo-normals are exact
  bool usable = true;  // indices in range, coordinates finite, at least one face with three different corners
};

// mesh := base fault* placement
class NastyMeshes {
 public:
  explicit NastyMeshes(unsigned seed) : random_(seed) {}

  NastyMesh Make() {
    NastyMesh out;
    Base(out);
    for (int faults = Below(4); faults > 0; --faults) Fault(out);
    Place(out);
    if (Below(10) == 0) Break(out);
    out.usable = Usable(out.mesh);
    return out;
  }

  double Uniform() { return random_() / 4294967295.0; }
  int Below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  Eigen::Vector3d Direction() { return Eigen::Vector3d(Uniform() - 0.5, Uniform() - 0.5, Uniform() - 0.5); }

 private:
  void Base(NastyMesh& out) {
    switch (Below(7)) {
      case 0:
        out.mesh = Icosphere(Below(4)), out.story = "sphere";
        break;
      case 1:
        out.mesh = Box({-1, -1, -1}, {1, std::pow(10, -6 * Uniform()) - 0.9999999, 1}), out.story = "box";
        break;
      case 2:
      case 3:
        out.mesh = SpikySphere(1 + Below(3), Uniform(), random_()), out.story = "spiky";
        break;
      case 4:
        out.mesh = Joined(Icosphere(2), Inverted(Transformed(Icosphere(1), 0.5, 0.3 * Direction())));
        out.story = "hollow";
        break;
      case 5:
        out.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        out.mesh.faces = {{0, 1, 2}};
        out.sound = false, out.story = "triangle";
        break;
      default:
        for (int i = 0; i < 12; ++i) out.mesh.vertices.push_back(2 * Direction());
        for (int i = 0; i < 20; ++i) out.mesh.faces.emplace_back(Below(12), Below(12), Below(12));
        out.mesh.faces.emplace_back(0, 1, 2);
        out.sound = false, out.story = "soup";
    }
  }

  size_t SomeFace(const TriangleMesh& m) { return random_() % m.faces.size(); }
  size_t SomeVertex(const TriangleMesh& m) { return random_() % m.vertices.size(); }

  void Fault(NastyMesh& out) {
    TriangleMesh& m = out.mesh;
    const int kind = Below(15);
    static constexpr const char* kNames[15] = {
        "duplicate face", "duplicate turned", "missing faces",   "turned face",     "collapsed face",
        "needle face",    "unwelded",         "overlap",         "nested",          "fin",
        "T-junction",     "vertex moved",     "unused vertices", "vertices merged", "all turned"};
    out.story += std::string(", ") + kNames[kind];
    bool harmless = false;
    switch (kind) {
      case 0:
        m.faces.push_back(m.faces[SomeFace(m)]);
        break;
      case 1: {
        const Eigen::Vector3i f = m.faces[SomeFace(m)];
        m.faces.emplace_back(f[1], f[0], f[2]);
        break;
      }
      case 2:
        if (m.faces.size() > 3) m.faces.resize(m.faces.size() - 1 - SomeFace(m) / 2);
        break;
      case 3: {
        Eigen::Vector3i& f = m.faces[SomeFace(m)];
        std::swap(f[0], f[1]);
        break;
      }
      case 4: {
        const int v = static_cast<int>(SomeVertex(m));
        m.faces.emplace_back(v, v, static_cast<int>(SomeVertex(m)));
        harmless = true;
        break;
      }
      case 5: {  // three points of a line, and nearly so
        const Eigen::Vector3d a = m.vertices[SomeVertex(m)], d = Direction();
        const int n = static_cast<int>(m.vertices.size());
        m.vertices.insert(m.vertices.end(), {a, a + d, a + Uniform() * d + 1e-14 * Below(3) * Direction()});
        m.faces.emplace_back(n, n + 1, n + 2);
        break;
      }
      case 6:
        m = Soup(m), harmless = true;
        break;
      case 7:
        m = Joined(m, Transformed(Icosphere(1), 0.7, Direction()));
        break;
      case 8:
        m = Joined(m, Transformed(m, 0.3, Direction() * 0.1));
        break;
      case 9: {
        const Eigen::Vector3i f = m.faces[SomeFace(m)];
        m.vertices.push_back(2 * Direction());
        m.faces.emplace_back(f[0], f[1], static_cast<int>(m.vertices.size()) - 1);
        break;
      }
      case 10: {  // a face cut in two, its neighbour not
        const size_t f = SomeFace(m);
        const Eigen::Vector3i face = m.faces[f];
        m.vertices.push_back((m.vertices[face[0]] + m.vertices[face[1]]) / 2);
        const int n = static_cast<int>(m.vertices.size()) - 1;
        m.faces[f] = {face[0], n, face[2]};
        m.faces.emplace_back(n, face[1], face[2]);
        break;
      }
      case 11:
        m.vertices[SomeVertex(m)] += Direction();
        break;
      case 12:
        m.vertices.push_back(Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
        harmless = true;
        break;
      case 13:
        m.vertices[SomeVertex(m)] = m.vertices[SomeVertex(m)];
        break;
      default:
        m = Inverted(m);
        harmless = true;
    }
    if (!harmless) out.sound = false;
  }

  // Something that must be refused, unless no face uses it.
  void Break(NastyMesh& out) {
    TriangleMesh& m = out.mesh;
    int& index = m.faces[SomeFace(m)][Below(3)];
    out.sound = false;
    switch (Below(4)) {
      case 0:
        m.vertices[static_cast<size_t>(index)][Below(3)] = std::numeric_limits<double>::quiet_NaN();
        break;
      case 1:
        m.vertices[static_cast<size_t>(index)][Below(3)] = -std::numeric_limits<double>::infinity();
        break;
      case 2:
        index = -1 - Below(1 << 30);
        break;
      default:
        index = static_cast<int>(m.vertices.size()) + Below(9);
    }
    out.story += ", broken";
  }

  static bool Usable(const TriangleMesh& m) {
    bool any = false;
    for (const Eigen::Vector3i& f : m.faces) {
      for (int k = 0; k < 3; ++k)
        if (f[k] < 0 || f[k] >= static_cast<int>(m.vertices.size()) ||
            !m.vertices[static_cast<size_t>(f[k])].allFinite())
          return false;
      const auto differ = [&](int i, int j) {
        return m.vertices[static_cast<size_t>(f[i])] != m.vertices[static_cast<size_t>(f[j])];
      };
      any = any || (differ(0, 1) && differ(1, 2) && differ(2, 0));
    }
    return any;
  }

  void Place(NastyMesh& out) {
    static constexpr double kScales[] = {1, 1, 1, 1e-3, 1e6, 1e-6};
    const double scale = kScales[Below(6)], far = Below(2) ? std::pow(10, 6 * Uniform()) : 0;
    out.mesh = Transformed(out.mesh, scale, scale * far * Direction());
    out.story += " at " + std::to_string(far) + " times " + std::to_string(scale);
  }

  std::mt19937 random_;
};

}  // namespace glint::testing
