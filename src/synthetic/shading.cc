#include "synthetic/shading.h"

#include <algorithm>
#include <cmath>

namespace glint {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

Array3d Fresnel(const Array3d& at_normal, double cosine) {
  const double m = std::clamp(1 - cosine, 0.0, 1.0), m2 = m * m;
  return at_normal + (1 - at_normal) * (m2 * m2 * m);
}

// Of what a white diffuse surface facing the light shows there.
double Irradiance(const StageLight& light, const Rigid3d& cam_from_stage, const Vector3d& x) {
  if (light.light.type == LightType::kDistant) return light.irradiance;
  const double falloff = light.reference_distance / light.Distance(cam_from_stage, x);
  return light.irradiance * falloff * falloff;
}

// Share of a light's disc that the surface point sees.
double LightVisibility(const Stage& stage, const SurfaceHit& hit, const Vector3d& to_light, double distance,
                       uint64_t sample) {
  if (stage.light_radius == 0) return stage.Visibility(hit, to_light, distance);
  constexpr int kSamples = 6, kFirst = 3;
  const Vector3d side = to_light.unitOrthogonal(), other = to_light.cross(side);
  const double turn = 2 * std::numbers::pi * UnitOfHash(sample);
  double sum = 0;
  for (int i = 0; i < kSamples; ++i) {
    // From the rim inwards: where three points of the rim agree, the disc is wholly seen or hidden.
    const double r = stage.light_radius * std::sqrt((kSamples - i - 0.5) / kSamples), angle = turn + 2.39996 * i;
    const Vector3d direction = (to_light + r * (std::cos(angle) * side + std::sin(angle) * other)).normalized();
    sum += stage.Visibility(hit, direction, distance);
    if (i + 1 == kFirst && (sum == 0 || sum == kFirst)) return sum / kFirst;
  }
  return sum / kSamples;
}

struct Lit {
  Array3d diffuse = Array3d::Zero();   // for an albedo of one
  Array3d specular = Array3d::Zero();  // exposed
};

Lit DirectLight(const Stage& stage, const StageView& view, const SurfaceHit& hit, const Vector3d& to_viewer,
                uint64_t sample) {
  Lit lit;
  for (size_t i = 0; i < stage.lights.size(); ++i) {
    const StageLight& light = stage.lights[i];
    const Vector3d to_light = DirectionToLight(light.light, view.cam_from_stage, hit.position);
    const double cosine = hit.normal.dot(to_light);
    if (cosine <= 0) continue;
    const double distance = light.Distance(view.cam_from_stage, hit.position);
    const double visible = LightVisibility(stage, hit, to_light, distance, HashOf({sample, i}));
    if (visible == 0) continue;
    lit.diffuse += visible * cosine * Irradiance(light, view.cam_from_stage, hit.position);
    if (hit.kind == SurfaceKind::kObject)
      lit.specular += visible * SpecularLobe(stage, i, view.cam_from_stage, hit.position, hit.normal, to_viewer);
  }
  return lit;
}

// Darker where the object is near the ground.
double Crevice(const Stage& stage, const SurfaceHit& hit) {
  if (hit.kind == SurfaceKind::kGround)
    return 1 - 0.65 * std::exp(-3.5 * std::max(stage.shape->Value(hit.position), 0.0));
  return 1 - 0.5 * std::exp(-4 * (hit.position.z() - stage.surroundings.ground_z()));
}

// What the gloss mirrors of the room and the ground, without shadows.
Array3d Mirrored(const Stage& stage, const SurfaceHit& hit, const Vector3d& direction) {
  const Vector3d reflected = direction - 2 * direction.dot(hit.normal) * hit.normal;
  Array3d room = stage.surroundings.Room(reflected);
  if (reflected.z() >= -0.02) return room;
  const double t = (stage.surroundings.ground_z() - hit.position.z()) / reflected.z();
  if (t > 20) return room;
  const Vector3d x = hit.position + t * reflected;
  double sum = 0;
  for (const StageLight& light : stage.lights)
    if (light.light.frame == LightFrame::kWorld) sum += light.irradiance * light.light.vector.normalized().z();
  const double blur = t * std::max(2 * stage.gloss.alpha, 0.02);
  const Array3d ground =
      stage.surroundings.GroundAlbedo(x.x(), x.y(), blur) * (sum + stage.surroundings.Ambient(Vector3d::UnitZ()));
  const double fade = std::clamp((t - 10) / 10, 0.0, 1.0);
  return (1 - fade) * ground * std::min(1.0, 0.3 + t) + fade * room;
}

Shading ShadeObject(const Stage& stage, const StageView& view, const SurfaceHit& hit, const Vector3d& direction,
                    uint64_t sample) {
  const Mark* mark = stage.marks.At(hit.position);
  const Lit lit = DirectLight(stage, view, hit, -direction, sample);
  const Array3d fresnel = Fresnel(stage.ReflectanceAt(hit.position), -direction.dot(hit.normal));
  Shading shading;
  shading.specular = lit.specular.maxCoeff();
  shading.radiance = lit.specular + stage.exposure * fresnel * Mirrored(stage, hit, direction) * Crevice(stage, hit);
  if (!stage.OpaqueAt(hit.position)) {
    const SurfaceHit behind = stage.Trace(view.Center(), direction, true);
    shading.radiance +=
        (1 - fresnel) * stage.gloss.transmittance * Shade(stage, view, behind, direction, sample).radiance;
    return shading;
  }
  const Array3d ambient = stage.surroundings.Ambient(hit.normal) * Crevice(stage, hit);
  const Array3d albedo = mark ? mark->color : stage.transparent() ? Array3d(0.02, 0.02, 0.02) : stage.gloss.albedo;
  shading.radiance += stage.exposure * albedo * (1 - fresnel) * (lit.diffuse + ambient);
  return shading;
}

// GGX with Smith's masking and Fresnel's term, times the cosine of the light.
Array3d Lobe(double alpha, const Array3d& reflectance, const Vector3d& normal, const Vector3d& to_viewer,
             const Vector3d& to_light) {
  const double nl = normal.dot(to_light), nv = normal.dot(to_viewer);
  if (nl <= 0 || nv <= 0) return Array3d::Zero();
  const Vector3d half = (to_light + to_viewer).normalized();
  const double alpha2 = alpha * alpha;
  const double sine2 = normal.cross(half).squaredNorm();
  const double slope = sine2 + alpha2 * (1 - sine2);
  const double d = alpha2 / (std::numbers::pi * slope * slope);
  const double masking =
      0.5 / (nl * std::sqrt(nv * nv * (1 - alpha2) + alpha2) + nv * std::sqrt(nl * nl * (1 - alpha2) + alpha2));
  return d * masking * nl * Fresnel(reflectance, half.dot(to_viewer));
}

}  // namespace

