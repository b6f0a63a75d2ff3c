#include "silhouette/silhouettes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"
#include "core/parallel.h"
#include "silhouette/agreement.h"
#include "silhouette/candidates.h"
#include "silhouette/hull.h"
#include "silhouette/support.h"

namespace glint {

using internal::Candidate;
using internal::ContourPoint;
using internal::ViewMask;
using internal::Work;

struct Silhouettes::Impl {
  Scene views;  // without points
  internal::MaskSet masks;
  std::vector<OutlineSample> outline, rays;
  TriangleMesh hull;
};

namespace {

constexpr double kMinOverlap = 0.5;   // of a mask with the rough mesh, intersection over union
constexpr double kRoomRel = 0.02;     // of the diagonal: the other views' masks may leave this much room outside
constexpr double kExcessRel = 0.006;  // or exclude the outline by this much
constexpr double kSlackRel = 0.004;   // see FindContact
constexpr double kMinShare = 0.4;     // of its samples that a view must have confirmed
constexpr size_t kMinViews = 4;
constexpr int kMaxRounds = 4;
constexpr int kHullRounds = 3;       // of outlines looked for in the photographs, each around what the last ones leave
constexpr double kBesideRel = 0.03;  // of the diagonal: of another view's sample that supports one
// Of a view's places that can be told, those that are right, for the rest to be believed; as if it had so many more
// that are as right as all views' are.
constexpr double kRightShare = 0.9, kUsualPlaces = 10;
constexpr double kGroundRel = 0.02;  // of the diagonal: lower than this an outline may be a shadow's

// Views spread over all of them.
std::vector<size_t> ChosenViews(size_t count, size_t most) {
  std::vector<size_t> chosen;
  const size_t n = std::min(count, most);
  for (size_t i = 0; i < n; ++i) chosen.push_back((2 * i + 1) * count / (2 * n));
  return chosen;
}

// The sample without its depth; nothing where the camera has no rays.
std::optional<OutlineSample> RayOf(const Work& work, const ViewMask& mask, const ContourPoint& p) {
  const View& view = work.scene.views[mask.view];
  OutlineSample s;
  s.view = static_cast<uint32_t>(mask.view);
  s.px = mask.raster.ToImage(p.at);
  const Eigen::Vector2d out = (mask.raster.ToImage(p.at + p.out) - s.px).normalized(), along(-out.y(), out.x());
  const auto ray = view.RayThrough(s.px), a = view.RayThrough(s.px - along), b = view.RayThrough(s.px + along),
             o = view.RayThrough(s.px + out);
  if (!ray || !a || !b || !o) return std::nullopt;
  s.ray = *ray;
  s.normal = (*b - *a).cross(s.ray).normalized();
  if (s.normal.dot(*o - *ray) < 0) s.normal = -s.normal;
  return s;
}

struct Judged {
  std::vector<OutlineSample> trusted;
  size_t count = 0;
};

// What the other views say of one's outline; what may be a shadow's counts neither for it nor against it.
Judged Judge(const Work& work, const internal::MaskSet& set, int own, const Candidate& candidate) {
  Judged out;
  const internal::Reach reach = work.Ball();
  for (const ContourPoint& p : candidate.contour) {
    std::optional<OutlineSample> s = RayOf(work, set.masks[own], p);
    if (!s) continue;
    const auto outside = internal::FindContact(work.scene, set, own, reach, kSlackRel * work.diagonal, *s);
    if (outside && candidate.found && work.rough.ground &&
        work.rough.ground->signedDistance(set.masks[own].eye + s->depth * s->ray) < kGroundRel * work.diagonal)
      continue;
    ++out.count;
    if (!outside || *outside > kExcessRel * work.diagonal || *outside < -kRoomRel * work.diagonal) continue;
    s->sigma = candidate.sigma_px * s->depth / set.masks[own].focal_px;
    out.trusted.push_back(*s);
  }
  return out;
}

// Leaves out views that the others contradict, until the rest agree.
void KeepWhatAgrees(const Work& work, std::vector<Candidate>& candidates, internal::MaskSet& set,
                    std::vector<OutlineSample>& outline, SilhouetteSummary& summary, Progress& progress) {
  for (int round = 0; round < kMaxRounds; ++round) {
    set.masks.clear();
    for (const Candidate& c : candidates) set.masks.push_back(c.mask);
    std::vector<Judged> judged(candidates.size());
    ParallelFor(candidates.size(), 1, [&](size_t i) {
      progress.ThrowIfCancelled();
      judged[i] = Judge(work, set, static_cast<int>(i), candidates[i]);
    });
    outline.clear();
    std::vector<Candidate> kept;
    summary.num_samples = 0;
    for (size_t i = 0; i < candidates.size(); ++i) {
      summary.num_samples += judged[i].count;
      if (static_cast<double>(judged[i].trusted.size()) < kMinShare * static_cast<double>(judged[i].count)) continue;
      outline.insert(outline.end(), judged[i].trusted.begin(), judged[i].trusted.end());
      kept.push_back(std::move(candidates[i]));
    }
    const bool all = kept.size() == candidates.size();
    candidates = std::move(kept);
    if (all) break;
  }
  summary.num_trusted_views = candidates.size();
}

struct Supported {
  std::vector<OutlineSample> outline, rays;
  size_t num_judged = 0;  // places that two other views have something beside, right or not
};

// The outline without what no two other views have beside it: a wrong one that touches what the others leave room for.
// From few sides most places have nothing beside them, and where along its ray such a one touches is uncertain; that it
// does is not, in a view that is right where it can be told. From many sides the few that are alone are wrong ones.
Supported WhatIsSupported(const Work& work, const std::vector<OutlineSample>& outline) {
  const OutlineNeighbors neighbors(work.scene, outline);
  enum class Verdict : uint8_t { kNone, kRight, kWrong };
  std::vector<Verdict> verdict(outline.size());
  ParallelFor(outline.size(), 64, [&](size_t i) {
    const Support s = neighbors.Of(i, kBesideRel * work.diagonal);
    if (s.views >= 3) verdict[i] = std::abs(s.offset) < kExcessRel * work.diagonal ? Verdict::kRight : Verdict::kWrong;
  });
  std::vector<size_t> right(work.scene.views.size(), 0), judged(right);
  Supported out;
  for (size_t i = 0; i < outline.size(); ++i) {
    right[outline[i].view] += verdict[i] == Verdict::kRight;
    judged[outline[i].view] += verdict[i] != Verdict::kNone;
    if (verdict[i] == Verdict::kRight) out.outline.push_back(outline[i]);
    out.num_judged += verdict[i] != Verdict::kNone;
  }
  const bool mostly_alone = 2 * out.num_judged < outline.size();
  const double usual =
      static_cast<double>(out.outline.size()) / std::max<double>(1, static_cast<double>(out.num_judged));
  for (size_t i = 0; i < outline.size(); ++i) {
    const size_t v = outline[i].view;
    const bool trusted = mostly_alone && static_cast<double>(right[v]) + kUsualPlaces * usual >=
                                             kRightShare * (static_cast<double>(judged[v]) + kUsualPlaces);
    if (verdict[i] == Verdict::kRight || (verdict[i] == Verdict::kNone && trusted)) out.rays.push_back(outline[i]);
  }
  return out;
}

template <class Make>
std::vector<Candidate> Collect(const std::vector<size_t>& views, Progress& progress, const Make& make) {
  std::vector<std::optional<Candidate>> made(views.size());
  ParallelFor(views.size(), 1, [&](size_t i) {
    progress.ThrowIfCancelled();
    made[i] = make(views[i]);
  });
  std::vector<Candidate> out;
  for (std::optional<Candidate>& c : made)
    if (c && !c->contour.empty()) out.push_back(std::move(*c));
  return out;
}

// Whether masks show the object, not what to leave out of the photograph.
bool ShowTheObject(const std::vector<Candidate>& candidates) {
  const auto good =
      std::count_if(candidates.begin(), candidates.end(), [](const Candidate& c) { return c.overlap > kMinOverlap; });
  return candidates.size() >= kMinViews && 2 * static_cast<size_t>(good) > candidates.size();
}

// Whether the views confirm each other; only then are there an outline and masks.
bool Confirm(const Work& work, std::vector<Candidate> candidates, internal::MaskSet& masks,
             std::vector<OutlineSample>& outline, std::vector<OutlineSample>& rays, SilhouetteSummary& s,
             Progress& progress) {
  const bool found = s.source == "photographs";
  outline.clear();
  rays.clear();
  masks.masks.clear();
  s.num_views = candidates.size();
  s.num_trusted_views = s.num_samples = s.num_trusted_samples = 0;
  // A mask is wrong here and there if it was found; a given one as a whole or not at all.
  masks.contradictions = found ? 2 + static_cast<int>(candidates.size() / 32) : 2;
  if (candidates.size() < kMinViews) return false;
  KeepWhatAgrees(work, candidates, masks, outline, s, progress);
  const bool most_views = s.num_trusted_views >= kMinViews && 2 * s.num_trusted_views >= s.num_views;
  bool most_places = true;  // else most of what was found is wrong
  if (most_views && found) {
    Supported supported = WhatIsSupported(work, outline);
    most_places = supported.num_judged > 0 &&
                  2 * outline.size() * supported.outline.size() >= s.num_samples * supported.num_judged;
    outline = std::move(supported.outline);
    rays = std::move(supported.rays);
  } else {
    rays = outline;
  }
  if (!most_views || !most_places) {
    outline.clear();
    rays.clear();
    masks.masks.clear();
  }
  s.num_trusted_samples = outline.size();
  return !outline.empty();
}

// What most of the masks leave room for: where the rough mesh lacks a part of the object, or a mask of it, the others
// have it, so that outlines can be looked for nearer to where they are.
TriangleMesh HullOf(const Work& work, const std::vector<Candidate>& candidates) {
  std::vector<ViewMask> masks;
  for (const Candidate& c : candidates) masks.push_back(c.mask);
  return internal::HullOfMost(work.scene, masks, work.Ball(), work.rough.ground);
}

}  // namespace

void SilhouetteOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "use",
           .help = "Where the object's outlines come from: masks that show it, else the photographs (auto)",
           .choices = {"auto", "masks", "none"}},
          use);
  v.Field({.name = "max_views", .help = "Most photographs whose outlines are used", .min = 4, .max = 10000}, max_views);
}

