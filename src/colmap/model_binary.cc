#include <fmt/format.h>

#include <algorithm>
#include <ostream>

#include "colmap/binary_reader.h"
#include "colmap/model_files.h"
#include "core/atomic_file.h"

namespace glint::internal {
namespace {

constexpr size_t kMaxNameLength = 4096;
constexpr uint64_t kPoseBytes = 7 * sizeof(double);
constexpr uint64_t kPoint2DBytes = 2 * sizeof(double) + sizeof(uint64_t);
constexpr uint64_t kTrackElementBytes = 2 * sizeof(uint32_t);
// What one record takes at the least.
constexpr uint64_t kMinCameraBytes = 2 * sizeof(uint32_t) + 2 * sizeof(uint64_t);
constexpr uint64_t kMinImageBytes = sizeof(uint32_t) + kPoseBytes + sizeof(uint32_t) + 1 + sizeof(uint64_t);
constexpr uint64_t kMinPointBytes = sizeof(uint64_t) + 3 * sizeof(double) + 3 + sizeof(double) + sizeof(uint64_t);
constexpr uint64_t kMinRigBytes = 2 * sizeof(uint32_t);
constexpr uint64_t kMinFrameBytes = 3 * sizeof(uint32_t) + kPoseBytes;
constexpr int32_t kCameraSensor = 0;  // COLMAP's sensor types: -1 invalid, 0 camera, 1 IMU

// In memory as in the file, so that an image's points are read at once.
static_assert(sizeof(Point2D) == kPoint2DBytes && sizeof(TrackElement) == kTrackElementBytes);

Rigid3d ReadPose(BinaryReader& in, Warnings& warnings) {
  std::array<double, 7> values;
  in.ReadBytes(values.data(), kPoseBytes, "a pose");
  return CheckedPose(Eigen::Vector4d(values.data()), Eigen::Vector3d(values.data() + 4), in.path(), in.Record(),
                     warnings);
}

void WarnOfTrailingBytes(const BinaryReader& in, Warnings& warnings) {
  warnings.Add(
      "trailing bytes",
      [&] {
        return fmt::format("{}: expected the end after the last record, found {} more bytes", in.path().string(),
                           in.Remaining());
      },
      in.Remaining() > 0 ? 1 : 0);
}

// Reads a count and then that many records, each by `read_record(in, record)`.
template <class Record, class ReadRecord>
std::vector<Record> ReadRecords(const std::filesystem::path& file, std::string_view kind, std::string_view kinds,
                                uint64_t min_bytes, Warnings& warnings, const ReadRecord& read_record) {
  BinaryReader in(file);
  const uint64_t count = in.ReadCount(kinds, min_bytes);
  std::vector<Record> records;
  records.reserve(count);
  for (uint64_t i = 0; i < count; ++i) {
    in.BeginRecord(kind, i + 1, count);
    read_record(in, records.emplace_back());
  }
  WarnOfTrailingBytes(in, warnings);
  return records;
}

// Appends values and hands them to the stream in large pieces.
class BinaryWriter {
 public:
  explicit BinaryWriter(std::ostream& out) : out_(out) {}
  ~BinaryWriter() { Flush(); }
  template <class T>
  void Write(T value) {
    static_assert(std::is_arithmetic_v<T>);
    WriteBytes(&value, sizeof(T));
  }
  void WriteBytes(const void* bytes, size_t size) {
    buffer_.append(static_cast<const char*>(bytes), size);
    if (buffer_.size() > (size_t{1} << 20)) Flush();
  }
  void WritePose(const Rigid3d& pose) {
    const auto& q = pose.rotation;
    for (const double value : {q.w(), q.x(), q.y(), q.z()}) Write(value);
    for (const double value : pose.translation) Write(value);
  }

