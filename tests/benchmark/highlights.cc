// Highlights measured: precision, recall and peak error on rendered scenes beside a plain threshold and Shen, Zheng
// 2013 (intensity ratio) on the same images; masks of the vase beside the path tracer's specular pass; throughput
// beside cv::imdecode.
//   highlights [--scenes a,b] [--roughness 0.05,..] [--bases coloured,..] [--noise 1,..] [--vase DIR]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "colmap/project.h"
#include "core/parallel.h"
#include "highlights/brightness.h"
#include "highlights/detect.h"
#include "highlights/gate.h"
#include "highlights/overlay.h"
#include "io/project_images.h"
#include "light/light_io.h"
#include "seed/build_seed.h"
#include "synthetic/synthesize.h"
#include "tests/benchmark/highlight_peers.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

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
  void Add(const Score& s) {
    found += s.found, right += s.right, expected += s.expected, met += s.met;
    errors_px.insert(errors_px.end(), s.errors_px.begin(), s.errors_px.end());
  }
};

using Scores = std::vector<std::pair<std::string, Score>>;
using Reasons = std::map<std::string, int>;

struct ViewData {
  cv::Mat image;
  std::vector<TrueHighlight> truth;  // lit
  std::vector<char> expected;        // of the truth: not faint, at an incidence that counts
};

double Reach(double area_px) { return std::max(2.0, 0.2 * 2 * std::sqrt(area_px / M_PI)); }

// The nearest true peak within 2 px or a fifth of the blob's diameter; truth.size(): none.
size_t Match(const Peak& p, const std::vector<TrueHighlight>& truth) {
  size_t best = truth.size();
  double nearest = Reach(p.area_px);
  for (size_t t = 0; t < truth.size(); ++t)
    if ((truth[t].px - p.px).norm() <= nearest) nearest = (truth[t].px - p.px).norm(), best = t;
  return best;
}

// A true peak is met once: what is found there again is wrong.
void Count(const std::vector<Peak>& peaks, const ViewData& view, Score& score) {
  std::vector<char> met(view.truth.size(), 0);
  for (const Peak& p : peaks) {
    const size_t t = Match(p, view.truth);
    ++score.found;
    if (t == view.truth.size() || met[t]) continue;
    ++score.right;
    met[t] = 1;
    score.errors_px.push_back((view.truth[t].px - p.px).norm());
  }
  for (size_t t = 0; t < view.truth.size(); ++t) {
    score.expected += view.expected[t];
    score.met += view.expected[t] && met[t];
  }
}

std::vector<Peak> AcceptedPeaks(const std::vector<Highlight>& highlights, size_t view) {
  std::vector<Peak> peaks;
  for (const Highlight& h : highlights)
    if (h.view == view && h.status == HighlightStatus::kAccepted) peaks.push_back({h.px, h.area_px});
  return peaks;
}

// Why expected highlights are missing after the gate, and what the accepted wrong ones are.
void Explain(const std::vector<Highlight>& highlights, size_t v, const ViewData& view, Reasons& reasons) {
  for (size_t t = 0; t < view.truth.size(); ++t) {
    if (!view.expected[t]) continue;
    std::string why = "missed: no candidate";
    for (const Highlight& h : highlights) {
      if (h.view != v || Match({h.px, h.area_px}, {view.truth[t]}) != 0) continue;
      if (h.status == HighlightStatus::kAccepted) {
        why.clear();
        break;
      }
      if (why == "missed: no candidate") why = fmt::format("missed: {}", StatusName(h.status));
    }
    if (!why.empty()) ++reasons[why];
  }
  for (const Highlight& h : highlights) {
    if (h.view != v || h.status != HighlightStatus::kAccepted) continue;
    if (Match({h.px, h.area_px}, view.truth) < view.truth.size()) continue;
    const bool near = Match({h.px, 25 * h.area_px}, view.truth) < view.truth.size();
    ++reasons[near ? "wrong: within a diameter of a peak" : "wrong: elsewhere"];
  }
}

void PrintScores(const std::string& name, Scores scores) {
  fmt::print("{:<40}", name);
  for (auto& [method, s] : scores)
    fmt::print(" | {} {:.3f} {:.3f} {:>5.2f}", method, s.Precision(), s.Recall(), s.MedianError());
  if (!scores.empty()) fmt::print(" | {} expected", scores[0].second.expected);
  fmt::print("\n");
  std::fflush(stdout);
}

