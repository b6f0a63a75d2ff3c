#include "pipeline/similarity.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace glint {

Eigen::Affine3d ReadSimilarity(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!std::filesystem::is_regular_file(path) || !in)
    throw InputError(path.string(), "", "cannot be read; expected a JSON file with scale, R and t");
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  double scale = 0;
  try {
    const nlohmann::json json = nlohmann::json::parse(in);
    scale = json.at("scale").get<double>();
    for (int r = 0; r < 3; ++r) {
      translation[r] = json.at("t").at(r).get<double>();
      for (int c = 0; c < 3; ++c) rotation(r, c) = json.at("R").at(r).at(c).get<double>();
    }
  } catch (const nlohmann::json::exception& e) {
    throw InputError(path.string(), "", fmt::format("expected scale, R (3 rows of 3) and t: {}", e.what()));
  }
  if (!(scale > 0) || !translation.allFinite() || !rotation.isUnitary(1e-3) || rotation.determinant() < 0)
    throw InputError(path.string(), "R", "expected a positive scale, a rotation and a finite translation");
  return Eigen::Translation3d(translation) * Eigen::Affine3d(scale * rotation);
}

void Transform(const Eigen::Affine3d& similarity, TriangleMesh& mesh) {
  for (Eigen::Vector3d& x : mesh.vertices) x = similarity * x;
  for (Eigen::Vector3d& n : mesh.normals) n = (similarity.linear() * n).normalized();
}

void Transform(const Eigen::Affine3d& similarity, Scene& scene) {
  const Eigen::Quaterniond rotation(similarity.rotation());
  for (View& view : scene.views) {
    const Eigen::Vector3d center = similarity * view.Center();
    view.cam_from_world.rotation = (view.cam_from_world.rotation * rotation.conjugate()).normalized();
    view.cam_from_world.translation = -(view.cam_from_world.rotation * center);
  }
  for (ScenePoint& point : scene.points) point.position = similarity * point.position;
}

void Transform(const Eigen::Affine3d& similarity, std::vector<Light>& lights) {
  const double scale = std::cbrt(similarity.linear().determinant());
  for (Light& light : lights) {
    const bool world = light.frame == LightFrame::kWorld;
    if (light.type == LightType::kDistant) {
      if (world) light.vector = (similarity.linear() * light.vector).normalized();
    } else {
      light.vector = world ? Eigen::Vector3d(similarity * light.vector) : Eigen::Vector3d(scale * light.vector);
      light.sigma *= scale;
    }
  }
}

}  // namespace glint
