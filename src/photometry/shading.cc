#include "photometry/shading.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/median.h"
#include "core/parallel.h"
#include "core/square.h"
#include "photometry/materials.h"
#include "photometry/shadows.h"

namespace glint {
namespace {

constexpr int kRounds = 15;
constexpr double kRidge = 1e-5;  // where normals are too much alike to tell the room from the lights
constexpr size_t kFewestPatches = 40;
constexpr double kMinContrast = 2.5;  // in scatters
constexpr double kDarkest = 0.2;      // of the median brightness: below, errors are as large as there
constexpr double kColored = 0.25;     // the share of its colour that is not grey
constexpr double kBlack = 1e-6;       // no brightness at all
constexpr double kMaxSigma = 0.35;

// One brightness: b = a₀ + n·(g + Σ eₗ Eₗ).
struct Equation {
  size_t patch;
  double brightness;
  std::vector<Eigen::Vector3d> irradiance;  // a light: towards it, 1 long at the object's centre; zero in shadow
};

// A view's equation for a patch; nothing near the edge of a shadow.
std::optional<Equation> EquationOf(const SurfacePatch& patch, size_t index, double brightness, const View& view,
                                   const std::vector<Light>& lights, const Shadows& shadows) {
  Equation equation{index, brightness, {}};
  for (const Light& light : lights) {
    const auto irradiance = ShinesIn(light, view.name)
                                ? shadows.Irradiance(patch.position, patch.normal, light, view.cam_from_world)
                                : std::optional<Eigen::Vector3d>(Eigen::Vector3d::Zero());
    if (!irradiance) return std::nullopt;
    equation.irradiance.push_back(*irradiance);
  }
  return equation;
}

// What makes a brightness of a material's colours. Where the material has a colour, white does not count: what its
// gloss mirrors of the surroundings is nearly that.
Eigen::Array3d Channels(const std::vector<SurfacePatch>& patches, const std::vector<size_t>& material) {
  Eigen::Array3d color = Eigen::Array3d::Zero();
  for (const size_t patch : material)
    for (const PatchLook& look : patches[patch].looks) color += look.rgb / std::max(look.rgb.sum(), kBlack);
  color /= std::max(color.matrix().norm(), kBlack);
  const Eigen::Array3d colored = color - color.mean();
  if (colored.matrix().norm() < kColored) return Eigen::Array3d::Ones();
  return colored / colored.matrix().norm();
}

// One equation a patch where its light is the same in all views, one a look where it is not.
std::vector<Equation> EquationsOf(const SurfacePatch& patch, size_t index, const Scene& scene,
                                  const std::vector<Light>& lights, const Shadows& shadows,
                                  const Eigen::Array3d& channels) {
  std::vector<Equation> equations;
  if (patch.looks.empty()) return equations;
  const bool same = std::all_of(lights.begin(), lights.end(), [](const Light& light) {
    return light.frame == LightFrame::kWorld && light.images.empty();
  });
  const auto add = [&](double brightness, uint32_t view) {
    if (auto equation = EquationOf(patch, index, brightness, scene.views[view], lights, shadows))
      equations.push_back(std::move(*equation));
  };
  if (same) {
    std::vector<double> values;
    for (const PatchLook& look : patch.looks) values.push_back((channels * look.rgb).sum());
    add(Median(values), patch.looks.front().view);
  } else {
    for (const PatchLook& look : patch.looks) add((channels * look.rgb).sum(), look.view);
  }
  return equations;
}

// Of one material: a₀, g and e, and how well they do.
struct Fit {
  double ambient = 0;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::VectorXd strength;  // a light
  double scatter = 0, contrast = 0;
  double darkest = 0;

