// Highlights measured: precision, recall and peak error on rendered scenes beside a plain threshold and Shen, Zheng
// 2013 (intensity ratio) on the same images; masks of the vase beside the path tracer's specular pass; throughput
// beside cv::imdecode.
//   highlights [--scenes a,b] [--roughness 0.05,..] [--bases coloured,..] [--noise 1,..] [--vase DIR]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "colmap/project.h"
#include "highlights/brightness.h"
#include "highlights/gate.h"
#include "highlights/overlay.h"
#include "io/project_images.h"
#include "light/light_io.h"
#include "pipeline/image_stages.h"
#include "pipeline/seed_stage.h"
#include "pipeline/terminal.h"
#include "synthetic/synthesize.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

struct Peak {
  Eigen::Vector2d px;  // COLMAP's frame
  double area_px = 0;
};

// Centroids of the pieces of a mask, weighed by `weight` (CV_32F).
std::vector<Peak> Pieces(const cv::Mat& mask, const cv::Mat& weight) {
  cv::Mat labels;
  const int count = cv::connectedComponents(mask, labels, 8, CV_32S);
  std::vector<Eigen::Vector4d> sums(static_cast<size_t>(count), Eigen::Vector4d::Zero());
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x) {
      const double w = weight.at<float>(y, x);
      sums[static_cast<size_t>(labels.at<int>(y, x))] += Eigen::Vector4d(w * (x + 0.5), w * (y + 0.5), w, 1);
    }
  std::vector<Peak> peaks;
  for (size_t k = 1; k < sums.size(); ++k)
    if (sums[k][2] > 0 && sums[k][3] >= 4) peaks.push_back({sums[k].head<2>() / sums[k][2], sums[k][3]});
  return peaks;
}

std::vector<Peak> PlainThreshold(const cv::Mat& image) {
  cv::Mat map;
  LinearMinChannel(image).convertTo(map, CV_32F, 1 / 65535.0);
  return Pieces(map > 0.8, map);
}

// Shen, Zheng, Real-time highlight removal using intensity ratio, Applied Optics 52, 2013: pixels are grouped by the
// minimum and maximum of their pseudo-chromaticity; in a group the ratio of maximum to range is that of the diffuse
// part (median); what exceeds it is specular.
std::vector<Peak> ShenZheng(const cv::Mat& image) {
  constexpr int kBins = 12;
  const cv::Size size = image.size();
  cv::Mat low(size, CV_32F), high(size, CV_32F), group(size, CV_32S), specular = cv::Mat::zeros(size, CV_32F);
  double mean_low = 0;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const auto& p = image.at<cv::Vec3b>(y, x);
      const auto [a, b] = std::minmax({p[0], p[1], p[2]});
      low.at<float>(y, x) = a, high.at<float>(y, x) = b;
      mean_low += a / double(size.area());
    }
  std::vector<std::vector<float>> ratios(kBins * kBins);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const auto& p = image.at<cv::Vec3b>(y, x);
      const double a = low.at<float>(y, x), b = high.at<float>(y, x);
      const double sum = p[0] + p[1] + p[2] - 3 * a + 3 * mean_low;  // pseudo specular-free
      const int i = std::min(kBins - 1, int(kBins * 3 * mean_low / std::max(sum, 1e-6)));
      const int j = std::min(kBins - 1, int(kBins * (b - a + mean_low) / std::max(sum, 1e-6)));
      group.at<int>(y, x) = i * kBins + j;
      if (a > mean_low && b > a) ratios[static_cast<size_t>(i * kBins + j)].push_back(float(b / (b - a)));
    }
  std::vector<double> ratio(ratios.size(), 0);
  for (size_t k = 0; k < ratios.size(); ++k) {
    if (ratios[k].empty()) continue;
    auto middle = ratios[k].begin() + static_cast<long>(ratios[k].size() / 2);
    std::nth_element(ratios[k].begin(), middle, ratios[k].end());
    ratio[k] = *middle;
  }
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double a = low.at<float>(y, x), b = high.at<float>(y, x);
      if (a <= mean_low) continue;
      const double diffuse = ratio[static_cast<size_t>(group.at<int>(y, x))] * (b - a);
      specular.at<float>(y, x) = static_cast<float>(std::clamp((b - diffuse) / 255, 0.0, 1.0));
    }
  return Pieces(specular > 0.3, specular);
}

struct Score {
  size_t found = 0, right = 0, expected = 0, met = 0;
  std::vector<double> errors_px;

  double Precision() const { return found ? double(right) / found : 1; }
  double Recall() const { return expected ? double(met) / expected : 1; }
  double MedianError() {
    if (errors_px.empty()) return 0;
    std::nth_element(errors_px.begin(), errors_px.begin() + errors_px.size() / 2, errors_px.end());
    return errors_px[errors_px.size() / 2];
  }
};

