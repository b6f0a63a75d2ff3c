#include "pipeline/advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace glint {
namespace {

constexpr double kDegrees = 180 / M_PI;
constexpr size_t kFewViews = 20;
constexpr size_t kFewHighlights = 20;
constexpr double kOneSideDeg = 35;        // nine of ten directions lie within this of their mean
constexpr double kNarrowCamerasDeg = 30;  // the same of the cameras, seen from the object
constexpr double kUncertainLightDeg = 2;
constexpr double kUncertainLightRel = 0.1;  // of the object's diagonal
constexpr double kUnsure = 0.2;             // confidence of normals that are known to 10 degrees
constexpr double kLargeShare = 0.5;

using List = std::vector<Advice>;

// Nine of ten of the unit vectors lie within this angle of their mean direction.
std::optional<double> SpreadDeg(const std::vector<Eigen::Vector3d>& directions) {
  if (directions.empty()) return std::nullopt;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& d : directions) mean += d;
  if (!(mean.norm() > 1e-6 * static_cast<double>(directions.size()))) return 180;
  mean.normalize();
  std::vector<double> angles;
  for (const Eigen::Vector3d& d : directions)
    angles.push_back(std::acos(std::clamp(d.dot(mean), -1.0, 1.0)) * kDegrees);
  const auto nine_tenths = angles.begin() + static_cast<std::ptrdiff_t>((angles.size() - 1) * 9 / 10);
  std::nth_element(angles.begin(), nine_tenths, angles.end());
  return *nine_tenths;
}

void AboutOutcome(const RunSummary& summary, List& list) {
  if (summary.outcome == "done") return;
  std::string cure = "See the photographs below for what was found in them and why it was rejected.";
  if (summary.num_candidates == 0)
    cure =
        "Light the object with one small bright lamp or the sun, expose so that only the highlights are white, and "
        "photograph it from many sides.";
  list.push_back({AdviceLevel::kProblem, "There is no refined surface: " + summary.outcome + ".", cure});
}

void AboutPhotographs(const RunSummary& summary, const Scene& scene, List& list) {
  if (summary.num_missing_images > 0)
    list.push_back({AdviceLevel::kWarning,
                    fmt::format("{} of {} photographs are missing; their highlights are not used.",
                                summary.num_missing_images, summary.num_views),
                    "Give the folder of the photographs with --images."});
  if (summary.num_views < kFewViews)
    list.push_back({AdviceLevel::kWarning,
                    fmt::format("There are only {} photographs. A highlight is told from white paint by how it moves "
                                "from photograph to photograph.",
                                summary.num_views),
                    "Take 30 or more, each from a slightly different place."});
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const ScenePoint& point : scene.points) middle += point.position / static_cast<double>(scene.points.size());
  std::vector<Eigen::Vector3d> directions;
  for (const View& view : scene.views) directions.push_back((view.Center() - middle).normalized());
  const auto spread = SpreadDeg(directions);
  if (spread && !scene.points.empty() && *spread < kNarrowCamerasDeg)
    list.push_back(
        {AdviceLevel::kWarning,
         fmt::format("The cameras all look from one side: nine of ten lie within {:.0f}° of one direction.", *spread),
         "Move around the object more, and change the height too."});
}

void AboutHighlights(const RunSummary& summary, const std::vector<Contact>& contacts, const std::vector<Light>& lights,
                     List& list) {
  if (summary.outcome == "done" && summary.refine.num_highlights > 0 && contacts.size() < kFewHighlights)
    list.push_back({AdviceLevel::kWarning, fmt::format("Only {} highlights could be used.", contacts.size()),
                    "Take more photographs, or light the object with more small lamps: every lamp adds a highlight "
                    "to every photograph."});
  std::vector<Eigen::Vector3d> normals;
  for (const Contact& c : contacts) normals.push_back(ContactNormal(c, lights.at(static_cast<size_t>(c.light))));
  const auto spread = SpreadDeg(normals);
  if (spread && *spread < kOneSideDeg)
    list.push_back(
        {AdviceLevel::kNote,
         fmt::format("All highlights lie on one side: nine of ten have a surface normal within {:.0f}° of one "
                     "direction. The rest of the surface is no better than the sparse points.",
                     *spread),
         "If the object has other glossy sides, move around it more, or put a lamp on the other side."});
  if (summary.gate.accepted > 0 && summary.gate.ambiguous_fraction > kLargeShare)
    list.push_back({AdviceLevel::kNote,
                    fmt::format("{:.0f} % of the highlights could come from either of two lights.",
                                100 * summary.gate.ambiguous_fraction),
                    "Put the lamps further apart, as seen from the object."});
}