  Eigen::Vector3d Slope(const Equation& e) const {
    Eigen::Vector3d slope = gradient;
    for (Eigen::Index l = 0; l < strength.size(); ++l) slope += strength[l] * e.irradiance[l];
    return slope;
  }
  double Predict(const Equation& e, const Eigen::Vector3d& normal) const { return ambient + normal.dot(Slope(e)); }
  // Errors go with the brightness: they are those of the colour.
  double Scale(double predicted) const { return std::max(predicted, darkest); }
};

// Least squares with weights; lights that would take light away are left out.
void Solve(const std::vector<Equation>& equations, const std::vector<SurfacePatch>& patches,
           const std::vector<double>& weights, Fit& fit) {
  const Eigen::Index num_lights = fit.strength.size();
  std::vector<bool> shines(static_cast<size_t>(num_lights), true);
  for (bool again = true; again;) {
    again = false;
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(4 + num_lights, 4 + num_lights);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(4 + num_lights);
    for (size_t i = 0; i < equations.size(); ++i) {
      const Eigen::Vector3d& n = patches[equations[i].patch].normal;
      Eigen::VectorXd row(4 + num_lights);
      row << 1, n, Eigen::VectorXd::Zero(num_lights);
      for (Eigen::Index l = 0; l < num_lights; ++l)
        if (shines[static_cast<size_t>(l)]) row[4 + l] = n.dot(equations[i].irradiance[l]);
      a += weights[i] * row * row.transpose();
      b += weights[i] * equations[i].brightness * row;
    }
    a.diagonal() *= 1 + kRidge;
    a.diagonal().array() += kRidge * kRidge * a(0, 0);
    const Eigen::VectorXd x = a.ldlt().solve(b);
    fit.ambient = x[0];
    fit.gradient = x.segment<3>(1);
    fit.strength = x.tail(num_lights);
    for (Eigen::Index l = 0; l < num_lights; ++l) {
      if (shines[static_cast<size_t>(l)] && fit.strength[l] < 0) {
        shines[static_cast<size_t>(l)] = false;
        again = true;
      }
      if (!shines[static_cast<size_t>(l)]) fit.strength[l] = 0;
    }
  }
}

Fit FitMaterial(const std::vector<Equation>& equations, const std::vector<SurfacePatch>& patches, size_t num_lights) {
  Fit fit;
  fit.strength = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(num_lights));
  std::vector<double> brightness;
  for (const Equation& e : equations) brightness.push_back(e.brightness);
  fit.darkest = std::max(kDarkest * Median(brightness), kBlack);
  std::vector<double> weights(equations.size(), 1);
  for (int round = 0; round < kRounds; ++round) {
    Solve(equations, patches, weights, fit);
    std::vector<double> off(equations.size()), predicted(equations.size());
    for (size_t i = 0; i < equations.size(); ++i) {
      predicted[i] = fit.Predict(equations[i], patches[equations[i].patch].normal);
      off[i] = std::abs(equations[i].brightness - predicted[i]) / fit.Scale(predicted[i]);
    }
    fit.scatter = std::max(1.4826 * Median(off), 1e-4);
    const double middle = Median(predicted);
    for (size_t i = 0; i < equations.size(); ++i) {
      const double ratio = off[i] / (3 * fit.scatter);
      weights[i] = 1 / Square((1 + ratio * ratio) * fit.Scale(predicted[i]));
      predicted[i] = std::abs(predicted[i] - middle) / fit.Scale(middle);
    }
    fit.contrast = 1.4826 * Median(predicted);
  }
  return fit;
}

void AddTilts(const std::vector<Equation>& equations, const std::vector<SurfacePatch>& patches, const Fit& fit,
              std::vector<Tilt>& tilts) {
  for (const Equation& e : equations) {
    const SurfacePatch& patch = patches[e.patch];
    const Eigen::Vector3d slope = fit.Slope(e);
    const double length = slope.norm();
    const bool lit = std::any_of(e.irradiance.begin(), e.irradiance.end(), [](const auto& i) { return !i.isZero(); });
    if (!lit || length <= 0) continue;
    Tilt tilt;
    tilt.position = patch.position;
    tilt.direction = slope / length;
    tilt.cosine = std::min((e.brightness - fit.ambient) / length, 1.0);
    tilt.sigma = fit.scatter * fit.Scale(fit.Predict(e, patch.normal)) / length;
    tilt.radius_world = patch.radius_world;
    if (tilt.sigma < kMaxSigma) tilts.push_back(tilt);
  }
}

}  // namespace

ShadingTilts TiltsFromShading(const TriangleMesh& surface, const Scene& scene, const std::vector<Light>& lights,
                              const std::vector<SurfacePatch>& patches) {
  ShadingTilts shading;
  if (lights.empty()) return shading;
  const Shadows shadows(surface);
  for (const std::vector<size_t>& material : SortIntoMaterials(patches)) {
    const Eigen::Array3d channels = Channels(patches, material);
    std::vector<std::vector<Equation>> by_patch(material.size());
    ParallelFor(material.size(), 64, [&](size_t i) {
      by_patch[i] = EquationsOf(patches[material[i]], material[i], scene, lights, shadows, channels);
    });
    std::vector<Equation> equations;
    for (const auto& of_patch : by_patch) equations.insert(equations.end(), of_patch.begin(), of_patch.end());
    Material report;
    report.num_patches = material.size();
    if (equations.size() >= kFewestPatches) {
      const Fit fit = FitMaterial(equations, patches, lights.size());
      report.scatter = fit.scatter;
      report.contrast = fit.contrast;
      report.used = fit.strength.maxCoeff() > 0 && fit.contrast > kMinContrast * fit.scatter;
      if (report.used) AddTilts(equations, patches, fit, shading.tilts);
    }
    shading.materials.push_back(report);
  }
  return shading;
}

}  // namespace glint
