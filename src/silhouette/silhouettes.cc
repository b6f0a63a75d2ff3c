#include "silhouette/silhouettes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/check.h"
#include "core/parallel.h"
#include "silhouette/agreement.h"
#include "silhouette/edge_search.h"
#include "silhouette/segment.h"

namespace glint {

using internal::ContourPoint;
using internal::Projection;
using internal::ViewMask;

struct Silhouettes::Impl {
  Scene views;  // without points
  std::vector<ViewMask> masks;
  std::vector<OutlineSample> outline;
};

namespace {

constexpr int kMaxSide = 320;         // px of the raster
constexpr double kMargin = 0.25;      // of the projection's larger side
constexpr double kReachRel = 0.10;    // of the diagonal: how far outside of the rough mesh the object may be
constexpr double kCoreRel = 0.05;     // and inside of it from where on it is for sure
constexpr double kStep = 2;           // px between samples
constexpr double kMinOverlap = 0.5;   // of a mask with the rough mesh, intersection over union
constexpr double kRoomRel = 0.02;     // of the diagonal: the other views' masks may leave this much room outside
constexpr double kExcessRel = 0.006;  // or exclude the outline by this much
constexpr double kSlackRel = 0.004;   // see FindContact
constexpr double kMinShare = 0.4;     // of its samples that a view must have confirmed
constexpr size_t kMinViews = 4;
constexpr int kMaxRounds = 4;
constexpr double kGroundRel = 0.02;    // of the diagonal: lower than this an outline may be a shadow's
constexpr double kMaskSigmaPx = 0.7;   // of a mask's outline, its px
constexpr double kFoundSigmaPx = 0.5;  // of a found one's, raster px

// Views spread over all of them.
std::vector<size_t> ChosenViews(size_t count, size_t most) {
  std::vector<size_t> chosen;
  const size_t n = std::min(count, most);
  for (size_t i = 0; i < n; ++i) chosen.push_back((2 * i + 1) * count / (2 * n));
  return chosen;
}

// A view with all that is worked out for it.
struct Candidate {
  ViewMask mask;
  std::vector<ContourPoint> contour;  // with an edge, where it was found
  double sigma_px = 0;                // raster px
  double overlap = 0;                 // with the rough mesh's projection
};

struct Work {
  const Scene& scene;
  const ImageSource& images;
  const RoughObject& rough;
  double diagonal;
  Eigen::Vector3d center;

  double RasterFocal(size_t view, const internal::Raster& raster) const {
    return MeanFocalLength(scene.views[view].camera) * raster.scale;
  }
  double DiagonalPx(size_t view, const internal::Raster& raster) const {
    return diagonal * RasterFocal(view, raster) / (scene.views[view].Center() - center).norm();
  }
};

double Overlap(const cv::Mat& a, const cv::Mat& b, double a_elsewhere) {
  const double both = cv::countNonZero(a & b), any = cv::countNonZero(a | b);
  return both / std::max(1.0, any + a_elsewhere);
}

void Finish(const Work& work, size_t view, const internal::Raster& raster, const cv::Mat& mask, Candidate& out) {
  const Eigen::Vector3d eye = work.scene.views[view].Center();
  out.mask = {view, raster, internal::SignedDistance(mask), eye, work.RasterFocal(view, raster)};
  for (const ContourPoint& p : internal::Contour(out.mask.distance, kStep))
    if (!raster.NearImageBorder(p.at, work.scene.views[view].camera, 3)) out.contour.push_back(p);
}

std::optional<Candidate> FromMask(const Work& work, size_t view) {
  cv::Mat mask;
  if (!work.images.LoadMask(view, mask)) return std::nullopt;
  const auto projection = internal::ProjectMesh(work.scene.views[view], work.rough.mesh, kMargin, kMaxSide);
  if (!projection) return std::nullopt;
  const internal::Raster& raster = projection->raster;
  cv::Mat small;
  cv::resize(mask(raster.window), small, raster.size, 0, 0, cv::INTER_AREA);
  small = small > 127;
  Candidate out;
  const double elsewhere =
      (cv::countNonZero(mask) - cv::countNonZero(mask(raster.window))) * raster.scale * raster.scale;
  out.overlap = Overlap(small, projection->distance < 0, elsewhere);
  out.sigma_px = kMaskSigmaPx * std::max(1.0, raster.scale);
  Finish(work, view, raster, small, out);
  return out;
}

cv::Mat Hints(const Work& work, size_t view, const internal::Raster& raster) {
  cv::Mat hints(raster.size, CV_8S, cv::Scalar(0));
  for (size_t i = 0; i < work.scene.points.size(); ++i) {
    if (work.rough.point_side[i] == 0) continue;
    for (const Observation& o : work.scene.points[i].observations) {
      if (o.view != view) continue;
      const Eigen::Vector2d at = raster.FromImage(o.px.cast<double>());
      const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
      for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}})
        if (x + dx >= 0 && y + dy >= 0 && x + dx < hints.cols && y + dy < hints.rows)
          hints.at<int8_t>(y + dy, x + dx) = work.rough.point_side[i];
    }
  }
  return hints;
}