Array3d SpecularLobe(const Stage& stage, size_t light, const Rigid3d& cam_from_stage, const Vector3d& x,
                     const Vector3d& normal, const Vector3d& to_viewer) {
  const StageLight& source = stage.lights[light];
  const Vector3d to_light = DirectionToLight(source.light, cam_from_stage, x);
  const double nl = normal.dot(to_light), nv = normal.dot(to_viewer);
  if (nl <= 0 || nv <= 0) return Array3d::Zero();
  const double received = stage.exposure * std::numbers::pi * Irradiance(source, cam_from_stage, x);
  const Array3d reflectance = stage.ReflectanceAt(x);
  const double sine = normal.cross((to_light + to_viewer).normalized()).norm();
  // Far from the peak the lobe is straight across the lamp.
  if (stage.light_radius == 0 || sine > 3 * (stage.light_radius + stage.gloss.alpha))
    return received * Lobe(stage.gloss.alpha, reflectance, normal, to_viewer, to_light);
  // The mean over the lamp's disc, on a sunflower's spiral.
  constexpr int kPoints = 80;
  const Vector3d side = to_light.unitOrthogonal(), other = to_light.cross(side);
  Array3d sum = Array3d::Zero();
  for (int i = 0; i < kPoints; ++i) {
    const double r = stage.light_radius * std::sqrt((i + 0.5) / kPoints), angle = 2.39996323 * i;
    const Vector3d direction = (to_light + r * (std::cos(angle) * side + std::sin(angle) * other)).normalized();
    sum += Lobe(stage.gloss.alpha, reflectance, normal, to_viewer, direction);
  }
  return received * sum / kPoints;
}

Shading Shade(const Stage& stage, const StageView& view, const SurfaceHit& hit, const Vector3d& direction,
              uint64_t sample) {
  if (hit.kind == SurfaceKind::kObject) return ShadeObject(stage, view, hit, direction, sample);
  if (hit.kind == SurfaceKind::kSky) return {stage.exposure * stage.surroundings.Room(direction), 0};
  const double footprint = hit.t / MeanFocalLength(view.camera) / std::max(0.05, -direction.dot(hit.normal));
  const Array3d albedo = hit.kind == SurfaceKind::kGround
                             ? stage.surroundings.GroundAlbedo(hit.position.x(), hit.position.y(), footprint)
                             : stage.surroundings.InteriorAlbedo(hit.position, hit.normal, footprint);
  const Array3d light = DirectLight(stage, view, hit, -direction, sample).diffuse +
                        stage.surroundings.Ambient(hit.normal) * Crevice(stage, hit);
  Array3d radiance = albedo * light;
  if (hit.kind == SurfaceKind::kGround) {  // the floor fades into the room far away
    const double fade = std::clamp((hit.position.head<2>().norm() - 8) / 20, 0.0, 1.0);
    radiance += fade * (stage.surroundings.Room(direction) - radiance);
  }
  return {stage.exposure * radiance, 0};
}

}  // namespace glint