// A match: within 2 px or a fifth of its diameter of the true peak. Expected are those that are lit, at an incidence
// that counts, and not faint.
void Count(const std::vector<Peak>& peaks, const std::vector<TrueHighlight>& truth,
           const std::vector<uint8_t>& expected, Score& score) {
  std::vector<char> met(truth.size(), 0);
  for (const Peak& p : peaks) {
    const double reach = std::max(2.0, 0.2 * 2 * std::sqrt(p.area_px / M_PI));
    size_t best = truth.size();
    double nearest = reach;
    for (size_t t = 0; t < truth.size(); ++t)
      if ((truth[t].px - p.px).norm() <= nearest) nearest = (truth[t].px - p.px).norm(), best = t;
    ++score.found;
    if (best == truth.size()) continue;
    ++score.right;
    met[best] = 1;
    score.errors_px.push_back(nearest);
  }
  for (size_t t = 0; t < truth.size(); ++t) {
    score.expected += expected[t];
    score.met += expected[t] && met[t];
  }
}

void PrintScores(const std::string& name, std::vector<std::pair<std::string, Score>> scores) {
  fmt::print("{:<36}", name);
  for (auto& [method, s] : scores)
    fmt::print(" | {} {:.3f} {:.3f} {:>5.2f}", method, s.Precision(), s.Recall(), s.MedianError());
  fmt::print("\n");
  std::fflush(stdout);
}

using Scores = std::vector<std::pair<std::string, Score>>;

void MeasureScene(const SyntheticOptions& options, Scores& total) {
  const SyntheticScene synthetic = SynthesizeScene(options);
  const Scene scene = MakeScene(synthetic.model);
  std::vector<cv::Mat> images(scene.views.size());
  std::vector<std::vector<TrueHighlight>> truth(scene.views.size());
  for (size_t v = 0; v < scene.views.size(); ++v) {
    ViewTruth view_truth;
    RenderView(synthetic, v, images[v], view_truth);
    images[v] = cv::imdecode(EncodeImage(synthetic, images[v]), cv::IMREAD_COLOR);
    truth[v] = view_truth.highlights;
  }
  const MemoryImages source(images);
  Config config;
  Terminal quiet(Verbosity::kQuiet);
  std::vector<Highlight> highlights = DetectInAllViews(scene, source, config.detect, quiet);
  std::vector<Highlight> candidates = highlights;
  const SeedStageResult seed = RunSeedStage(scene, source, "", config, quiet);
  if (seed.start.empty()) {
    fmt::print("{}: no seed\n", options.scene);
    return;
  }
  GateHighlights(scene, source, seed.start, synthetic.lights, config.gate, highlights);
  Scores scores = {{"detected", {}}, {"gated", {}}, {"threshold", {}}, {"Shen&Zheng", {}}};
  for (size_t v = 0; v < scene.views.size(); ++v) {
    std::vector<uint8_t> expected;
    for (const TrueHighlight& t : truth[v]) {
      const double cos = t.normal.dot((scene.views[v].Center() - t.position).normalized());
      expected.push_back(t.lit && t.strength > 0.1 && cos > std::cos(60 * M_PI / 180));
    }
    std::vector<Peak> all, accepted;
    for (const Highlight& h : candidates)
      if (h.view == v && h.status == HighlightStatus::kAccepted) all.push_back({h.px, h.area_px});
    for (const Highlight& h : highlights)
      if (h.view == v && h.status == HighlightStatus::kAccepted) accepted.push_back({h.px, h.area_px});
    Count(all, truth[v], expected, scores[0].second);
    Count(accepted, truth[v], expected, scores[1].second);
    Count(PlainThreshold(images[v]), truth[v], expected, scores[2].second);
    Count(ShenZheng(images[v]), truth[v], expected, scores[3].second);
  }
  PrintScores(fmt::format("{} a={} {} n={} q={} lamp={}", options.scene, options.roughness, options.base,
                          options.noise_levels, options.jpeg_quality, options.light_angle_deg),
              scores);
  total.resize(scores.size());
  for (size_t m = 0; m < scores.size(); ++m) {
    total[m].first = scores[m].first;
    Score &sum = total[m].second, &s = scores[m].second;
    sum.found += s.found, sum.right += s.right, sum.expected += s.expected, sum.met += s.met;
    sum.errors_px.insert(sum.errors_px.end(), s.errors_px.begin(), s.errors_px.end());
  }
}

