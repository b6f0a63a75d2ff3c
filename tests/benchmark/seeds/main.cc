// Quality of the seed: synthetic scenes and, where it is there, the path-traced vase, with few and many points on the
// object and with virtual points among them (triangulated on highlights that move). One row a seed: the smooth seed
// against the truth where a camera sees it (distances from the truth's vertices in % of its diagonal, normals in
// degrees) and everywhere, what became of the virtual points, and seconds of processor time.
//   seeds [--scenes a,b] [--points 30,100] [--virtual 0,30] [--lights N] [--seed S] [--vase DIR] [--out DIR]
// On the vase's points as they are, beside COLMAP's own mesh of them and CGAL's Poisson reconstruction of those that
// the seed uses.
//   seeds --projects DIR,DIR [--out DIR]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <Eigen/Dense>
#include <algorithm>
#include <ctime>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "colmap/model.h"
#include "colmap/project.h"
#include "colmap/scene.h"
#include "core/error.h"
#include "geometry/closest_point.h"
#include "geometry/mesh_checks.h"
#include "geometry/ray_caster.h"
#include "io/mesh_io.h"
#include "light/light_io.h"
#include "metrics/compare.h"
#include "metrics/swept_region.h"
#include "pipeline/comparison.h"
#include "pipeline/picture.h"
#include "pipeline/similarity.h"
#include "seed/build_seed.h"
#include "synthetic/synthesize.h"
#include "tests/benchmark/seeds/poisson_peer.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

enum class Kind : uint8_t { kSurroundings, kObject, kVirtual };

struct Case {
  std::string name;
  Scene scene;
  std::vector<Kind> kind;  // per point
  TriangleMesh truth;      // in the scene's frame
};

void PrintHeader() {
  fmt::print("{:<10} {:>6} {:>7} | {:>7} {:>7} {:>7} | {:>7} {:>7} | {:>6} {:>5} {:>7} | {:>9} {:>8} {:>7}\n", "scene",
             "points", "virtual", "median", "95 %", "normals", "95 %", "back", "closed", "genus", "(truth)",
             "virt. used", "lost", "cpu s");
  fmt::print("{:<10} {:>6} {:>7} | {:>23} | {:>15} | {:>20} | {:>26}\n", "", "", "", "where seen", "everywhere", "",
             "");
}

size_t Count(const Case& c, Kind kind) { return std::count(c.kind.begin(), c.kind.end(), kind); }

// Truth, sparse surface and smooth seed from a few views; used points green, those left out red, virtual ones blue.
void WritePicture(const fs::path& path, const Case& c, const SeedResult& seed) {
  constexpr int kWidth = 480, kViews = 3;
  std::vector<cv::Mat> rows;
  for (int i = 0; i < kViews; ++i) {
    const View& view = c.scene.views[c.scene.views.size() * i / kViews];
    std::vector<cv::Mat> row;
    for (const TriangleMesh* mesh : {&c.truth, &seed.mesh, &seed.smooth}) {
      if (mesh->empty()) continue;
      TriangleMesh shown = *mesh;
      EnsureNormals(shown);
      row.push_back(RenderMesh(shown, view, kWidth));
      const double scale = static_cast<double>(kWidth) / static_cast<double>(view.camera.width);
      for (size_t p = 0; p < c.scene.points.size() && mesh != &seed.smooth; ++p) {
        const auto px = view.Project(c.scene.points[p].position);
        if (!px || (!seed.point_used[p] && c.kind[p] == Kind::kSurroundings)) continue;
        const cv::Scalar color = c.kind[p] == Kind::kVirtual ? cv::Scalar(255, 0, 0)
                                 : seed.point_used[p]        ? cv::Scalar(0, 160, 0)
                                                             : cv::Scalar(0, 0, 255);
        cv::circle(row.back(), cv::Point2d(px->x() * scale, px->y() * scale), 2, color, cv::FILLED);
      }
    }
    cv::hconcat(row, rows.emplace_back());
  }
  cv::Mat sheet;
  cv::vconcat(rows, sheet);
  cv::imwrite(path.string(), sheet);
}

