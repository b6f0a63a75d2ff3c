#include "synthetic/synthetic_image_source.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/check.h"

namespace glint {

struct SyntheticImageSource::Rendered {
  std::once_flag once;
  cv::Mat image;
  ViewTruth truth;
};

SyntheticImageSource::SyntheticImageSource(SyntheticScene scene, bool with_masks)
    : scene_(std::move(scene)), with_masks_(with_masks) {
  for (size_t v = 0; v < scene_.model.images.size(); ++v) rendered_.push_back(std::make_unique<Rendered>());
}

SyntheticImageSource::~SyntheticImageSource() = default;

size_t SyntheticImageSource::size() const { return rendered_.size(); }

const SyntheticImageSource::Rendered& SyntheticImageSource::Get(size_t view) const {
  GLINT_CHECK_LT(view, rendered_.size());
  Rendered& rendered = *rendered_[view];
  // Isolated: a thread that waits inside must not take up a task that waits for this very view.
  const auto render = [&] {
    RenderView(scene_, view, rendered.image, rendered.truth);
    rendered.image = cv::imdecode(EncodeImage(scene_, rendered.image), cv::IMREAD_COLOR);
  };
  std::call_once(rendered.once, [&] { tbb::this_task_arena::isolate(render); });
  return rendered;
}

bool SyntheticImageSource::Load(size_t view, cv::Mat& image) const {
  image = Get(view).image.clone();
  return true;
}

bool SyntheticImageSource::LoadMask(size_t view, cv::Mat& mask) const {
  if (!with_masks_) return false;
  const ViewTruth& truth = Get(view).truth;
  mask.create(truth.height, truth.width, CV_8UC1);
  std::copy(truth.object_mask.begin(), truth.object_mask.end(), mask.data);
  return true;
}

const ViewTruth& SyntheticImageSource::Truth(size_t view) const { return Get(view).truth; }

}  // namespace glint
