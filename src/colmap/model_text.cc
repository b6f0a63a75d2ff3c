#include <fmt/format.h>

#include <array>
#include <iterator>
#include <ostream>

#include "colmap/model_files.h"
#include "colmap/text_reader.h"
#include "core/atomic_file.h"

namespace glint::internal {
namespace {

Rigid3d ReadPose(TextReader& in, Warnings& warnings) {
  std::array<double, 7> values;
  for (double& value : values) value = in.Number<double>("a pose as QW QX QY QZ TX TY TZ");
  return CheckedPose(Eigen::Vector4d(values.data()), Eigen::Vector3d(values.data() + 4), in.path(), in.Record(),
                     warnings);
}

bool ReadIsCamera(TextReader& in) {
  const std::string_view type = in.Token("a sensor type");
  if (type == "CAMERA") return true;
  if (type == "IMU" || type == "INVALID") return false;
  in.Fail(fmt::format("expected the sensor type CAMERA or IMU, found '{}'", type));
}

uint64_t ReadPointId(TextReader& in) {
  const std::string_view what = "a 2D point as X Y POINT3D_ID (-1 for none)";
  const int64_t id = in.Number<int64_t>(what);
  if (id < -1) in.Fail(fmt::format("expected {}, found the id {}", what, id));
  return id == -1 ? kInvalidPoint3DId : static_cast<uint64_t>(id);
}

void ReadPoints2D(TextReader& in, Image& image) {
  if (!in.NextLine()) return;  // the file's last line may be missing where it would be empty
  while (!in.AtEnd()) {
    Point2D& point = image.points2d.emplace_back();
    point.px.x() = in.Number<double>("a 2D point as X Y POINT3D_ID (-1 for none)");
    point.px.y() = in.Number<double>("a 2D point as X Y POINT3D_ID (-1 for none)");
    point.point3d_id = ReadPointId(in);
  }
  image.points2d.shrink_to_fit();
}

// Collects lines and hands them to the stream in large pieces.
class TextWriter {
 public:
  explicit TextWriter(std::ostream& out) : out_(out) {}
  ~TextWriter() { Flush(); }
  template <class... Args>
  void Print(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(buffer_), format, std::forward<Args>(args)...);
    if (buffer_.size() > (size_t{1} << 20)) Flush();
  }

 private:
  void Flush() {
    out_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
  }
  std::ostream& out_;
  fmt::memory_buffer buffer_;
};

}  // namespace

std::vector<Camera> ReadCamerasText(const std::filesystem::path& file) {
  std::vector<Camera> cameras;
  TextReader in(file);
  while (in.NextRecord()) {
    Camera& camera = cameras.emplace_back();
    camera.id = in.Number<uint32_t>("a camera id");
    in.Describe("camera", camera.id);
    const std::string_view name = in.Token("a camera model");
    const auto model = CameraModelFromName(name);
    if (!model) in.Fail(fmt::format("expected a camera model of COLMAP such as PINHOLE or OPENCV, found '{}'", name));
    camera.model = *model;
    camera.width = in.Number<uint64_t>("a width in pixels");
    camera.height = in.Number<uint64_t>("a height in pixels");
    while (!in.AtEnd()) camera.params.push_back(in.Number<double>("a camera parameter"));
  }
  return cameras;
}

std::vector<Image> ReadImagesText(const std::filesystem::path& file, Warnings& warnings) {
  std::vector<Image> images;
  TextReader in(file);
  while (in.NextRecord()) {
    Image& image = images.emplace_back();
    image.id = in.Number<uint32_t>("an image as IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME");
    in.Describe("image", image.id);
    image.cam_from_world = ReadPose(in, warnings);
    image.camera_id = in.Number<uint32_t>("a camera id");
    if (in.AtEnd()) in.Fail("expected an image name, found the end of the line");
    image.name = in.Rest();
    ReadPoints2D(in, image);
  }
  return images;
}

std::vector<std::string> ReadImageNamesText(const std::filesystem::path& file) {
  std::vector<std::string> names;
  TextReader in(file);
  while (in.NextRecord()) {
    for (int i = 0; i < 9; ++i) in.Token("an image as IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME");
    names.emplace_back(in.Rest());
    in.NextLine();
  }
  return names;
}

std::vector<Point3D> ReadPointsText(const std::filesystem::path& file) {
  std::vector<Point3D> points;
  TextReader in(file);
  while (in.NextRecord()) {
    Point3D& point = points.emplace_back();
    point.id = in.Number<uint64_t>("a point as POINT3D_ID X Y Z R G B ERROR TRACK[]");
    in.Describe("point", point.id);
    for (double& value : point.xyz) value = in.Number<double>("a point's position");
    for (uint8_t& value : point.rgb) value = in.Number<uint8_t>("a colour from 0 to 255");
    point.error_px = in.Number<double>("a point's error");
    while (!in.AtEnd()) {
      TrackElement& element = point.track.emplace_back();
      element.image_id = in.Number<uint32_t>("a track element as IMAGE_ID POINT2D_IDX");
      element.point2d_index = in.Number<uint32_t>("a track element as IMAGE_ID POINT2D_IDX");
    }
    point.track.shrink_to_fit();
  }
  return points;
}