// Distances and normals of a mesh against the truth, with what else is to be said of it.
void PrintRow(const Case& c, const std::string& label, const TriangleMesh& mesh, const std::string& end) {
  const std::vector<uint16_t> views = VisibleViews(c.truth, c.scene);
  std::vector<uint8_t> seen(views.size()), all(views.size(), 1);
  for (size_t v = 0; v < views.size(); ++v) seen[v] = views[v] > 0;
  const MeshComparison comparison = CompareMeshes(mesh, c.truth, {.num_samples = 20000});
  const ErrorStats distance = DistanceStatsRel(comparison, seen);
  const MeshChecks checks = CheckMeshSoundness(mesh);
  const MeshChecks truth = CheckMeshSoundness(c.truth, {.self_intersections = false});
  fmt::print("{} {:>7.3f} {:>7.3f} {:>7.2f} | {:>7.3f} {:>7.3f} | {:>6} {:>5} {:>7} |{}\n", label,
             100 * distance.median, 100 * distance.p95, NormalStats(comparison, seen).mean,
             100 * DistanceStatsRel(comparison, all).p95, 100 * comparison.accuracy_rel.p95,
             checks.sound()  ? "yes"
             : checks.closed ? "folded"
                             : "NO",
             checks.genus, fmt::format("({})", truth.genus), end);
  std::fflush(stdout);
}

// What others make of the same points.
void MeasurePeers(const Case& c, const fs::path& colmap_mesh) {
  const SeedResult seed = BuildSeed(c.scene);
  std::vector<Eigen::Vector3d> points, toward;
  for (size_t i = 0; i < seed.fate.size(); ++i) {
    if (seed.fate[i] != PointFate::kUsed && seed.fate[i] != PointFate::kObject) continue;
    const ScenePoint& point = c.scene.points[i];
    points.push_back(point.position);
    toward.push_back(TowardViews(c.scene, point));
  }
  const std::string label = "{:<10} {:>14} |";
  if (fs::exists(colmap_mesh))
    PrintRow(c, fmt::format(fmt::runtime(label), "COLMAP's", "delaunay"), ReadMesh(colmap_mesh), "");
  const TriangleMesh poisson = benchmark::PoissonSurface(points, toward);
  const std::string name = fmt::format(fmt::runtime(label), "CGAL's", "Poisson");
  if (poisson.empty())
    fmt::print("{} no surface\n", name);
  else
    PrintRow(c, name, poisson, "");
}

void Measure(const Case& c, const fs::path& out) {
  SeedSummary summary;
  const std::clock_t start = std::clock();
  const SeedResult seed = BuildSeed(c.scene, {}, &summary);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  if (!out.empty()) fmt::print("{}\n", summary.BriefReport());
  const std::string label =
      fmt::format("{:<10} {:>6} {:>7} |", c.name, Count(c, Kind::kObject), Count(c, Kind::kVirtual));
  if (seed.smooth.empty()) {
    fmt::print("{} {}\n", label, summary.BriefReport());
    return;
  }
  size_t virtual_used = 0, lost = 0;
  for (size_t i = 0; i < c.kind.size(); ++i) {
    virtual_used += c.kind[i] == Kind::kVirtual && seed.point_used[i];
    lost += c.kind[i] == Kind::kObject && !seed.point_used[i];
  }
  PrintRow(c, label, seed.smooth, fmt::format(" {:>9} {:>8} {:>7.1f}", virtual_used, lost, seconds));
  if (out.empty()) return;
  const std::string file = fmt::format("{}-{}-{}", c.name, Count(c, Kind::kObject), Count(c, Kind::kVirtual));
  fs::create_directories(out);
  WriteMesh(out / (file + "-seed.ply"), seed.mesh);
  WriteMesh(out / (file + "-start.ply"), seed.smooth);
  WriteMesh(out / (c.name + "-truth.ply"), c.truth);
  WritePicture(out / (file + ".png"), c, seed);
}

Case SyntheticCase(SyntheticOptions options, int points, double virtual_share) {
  options.object_points = points;
  options.virtual_share = virtual_share;
  const SyntheticScene synthetic = SynthesizeScene(options);
  Case c{options.scene, MakeScene(synthetic.model), {}, TrueMesh(synthetic)};
  for (const SyntheticPoint::Origin origin : synthetic.point_origins)
    c.kind.push_back(origin == SyntheticPoint::Origin::kMark        ? Kind::kObject
                     : origin == SyntheticPoint::Origin::kHighlight ? Kind::kVirtual
                                                                    : Kind::kSurroundings);
  return c;
}

// The vase's truth with what is needed to put highlights on it.
struct Vase {
  Scene scene;
  TriangleMesh truth;
  std::vector<Light> lights;
  std::vector<double> distance;  // per point of the scene, from the truth
};