std::optional<Candidate> FromPhotograph(const Work& work, size_t view) {
  const auto projection = internal::ProjectMesh(work.scene.views[view], work.rough.mesh, kMargin, kMaxSide);
  cv::Mat image;
  if (!projection || !work.images.Load(view, image)) return std::nullopt;
  const internal::Raster& raster = projection->raster;
  cv::Mat window = image(raster.window), small;
  if (window.depth() == CV_16U) window.convertTo(window, CV_8U, 1.0 / 257);
  cv::resize(window, small, raster.size, 0, 0, cv::INTER_AREA);
  const double size = work.DiagonalPx(view, raster);
  const cv::Mat mask = internal::Segment({small, projection->distance, Hints(work, view, raster),
                                          std::max(3.0, kReachRel * size), std::max(2.0, kCoreRel * size)});
  Candidate out;
  out.overlap = Overlap(mask, projection->distance < 0, 0);
  out.sigma_px = kFoundSigmaPx;
  Finish(work, view, raster, mask, out);
  out.contour = internal::OnEdges(small, out.contour);
  return out;
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

// What the other views say of one's outline.
Judged Judge(const Work& work, const std::vector<ViewMask>& masks, int own, const Candidate& candidate) {
  Judged out;
  const internal::Reach reach{work.center, 0.75 * work.diagonal};
  for (const ContourPoint& p : candidate.contour) {
    std::optional<OutlineSample> s = RayOf(work, masks[own], p);
    if (!s) continue;
    ++out.count;
    const auto outside = internal::FindContact(work.scene, masks, own, reach, kSlackRel * work.diagonal, *s);
    if (!outside || *outside > kExcessRel * work.diagonal || *outside < -kRoomRel * work.diagonal) continue;
    s->sigma = candidate.sigma_px * s->depth / masks[own].focal_px;
    if (work.rough.ground &&
        work.rough.ground->signedDistance(masks[own].eye + s->depth * s->ray) < kGroundRel * work.diagonal)
      continue;
    out.trusted.push_back(*s);
  }
  return out;
}

// Leaves out views that the others contradict, until the rest agree.
void KeepWhatAgrees(const Work& work, std::vector<Candidate>& candidates, std::vector<ViewMask>& masks,
                    std::vector<OutlineSample>& outline, SilhouetteSummary& summary, Progress& progress) {
  for (int round = 0; round < kMaxRounds; ++round) {
    masks.clear();
    for (const Candidate& c : candidates) masks.push_back(c.mask);
    std::vector<Judged> judged(candidates.size());
    ParallelFor(candidates.size(), 1, [&](size_t i) {
      progress.ThrowIfCancelled();
      judged[i] = Judge(work, masks, static_cast<int>(i), candidates[i]);
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
  summary.num_trusted_samples = outline.size();
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

std::optional<double> Silhouettes::OutsideBy(const Eigen::Vector3d& x) const {
  return internal::OutsideBy(impl_->views, impl_->masks, x);
}

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
  std::vector<Candidate> candidates = Collect(views, progress, [&](size_t v) { return FromMask(work, v); });
  s.source = "masks";
  if (!ShowTheObject(candidates)) {
    candidates.clear();
    s.source = "";
    if (options.use == "masks") return out;
    s.source = "photographs";
    candidates = Collect(views, progress, [&](size_t v) { return FromPhotograph(work, v); });
  }
  s.num_views = candidates.size();
  if (candidates.size() < kMinViews) return out;
  KeepWhatAgrees(work, candidates, out.impl_->masks, out.impl_->outline, s, progress);
  if (s.num_trusted_views < kMinViews || 2 * s.num_trusted_views < s.num_views) {
    out.impl_->outline.clear();
    out.impl_->masks.clear();
    s.num_trusted_samples = 0;
  }
  return out;
}

}  // namespace glint
