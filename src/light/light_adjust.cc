#include "light/light_adjust.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace glint {
Light Moved(const Light& light, double diagonal, const Eigen::Vector3d& step) {
  Light moved = light;
  moved.vector += TangentBasis(light, diagonal) * step;
  if (light.type == LightType::kDistant) moved.vector.normalize();
  return moved;
}

Eigen::Matrix3d TangentBasis(const Light& light, double diagonal) {
  if (light.type == LightType::kPoint) return diagonal * Eigen::Matrix3d::Identity();
  Eigen::Matrix3d basis = Eigen::Matrix3d::Zero();
  basis.col(0) = light.vector.unitOrthogonal();
  basis.col(1) = light.vector.cross(basis.col(0));
  return basis;
}

int NumParameters(const Light& light) { return light.type == LightType::kDistant ? 2 : 3; }

double Disagreement(const LightObservation& observation, const Light& light, double max_incidence_deg) {
  if (observation.outlier) return M_PI;
  const Eigen::Vector3d to_camera =
      (observation.cam_from_world.Inverse().translation - observation.position).normalized();
  const Eigen::Vector3d half = HalfVector(light, observation.cam_from_world, observation.position);
  if (half.dot(to_camera) < std::cos(max_incidence_deg * (M_PI / 180))) return M_PI;
  return std::atan2(half.cross(observation.normal).norm(), half.dot(observation.normal));
}

Eigen::Matrix3d HalfVectorJacobian(const LightObservation& o, const Light& light, double diagonal) {
  constexpr double kStep = 1e-5;
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
  for (int p = 0; p < NumParameters(light); ++p) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(p);
    jacobian.col(p) = (HalfVector(Moved(light, diagonal, step), o.cam_from_world, o.position) -
                       HalfVector(Moved(light, diagonal, -step), o.cam_from_world, o.position)) /
                      (2 * kStep);
  }
  return jacobian;
}

LightEquations LineariseLight(const std::vector<LightObservation>& observations, const Eigen::VectorXd& weights,
                              const Light& light, double max_incidence_deg, double diagonal, double prior) {
  LightEquations equations;
  if (prior > 0 && light.type == LightType::kPoint && light.frame == LightFrame::kCamera) {
    const Eigen::Vector3d x = light.vector / diagonal;
    equations.hessian = prior * Eigen::Matrix3d::Identity();
    equations.gradient = prior * x;
    equations.cost = prior * x.squaredNorm();
  }
  for (size_t i = 0; i < observations.size(); ++i) {
    if (weights[i] < 1e-3) continue;
    const LightObservation& o = observations[i];
    if (Disagreement(o, light, max_incidence_deg) > 3) continue;
    const Eigen::Vector3d r = HalfVector(light, o.cam_from_world, o.position) - o.normal;
    const Eigen::Matrix3d jacobian = HalfVectorJacobian(o, light, diagonal);
    equations.hessian += weights[i] * jacobian.transpose() * jacobian;
    equations.gradient += weights[i] * jacobian.transpose() * r;
    equations.cost += weights[i] * r.squaredNorm();
  }
  return equations;
}

void AdjustLight(const std::vector<LightObservation>& observations, const Eigen::VectorXd& weights,
                 double max_incidence_deg, double diagonal, double prior, Light& light) {
  double lambda = 1e-3;
  for (int iteration = 0; iteration < 4; ++iteration) {
    const LightEquations now = LineariseLight(observations, weights, light, max_incidence_deg, diagonal, prior);
    if (now.cost <= 0) return;
    const int p = NumParameters(light);
    Eigen::Matrix3d damped = now.hessian;
    damped.diagonal().array() += lambda * now.hessian.trace() + 1e-12;
    if (p == 2) damped(2, 2) = 1;
    Eigen::Vector3d step = -damped.ldlt().solve(now.gradient);
    if (p == 2) step.z() = 0;
    step *= std::min(1.0, 0.5 / std::max(step.norm(), 1e-12));
    const Light next = Moved(light, diagonal, step);
    if (LineariseLight(observations, weights, next, max_incidence_deg, diagonal, prior).cost < now.cost) {
      light = next;
      lambda = std::max(lambda / 10, 1e-9);
      if (step.norm() < 1e-6) return;
    } else {
      lambda *= 20;
    }
  }
}

}  // namespace glint
