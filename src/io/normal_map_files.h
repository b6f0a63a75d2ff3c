// Normal maps as files, one a photograph.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "colmap/scene.h"
#include "core/options.h"
#include "core/progress.h"
#include "io/normal_source.h"

namespace glint {

struct NormalMapOptions {
  std::string axes = "opengl";  // or "opencv", "world": in what the maps' normals are
  void Visit(OptionVisitor& v);
};

// A view's map is the first there is of FOLDER/<image name>.png, .tif, .tiff, .geometric.bin and .photometric.bin, then
// the same with the image's extension left out. Images: red, green and blue are x, y and z, from -1 (black) to 1
// (white), 8 or 16 bits; a colour that is no unit vector (black, grey) is no normal. The .bin files are COLMAP's
// (dense/stereo/normal_maps), always in COLMAP's axes.
class NormalMapFiles : public NormalSource {
 public:
  // Throws InputError if the folder is not there or has no map of any view; says how many have none.
  NormalMapFiles(const Scene& scene, const std::filesystem::path& folder, const NormalMapOptions& options,
                 Progress& progress = Progress::Silent());

  // Throws InputError that names the file: not readable, cut, of other proportions than the camera's.
  bool LoadNormals(size_t view, cv::Mat& normals) const override;

  // Of the views' maps, for who wants to know whether they have changed; relative to the folder.
  std::vector<std::string> Names() const;

 private:
  struct Entry {
    std::string name;  // empty: none
    uint64_t width = 0, height = 0;
    Eigen::Matrix3d cam_from_map;
  };
  std::filesystem::path folder_;
  std::vector<Entry> views_;
};

}  // namespace glint