std::vector<Rig> ReadRigsText(const std::filesystem::path& file, Warnings& warnings) {
  std::vector<Rig> rigs;
  TextReader in(file);
  while (in.NextRecord()) {
    Rig& rig = rigs.emplace_back();
    rig.id = in.Number<uint32_t>("a rig id");
    in.Describe("rig", rig.id);
    const uint32_t num_sensors = in.Number<uint32_t>("the number of sensors");
    for (uint32_t i = 0; i < num_sensors; ++i) {
      const bool is_camera = ReadIsCamera(in);
      const uint32_t sensor_id = in.Number<uint32_t>("a sensor id");
      std::optional<Rigid3d> camera_from_rig;
      // The first sensor is the reference and has no pose of its own.
      if (i > 0 && in.Number<int>("1 or 0 for a sensor with or without pose") != 0) {
        camera_from_rig = ReadPose(in, warnings);
      }
      if (!is_camera) continue;
      if (i == 0) {
        rig.reference_camera_id = sensor_id;
      } else {
        rig.cameras.emplace_back(sensor_id, camera_from_rig);
      }
    }
  }
  return rigs;
}

std::vector<Frame> ReadFramesText(const std::filesystem::path& file, Warnings& warnings) {
  std::vector<Frame> frames;
  TextReader in(file);
  while (in.NextRecord()) {
    Frame& frame = frames.emplace_back();
    frame.id = in.Number<uint32_t>("a frame id");
    in.Describe("frame", frame.id);
    frame.rig_id = in.Number<uint32_t>("a rig id");
    frame.rig_from_world = ReadPose(in, warnings);
    const uint32_t num_data = in.Number<uint32_t>("the number of data ids");
    for (uint32_t i = 0; i < num_data; ++i) {
      const bool is_camera = ReadIsCamera(in);
      const uint32_t sensor_id = in.Number<uint32_t>("a sensor id");
      const uint64_t data_id = in.Number<uint64_t>("a data id");
      if (is_camera) frame.images.emplace_back(sensor_id, data_id);
    }
  }
  return frames;
}

void WriteText(const Model& model, const std::filesystem::path& folder) {
  // Numbers are printed as the shortest decimal that reads back as the same double.
  WriteFileAtomically(folder / "cameras.txt", [&](std::ostream& stream) {
    TextWriter out(stream);
    out.Print("# Camera list with one line of data per camera:\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n");
    out.Print("# Number of cameras: {}\n", model.cameras.size());
    for (const auto& [id, camera] : model.cameras) {
      out.Print("{} {} {} {}", id, *CameraModelName(static_cast<int>(camera.model)), camera.width, camera.height);
      for (const double param : camera.params) out.Print(" {}", param);
      out.Print("\n");
    }
  });
  WriteFileAtomically(folder / "images.txt", [&](std::ostream& stream) {
    TextWriter out(stream);
    out.Print("# Image list with two lines of data per image:\n");
    out.Print("#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n");
    out.Print("#   POINTS2D[] as (X, Y, POINT3D_ID)\n# Number of images: {}\n", model.images.size());
    for (const Image& image : model.images) {
      const auto& q = image.cam_from_world.rotation;
      const auto& t = image.cam_from_world.translation;
      out.Print("{} {} {} {} {} {} {} {} {} {}\n", image.id, q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z(),
                image.camera_id, image.name);
      std::string_view separator = "";
      for (const Point2D& point : image.points2d) {
        out.Print("{}{} {} ", separator, point.px.x(), point.px.y());
        if (point.point3d_id == kInvalidPoint3DId) {
          out.Print("-1");
        } else {
          out.Print("{}", point.point3d_id);
        }
        separator = " ";
      }
      out.Print("\n");
    }
  });
  WriteFileAtomically(folder / "points3D.txt", [&](std::ostream& stream) {
    TextWriter out(stream);
    out.Print("# 3D point list with one line of data per point:\n");
    out.Print("#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n");
    out.Print("# Number of points: {}\n", model.points.size());
    for (const Point3D& p : model.points) {
      out.Print("{} {} {} {} {} {} {} {}", p.id, p.xyz.x(), p.xyz.y(), p.xyz.z(), p.rgb[0], p.rgb[1], p.rgb[2],
                p.error_px);
      for (const TrackElement& element : p.track) out.Print(" {} {}", element.image_id, element.point2d_index);
      out.Print("\n");
    }
  });
}

}  // namespace glint::internal
