#include "pipeline/versions.h"

#include <CGAL/version.h>
#include <ceres/version.h>
#include <embree3/rtcore_config.h>
#include <fmt/format.h>
#include <openvdb/version.h>
#include <tbb/version.h>

#include <Eigen/Core>
#include <opencv2/core/utility.hpp>

namespace glint {

std::vector<std::pair<std::string, std::string>> LibraryVersions() {
  return {{"CGAL", CGAL_VERSION_STR},
          {"Ceres", CERES_VERSION_STRING},
          {"Eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
          {"Embree", RTC_VERSION_STRING},
          {"OpenCV", cv::getVersionString()},
          {"OpenVDB", openvdb::getLibraryVersionString()},
          {"TBB", TBB_runtime_version()},
          {"compiler", __VERSION__}};
}

}  // namespace glint
