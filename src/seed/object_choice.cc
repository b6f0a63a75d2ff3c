#include "seed/object_choice.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/core.hpp>

#include "core/check.h"
#include "core/error.h"
#include "geometry/point_index.h"
#include "seed/clusters.h"
#include "seed/sparse_cells.h"

namespace glint {
namespace {

constexpr double kReachRel = 1.5;          // of the focus distance: what is farther from the focus is not looked at
constexpr double kNearRel = 0.25;          // of the focus distance: how near the focus the object is expected
constexpr double kAboveGroundRel = 0.015;  // of the focus distance: matter lower than this joins neighbours on a table
constexpr double kFloorAtBorders = 0.1;    // see ShareAtBorders()
constexpr int64_t kFewPoints = 15;  // on a plane that has more, they are rather the object's edge than the object
constexpr double kMaxGap = 4;       // spacings from a point to the piece that it is counted to

bool OnGround(const std::optional<GroundPlane>& ground, const Eigen::Vector3d& x) {
  return ground && ground->plane.signedDistance(x) < ground->tolerance;
}

std::vector<PointRole> RolesByBox(const Scene& scene, const std::vector<uint8_t>& use, const std::vector<double>& box,
                                  const std::optional<GroundPlane>& ground) {
  const Eigen::Vector3d center(box[0], box[1], box[2]), half = Eigen::Vector3d(box[3], box[4], box[5]) / 2;
  std::vector<PointRole> role(scene.points.size(), PointRole::kUnused);
  for (size_t i = 0; i < role.size(); ++i) {
    if (!use[i]) continue;
    const bool in = ((scene.points[i].position - center).cwiseAbs().array() <= half.array()).all();
    role[i] = !in                                          ? PointRole::kContext
              : OnGround(ground, scene.points[i].position) ? PointRole::kGround
                                                           : PointRole::kObject;
  }
  return role;
}

// Per scene point: observations on the masks minus those off them; empty if no view has a mask.
std::vector<int> MaskBalance(const Scene& scene, const ImageSource& masks) {
  std::vector<std::vector<std::pair<int, Eigen::Vector2f>>> by_view(scene.views.size());
  for (size_t i = 0; i < scene.points.size(); ++i)
    for (const Observation& o : scene.points[i].observations) by_view[o.view].emplace_back(static_cast<int>(i), o.px);
  std::vector<int> balance(scene.points.size(), 0);
  bool any = false;
  for (size_t v = 0; v < scene.views.size(); ++v) {
    cv::Mat mask;
    if (!masks.LoadMask(v, mask)) continue;
    any = true;
    for (const auto& [point, px] : by_view[v]) {
      const int x = static_cast<int>(std::clamp(px.x(), 0.0F, static_cast<float>(mask.cols - 1)));
      const int y = static_cast<int>(std::clamp(px.y(), 0.0F, static_cast<float>(mask.rows - 1)));
      balance[point] += mask.at<uint8_t>(y, x) ? 1 : -1;
    }
  }
  if (!any) balance.clear();
  return balance;
}

// The piece of matter with the most volume near the focus; −1 if there is none.
int PieceAtFocus(const Tetrahedra& tetrahedra, const CellComponents& pieces, const Focus& focus) {
  std::vector<double> score(pieces.count, 0.0);
  for (int c = 0; c < static_cast<int>(tetrahedra.cells.size()); ++c) {
    if (pieces.component[c] < 0) continue;
    const double off = (tetrahedra.Centroid(c) - focus.center).norm() / (kNearRel * focus.distance);
    score[pieces.component[c]] += tetrahedra.Volume(c) * std::exp(-0.5 * off * off);
  }
  if (score.empty()) return -1;
  return static_cast<int>(std::max_element(score.begin(), score.end()) - score.begin());
}

// Per vertex of the triangulation: the piece most of whose cells it belongs to; −1: none.
std::vector<int> PieceOfVertex(const Tetrahedra& tetrahedra, const CellComponents& pieces) {
  std::vector<std::map<int, int>> count(tetrahedra.points.size());
  for (size_t c = 0; c < tetrahedra.cells.size(); ++c)
    if (pieces.component[c] >= 0)
      for (int v : tetrahedra.cells[c])
        if (v >= 0) ++count[v][pieces.component[c]];
  std::vector<int> piece(tetrahedra.points.size(), -1);
  for (size_t v = 0; v < piece.size(); ++v) {
    int best = 0;
    for (const auto& [p, n] : count[v])
      if (n > best) {
        best = n;
        piece[v] = p;
      }
  }
  return piece;
}

// Points that bound no matter go with their nearest neighbour that does, unless it is far.
void AdoptLoosePoints(const std::vector<Eigen::Vector3d>& points, const std::vector<uint8_t>& eligible,
                      std::vector<int>& piece) {
  std::vector<Eigen::Vector3d> settled;
  std::vector<int> settled_piece;
  for (size_t i = 0; i < points.size(); ++i)
    if (eligible[i] && piece[i] >= 0) {
      settled.push_back(points[i]);
      settled_piece.push_back(piece[i]);
    }
  if (settled.size() < 2) return;
  const PointIndex index(settled);
  for (size_t i = 0; i < points.size(); ++i) {
    if (!eligible[i] || piece[i] >= 0) continue;
    const int nearest = index.Nearest(points[i], 1)[0];
    const std::vector<int> around = index.Nearest(settled[nearest], 4);
    const double spacing = (settled[around.back()] - settled[nearest]).norm();
    if ((points[i] - settled[nearest]).norm() < kMaxGap * spacing) piece[i] = settled_piece[nearest];
  }
}

// Whether matter may be in a cell when pieces are told apart: above the ground and finite.
std::vector<uint8_t> AboveGround(const Tetrahedra& tetrahedra, const std::vector<uint8_t>& labels,
                                 const std::optional<GroundPlane>& ground, double min_height) {
  std::vector<uint8_t> above = labels;
  for (int c = 0; c < static_cast<int>(labels.size()); ++c) {
    if (!labels[c]) continue;
    // A cut may leave an infinite cell inside; it has neither corners nor a centroid.
    if (tetrahedra.IsInfinite(c) || (ground && ground->plane.signedDistance(tetrahedra.Centroid(c)) < min_height))
      above[c] = 0;
  }
  return above;
}

// Unseen space joins the object with what is behind it.
void LeaveOutWhatLiesApart(const Scene& scene, ObjectChoice& choice) {
  std::vector<Eigen::Vector3d> points;
  std::vector<size_t> index;
  for (size_t i = 0; i < choice.role.size(); ++i) {
    if (choice.role[i] != PointRole::kObject) continue;
    points.push_back(scene.points[i].position);
    index.push_back(i);
  }
  const std::vector<uint8_t> apart = LieApart(points);
  for (size_t k = 0; k < index.size(); ++k)
    if (apart[k]) choice.role[index[k]] = PointRole::kContext;
}

void FindByFocus(const Scene& scene, const PointReliability& reliability, const std::vector<uint8_t>& use,
                 const CutOptions& cut, ObjectChoice& choice) {
  std::vector<SparseVertex> vertices;
  std::vector<uint8_t> above_band;
  for (size_t i = 0; i < scene.points.size(); ++i) {
    const Eigen::Vector3d& x = scene.points[i].position;
    if (!use[i]) continue;
    choice.role[i] = PointRole::kContext;
    if ((x - choice.focus.center).norm() > kReachRel * choice.focus.distance) continue;
    const bool on_ground = OnGround(choice.ground, x);
    if (on_ground) choice.role[i] = PointRole::kGround;
    above_band.push_back(on_ground ? 0 : 1);
    vertices.push_back({x, static_cast<int>(i), reliability.sigma[i]});
  }
  const SparseCells cells = BuildSparseCells(scene, vertices);
  const Tetrahedra& t = cells.tetrahedra;
  const std::vector<uint8_t> labels =
      AboveGround(t, CutCells(t, cells.votes, std::vector<uint8_t>(t.cells.size(), 1), cut), choice.ground,
                  kAboveGroundRel * choice.focus.distance);
  const CellComponents pieces = ConnectedCells(t, labels);
  const int object = PieceAtFocus(t, pieces, choice.focus);
  if (object < 0) return;
  std::vector<int> piece = PieceOfVertex(t, pieces);
  AdoptLoosePoints(t.points, above_band, piece);
  for (size_t v = 0; v < piece.size(); ++v)
    if (above_band[v] && piece[v] == object) choice.role[cells.scene_point[v]] = PointRole::kObject;
  LeaveOutWhatLiesApart(scene, choice);
}

// A floor goes on to the border of the photographs, an object is taken whole: how much of what is seen of the plane
// lies in a tenth of the width or height from the border (a floor fills a third of a photograph there).
double ShareAtBorders(const Scene& scene, const std::vector<PointRole>& role) {
  constexpr double kMargin = 0.1;
  size_t seen = 0, at_border = 0;
  for (size_t i = 0; i < role.size(); ++i) {
    if (role[i] != PointRole::kGround) continue;
    for (const Observation& o : scene.points[i].observations) {
      const Camera& camera = scene.views[o.view].camera;
      const double x = o.px.x() / static_cast<double>(camera.width), y = o.px.y() / static_cast<double>(camera.height);
      ++seen;
      at_border += std::min({x, 1 - x, y, 1 - y}) < kMargin;
    }
  }
  return seen > 0 ? static_cast<double>(at_border) / static_cast<double>(seen) : 1;
}

int64_t CountObject(const ObjectChoice& choice) {
  return std::count(choice.role.begin(), choice.role.end(), PointRole::kObject);
}

}  // namespace

void ObjectOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "box",
           .help = "Box around the object instead of an automatic choice: centre x y z and size x y z",
           .unit = "world"},
          box);
  v.Field({.name = "ground",
           .help = "Whether to look for the plane that the object stands on",
           .choices = {"auto", "none"}},
          ground);
}