// Highlights on the vase against the specular pass: a found one is right if its peak lies on the mask (grown by 2 px);
// a true one is a piece of at least 12 px whose middle is within reach of a found one.
void MeasureVase(const fs::path& vase) {
  const ProjectPaths paths = FindProject(vase / "project");
  const Scene scene = MakeScene(ReadModel(paths.model));
  Terminal quiet(Verbosity::kQuiet);
  const ProjectImages images(scene, paths, quiet);
  Config config;
  const SeedStageResult seed = RunSeedStage(scene, images, "", config, quiet);
  std::vector<Highlight> highlights = DetectInAllViews(scene, images, config.detect, quiet);
  GateHighlights(scene, images, seed.start, ReadLights(vase / "lights.json"), config.gate, highlights);
  size_t found = 0, right = 0, pieces = 0, met = 0;
  double mask_both = 0, mask_found = 0, mask_true = 0;
  for (size_t v = 0; v < scene.views.size(); ++v) {
    const fs::path file = vase / "truth" / "highlights" / fs::path(scene.views[v].name).replace_extension(".png");
    cv::Mat truth = cv::imread(file.string(), cv::IMREAD_GRAYSCALE), grown;
    if (truth.empty()) continue;
    cv::dilate(truth, grown, cv::Mat::ones(5, 5, CV_8U));
    std::vector<Highlight> accepted;
    for (const Highlight& h : highlights)
      if (h.view == v && h.status == HighlightStatus::kAccepted) accepted.push_back(h);
    for (const Highlight& h : accepted) {
      ++found;
      right += grown.at<uint8_t>(int(h.px.y()), int(h.px.x())) > 0;
    }
    cv::Mat weight(truth.size(), CV_32F, cv::Scalar(1));
    for (const Peak& p : Pieces(truth > 0, weight)) {
      if (p.area_px < 12) continue;
      ++pieces;
      met += std::any_of(accepted.begin(), accepted.end(), [&](const Highlight& h) {
        return (h.px - p.px).norm() < std::max(3.0, std::sqrt(p.area_px / M_PI));
      });
    }
    const cv::Mat mask = HighlightMask(truth.cols, truth.rows, accepted, 0) == 0;
    mask_both += cv::countNonZero(mask & (truth > 0));
    mask_found += cv::countNonZero(mask);
    mask_true += cv::countNonZero(truth);
  }
  fmt::print(
      "vase, accepted by the gate: {} of {} lie on the specular pass (precision {:.3f}); {} of {} pieces of at "
      "least 12 px are met (recall {:.3f}); pixels: precision {:.3f}, recall {:.3f}\n",
      right, found, double(right) / std::max<size_t>(found, 1), met, pieces, double(met) / std::max<size_t>(pieces, 1),
      mask_both / std::max(mask_found, 1.0), mask_both / std::max(mask_true, 1.0));
}

// One thread, medians over the files of a folder.
void MeasureThroughput(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  files.resize(std::min<size_t>(files.size(), 12));
  cv::setNumThreads(1);
  std::vector<double> decode, detect;
  for (const fs::path& file : files) {
    std::ifstream in(file, std::ios::binary);
    const std::vector<char> bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    const auto seconds = [](const auto& work) {
      double best = 1e9;
      for (int k = 0; k < 3; ++k) {
        const auto start = std::chrono::steady_clock::now();
        work();
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      }
      return best;
    };
    cv::Mat image;
    const double decode_s = seconds([&] { image = cv::imdecode(bytes, cv::IMREAD_COLOR); });
    if (image.empty()) continue;
    const double mp = 1e-6 * double(image.total());
    decode.push_back(mp / decode_s);
    detect.push_back(mp / seconds([&] { DetectHighlights(image, cv::Mat(), 0, DetectOptions()); }));
  }
  const auto median = [](std::vector<double> v) {
    std::sort(v.begin(), v.end());
    return v.empty() ? 0 : v[v.size() / 2];
  };
  fmt::print("{}: detection {:.1f} MP/s, cv::imdecode {:.1f} MP/s, one core\n", folder.string(), median(detect),
             median(decode));
}

int Main(int argc, char** argv) {
  CLI::App app("Highlights measured");
  std::vector<std::string> scenes = {"sphere", "blob", "torus", "hood"},
                           bases = {"coloured", "black", "white", "metallic"};
  std::vector<double> roughness = {0.05, 0.2}, noise = {1}, lamp = {0};
  std::vector<fs::path> folders;
  fs::path vase;
  SyntheticOptions options;
  options.views = 20;
  options.width = 480;
  options.height = 360;
  options.lights = 2;
  app.add_option("--scenes", scenes, "'none' for none")->delimiter(',');
  app.add_option("--bases", bases, "base colours")->delimiter(',');
  app.add_option("--roughness", roughness, "GGX alpha")->delimiter(',');
  app.add_option("--noise", noise, "levels of 255")->delimiter(',');
  app.add_option("--lamp", lamp, "angular diameter, deg")->delimiter(',');
  app.add_option("--quality", options.jpeg_quality, "JPEG");
  app.add_option("--views", options.views, "views");
  app.add_option("--width", options.width, "px");
  app.add_option("--height", options.height, "px");
  app.add_option("--vase", vase, "folder of the vase");
  app.add_option("--throughput", folders, "folders of images")->delimiter(',');
  CLI11_PARSE(app, argc, argv);
  fmt::print("precision, recall, median peak error (px)\n");
  Scores total;
  for (const std::string& scene : scenes)
    for (const std::string& base : bases)
      for (double alpha : roughness)
        for (double n : noise)
          for (double l : lamp) {
            if (scene == "none") continue;
            options.scene = scene, options.base = base, options.roughness = alpha, options.noise_levels = n;
            options.light_angle_deg = l;
            MeasureScene(options, total);
          }
  if (!total.empty()) PrintScores("all", total);
  if (!vase.empty()) MeasureVase(vase);
  for (const fs::path& folder : folders) MeasureThroughput(folder);
  return 0;
}

}  // namespace
}  // namespace glint

int main(int argc, char** argv) { return glint::Main(argc, argv); }
