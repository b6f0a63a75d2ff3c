// Normals that someone else measured in the photographs: by photometric stereo or a network.
#pragma once

#include <cstddef>

namespace cv {
class Mat;
}

namespace glint {

// Thread-safe. Implementations: files (io/normal_map_files.h), memory (tests).
class NormalSource {
 public:
  virtual ~NormalSource() = default;

  // A view's map: CV_32FC3, unit normals in the camera's axes (x right, y down, z forward), zero where there is none;
  // of any size in the camera's proportions. False if the view has none; throws InputError if it can not be used.
  virtual bool LoadNormals(size_t view, cv::Mat& normals) const = 0;
};

}  // namespace glint