std::vector<Highlight> DetectAll(const ImageSource& images) {
  std::vector<std::vector<Highlight>> by_view(images.size());
  ParallelFor(images.size(), 1, [&](size_t v) {
    cv::Mat image, mask;
    if (!images.Load(v, image)) return;
    images.LoadMask(v, mask);
    by_view[v] = DetectHighlights(image, mask, static_cast<uint32_t>(v), {});
  });
  std::vector<Highlight> all;
  for (const auto& found : by_view) all.insert(all.end(), found.begin(), found.end());
  return all;
}

std::vector<ViewData> Photograph(const SyntheticScene& synthetic, const Scene& scene) {
  std::vector<ViewData> views(scene.views.size());
  for (size_t v = 0; v < views.size(); ++v) {
    ViewTruth truth;
    cv::Mat image;
    RenderView(synthetic, v, image, truth);
    views[v].image = cv::imdecode(EncodeImage(synthetic, image), cv::IMREAD_COLOR);
    for (const TrueHighlight& t : truth.highlights) {
      if (!t.lit) continue;
      const double cos = t.normal.dot((scene.views[v].Center() - t.position).normalized());
      views[v].truth.push_back(t);
      views[v].expected.push_back(t.strength > 0.1 && cos > std::cos(60 * M_PI / 180));
    }
  }
  return views;
}

void MeasureScene(const SyntheticOptions& options, bool explain, Scores& total) {
  const SyntheticScene synthetic = SynthesizeScene(options);
  const Scene scene = MakeScene(synthetic.model);
  const std::vector<ViewData> views = Photograph(synthetic, scene);
  std::vector<cv::Mat> images;
  for (const ViewData& view : views) images.push_back(view.image);
  const MemoryImages source(images);
  const std::vector<Highlight> candidates = DetectAll(source);
  SeedSummary seed_summary;
  const SeedResult seed = BuildSeed(scene, {}, &seed_summary);
  if (seed.smooth.empty()) return fmt::print("{}: no seed\n", options.scene);
  std::vector<Highlight> gated = candidates;
  GateHighlights(scene, source, seed.smooth, synthetic.lights, {}, gated);
  Scores scores = {{"detected", {}}, {"gated", {}}, {"threshold", {}}, {"Shen&Zheng", {}}};
  Reasons reasons;
  for (size_t v = 0; v < views.size(); ++v) {
    Count(AcceptedPeaks(candidates, v), views[v], scores[0].second);
    Count(AcceptedPeaks(gated, v), views[v], scores[1].second);
    Count(PlainThreshold(views[v].image), views[v], scores[2].second);
    Count(ShenZheng(views[v].image), views[v], scores[3].second);
    Explain(gated, v, views[v], reasons);
  }
  PrintScores(fmt::format("{} a={} {} n={} q={} lamp={}", options.scene, options.roughness, options.base,
                          options.noise_levels, options.jpeg_quality, options.light_angle_deg),
              scores);
  if (explain) fmt::print("    {}\n", seed_summary.BriefReport());
  if (explain)
    for (const auto& [reason, count] : reasons) fmt::print("    {} {}\n", count, reason);
  total.resize(scores.size());
  for (size_t m = 0; m < scores.size(); ++m) {
    total[m].first = scores[m].first;
    total[m].second.Add(scores[m].second);
  }
}

// Highlights on the vase against the specular pass: a found one is right if its peak lies on the mask (grown by 2 px);
// a true one is a piece of at least 12 px whose middle is within reach of a found one.
void MeasureVase(const fs::path& vase) {
  const ProjectPaths paths = FindProject(vase / "project");
  const Scene scene = MakeScene(ReadModel(paths.model));
  const ProjectImages images(scene, paths, Progress::Silent());
  const SeedResult seed = BuildSeed(scene);
  std::vector<Highlight> highlights = DetectAll(images);
  GateHighlights(scene, images, seed.smooth, ReadLights(vase / "lights.json"), {}, highlights);
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

// One thread, medians over the files of a folder. Processor time: what else runs on the machine does not count.
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
        const std::clock_t start = std::clock();
        work();
        best = std::min(best, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
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
  bool explain = false;
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
  app.add_flag("--explain", explain, "why expected ones are missing and what the wrong ones are");
  app.add_option("--seed", options.seed, "of the scene");
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
            MeasureScene(options, explain, total);
          }
  if (!total.empty()) PrintScores("all", total);
  if (!vase.empty()) MeasureVase(vase);
  for (const fs::path& folder : folders) MeasureThroughput(folder);
  return 0;
}

}  // namespace
}  // namespace glint

int main(int argc, char** argv) { return glint::Main(argc, argv); }
