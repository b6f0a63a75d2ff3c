#include "metrics/align.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/check.h"
#include "core/median.h"
#include "core/parallel.h"
#include "core/random_bits.h"
#include "core/square.h"
#include "geometry/closest_point.h"
#include "metrics/surface_samples.h"

namespace glint {
namespace {

using Eigen::Affine3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

constexpr int kFewSamples = 200, kManySamples = 2500;  // on each surface: for every start, for the best ones
constexpr int kFewIterations = 10, kManyIterations = 25;
constexpr size_t kKept = 2;      // starts that are followed to the end
constexpr uint64_t kTurns = 80;  // at random, beside the 24 that lay principal axes on each other
constexpr double kCommon = 0.9;  // share of the samples that the measure of a fit is about
constexpr double kClearly = 0.9;
constexpr double kSigmaOfMedian = 1.4826;
constexpr double kAtRest = 1e-7;

// A point that moves with the mesh should lie on the plane through the other.
struct Pair {
  Vector3d moving, fixed, normal;  // in the reference's frame
  double distance;
};

double ScaleOf(const Affine3d& similarity) { return std::cbrt(similarity.linear().determinant()); }

class Surfaces {
 public:
  Surfaces(const TriangleMesh& mesh, const TriangleMesh& reference)
      : mesh_(mesh),
        reference_(reference),
        on_mesh_(mesh),
        on_reference_(reference),
        center_(BoundingBox(reference).center()),
        diagonal_(Diagonal(reference)) {}

  const Vector3d& center() const { return center_; }
  double diagonal() const { return diagonal_; }

  std::vector<Pair> Pairs(const Affine3d& reference_from_mesh, const std::vector<AreaSample>& of_mesh,
                          const std::vector<AreaSample>& of_reference) const {
    const Affine3d mesh_from_reference = reference_from_mesh.inverse();
    const double scale = ScaleOf(reference_from_mesh);
    std::vector<Pair> pairs;
    for (const AreaSample& s : of_mesh) {
      const Vector3d x = reference_from_mesh * s.position;
      const MeshPoint at = *on_reference_.Find(x);
      pairs.push_back({x, at.point, FaceNormal(reference_, at.face), std::sqrt(at.squared_distance)});
    }
    for (const AreaSample& s : of_reference) {
      const MeshPoint at = *on_mesh_.Find(mesh_from_reference * s.position);
      pairs.push_back({reference_from_mesh * at.point, s.position,
                       reference_from_mesh.linear() * FaceNormal(mesh_, at.face) / scale,
                       scale * std::sqrt(at.squared_distance)});
    }
    return pairs;
  }