std::string SilhouetteSummary::BriefReport() const {
  if (source.empty()) return "no outlines";
  if (num_trusted_samples == 0)
    return fmt::format("outlines from the {} of {} views do not agree: not used", source, num_views);
  return fmt::format("outlines from the {} of {} of {} views, {} of {} places on them confirmed by the others", source,
                     num_trusted_views, num_views, num_trusted_samples, num_samples);
}

Silhouettes::Silhouettes() : impl_(std::make_unique<Impl>()) {}
Silhouettes::~Silhouettes() = default;
Silhouettes::Silhouettes(Silhouettes&&) noexcept = default;
Silhouettes& Silhouettes::operator=(Silhouettes&&) noexcept = default;

const std::vector<OutlineSample>& Silhouettes::outline() const { return impl_->outline; }
const std::vector<OutlineSample>& Silhouettes::rays() const { return impl_->rays; }

std::optional<double> Silhouettes::OutsideBy(const Eigen::Vector3d& x) const {
  return internal::OutsideBy(impl_->views, impl_->masks, x);
}

std::optional<double> Silhouettes::SeenThroughBy(const Eigen::Vector3d& x, size_t views) const {
  return internal::SeenThroughBy(impl_->views, impl_->masks, views, x);
}

const TriangleMesh& Silhouettes::hull() const { return impl_->hull; }
size_t Silhouettes::num_views() const { return impl_->masks.masks.size(); }

