// The photographs of a synthetic scene without a disk.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "io/image_source.h"
#include "synthetic/synthesize.h"

namespace glint {

// Renders a view when it is first asked for, passes it through its JPEG compression, and keeps it. Thread-safe.
class SyntheticImageSource : public ImageSource {
 public:
  explicit SyntheticImageSource(SyntheticScene scene, bool with_masks = false);
  ~SyntheticImageSource() override;

  size_t size() const override;
  bool Load(size_t view, cv::Mat& image) const override;
  bool LoadMask(size_t view, cv::Mat& mask) const override;  // 255 on the object, if asked for

  const SyntheticScene& scene() const { return scene_; }
  const ViewTruth& Truth(size_t view) const;

 private:
  struct Rendered;
  const Rendered& Get(size_t view) const;
  SyntheticScene scene_;
  bool with_masks_;
  mutable std::vector<std::unique_ptr<Rendered>> rendered_;
};

}  // namespace glint
