// Images by view, read when they are asked for: stages never open files themselves.
#pragma once

#include <cstddef>
#include <optional>

namespace cv {
class Mat;
}

namespace glint {

// Thread-safe. Implementations: files of a project (io/project_images.h), rendered images (tests).
class ImageSource {
 public:
  virtual ~ImageSource() = default;
  virtual size_t size() const = 0;  // number of views

  // The view's image: CV_8UC3 or CV_16UC3, BGR, camera's width × height. Returns false if the image is not
  // there (already counted and warned about); throws InputError if it is there but cannot be used.
  virtual bool Load(size_t view, cv::Mat& image) const = 0;

  // The view's mask: CV_8UC1, 0 where the image is to be ignored. False if there is none.
  virtual bool LoadMask(size_t view, cv::Mat& mask) const = 0;
};

}  // namespace glint
