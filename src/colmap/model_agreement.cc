#include <fmt/format.h>

#include <algorithm>
#include <unordered_map>

#include "colmap/model_files.h"
#include "core/error.h"

namespace glint::internal {
namespace {

constexpr size_t kMinObservations = 30, kMaxObservations = 200000;
// COLMAP leaves observations out beyond 4 px, so a sound model is far from all of these.
constexpr double kMaxMedianPx = 20, kMaxMedianRel = 0.02, kMinInside = 0.9;

bool IsInside(const Camera& camera, const Eigen::Vector2d& px) {
  return px.x() >= 0 && px.y() >= 0 && px.x() <= static_cast<double>(camera.width) &&
         px.y() <= static_cast<double>(camera.height);
}

}  // namespace

void CheckAgreement(const ModelFiles& files, const Model& model) {
  std::unordered_map<uint32_t, std::pair<const Image*, bool>> image_of_id;  // and whether its pixels were dropped
  for (const Image& image : model.images) image_of_id.emplace(image.id, std::pair(&image, HasZeroedPoints(image)));
  size_t num_observations = 0;
  for (const Point3D& point : model.points) num_observations += point.track.size();
  const size_t stride = num_observations / kMaxObservations + 1;

  std::vector<double> errors_px, errors_rel;
  size_t num_without_pixel = 0, num_inside = 0, index = 0;
  for (const Point3D& point : model.points) {
    for (const TrackElement& element : point.track) {
      if (index++ % stride != 0) continue;
      const auto& [image, is_zeroed] = image_of_id.at(element.image_id);
      const Camera& camera = model.cameras.at(image->camera_id);
      const auto px = ProjectToPixel(camera, image->cam_from_world * point.xyz);
      const double diagonal = std::hypot(camera.width, camera.height);
      if (is_zeroed) {
        ++num_without_pixel;
        num_inside += px && IsInside(camera, *px) ? 1 : 0;
      } else {
        const Eigen::Vector2d seen = image->points2d[element.point2d_index].px;
        errors_px.push_back(px ? (*px - seen).norm() : diagonal);
        errors_rel.push_back(errors_px.back() / diagonal);
      }
    }
  }
  if (num_without_pixel >= kMinObservations && num_inside < kMinInside * num_without_pixel) {
    throw InputError(files.images.string(), "",
                     fmt::format("expected poses that see the points of {}; the 2D points are all at (0, 0), and only "
                                 "{:.0f} % of the tracks' points project into their images: the poses do not belong to "
                                 "the points",
                                 files.points.filename().string(), 100.0 * num_inside / num_without_pixel));
  }
  if (errors_px.size() < kMinObservations) return;
  const auto median = [](std::vector<double>& values) {
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
  };
  const double median_px = median(errors_px);
  if (median_px > kMaxMedianPx && median(errors_rel) > kMaxMedianRel) {
    throw InputError(files.images.string(), "",
                     fmt::format("expected poses that project the points of {} to where the images saw them, found a "
                                 "median error of {:.0f} px: are the poses camera-to-world, or of another model?",
                                 files.points.filename().string(), median_px));
  }
}

}  // namespace glint::internal
