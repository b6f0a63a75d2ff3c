#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "colmap/model_files.h"

namespace glint::internal {
namespace {

// Position in a sorted list of an id; a table where the ids are dense, else a binary search.
class IdIndex {
 public:
  template <class Records>
  explicit IdIndex(const Records& records) {
    ids_.reserve(records.size());
    for (const auto& record : records) ids_.push_back(record.id);
    const uint64_t max_id = ids_.empty() ? 0 : ids_.back();
    if (max_id > 4 * ids_.size() + 65536) return;
    table_.assign(max_id + 1, kNone);
    for (size_t i = 0; i < ids_.size(); ++i) table_[ids_[i]] = static_cast<uint32_t>(i);
    ids_ = {};
  }
  static constexpr uint32_t kNone = ~uint32_t{0};
  uint32_t Find(uint64_t id) const {
    if (!table_.empty()) return id < table_.size() ? table_[id] : kNone;
    const auto found = std::lower_bound(ids_.begin(), ids_.end(), id);
    return found != ids_.end() && *found == id ? static_cast<uint32_t>(found - ids_.begin()) : kNone;
  }

 private:
  std::vector<uint64_t> ids_;
  std::vector<uint32_t> table_;
};

}  // namespace

void RepairTracks(const ModelFiles& files, Model& model, Warnings& warnings) {
  const IdIndex image_index(model.images);
  // One bit a 2D point: some track lists it.
  std::vector<size_t> first_bit(model.images.size() + 1, 0);
  for (size_t i = 0; i < model.images.size(); ++i) first_bit[i + 1] = first_bit[i] + model.images[i].points2d.size();
  std::vector<bool> is_listed(first_bit.back(), false);
  // Programs that drop the 2D points leave zeros, also for the ids: there the tracks alone are to be believed.
  std::vector<bool> is_zeroed(model.images.size());
  for (size_t i = 0; i < model.images.size(); ++i) {
    is_zeroed[i] = HasZeroedPoints(model.images[i]);
    if (!is_zeroed[i]) continue;
    for (Point2D& point2d : model.images[i].points2d) point2d.point3d_id = kInvalidPoint3DId;
  }

  for (Point3D& point : model.points) {
    const auto drop = [&](std::string_view kind, const TrackElement& element, const std::string& found) {
      warnings.Add(kind, [&] {
        return fmt::format("{}: point {}: its track refers to 2D point {} of image {}, {}; left out",
                           files.points.string(), point.id, element.point2d_index, element.image_id, found);
      });
    };
    std::erase_if(point.track, [&](const TrackElement& element) {
      const uint32_t image = image_index.Find(element.image_id);
      if (image == IdIndex::kNone) {
        drop("missing image", element, "which is not in the model");
        return true;
      }
      auto& points2d = model.images[image].points2d;
      if (element.point2d_index >= points2d.size()) {
        drop("missing 2D point", element, "which has fewer");
        return true;
      }
      Point2D& point2d = points2d[element.point2d_index];
      if (is_zeroed[image] && point2d.point3d_id == kInvalidPoint3DId) point2d.point3d_id = point.id;
      if (point2d.point3d_id != point.id || !point2d.px.allFinite()) {
        drop("contradicting 2D point", element, "which does not refer back to it");
        return true;
      }
      const size_t bit = first_bit[image] + element.point2d_index;
      if (is_listed[bit]) return true;  // listed twice in one track: once is enough
      is_listed[bit] = true;
      return false;
    });
  }
  for (size_t i = 0; i < model.images.size(); ++i) {
    Image& image = model.images[i];
    for (size_t k = 0; k < image.points2d.size(); ++k) {
      Point2D& point2d = image.points2d[k];
      if (point2d.point3d_id == kInvalidPoint3DId || is_listed[first_bit[i] + k]) continue;
      warnings.Add("unlisted 2D point", [&] {
        return fmt::format(
            "{}: image {} '{}': 2D point {} refers to point {}, which is missing or does not list it; "
            "the reference is left out",
            files.images.string(), image.id, image.name, k, point2d.point3d_id);
      });
      point2d.point3d_id = kInvalidPoint3DId;
    }
  }
}

}  // namespace glint::internal
