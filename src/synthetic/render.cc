#include "synthetic/render.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>

#include "core/parallel.h"
#include "synthetic/shading.h"

namespace glint {
namespace {

using Eigen::Array3f;
using Eigen::Vector2d;
using Eigen::Vector3d;

// One ray's outcome.
struct Sample {
  Array3f radiance = Array3f::Zero();
  float specular = 0;
  SurfaceKind kind = SurfaceKind::kSky;
};

double EncodeExactly(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

// sRGB's tone curve in 8-bit levels, continued above white so that noise does not darken saturated pixels.
float Encode(float linear) {
  constexpr int kSize = 8192;
  static const std::vector<float> table = [] {
    std::vector<float> values(kSize + 2);
    for (int i = 0; i < kSize + 2; ++i) values[i] = static_cast<float>(255 * EncodeExactly(i / double{kSize}));
    return values;
  }();
  if (linear >= 1) return 255 * (1 + 0.44f * (std::min(linear, 4.f) - 1));
  const float position = std::max(linear, 0.f) * kSize;
  const int i = static_cast<int>(position);
  return table[i] + (position - static_cast<float>(i)) * (table[i + 1] - table[i]);
}

class Renderer {
 public:
  Renderer(const Stage& stage, size_t view_index)
      : stage_(stage),
        view_(stage.views[view_index]),
        view_index_(view_index),
        center_(view_.Center()),
        width_(static_cast<int>(view_.camera.width)),
        height_(static_cast<int>(view_.camera.height)),
        samples_(static_cast<size_t>(width_) * height_),
        maps_(stage.lights.size()) {
    for (LobeMap& map : maps_) map = {width_, height_, 1, std::vector<float>(samples_.size(), -1)};
  }

  void TraceCentres() {
    ParallelFor(height_, 4, [&](size_t y) {
      for (int x = 0; x < width_; ++x) {
        const size_t i = Index(x, static_cast<int>(y));
        samples_[i] = Trace(Vector2d(x + 0.5, static_cast<double>(y) + 0.5), i, &maps_);
      }
    });
  }

  // The mean of five rays where a pixel differs from a neighbour.
  std::vector<Array3f> Smooth() const {
    std::vector<Array3f> smooth(samples_.size());
    ParallelFor(height_, 4, [&](size_t row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < width_; ++x) {
        const size_t i = Index(x, y);
        smooth[i] = samples_[i].radiance;
        if (!NeedsMore(x, y)) continue;
        static constexpr double kOffsets[4][2] = {{0.375, 0.125}, {0.875, 0.375}, {0.625, 0.875}, {0.125, 0.625}};
        for (int k = 0; k < 4; ++k) {
          const Vector2d px(x + kOffsets[k][0], y + kOffsets[k][1]);
          smooth[i] += Trace(px, i + (k + 1) * samples_.size(), nullptr).radiance;
        }
        smooth[i] /= 5;
      }
    });
    return smooth;
  }

  void FillTruth(ViewTruth& truth) const {
    truth.width = width_;
    truth.height = height_;
    truth.object_mask.resize(samples_.size());
    truth.specular.resize(samples_.size());
    for (size_t i = 0; i < samples_.size(); ++i) {
      truth.object_mask[i] = samples_[i].kind == SurfaceKind::kObject ? 255 : 0;
      truth.specular[i] = samples_[i].specular;
    }
    truth.highlights.clear();
    for (size_t light = 0; light < maps_.size(); ++light)
      for (const TrueHighlight& h : FindTrueHighlights(stage_, view_, light, maps_[light]))
        truth.highlights.push_back(h);
  }

 private:
  size_t Index(int x, int y) const { return static_cast<size_t>(y) * width_ + x; }

  Sample Trace(const Vector2d& px, size_t key, std::vector<LobeMap>* maps) const {
    Sample sample;
    const auto direction = view_.RayThrough(px);
    if (!direction) return sample;
    const SurfaceHit hit = stage_.Trace(center_, *direction);
    const Shading shading = Shade(stage_, view_, hit, *direction, HashOf({stage_.seed, view_index_, key}));
    sample.radiance = shading.radiance.cast<float>();
    sample.specular = static_cast<float>(shading.specular);
    sample.kind = hit.kind;
    if (maps && hit.kind == SurfaceKind::kObject)
      for (size_t l = 0; l < maps->size(); ++l) {
        const Vector3d half = HalfVector(stage_.lights[l].light, view_.cam_from_stage, hit.position);
        (*maps)[l].cosine[key] = static_cast<float>(half.dot(hit.normal));
      }
    return sample;
  }

  bool NeedsMore(int x, int y) const {
    const Sample& here = samples_[Index(x, y)];
    static constexpr int kNeighbours[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    for (const auto& n : kNeighbours) {
      const int nx = x + n[0], ny = y + n[1];
      if (nx < 0 || ny < 0 || nx >= width_ || ny >= height_) continue;
      const Sample& there = samples_[Index(nx, ny)];
      if (there.kind != here.kind) return true;
      // A difference of about 20 levels.
      const Array3f a = here.radiance.min(1).max(0).sqrt(), b = there.radiance.min(1).max(0).sqrt();
      if ((a - b).abs().maxCoeff() > 0.08f) return true;
    }
    return false;
  }

  const Stage& stage_;
  const StageView& view_;
  size_t view_index_;
  Vector3d center_;
  int width_, height_;
  std::vector<Sample> samples_;
  std::vector<LobeMap> maps_;
};

}  // namespace

double SensorLevel(double radiance) { return Encode(static_cast<float>(radiance)); }

void RenderView(const Stage& stage, size_t view, const SensorOptions& sensor, cv::Mat& image, ViewTruth& truth) {
  Renderer renderer(stage, view);
  renderer.TraceCentres();
  const std::vector<Array3f> radiance = renderer.Smooth();
  renderer.FillTruth(truth);
  image.create(truth.height, truth.width, CV_8UC3);
  ParallelFor(truth.height, 16, [&](size_t y) {
    cv::Vec3b* row = image.ptr<cv::Vec3b>(static_cast<int>(y));
    Random random({stage.seed, 71, view, y});
    for (int x = 0; x < truth.width; ++x) {
      const Array3f& color = radiance[y * truth.width + x];
      for (int c = 0; c < 3; ++c) {
        double level = Encode(color[c]);
        if (sensor.noise_levels > 0) level += sensor.noise_levels * random.Normal();
        row[x][2 - c] = static_cast<uint8_t>(std::clamp(std::lround(level), 0l, 255l));
      }
    }
  });
}

}  // namespace glint