Vase ReadVase(const fs::path& folder) {
  Vase vase{MakeScene(ReadModel(folder / "project" / "sparse" / "0")),
            ReadMesh(folder / "truth" / "gt_mesh.ply"),
            ReadLights(folder / "lights.json"),
            {}};
  Transform(ReadSimilarity(folder / "truth" / "sim3_colmap_to_gt.json").inverse(), vase.truth);
  const ClosestPointQuery query(vase.truth);
  for (const ScenePoint& p : vase.scene.points)
    vase.distance.push_back(std::sqrt(query.Find(p.position)->squared_distance));
  return vase;
}

// Where the view sees the light mirrored: per view the truth's vertex with the normal nearest to the half vector, −1
// if it is hidden or none comes near.
std::vector<int> Contacts(const Vase& vase) {
  const RayCaster caster(vase.truth);
  const double margin = 1e-4 * Diagonal(vase.truth);
  std::vector<int> contact(vase.scene.views.size(), -1);
  for (size_t i = 0; i < contact.size(); ++i) {
    double best = std::cos(3 * M_PI / 180);
    for (size_t v = 0; v < vase.truth.vertices.size(); ++v) {
      const Eigen::Vector3d& x = vase.truth.vertices[v];
      const double cosine =
          vase.truth.normals[v].dot(HalfVector(vase.lights[0], vase.scene.views[i].cam_from_world, x));
      if (cosine <= best || caster.Occluded(x, vase.scene.views[i].Center(), margin)) continue;
      best = cosine;
      contact[i] = static_cast<int>(v);
    }
  }
  return contact;
}

// Nearest to the rays through the observations; the mean reprojection error is its error_px.
void TriangulateMidpoint(const Scene& scene, ScenePoint& point) {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Observation& o : point.observations) {
    const View& view = scene.views[o.view];
    const Eigen::Vector3d d = *view.RayThrough(o.px.cast<double>());
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - d * d.transpose();
    matrix += across;
    right += across * view.Center();
  }
  point.position = matrix.ldlt().solve(right);
  point.error_px = 0;
  for (const Observation& o : point.observations) {
    const auto px = scene.views[o.view].Project(point.position);
    point.error_px += px ? (*px - o.px.cast<double>()).norm() : 1e9;
  }
  point.error_px /= static_cast<double>(point.observations.size());
}

// Points on one highlight in three to five neighbouring views, as far as COLMAP would accept them.
void AddVirtualPoints(const Vase& vase, size_t count, Case& c) {
  const std::vector<int> contact = Contacts(vase);
  const double reach = 0.3 * Diagonal(vase.truth);
  std::mt19937 random(7);
  std::normal_distribution<float> noise(0, 0.5f);
  size_t added = 0;
  for (size_t tries = 0; tries < 50 * count && added < count; ++tries) {
    const size_t first = random() % contact.size();
    const size_t length = 3 + random() % 3;
    if (contact[first] < 0) continue;
    std::vector<std::pair<double, size_t>> near;
    for (size_t i = 0; i < contact.size(); ++i)
      if (contact[i] >= 0 && (vase.truth.vertices[contact[i]] - vase.truth.vertices[contact[first]]).norm() < reach)
        near.emplace_back((vase.scene.views[i].Center() - vase.scene.views[first].Center()).norm(), i);
    std::sort(near.begin(), near.end());
    ScenePoint point{Eigen::Vector3d::Zero(), {250, 250, 248}, 0, {}};
    for (size_t k = 0; k < std::min(length, near.size()); ++k) {
      const size_t i = near[k].second;
      const auto px = vase.scene.views[i].Project(vase.truth.vertices[contact[i]]);
      if (px)
        point.observations.push_back(
            {static_cast<uint32_t>(i), px->cast<float>() + Eigen::Vector2f(noise(random), noise(random))});
    }
    while (point.observations.size() >= 3) {
      TriangulateMidpoint(vase.scene, point);
      if (point.error_px < 3) break;
      point.observations.pop_back();
    }
    if (point.observations.size() < 3) continue;
    c.scene.points.push_back(point);
    c.kind.push_back(Kind::kVirtual);
    ++added;
  }
}