 private:
  const TriangleMesh& mesh_;
  const TriangleMesh& reference_;
  ClosestPointQuery on_mesh_, on_reference_;
  Vector3d center_;
  double diagonal_;
};

double MeanOfCommon(const std::vector<Pair>& pairs) {
  std::vector<double> distances;
  for (const Pair& pair : pairs) distances.push_back(pair.distance);
  std::sort(distances.begin(), distances.end());
  distances.resize(std::max<size_t>(1, static_cast<size_t>(kCommon * static_cast<double>(distances.size()))));
  double sum = 0;
  for (double d : distances) sum += d;
  return sum / static_cast<double>(distances.size());
}

// The small turn, move (of the diagonal) and log of scale about the reference's middle that bring the pairs together;
// those far apart count little.
Vector7d Step(const Surfaces& surfaces, const std::vector<Pair>& pairs, bool with_scale) {
  std::vector<double> distances;
  for (const Pair& pair : pairs) distances.push_back(pair.distance);
  const double sigma = std::max(kSigmaOfMedian * Median(distances), 1e-12 * surfaces.diagonal());
  Matrix7d a = Matrix7d::Zero();
  Vector7d b = Vector7d::Zero();
  for (const Pair& pair : pairs) {
    const Vector3d arm = (pair.moving - surfaces.center()) / surfaces.diagonal();
    Vector7d row;
    row << arm.cross(pair.normal), pair.normal, with_scale ? pair.normal.dot(arm) : 0.0;
    const double weight = 1 / (1 + Square(pair.distance / sigma));
    a += weight * row * row.transpose();
    b += weight * row * pair.normal.dot(pair.fixed - pair.moving) / surfaces.diagonal();
  }
  a.diagonal().array() += 1e-9 * a.trace();  // what no distance depends on, such as the turn of a ball, stays
  return a.ldlt().solve(b);
}

Affine3d Moved(const Surfaces& surfaces, const Vector7d& step, const Affine3d& from) {
  const Vector3d turn = step.head<3>();
  const double angle = std::min(turn.norm(), 0.5);
  Affine3d move = Affine3d::Identity();
  move.translate(surfaces.center() + surfaces.diagonal() * step.segment<3>(3));
  if (angle > 0) move.rotate(Eigen::AngleAxisd(angle, turn.normalized()));
  move.scale(std::exp(std::clamp(step[6], -0.3, 0.3)));
  move.translate(-surfaces.center());
  return move * from;
}

struct Fit {
  Affine3d reference_from_mesh;
  double mean = 0;  // world units of the reference
};

Fit Follow(const Surfaces& surfaces, const std::vector<AreaSample>& of_mesh,
           const std::vector<AreaSample>& of_reference, bool with_scale, int iterations, Fit fit) {
  for (int i = 0; i < iterations; ++i) {
    const Vector7d step = Step(surfaces, surfaces.Pairs(fit.reference_from_mesh, of_mesh, of_reference), with_scale);
    fit.reference_from_mesh = Moved(surfaces, step, fit.reference_from_mesh);
    if (step.norm() < kAtRest) break;
  }
  fit.mean = MeanOfCommon(surfaces.Pairs(fit.reference_from_mesh, of_mesh, of_reference));
  return fit;
}

// Middle, size and axes of a surface.
struct Frame {
  Vector3d middle = Vector3d::Zero();
  double size = 0;
  Matrix3d axes;  // columns, right-handed
};

Frame FrameOf(const std::vector<AreaSample>& samples) {
  Frame frame;
  Matrix3d covariance = Matrix3d::Zero();
  for (const AreaSample& s : samples) frame.middle += s.position / static_cast<double>(samples.size());
  for (const AreaSample& s : samples)
    covariance += (s.position - frame.middle) * (s.position - frame.middle).transpose();
  covariance /= static_cast<double>(samples.size());
  frame.size = std::sqrt(covariance.trace());
  frame.axes = Eigen::SelfAdjointEigenSolver<Matrix3d>(covariance).eigenvectors();
  if (frame.axes.determinant() < 0) frame.axes.col(0) *= -1;
  return frame;
}

// The 24 turns that take axes to axes, and others at random.
std::vector<Matrix3d> Turns() {
  std::vector<Matrix3d> turns;
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (int signs = 0; x != y && signs < 4; ++signs) {
        Matrix3d turn = Matrix3d::Zero();
        turn(x, 0) = signs & 1 ? -1 : 1;
        turn(y, 1) = signs & 2 ? -1 : 1;
        turn.col(2) = turn.col(0).cross(turn.col(1));
        turns.push_back(turn);
      }
  const auto uniform = [](uint64_t i) { return static_cast<double>(RandomBits(7, i) >> 11) / 9007199254740992.0; };
  for (uint64_t i = 0; i < kTurns; ++i) {  // uniform (Shoemake 1992)
    const double u = uniform(3 * i), a = 2 * M_PI * uniform(3 * i + 1), b = 2 * M_PI * uniform(3 * i + 2);
    turns.push_back(Eigen::Quaterniond(std::sqrt(u) * std::cos(b), std::sqrt(1 - u) * std::sin(a),
                                       std::sqrt(1 - u) * std::cos(a), std::sqrt(u) * std::sin(b))
                        .toRotationMatrix());
  }
  return turns;
}

std::vector<Fit> Starts(const Frame& mesh, const Frame& reference, bool with_scale, const Affine3d& start) {
  std::vector<Fit> starts = {{start}};
  for (const Matrix3d& turn : Turns()) {
    Affine3d from_mesh = Affine3d::Identity();
    from_mesh.translate(reference.middle);
    from_mesh.rotate(Matrix3d(reference.axes * turn * mesh.axes.transpose()));
    from_mesh.scale(with_scale ? reference.size / mesh.size : 1);
    from_mesh.translate(-mesh.middle);
    starts.push_back({from_mesh});
  }
  return starts;
}

}  // namespace

Alignment AlignMeshes(const TriangleMesh& mesh, const TriangleMesh& reference, bool with_scale, const Affine3d& start,
                      Progress& progress) {
  const Surfaces surfaces(mesh, reference);
  const auto few_mesh = SampleSurface(mesh, kFewSamples), few_reference = SampleSurface(reference, kFewSamples);
  const auto many_mesh = SampleSurface(mesh, kManySamples), many_reference = SampleSurface(reference, kManySamples);
  GLINT_CHECK(!many_mesh.empty() && !many_reference.empty());
  std::vector<Fit> fits = Starts(FrameOf(many_mesh), FrameOf(many_reference), with_scale, start);
  progress.Begin("aligning", fits.size() + kKept + 1);
  ParallelFor(fits.size(), 1, [&](size_t i) {
    fits[i] = Follow(surfaces, few_mesh, few_reference, with_scale, kFewIterations, fits[i]);
    progress.Advance();
  });
  // The first, from where the mesh was, is followed in any case.
  std::stable_sort(fits.begin() + 1, fits.end(), [](const Fit& a, const Fit& b) { return a.mean < b.mean; });
  fits.resize(std::min(fits.size(), kKept + 1));
  ParallelFor(fits.size(), 1, [&](size_t i) {
    fits[i] = Follow(surfaces, many_mesh, many_reference, with_scale, kManyIterations, fits[i]);
    progress.Advance();
  });
  progress.ThrowIfCancelled();
  const Fit& other =
      *std::min_element(fits.begin() + 1, fits.end(), [](const Fit& a, const Fit& b) { return a.mean < b.mean; });
  const Fit& best = other.mean < kClearly * fits.front().mean ? other : fits.front();
  const Matrix3d turn = best.reference_from_mesh.linear() / ScaleOf(best.reference_from_mesh);
  return {best.reference_from_mesh, ScaleOf(best.reference_from_mesh), Eigen::AngleAxisd(turn).angle() * 180 / M_PI,
          best.mean / surfaces.diagonal()};
}

}  // namespace glint
