// Residuals of the specular bundle, written once for automatic differentiation (Ceres' Jets) and plain doubles.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "constraints/contact.h"

namespace glint {

// Half vector at origin + depth * direction; `light` is a direction or a position in the light's frame.
struct HalfVectorModel {
  LightType type;
  LightFrame frame;
  Eigen::Matrix3d world_from_cam_rotation;
  Eigen::Vector3d origin;     // camera centre
  Eigen::Vector3d direction;  // unit, from the camera

  HalfVectorModel(const Contact& contact, const Light& light)
      : type(light.type),
        frame(light.frame),
        world_from_cam_rotation(contact.cam_from_world.rotation.conjugate().toRotationMatrix()),
        origin(contact.origin),
        direction(contact.direction) {}

  template <class T>
  Eigen::Matrix<T, 3, 1> Position(const T& depth) const {
    return origin.cast<T>() + direction.cast<T>() * depth;
  }

  template <class T>
  Eigen::Matrix<T, 3, 1> Normal(const Eigen::Matrix<T, 3, 1>& position, const T* light) const {
    Eigen::Matrix<T, 3, 1> l(light[0], light[1], light[2]);
    if (frame == LightFrame::kCamera) l = world_from_cam_rotation.cast<T>() * l;
    if (type == LightType::kPoint) {
      if (frame == LightFrame::kCamera) l += origin.cast<T>();
      l -= position;
    }
    return (l.normalized() - direction.cast<T>()).normalized();
  }
};

// ((n_i + n_j)/|n_i + n_j| · (x_j − x_i) − offset) / sigma: with no offset exact on a sphere, third order in the chord
// elsewhere (DESIGN 3.3). `offset` is the same product on the current surface, which takes up how the curvature changes
// between the two contacts: once surface and contacts agree, the residual is exact (a deferred correction).
struct ChordResidual {
  HalfVectorModel a, b;
  double inverse_sigma;
  double offset = 0;

  template <class T>
  bool operator()(const T* depth_a, const T* depth_b, const T* light_a, const T* light_b, T* residual) const {
    const Eigen::Matrix<T, 3, 1> x_a = a.Position(*depth_a), x_b = b.Position(*depth_b);
    const Eigen::Matrix<T, 3, 1> n = (a.Normal(x_a, light_a) + b.Normal(x_b, light_b)).normalized();
    *residual = T(inverse_sigma) * (n.dot(x_b - x_a) - T(offset));
    return true;
  }
  template <class T>
  bool operator()(const T* depth_a, const T* depth_b, const T* light, T* residual) const {
    return (*this)(depth_a, depth_b, light, light, residual);
  }
};

// The same between a contact and a surface point whose normal is known approximately.
struct PointChordResidual {
  HalfVectorModel a;
  Eigen::Vector3d point;
  Eigen::Vector3d normal;
  double inverse_sigma;
  double offset = 0;

  template <class T>
  bool operator()(const T* depth, const T* light, T* residual) const {
    const Eigen::Matrix<T, 3, 1> x = a.Position(*depth);
    const Eigen::Matrix<T, 3, 1> n = (a.Normal(x, light) + normal.cast<T>()).normalized();
    *residual = T(inverse_sigma) * (n.dot(point.cast<T>() - x) - T(offset));
    return true;
  }
};

// (value − mean) / sigma of each of Size parameters.
template <int Size>
struct PriorResidual {
  Eigen::Matrix<double, Size, 1> mean;
  double inverse_sigma;

  template <class T>
  bool operator()(const T* value, T* residual) const {
    for (int k = 0; k < Size; ++k) residual[k] = T(inverse_sigma) * (value[k] - T(mean[k]));
    return true;
  }
};

}  // namespace glint