// The points on the vase thinned to `points` (0: as they are, with whatever is wrong among them), those around it kept.
Case VaseCase(const Vase& vase, size_t points, double virtual_share) {
  const double diagonal = Diagonal(vase.truth);
  Case c{"vase", {vase.scene.views, {}}, {}, vase.truth};
  const Eigen::AlignedBox3d box = BoundingBox(vase.truth);
  std::vector<size_t> on_object;
  for (size_t i = 0; i < vase.scene.points.size(); ++i) {
    if (points == 0 || vase.distance[i] > 0.02 * diagonal) {
      // Inside the vase's own box, but not on it: wrong. Only the row of the points as they are has them.
      if (points != 0 && box.contains(vase.scene.points[i].position) && vase.distance[i] < 0.2 * diagonal) continue;
      c.scene.points.push_back(vase.scene.points[i]);
      c.kind.push_back(vase.distance[i] < 0.005 * diagonal ? Kind::kObject : Kind::kSurroundings);
    } else {
      on_object.push_back(i);
    }
  }
  std::shuffle(on_object.begin(), on_object.end(), std::mt19937(3));
  on_object.resize(std::min(on_object.size(), points));
  for (size_t i : on_object) {
    c.scene.points.push_back(vase.scene.points[i]);
    c.kind.push_back(Kind::kObject);
  }
  AddVirtualPoints(vase, static_cast<size_t>(std::lround(virtual_share * static_cast<double>(on_object.size()))), c);
  return c;
}

// A project without a truth: whether it gives a closed seed, and what of.
void MeasureProject(const fs::path& folder, const fs::path& out) {
  try {
    const Scene scene = MakeScene(ReadModel(FindProject(folder).model));
    const Case c{folder.filename().string(), scene, std::vector<Kind>(scene.points.size(), Kind::kSurroundings), {}};
    SeedSummary summary;
    const SeedResult seed = BuildSeed(scene, {}, &summary);
    const bool closed = !seed.smooth.empty() && CheckMeshSoundness(seed.smooth, {.self_intersections = false}).closed;
    fmt::print("{}: {}; {}\n", c.name, closed ? "closed" : "NOT CLOSED", summary.BriefReport());
    if (out.empty() || seed.smooth.empty()) return;
    fs::create_directories(out);
    WriteMesh(out / (c.name + "-seed.ply"), seed.mesh);
    WriteMesh(out / (c.name + "-start.ply"), seed.smooth);
    WritePicture(out / (c.name + ".png"), c, seed);
  } catch (const Error& error) {
    fmt::print("{}: {}\n", folder.string(), error.what());
  }
  std::fflush(stdout);
}

int Main(int argc, char** argv) {
  CLI::App app("Quality of the seed on synthetic scenes and the vase");
  std::vector<std::string> scenes;
  for (const std::string_view name : ShapeNames()) scenes.emplace_back(name);
  std::vector<int> points = {30, 100, 300, 3000};
  std::vector<double> virtual_percent = {0, 10, 30};
  SyntheticOptions options;
  options.lights = 2;
  fs::path vase_folder, out;
  std::vector<fs::path> projects;
  app.add_option("--scenes", scenes, "scenes to measure; 'none' for none")->delimiter(',');
  app.add_option("--points", points, "points on the object")->delimiter(',');
  app.add_option("--virtual", virtual_percent, "virtual points, % of those on the object")->delimiter(',');
  app.add_option("--lights", options.lights, "number of lights");
  app.add_option("--views", options.views, "views");
  app.add_option("--seed", options.seed, "random seed of the scenes");
  app.add_option("--vase", vase_folder, "folder of the vase");
  app.add_option("--projects", projects, "projects without a truth, measured alone")->delimiter(',');
  app.add_option("--out", out, "folder to keep the meshes in");
  CLI11_PARSE(app, argc, argv);
  for (const fs::path& project : projects) MeasureProject(project, out);
  if (!projects.empty()) return 0;
  PrintHeader();
  for (const std::string& scene : scenes)
    for (const int count : points)
      for (const double percent : virtual_percent) {
        if (scene == "none") continue;
        options.scene = scene;
        Measure(SyntheticCase(options, count, percent / 100), out);
      }
  if (vase_folder.empty()) return 0;
  const Vase vase = ReadVase(vase_folder);
  for (const int count : points)
    for (const double percent : virtual_percent) Measure(VaseCase(vase, count, percent / 100), out);
  const Case as_it_is = VaseCase(vase, 0, 0);
  Measure(as_it_is, out);
  MeasurePeers(as_it_is, vase_folder / "colmap-delaunay-sparse.ply");
  return 0;
}

}  // namespace
}  // namespace glint

int main(int argc, char** argv) {
  try {
    return glint::Main(argc, argv);
  } catch (const glint::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