ObjectChoice ChooseObject(const Scene& scene, const PointReliability& reliability, const ObjectOptions& options,
                          const CutOptions& cut, const ImageSource* masks, Progress& progress) {
  GLINT_CHECK_EQ(reliability.status.size(), scene.points.size());
  const bool box_is_sound =
      options.box.empty() ||
      (options.box.size() == 6 && options.box[3] > 0 && options.box[4] > 0 && options.box[5] > 0 &&
       std::all_of(options.box.begin(), options.box.end(), [](double x) { return std::isfinite(x); }));
  if (!box_is_sound) throw InputError("", "seed.object.box", "expected centre x y z and three sizes above 0");
  const std::vector<uint8_t> use = reliability.ReliableMask();
  ObjectChoice choice;
  choice.role.assign(scene.points.size(), PointRole::kUnused);
  if (scene.views.empty()) return choice;
  choice.focus = FindFocus(scene, use);
  if (options.ground == "auto") choice.ground = FindGround(scene, use, choice.focus);
  progress.ThrowIfCancelled();

  if (!options.box.empty()) {
    choice.role = RolesByBox(scene, use, options.box, choice.ground);
    choice.chosen_by = "box";
    return choice;
  }
  if (masks) {
    const std::vector<int> balance = MaskBalance(scene, *masks);
    for (size_t i = 0; i < balance.size(); ++i)
      if (use[i]) choice.role[i] = balance[i] > 0 ? PointRole::kObject : PointRole::kContext;
    choice.chosen_by = "masks";
    if (CountObject(choice) >= 4) return choice;
  }
  const ObjectChoice nothing_chosen = choice;
  FindByFocus(scene, reliability, use, cut, choice);
  if (choice.ground && CountObject(choice) < kFewPoints && ShareAtBorders(scene, choice.role) < kFloorAtBorders) {
    // The plane may be the object itself: a car's hood with hardly a point around it.
    ObjectChoice without = nothing_chosen;
    without.ground.reset();
    FindByFocus(scene, reliability, use, cut, without);
    if (CountObject(without) >= kFewPoints) choice = std::move(without);
  }
  choice.chosen_by = choice.ground ? "ground and focus" : "focus";
  return choice;
}

}  // namespace glint
