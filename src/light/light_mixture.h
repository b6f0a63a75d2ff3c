// A mixture of lights and outliers on the normals under highlights, and its fit by expectation maximisation.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "light/light.h"
#include "light/light_fit.h"

namespace glint {

struct LightMixture {
  std::vector<Light> lights;
  std::vector<double> shares;  // one a light; the rest are outliers
  std::vector<double> sigmas;  // of the normals under each light's highlights: seeds are better here and worse there
  double criterion = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd responsibilities;  // observation × light
  Eigen::MatrixXd weights;           // the same, less for those in the tails

  // A further light: it starts with most of what is left, and catches what is broadly right.
  void Add(const Light& light);
  // Another light in the place of one, with as broad a start.
  void Replace(size_t k, const Light& light);
  void Remove(size_t k);
  double OutlierShare() const;
  // Observations that the light with the fewest explains.
  double LeastSupport() const;
};

inline constexpr double kBroadStart = 4 * M_PI / 180;  // sigma, radians

class LightMixtureFit {
 public:
  LightMixtureFit(const std::vector<LightObservation>& observations, const Eigen::Vector3d& center, double diagonal,
                  const LightFitOptions& options);

  // From the mixture's lights, shares and sigmas to the nearest maximum; fills everything else.
  void Finish(LightMixture& m) const;

  // Two of the lights are the same, as far as normals this uncertain can tell.
  bool Repeats(const LightMixture& m) const;

  // Of a flash, see LineariseLight().
  double Prior(double sigma) const;

 private:
  double Expect(LightMixture& m) const;
  void Maximise(LightMixture& m) const;
  double Complexity(const Light& light) const;
  double MeanAngle(const Light& one, const Light& other) const;

  const std::vector<LightObservation>& observations_;
  const Eigen::Vector3d center_;
  const double diagonal_;
  const LightFitOptions& options_;
  double flash_spread_ = 0;  // how far from the camera a flash is expected, diagonals
  double num_eligible_ = 0;  // observations that are not outliers in any case
};

inline bool IsFlash(const Light& light) {
  return light.type == LightType::kPoint && light.frame == LightFrame::kCamera;
}

}  // namespace glint