Silhouettes FindSilhouettes(const Scene& scene, const ImageSource& images, const RoughObject& rough,
                            const SilhouetteOptions& options, SilhouetteSummary* summary, Progress& progress) {
  GLINT_CHECK_EQ(rough.point_side.size(), scene.points.size());
  SilhouetteSummary unused;
  SilhouetteSummary& s = summary ? *summary : unused;
  s = SilhouetteSummary();
  Silhouettes out;
  out.impl_->views.views = scene.views;
  if (options.use == "none" || rough.mesh.empty()) return out;
  const Work work{scene, images, rough, Diagonal(rough.mesh), BoundingBox(rough.mesh).center()};
  const std::vector<size_t> views = ChosenViews(scene.views.size(), static_cast<size_t>(options.max_views));
  std::vector<Candidate> candidates = Collect(views, progress, [&](size_t v) { return internal::FromMask(work, v); });
  s.source = "masks";
  if (ShowTheObject(candidates)) {
    Confirm(work, std::move(candidates), out.impl_->masks, out.impl_->outline, out.impl_->rays, s, progress);
    return out;
  }
  s.source = "";
  if (options.use == "masks") return out;
  s.source = "photographs";
  std::optional<TriangleMesh> hull;
  for (int round = 0; round < kHullRounds && (!hull || !hull->empty()); ++round) {
    candidates =
        Collect(views, progress, [&](size_t v) { return internal::FromPhotograph(work, v, hull ? &*hull : nullptr); });
    if (Confirm(work, candidates, out.impl_->masks, out.impl_->outline, out.impl_->rays, s, progress)) break;
    hull = HullOf(work, candidates);
  }
  if (out.from_few_sides())
    out.impl_->hull = internal::HullOfMost(scene, out.impl_->masks.masks, work.Ball(), rough.ground);
  return out;
}

}  // namespace glint