 private:
  void Flush() {
    out_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
  }
  std::ostream& out_;
  std::string buffer_;
};

}  // namespace

std::vector<Camera> ReadCamerasBinary(const std::filesystem::path& file, Warnings& warnings) {
  return ReadRecords<Camera>(
      file, "camera", "cameras", kMinCameraBytes, warnings, [](BinaryReader& in, Camera& camera) {
        camera.id = in.Read<uint32_t>("a camera id");
        in.DescribeId(camera.id);
        const int32_t model = in.Read<int32_t>("a camera model");
        const auto num_params = CameraModelNumParams(model);
        // Without the model the record's length is unknown: nothing after it can be read.
        if (!num_params) in.Fail(fmt::format("expected a camera model id of COLMAP (0 to 17), found {}", model));
        camera.model = static_cast<CameraModel>(model);
        camera.width = in.Read<uint64_t>("a camera's width");
        camera.height = in.Read<uint64_t>("a camera's height");
        camera.params.resize(*num_params);
        in.ReadBytes(camera.params.data(), *num_params * sizeof(double), "a camera's parameters");
      });
}

std::vector<Image> ReadImagesBinary(const std::filesystem::path& file, Warnings& warnings) {
  return ReadRecords<Image>(file, "image", "images", kMinImageBytes, warnings, [&](BinaryReader& in, Image& image) {
    image.id = in.Read<uint32_t>("an image id");
    in.DescribeId(image.id);
    image.cam_from_world = ReadPose(in, warnings);
    image.camera_id = in.Read<uint32_t>("a camera id");
    image.name = in.ReadZeroTerminated("the image name", kMaxNameLength);
    in.DescribeName(image.name);
    image.points2d.resize(in.ReadCount("2D points", kPoint2DBytes));
    in.ReadBytes(static_cast<void*>(image.points2d.data()), image.points2d.size() * kPoint2DBytes, "2D points");
  });
}

std::vector<Point3D> ReadPointsBinary(const std::filesystem::path& file, Warnings& warnings) {
  return ReadRecords<Point3D>(file, "point", "points", kMinPointBytes, warnings, [](BinaryReader& in, Point3D& point) {
    point.id = in.Read<uint64_t>("a point id");
    in.DescribeId(point.id);
    in.ReadBytes(point.xyz.data(), 3 * sizeof(double), "a point's position");
    in.ReadBytes(point.rgb.data(), 3, "a point's colour");
    point.error_px = in.Read<double>("a point's error");
    point.track.resize(in.ReadCount("track elements", kTrackElementBytes));
    in.ReadBytes(point.track.data(), point.track.size() * kTrackElementBytes, "a track");
  });
}

std::vector<Rig> ReadRigsBinary(const std::filesystem::path& file, Warnings& warnings) {
  return ReadRecords<Rig>(file, "rig", "rigs", kMinRigBytes, warnings, [&](BinaryReader& in, Rig& rig) {
    rig.id = in.Read<uint32_t>("a rig id");
    in.DescribeId(rig.id);
    const uint32_t num_sensors = in.Read<uint32_t>("the number of sensors");
    for (uint32_t i = 0; i < num_sensors; ++i) {
      const int32_t type = in.Read<int32_t>("a sensor type");
      const uint32_t sensor_id = in.Read<uint32_t>("a sensor id");
      std::optional<Rigid3d> camera_from_rig;
      // The first sensor is the reference and has no pose of its own.
      if (i > 0 && in.Read<uint8_t>("the mark of a sensor's pose") != 0) camera_from_rig = ReadPose(in, warnings);
      if (type != kCameraSensor) continue;
      if (i == 0) {
        rig.reference_camera_id = sensor_id;
      } else {
        rig.cameras.emplace_back(sensor_id, camera_from_rig);
      }
    }
  });
}

std::vector<Frame> ReadFramesBinary(const std::filesystem::path& file, Warnings& warnings) {
  return ReadRecords<Frame>(file, "frame", "frames", kMinFrameBytes, warnings, [&](BinaryReader& in, Frame& frame) {
    frame.id = in.Read<uint32_t>("a frame id");
    in.DescribeId(frame.id);
    frame.rig_id = in.Read<uint32_t>("a rig id");
    frame.rig_from_world = ReadPose(in, warnings);
    const uint32_t num_data = in.Read<uint32_t>("the number of data ids");
    for (uint32_t i = 0; i < num_data; ++i) {
      const int32_t type = in.Read<int32_t>("a sensor type");
      const uint32_t sensor_id = in.Read<uint32_t>("a sensor id");
      const uint64_t data_id = in.Read<uint64_t>("a data id");
      if (type == kCameraSensor) frame.images.emplace_back(sensor_id, data_id);
    }
  });
}

std::vector<std::string> ReadImageNamesBinary(const std::filesystem::path& file) {
  BinaryReader in(file);
  const uint64_t count = in.ReadCount("images", kMinImageBytes);
  std::vector<std::string> names;
  for (uint64_t i = 0; i < count; ++i) {
    in.BeginRecord("image", i + 1, count);
    in.DescribeId(in.Read<uint32_t>("an image id"));
    in.Skip(kPoseBytes + sizeof(uint32_t), "a pose and a camera id");
    names.push_back(in.ReadZeroTerminated("the image name", kMaxNameLength));
    in.DescribeName(names.back());
    in.Skip(in.ReadCount("2D points", kPoint2DBytes) * kPoint2DBytes, "2D points");
  }
  return names;
}

void WriteBinary(const Model& model, const std::filesystem::path& folder) {
  WriteFileAtomically(folder / "cameras.bin", [&](std::ostream& stream) {
    BinaryWriter out(stream);
    out.Write<uint64_t>(model.cameras.size());
    for (const auto& [id, camera] : model.cameras) {
      out.Write<uint32_t>(id);
      out.Write<int32_t>(static_cast<int32_t>(camera.model));
      out.Write<uint64_t>(camera.width);
      out.Write<uint64_t>(camera.height);
      for (const double param : camera.params) out.Write(param);
    }
  });
  WriteFileAtomically(folder / "images.bin", [&](std::ostream& stream) {
    BinaryWriter out(stream);
    out.Write<uint64_t>(model.images.size());
    for (const Image& image : model.images) {
      out.Write<uint32_t>(image.id);
      out.WritePose(image.cam_from_world);
      out.Write<uint32_t>(image.camera_id);
      out.WriteBytes(image.name.c_str(), image.name.size() + 1);
      out.Write<uint64_t>(image.points2d.size());
      out.WriteBytes(image.points2d.data(), image.points2d.size() * kPoint2DBytes);
    }
  });
  WriteFileAtomically(folder / "points3D.bin", [&](std::ostream& stream) {
    BinaryWriter out(stream);
    out.Write<uint64_t>(model.points.size());
    for (const Point3D& point : model.points) {
      out.Write<uint64_t>(point.id);
      for (const double value : point.xyz) out.Write(value);
      out.WriteBytes(point.rgb.data(), 3);
      out.Write(point.error_px);
      out.Write<uint64_t>(point.track.size());
      out.WriteBytes(point.track.data(), point.track.size() * kTrackElementBytes);
    }
  });
}

}  // namespace glint::internal