// What to do where most candidates are rejected for one reason.
std::string CureOf(HighlightStatus status) {
  switch (status) {
    case HighlightStatus::kStaysPut:
    case HighlightStatus::kTinted:
    case HighlightStatus::kNotALobe:
      return "This is usual for printed or light paint and does no harm.";
    case HighlightStatus::kWeak:
      return "Use a smaller, brighter lamp, and keep the room dark.";
    case HighlightStatus::kTooLarge:
      return "Use a small lamp rather than a window or a soft box, or set detect.max_size_rel higher.";
    case HighlightStatus::kAtBorder:
      return "Keep the object well inside the picture.";
    case HighlightStatus::kOffSurface:
      return "Mask the background (--masks), or see whether the sparse surface covers the whole object.";
    case HighlightStatus::kWrongNormal:
      return "There may be a lamp, a window or a reflection that is not among the lights, or a light may be wrong.";
    case HighlightStatus::kGrazing:
      return "Bring the lamp nearer to the camera's side of the object.";
    case HighlightStatus::kTooFewViews:
      return "Take more photographs from places near to each other.";
    default:
      return "";
  }
}

void AboutRejections(const RunSummary& summary, List& list) {
  for (int s = 0; s < kNumHighlightStatuses; ++s) {
    const auto status = static_cast<HighlightStatus>(s);
    const size_t count = summary.highlights_by_status[static_cast<size_t>(s)];
    if (status == HighlightStatus::kAccepted || count == 0) continue;
    if (static_cast<double>(count) < kLargeShare * static_cast<double>(summary.num_candidates)) continue;
    list.push_back({AdviceLevel::kNote,
                    fmt::format("{} of {} bright spots were rejected for one reason: {}.", count,
                                summary.num_candidates, StatusReason(status)),
                    CureOf(status)});
  }
}

void AboutLights(const RunSummary& summary, List& list) {
  for (size_t k = 0; k < summary.lights.size(); ++k) {
    const FoundLight& found = summary.lights[k];
    const bool distant = found.light.type == LightType::kDistant;
    const double sigma =
        distant || !(summary.diagonal_world > 0) ? found.light.sigma : found.light.sigma / summary.diagonal_world;
    if (!found.determined) {
      list.push_back({AdviceLevel::kWarning,
                      fmt::format("Light {} is not determined and was not used: {}.", k, found.why),
                      "Photograph a chrome ball beside the object (glint light), give the light with --lights, or take "
                      "more photographs in which this light is mirrored."});
    } else if (sigma > (distant ? kUncertainLightDeg : kUncertainLightRel)) {
      list.push_back({AdviceLevel::kNote,
                      distant ? fmt::format("The direction of light {} is known to {:.1f}° only.", k, sigma)
                              : fmt::format("The place of light {} is known to {:.0f} % of the object's size only.", k,
                                            100 * sigma),
                      "Highlights on differently turned parts of the surface pin a light down: move around more."});
    }
  }
}

void AboutSurface(const RunSummary& summary, const TriangleMesh& mesh, List& list) {
  if (!summary.refine.iterations.empty() && !summary.refine.converged)
    list.push_back({AdviceLevel::kNote,
                    fmt::format("The refinement stopped while the contacts still moved by {:.2f} voxels.",
                                summary.refine.iterations.back().contact_motion_voxels),
                    "Allow more with --set refine.max_iterations=N."});
  if (mesh.confidence.empty()) return;
  const auto unsure =
      std::count_if(mesh.confidence.begin(), mesh.confidence.end(), [](float c) { return c < kUnsure; });
  const double share = static_cast<double>(unsure) / static_cast<double>(mesh.confidence.size());
  if (share > kLargeShare)
    list.push_back(
        {AdviceLevel::kNote,
         fmt::format("The normals of {:.0f} % of the surface are known to no better than 10°: no highlight is near "
                     "enough, and it rests on the sparse points and on smoothness.",
                     100 * share),
         "Look at the surface coloured by confidence: photograph so that highlights pass over what is dark."});
}

}  // namespace

std::vector<Advice> GiveAdvice(const RunSummary& summary, const Scene& scene, const std::vector<Contact>& contacts,
                               const std::vector<Light>& lights, const TriangleMesh& mesh) {
  List list;
  AboutOutcome(summary, list);
  for (const std::string& warning : summary.warnings) list.push_back({AdviceLevel::kWarning, warning, ""});
  AboutPhotographs(summary, scene, list);
  AboutLights(summary, list);
  AboutHighlights(summary, contacts, lights, list);
  AboutRejections(summary, list);
  AboutSurface(summary, mesh, list);
  std::stable_sort(list.begin(), list.end(), [](const Advice& a, const Advice& b) { return a.level < b.level; });
  if (list.empty()) list.push_back({AdviceLevel::kGood, "Nothing to complain of.", ""});
  return list;
}

}  // namespace glint
