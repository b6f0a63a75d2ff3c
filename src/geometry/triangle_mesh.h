// An indexed triangle mesh with optional attributes a vertex.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace glint {

// Faces are counter-clockwise seen from outside. An attribute vector is empty or has one entry a vertex.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> faces;

  std::vector<Eigen::Vector3d> normals;                             // unit, outward
  std::vector<std::array<uint8_t, 3>> colors;                       // sRGB
  std::vector<float> confidence;                                    // in [0, 1]
  std::vector<std::pair<std::string, std::vector<float>>> scalars;  // any further named attribute

  bool empty() const { return faces.empty(); }
};

Eigen::AlignedBox3d BoundingBox(const TriangleMesh& mesh);

// Length of the bounding box's diagonal: the unit of every length called `_rel`. 0 for an empty mesh.
double Diagonal(const TriangleMesh& mesh);

// Unit normal of face f; zero for a face without area.
Eigen::Vector3d FaceNormal(const TriangleMesh& mesh, size_t f);

double SurfaceArea(const TriangleMesh& mesh);

// Volume by the divergence theorem; positive for a closed mesh oriented outward.
double SignedVolume(const TriangleMesh& mesh);

// A copy without the vertices that no face uses; attributes go along.
TriangleMesh WithoutUnusedVertices(const TriangleMesh& mesh);

}  // namespace glint
