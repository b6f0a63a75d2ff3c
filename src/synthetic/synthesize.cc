#include "synthetic/synthesize.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <opencv2/imgcodecs.hpp>

#include "core/check.h"
#include "core/error.h"
#include "synthetic/shape_mesh.h"

namespace glint {
namespace {

using Eigen::Vector3d;

Similarity MakePlacement(const SyntheticOptions& options) {
  Similarity placement{options.scale, Eigen::Quaterniond::Identity(), Vector3d::Zero()};
  if (!options.place) return placement;
  Random random({static_cast<uint64_t>(options.seed), 61});
  const Vector3d axis = random.UnitVector();
  placement.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(random.Uniform(0.3, 2.8), axis)).normalized();
  placement.translation = options.scale * random.Uniform(0.5, 3) * random.UnitVector();
  return placement;
}

Rigid3d CamFromWorld(const Rigid3d& cam_from_stage, const Similarity& world_from_stage) {
  const Eigen::Quaterniond rotation = (cam_from_stage.rotation * world_from_stage.rotation.conjugate()).normalized();
  return {rotation, world_from_stage.scale * cam_from_stage.translation - rotation * world_from_stage.translation};
}

Light LightInWorld(const Light& light, const Similarity& world_from_stage) {
  Light world = light;
  if (light.frame == LightFrame::kCamera) {
    if (light.type == LightType::kPoint) world.vector *= world_from_stage.scale;
  } else if (light.type == LightType::kPoint) {
    world.vector = world_from_stage * light.vector;
  } else {
    world.vector = world_from_stage.rotation * light.vector;
  }
  return world;
}

// Features that nothing matched, as every real model has.
void AddLonelyFeatures(const SyntheticOptions& options, Image& image) {
  Random random({static_cast<uint64_t>(options.seed), 62, image.id});
  const size_t count = image.points2d.size() / 3;
  for (size_t i = 0; i < count; ++i)
    image.points2d.push_back({{random.Uniform(0, options.width), random.Uniform(0, options.height)}});
}

Model MakeModel(const SyntheticOptions& options, const Stage& stage, const std::vector<SyntheticPoint>& points,
                const Similarity& world_from_stage) {
  Model model;
  const Camera& camera = stage.views[0].camera;
  model.cameras[camera.id] = camera;
  for (size_t v = 0; v < stage.views.size(); ++v) {
    Image image;
    image.id = static_cast<uint32_t>(v + 1);
    image.name = fmt::format("view_{:03}.{}", v, options.jpeg_quality > 0 ? "jpg" : "png");
    image.camera_id = camera.id;
    image.cam_from_world = CamFromWorld(stage.views[v].cam_from_stage, world_from_stage);
    model.images.push_back(std::move(image));
  }
  for (const SyntheticPoint& p : points) {
    Point3D point;
    point.id = model.points.size() + 1;
    point.xyz = world_from_stage * p.position;
    point.rgb = p.rgb;
    point.error_px = p.error_px;
    for (const SyntheticObservation& o : p.observations) {
      Image& image = model.images[o.view];
      point.track.push_back({image.id, static_cast<uint32_t>(image.points2d.size())});
      image.points2d.push_back({o.px, point.id});
    }
    model.points.push_back(std::move(point));
  }
  for (Image& image : model.images) AddLonelyFeatures(options, image);
  return model;
}

}  // namespace

SyntheticScene SynthesizeScene(const SyntheticOptions& options, Progress& progress) {
  if (const auto violations = Violations(options); !violations.empty())
    throw InputError("", "synthetic scene", fmt::format("{}", fmt::join(violations, "; ")));
  SyntheticScene scene;
  scene.options = options;
  progress.Begin("scene", 2);
  auto stage = std::make_shared<Stage>(MakeStage(options));
  scene.stage = stage;
  scene.world_from_stage = MakePlacement(options);
  scene.shape = PlaceShape(stage->shape, scene.world_from_stage);
  for (const StageLight& light : stage->lights)
    scene.lights.push_back(LightInWorld(light.light, scene.world_from_stage));
  progress.Advance();
  progress.ThrowIfCancelled();
  const std::vector<SyntheticPoint> points = MakeSparsePoints(*stage, options);
  for (const SyntheticPoint& p : points) scene.point_origins.push_back(p.origin);
  scene.model = MakeModel(options, *stage, points, scene.world_from_stage);
  progress.Advance();
  return scene;
}

void RenderView(const SyntheticScene& scene, size_t view, cv::Mat& image, ViewTruth& truth) {
  GLINT_CHECK_LT(view, scene.stage->views.size());
  RenderView(*scene.stage, view, {scene.options.noise_levels}, image, truth);
  for (TrueHighlight& h : truth.highlights) {
    h.position = scene.world_from_stage * h.position;
    h.normal = scene.world_from_stage.rotation * h.normal;
  }
}

std::vector<unsigned char> EncodeImage(const SyntheticScene& scene, const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  const int quality = scene.options.jpeg_quality;
  const bool encoded = quality > 0 ? cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, quality})
                                   : cv::imencode(".png", image, bytes);
  GLINT_CHECK(encoded);
  return bytes;
}

TriangleMesh TrueMesh(const SyntheticScene& scene, int resolution) {
  TriangleMesh mesh = MeshShape(*scene.stage->shape, resolution);
  for (Vector3d& x : mesh.vertices) x = scene.world_from_stage * x;
  for (Vector3d& n : mesh.normals) n = scene.world_from_stage.rotation * n;
  return mesh;
}

}  // namespace glint
