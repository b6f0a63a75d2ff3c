// Sets a stage up from the options: shape, paint, marks, lights, cameras.
#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/square.h"
#include "synthetic/stage.h"

namespace glint {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kMarksPerPoint = 0.6;  // a mark has two to three features, most of which become points
constexpr double kFill = 0.86;          // of the frame's width or height, by the object

std::vector<Vector3d> SampleSurfacePoints(const ImplicitShape& shape, int count, uint64_t seed) {
  Random random({seed, 31});
  std::vector<Vector3d> points;
  for (int tries = 0; static_cast<int>(points.size()) < count && tries < 100 * count; ++tries)
    if (const auto hit = SampleSurface(shape, random)) points.push_back(hit->position);
  GLINT_CHECK(!points.empty());
  return points;
}

Gloss MakeGloss(const SyntheticOptions& options) {
  Random random({static_cast<uint64_t>(options.seed), 32});
  Gloss gloss;
  gloss.alpha = options.roughness;
  gloss.reflectance = Array3d::Constant(options.reflectance);
  static const std::vector<Array3d> paints = {
      {0.32, 0.025, 0.03}, {0.03, 0.07, 0.30}, {0.02, 0.20, 0.10}, {0.38, 0.17, 0.02}, {0.14, 0.03, 0.22}};
  static const std::vector<Array3d> metals = {{0.90, 0.68, 0.34}, {0.82, 0.52, 0.40}, {0.58, 0.57, 0.56}};
  const double shade = random.Uniform(0.85, 1.15);
  if (options.base == "white") gloss.albedo = Array3d(0.62, 0.61, 0.585);
  if (options.base == "black") gloss.albedo = Array3d(0.018, 0.018, 0.020) * shade;
  if (options.base == "coloured") gloss.albedo = paints[random.Index(static_cast<int>(paints.size()))] * shade;
  if (options.base == "metallic") {
    gloss.albedo = Array3d::Zero();
    gloss.reflectance = metals[random.Index(static_cast<int>(metals.size()))];
  }
  if (options.scene == "pane") gloss.transmittance = Array3d(0.76, 0.82, 0.79);
  return gloss;
}

std::vector<Array3d> MarkPalette(const Gloss& gloss) {
  const bool dark = gloss.albedo.mean() < 0.3 && gloss.reflectance.mean() < 0.3;
  if (dark) return {{0.75, 0.73, 0.70}, {0.70, 0.52, 0.10}, {0.35, 0.60, 0.70}, {0.75, 0.73, 0.70}};
  return {{0.03, 0.03, 0.03}, {0.05, 0.08, 0.30}, {0.35, 0.04, 0.03}, {0.03, 0.03, 0.03}};
}

// True if enough views look at the place to triangulate it (as many as a scene of few views can give).
bool WellSeen(const Stage& stage, const ShapeHit& place) {
  const int enough = std::min<int>(4, 1 + static_cast<int>(stage.views.size()) / 8);
  const SurfaceHit hit{SurfaceKind::kObject, 0, place.position, place.normal};
  int seen = 0;
  for (const StageView& view : stage.views) {
    const Vector3d to_viewer = (view.Center() - place.position).normalized();
    if (to_viewer.dot(place.normal) > 0.45 && stage.SeenAt(view, hit) && ++seen >= enough) return true;
  }
  return false;
}

// Of the surface that is well seen, the upper half is nearly blank, and so is clear glass. About enough marks for the
// points asked for.
Marks MakeMarks(const SyntheticOptions& options, const Stage& stage) {
  Random random({stage.seed, 33});
  std::vector<double> heights;
  for (int tries = 0; tries < 3000 && heights.size() < 1000; ++tries) {
    const auto hit = SampleSurface(*stage.shape, random);
    if (hit && WellSeen(stage, *hit)) heights.push_back(hit->position.z());
  }
  GLINT_CHECK(!heights.empty());
  std::nth_element(heights.begin(), heights.begin() + heights.size() / 2, heights.end());
  const double median = heights[heights.size() / 2];
  const std::vector<Array3d> palette = MarkPalette(stage.gloss);
  const int count = static_cast<int>(std::ceil(options.object_points * kMarksPerPoint));
  const int upper = static_cast<int>(std::lround(options.glossy_share * count));
  const int wanted[2] = {count - upper, upper};
  int made[2] = {0, 0};
  std::vector<Mark> marks;
  for (int tries = 0; made[0] + made[1] < count && tries < 100 * count; ++tries) {
    const auto hit = SampleSurface(*stage.shape, random);
    if (!hit) continue;
    const int half = hit->position.z() > median;
    if (made[half] >= wanted[half] || !WellSeen(stage, *hit)) continue;
    if (!stage.OpaqueAt(hit->position) && random.Uniform() > 0.05) continue;
    const Mark mark = MakeMark(*hit, palette, random);
    const bool overlaps = std::any_of(marks.begin(), marks.end(), [&](const Mark& other) {
      return (other.position - mark.position).norm() < 1.1 * (other.radius + mark.radius);
    });
    if (overlaps) continue;
    marks.push_back(mark);
    ++made[half];
  }
  return Marks(std::move(marks), median);
}

std::vector<StageLight> MakeLights(const SyntheticOptions& options) {
  Random random({static_cast<uint64_t>(options.seed), 34});
  static constexpr double kShares[3][3] = {{0.75, 0, 0}, {0.50, 0.45, 0}, {0.38, 0.34, 0.30}};
  const double first = random.Uniform(0, 2 * kPi);
  std::vector<StageLight> lights;
  for (int i = 0; i < options.lights; ++i) {
    const double azimuth = first + (2 * kPi * i + random.Uniform(-0.6, 0.6)) / std::max(options.lights, 2);
    const double elevation = random.Uniform(38, 62) * kPi / 180;
    const Vector3d direction(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
                             std::sin(elevation));
    // Beside the camera: above it, to the right, to the left.
    const Vector3d aside = Vector3d(i == 0   ? 0.25
                                    : i == 1 ? 0.55
                                             : -0.5,
                                    i == 0 ? -0.35 : -0.2, 0) *
                           random.Uniform(0.8, 1.2);
    StageLight light{{}, kShares[options.lights - 1][i], 1};
    if (options.light_kind == "distant") light.light.vector = direction;
    if (options.light_kind == "camera") light.light.vector = (2 * aside - Vector3d(0, 0, 1)).normalized();
    if (options.light_kind == "point") light.light.vector = direction * random.Uniform(2.6, 4);
    if (options.light_kind == "flash") light.light.vector = aside;
    const bool point = options.light_kind == "point" || options.light_kind == "flash";
    const bool moving = options.light_kind == "camera" || options.light_kind == "flash";
    light.light.type = point ? LightType::kPoint : LightType::kDistant;
    light.light.frame = moving ? LightFrame::kCamera : LightFrame::kWorld;
    light.reference_distance = light.light.vector.norm();
    lights.push_back(light);
  }
  return lights;
}

Camera MakeCamera(const SyntheticOptions& options) {
  Camera camera;
  camera.id = 1;
  camera.width = options.width;
  camera.height = options.height;
  const double f = 0.5 * options.width / std::tan(0.5 * options.fov_deg * kPi / 180);
  const double cx = 0.5 * options.width, cy = 0.5 * options.height;
  camera.model = *CameraModelFromName(options.camera_model);
  if (options.camera_model == "PINHOLE") camera.params = {f, f, cx, cy};
  if (options.camera_model == "SIMPLE_RADIAL") camera.params = {f, cx, cy, -0.06};
  if (options.camera_model == "OPENCV") camera.params = {f, 1.002 * f, cx, cy, -0.12, 0.05, 8e-4, -6e-4};
  return camera;
}

Rigid3d LookAt(const Vector3d& center, const Vector3d& target, double roll) {
  const Vector3d forward = (target - center).normalized();
  const Vector3d right = forward.cross(Vector3d::UnitZ()).normalized(), down = forward.cross(right);
  Eigen::Matrix3d axes;
  axes.row(0) = std::cos(roll) * right + std::sin(roll) * down;
  axes.row(1) = -std::sin(roll) * right + std::cos(roll) * down;
  axes.row(2) = forward;
  const Eigen::Quaterniond rotation = Eigen::Quaterniond(axes).normalized();
  return {rotation, -(rotation * center)};
}

// Largest extent of the points from the image's middle, 1 at the border.
double Extent(const Camera& camera, const Rigid3d& cam_from_stage, const std::vector<Vector3d>& points) {
  const double f = MeanFocalLength(camera);
  const double half_width = 0.5 * static_cast<double>(camera.width) / f;
  const double half_height = 0.5 * static_cast<double>(camera.height) / f;
  double extent = 0;
  for (const Vector3d& p : points) {
    const Vector3d x = cam_from_stage * p;
    if (x.z() < 0.1) return 10;
    extent = std::max({extent, std::abs(x.x() / x.z()) / half_width, std::abs(x.y() / x.z()) / half_height});
  }
  return extent;
}

// Rings on a dome, at a distance at which the object fills the frame.
std::vector<StageView> MakeViews(const SyntheticOptions& options, const ImplicitShape& shape) {
  Random random({static_cast<uint64_t>(options.seed), 35});
  const Camera camera = MakeCamera(options);
  const std::vector<Vector3d> points = SampleSurfacePoints(shape, 400, options.seed + 1);
  Vector3d low = points[0], high = low;
  for (const Vector3d& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const std::vector<double> elevations = options.views < 8    ? std::vector<double>{30}
                                         : options.views < 20 ? std::vector<double>{20, 48}
                                                              : std::vector<double>{14, 34, 57};
  const int rings = static_cast<int>(elevations.size());
  std::vector<StageView> views;
  for (int ring = 0, done = 0; ring < rings; ++ring) {
    // Higher rings are shorter and take fewer views.
    const int count = ring + 1 == rings ? options.views - done
                                        : static_cast<int>(std::lround(options.views * (1.25 - 0.25 * ring) / rings));
    const double first = random.Uniform(0, 2 * kPi);
    for (int i = 0; i < count; ++i) {
      const double azimuth = first + 2 * kPi * (i + random.Uniform(-0.2, 0.2)) / count;
      const double elevation = (elevations[ring] + random.Uniform(-4, 4)) * kPi / 180;
      const Vector3d outward(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
                             std::sin(elevation));
      const Vector3d target = 0.5 * (low + high) + 0.03 * Vector3d(random.Normal(), random.Normal(), random.Normal());
      const double roll = 0.04 * random.Normal(), back_off = random.Uniform(1, 1.1);
      double near = 0.5 * shape.radius(), far = 50 * shape.radius();
      for (int step = 0; step < 40; ++step) {
        const double middle = 0.5 * (near + far);
        (Extent(camera, LookAt(target + middle * outward, target, roll), points) > kFill ? near : far) = middle;
      }
      views.push_back({camera, LookAt(target + far * back_off * outward, target, roll)});
    }
    done += count;
  }
  return views;
}

Surroundings MakeSurroundings(const SyntheticOptions& options, const ImplicitShape& shape) {
  double lowest = 1e9;
  for (const Vector3d& p : SampleSurfacePoints(shape, 4000, options.seed + 2)) lowest = std::min(lowest, p.z());
  if (options.scene != "pane") return Surroundings(lowest - 0.01, nullptr, options.seed);
  // The pane covers a box that stands on the ground.
  const double depth = 0.55;
  return Surroundings(lowest - depth, std::make_shared<ShapeTracer>(MakePaneInterior(depth)), options.seed);
}

}  // namespace

Stage MakeStage(const SyntheticOptions& options) {
  Stage stage;
  stage.seed = options.seed;
  stage.shape = MakeShape(options.scene, options.seed);
  stage.tracer = std::make_shared<ShapeTracer>(stage.shape);
  stage.gloss = MakeGloss(options);
  stage.surroundings = MakeSurroundings(options, *stage.shape);
  stage.lights = MakeLights(options);
  stage.light_radius = 0.5 * options.light_angle_deg * kPi / 180;
  stage.views = MakeViews(options, *stage.shape);
  stage.marks = MakeMarks(options, stage);
  // A flash stands as far from the object as the camera does.
  if (options.light_kind == "flash")
    for (StageLight& light : stage.lights) light.reference_distance = stage.views[0].Center().norm();
  // Stop down for very bright highlights, as far as the rest of the picture bears it.
  const double peak = stage.gloss.reflectance.maxCoeff() / (4 * Square(stage.gloss.alpha)) * stage.lights[0].irradiance;
  stage.exposure = std::clamp(12 / peak, 0.5, 1.0);
  return stage;
}

}  // namespace glint
