// COLMAP projects as arrays, highlights in images, and lights.
#include "colmap/project.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <opencv2/core.hpp>

#include "arrays.h"
#include "background.h"
#include "bindings.h"
#include "colmap/scene.h"
#include "highlights/detect.h"
#include "highlights/find_lights.h"
#include "io/project_images.h"
#include "light/light_io.h"
#include "pipeline/artifacts.h"
#include "pipeline/image_stages.h"
#include "settings.h"

namespace glint::python {

Array<double> ArrayOfRigid(const Rigid3d& rigid) {
  Eigen::Matrix<double, 3, 4> matrix;
  matrix << rigid.rotation.toRotationMatrix(), rigid.translation;
  return ArrayOfMatrix(matrix);
}

namespace {

using std::filesystem::path;

// COLMAP's invalid id, which does not fit, becomes -1.
int64_t SignedId(uint64_t id) { return id == kInvalidPoint3DId ? -1 : static_cast<int64_t>(id); }

py::dict DictOf(const Camera& camera) {
  py::dict d;
  d["camera_id"] = camera.id;
  d["model"] = std::string(*CameraModelName(static_cast<int>(camera.model)));
  d["width"] = camera.width;
  d["height"] = camera.height;
  d["params"] = ArrayOfScalars(camera.params);
  return d;
}

py::dict DictOf(const Image& image) {
  py::dict d;
  d["image_id"] = image.id;
  d["name"] = image.name;
  d["camera_id"] = image.camera_id;
  d["cam_from_world"] = ArrayOfRigid(image.cam_from_world);
  d["points2D"] = ArrayOfRows<2, double>(image.points2d, [](const Point2D& p) { return p.px; });
  d["point3D_ids"] = ArrayOfEach<int64_t>(image.points2d, [](const Point2D& p) { return SignedId(p.point3d_id); });
  return d;
}

py::dict DictOf(const std::vector<Point3D>& points) {
  py::dict d;
  d["ids"] = ArrayOfEach<int64_t>(points, [](const Point3D& p) { return SignedId(p.id); });
  d["xyz"] = ArrayOfRows<3, double>(points, [](const Point3D& p) { return p.xyz; });
  d["color"] = ArrayOfRows<3, uint8_t>(points, [](const Point3D& p) { return p.rgb; });
  d["error"] = ArrayOfEach<double>(points, [](const Point3D& p) { return p.error_px; });
  std::vector<int64_t> offsets = {0};
  std::vector<TrackElement> elements;
  for (const Point3D& p : points) {
    elements.insert(elements.end(), p.track.begin(), p.track.end());
    offsets.push_back(static_cast<int64_t>(elements.size()));
  }
  d["track_offsets"] = ArrayOfScalars(offsets);
  d["track_image_ids"] = ArrayOfEach<int64_t>(elements, [](const TrackElement& e) { return e.image_id; });
  d["track_point2D_idxs"] = ArrayOfEach<int64_t>(elements, [](const TrackElement& e) { return e.point2d_index; });
  return d;
}

py::dict ReadProject(const path& project, const path& images, const path& masks) {
  ProjectPaths paths;
  const Model model = InBackground(py::none(), [&](Progress&) {
    paths = FindProject(project, images, masks);
    return ReadModel(paths.model);
  });
  py::dict d, cameras, views;
  for (const auto& [id, camera] : model.cameras) cameras[py::int_(id)] = DictOf(camera);
  for (const Image& image : model.images) views[py::int_(image.id)] = DictOf(image);
  d["path"] = project;
  d["model_path"] = paths.model;
  d["image_path"] = paths.images.empty() ? py::object(py::none()) : py::cast(paths.images);
  d["mask_path"] = paths.masks.empty() ? py::object(py::none()) : py::cast(paths.masks);
  d["cameras"] = cameras;
  d["images"] = views;
  d["points3D"] = DictOf(model.points);
  std::vector<std::string> warnings = paths.notes;
  warnings.insert(warnings.end(), model.warnings.begin(), model.warnings.end());
  d["warnings"] = warnings;
  return d;
}

// An (n, 2, 2) array of get(highlight).
template <class Get>
Array<double> ArrayOf2x2(const std::vector<Highlight>& highlights, const Get& get) {
  Array<double> array({highlights.size(), size_t{2}, size_t{2}});
  double* out = array.mutable_data();
  for (const Highlight& h : highlights) {
    const Eigen::Matrix2d m = get(h);
    for (int k = 0; k < 4; ++k) *out++ = m(k / 2, k % 2);
  }
  return array;
}

// `image_ids`: COLMAP's, by view; empty where there is but one image.
py::dict DictOf(const std::vector<Highlight>& highlights, const std::vector<uint32_t>& image_ids) {
  py::dict d;
  d["image_id"] = ArrayOfEach<int64_t>(
      highlights, [&](const Highlight& h) { return image_ids.empty() ? int64_t{-1} : int64_t{image_ids[h.view]}; });
  d["px"] = ArrayOfRows<2, double>(highlights, [](const Highlight& h) { return h.px; });
  d["covariance_px"] = ArrayOf2x2(highlights, [](const Highlight& h) { return h.covariance_px; });
  d["moments_px"] = ArrayOf2x2(highlights, [](const Highlight& h) { return h.moments_px; });
  d["area_px"] = ArrayOfEach<double>(highlights, [](const Highlight& h) { return h.area_px; });
  d["strength"] = ArrayOfEach<double>(highlights, [](const Highlight& h) { return h.strength; });
  d["saturated_fraction"] = ArrayOfEach<double>(highlights, [](const Highlight& h) { return h.saturated_fraction; });
  d["light"] = ArrayOfEach<int64_t>(highlights, [](const Highlight& h) { return h.light; });
  py::list status;
  for (const Highlight& h : highlights) status.append(std::string(StatusName(h.status)));
  d["status"] = status;
  return d;
}

// `image`: BGR, (h, w, 3) of 8 or 16 bit; `mask`: (h, w) or none.
py::dict DetectIn(const py::array& image, const py::object& mask, const std::vector<std::string>& settings) {
  const Config config = ConfigFrom({}, settings);
  const int type = image.itemsize() == 1 ? CV_8UC3 : CV_16UC3;
  const cv::Mat pixels(static_cast<int>(image.shape(0)), static_cast<int>(image.shape(1)), type,
                       const_cast<void*>(image.data()));
  cv::Mat kept;
  if (!mask.is_none()) {
    const auto array = mask.cast<Array<uint8_t>>();
    kept = cv::Mat(pixels.rows, pixels.cols, CV_8UC1, const_cast<uint8_t*>(array.data())).clone();
  }
  return DictOf(InBackground(py::none(), [&](Progress&) { return DetectHighlights(pixels, kept, 0, config.detect); }),
                {});
}

py::dict DictOf(const FoundLight& found) {
  py::dict d;
  d["type"] = found.light.type == LightType::kDistant ? "distant" : "point";
  d["frame"] = found.light.frame == LightFrame::kWorld ? "world" : "camera";
  d["vector"] = ArrayOfScalars(std::vector<double>(found.light.vector.data(), found.light.vector.data() + 3));
  d["sigma"] = found.light.sigma;
  d["covariance"] = ArrayOfMatrix(found.covariance);
  d["support"] = found.support;
  d["conditioning"] = found.conditioning;
  d["determined"] = found.determined;
  d["why"] = found.why;
  return d;
}

py::list ListOf(const std::vector<FoundLight>& lights) {
  py::list list;
  for (const FoundLight& light : lights) list.append(DictOf(light));
  return list;
}

void WriteLightList(const path& file, const py::list& lights) {
  std::vector<Light> written;
  for (const py::handle item : lights) {
    const auto fields = item.cast<py::dict>();
    const auto vector = fields["vector"].cast<std::array<double, 3>>();
    Light& light = written.emplace_back();
    light.type = fields["type"].cast<std::string>() == "distant" ? LightType::kDistant : LightType::kPoint;
    light.frame = fields["frame"].cast<std::string>() == "world" ? LightFrame::kWorld : LightFrame::kCamera;
    light.vector = {vector[0], vector[1], vector[2]};
    light.sigma = fields["sigma"].cast<double>();
  }
  WriteLights(file, written);
}

// What detection and the lights' votes say of a project, given its surface.
py::list FindProjectLights(const path& project, const path& images, const path& masks, const py::dict& fields,
                           const std::vector<std::string>& settings, const py::object& callback) {
  const Config config = ConfigFrom({}, settings);
  const TriangleMesh mesh = MeshOf(fields);
  return ListOf(InBackground(callback, [&](Progress& progress) {
    const ProjectPaths paths = FindProject(project, images, masks);
    const Scene scene = MakeScene(ReadModel(paths.model));
    const ProjectImages source(scene, paths, progress);
    const std::vector<Highlight> candidates = DetectInAllViews(scene, source, config.detect, progress);
    return FindLights(scene, source, mesh, config.gate, config.lights, candidates, nullptr, progress);
  }));
}

py::dict ReadProjectHighlights(const path& file, const path& model) {
  const Scene scene = MakeScene(ReadModel(model));
  std::vector<uint32_t> ids;
  for (const View& view : scene.views) ids.push_back(view.image_id);
  return DictOf(ReadHighlights(file, scene.views.size()), ids);
}

}  // namespace

void BindProject(py::module_& m) {
  m.def("read_project", &ReadProject, py::arg("path"), py::arg("images"), py::arg("masks"));
  m.def("detect_highlights", &DetectIn, py::arg("image"), py::arg("mask"), py::arg("settings"));
  m.def("read_highlights", &ReadProjectHighlights, py::arg("path"), py::arg("model"));
  m.def("find_lights", &FindProjectLights, py::arg("project"), py::arg("images"), py::arg("masks"), py::arg("mesh"),
        py::arg("settings"), py::arg("progress"));
  m.def(
      "read_lights", [](const path& file) { return ListOf(ReadFoundLights(file)); }, py::arg("path"));
  m.def("write_lights", &WriteLightList, py::arg("path"), py::arg("lights"));
}

}  // namespace glint::python
