#include "refine/band_multigrid.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <utility>

#include "core/parallel.h"
#include "refine/band_transfer.h"
#include "refine/dot.h"
#include "refine/row_sample.h"

namespace glint {
namespace {

constexpr size_t kGrain = 1 << 13;
constexpr size_t kDirectSize = 600;  // voxels, from which on a dense factorisation is quicker
constexpr size_t kMaxLevels = 12;
constexpr size_t kMaxRows = 4;  // with the same first voxel, for the next coarser band: more only cost memory
// The smoother takes down eigenvalues from here to 1. What the next coarser band cannot hold begins at 1/36 for the
// squared Laplacian, whose waves across one axis are the slowest.
constexpr float kSmallestSmoothed = 1.f / 20;
constexpr int kDegree = 3;

// The same terms for the coarse band: integrals over the surface, spread over fewer voxels of twice the size.
BandWeights CoarseWeights(const BandWeights& fine, size_t num_fine, const BandTransfer& transfer) {
  BandWeights coarse;
  const double more = static_cast<double>(num_fine) / static_cast<double>(transfer.coarse().size());
  coarse.smoothness = fine.smoothness * more / 16;
  coarse.bend_change = fine.bend_change * more / 64;
  coarse.normal = fine.normal * more / 4;
  coarse.n = transfer.MeanNormals(fine.n);
  transfer.Restrict(fine.pull, coarse.pull);
  return coarse;
}

}  // namespace

struct BandMultigrid::Level {
  std::unique_ptr<BandTransfer> transfer;  // from the next finer level; none on the finest
  BandWeights weights;                     // not used on the finest
  std::optional<RowSample> sample;         // of its rows; none on the finest
  std::unique_ptr<BandOperator> own;
  const BandOperator* matrix = nullptr;
  std::vector<float> inverse;                        // of the absolute row sums
  std::vector<float> x, b, residual, step, product;  // of the cycle
  std::vector<float> first, of_first;  // of Accelerated: what its first cycle made, and the matrix times it
  Eigen::LLT<Eigen::MatrixXf> direct;  // coarsest only

  void Prepare() {
    inverse = matrix->InverseAbsoluteRowSums();
    const size_t n = matrix->topology().size();
    x.resize(n), b.resize(n), residual.resize(n), step.resize(n), product.resize(n);
  }

  void Clear() {
    std::fill(x.begin(), x.end(), 0.0F);
    residual = b;
  }

  // Chebyshev iteration for A x = b on [kSmallestSmoothed, 1]. Afterwards the residual lacks A · step.
  void Smooth() {
    constexpr float theta = (1 + kSmallestSmoothed) / 2, delta = (1 - kSmallestSmoothed) / 2, sigma = theta / delta;
    const size_t n = x.size();
    ParallelFor(n, kGrain, [&](size_t i) {
      step[i] = inverse[i] * residual[i] / theta;
      x[i] += step[i];
    });
    float rho = 1 / sigma;
    for (int k = 1; k < kDegree; ++k) {
      matrix->Apply(step, product);
      const float next = 1 / (2 * sigma - rho), keep = next * rho, gain = 2 * next / delta;
      ParallelFor(n, kGrain, [&](size_t i) {
        residual[i] -= product[i];
        step[i] = keep * step[i] + gain * inverse[i] * residual[i];
        x[i] += step[i];
      });
      rho = next;
    }
  }

  void FinishResidual() {
    matrix->Apply(step, product);
    ParallelFor(x.size(), kGrain, [&](size_t i) { residual[i] -= product[i]; });
  }

  // x plus as much of `step` as lowers the energy most.
  void TakeBestStep() {
    matrix->Apply(step, product);
    const double curvature = Dot(step, product);
    if (!(curvature > 0)) return;
    const float length = static_cast<float>(Dot(residual, step) / curvature);
    ParallelFor(x.size(), kGrain, [&](size_t i) {
      x[i] += length * step[i];
      residual[i] -= length * product[i];
    });
  }
};

BandMultigrid::BandMultigrid(const BandOperator& finest) {
  const BandRows none;
  levels_.push_back(std::make_unique<Level>());
  levels_[0]->matrix = &finest;
  levels_[0]->Prepare();
  while (levels_.size() < kMaxLevels && levels_.back()->x.size() > kDirectSize) {
    const Level& fine = *levels_.back();
    auto coarse = std::make_unique<Level>();
    coarse->transfer = std::make_unique<BandTransfer>(fine.matrix->topology());
    if (coarse->transfer->coarse().size() > fine.x.size() * 3 / 4) break;  // as coarse as it gets
    coarse->weights = CoarseWeights(fine.matrix->weights(), fine.x.size(), *coarse->transfer);
    const bool crowded = fine.matrix->Crowded();
    const BandRows& rows = crowded ? none : fine.matrix->rows();
    coarse->sample.emplace(rows, fine.x.size(), kMaxRows);
    coarse->own = std::make_unique<BandOperator>(coarse->transfer->coarse(), coarse->weights,
                                                 coarse->transfer->Restrict(coarse->sample->Taken(rows)));
    if (crowded) coarse->own->SetGram(fine.matrix->Gram().Restricted(*coarse->transfer));
    coarse->matrix = coarse->own.get();
    coarse->Prepare();
    levels_.push_back(std::move(coarse));
  }
  FactorCoarsest();
}

BandMultigrid::~BandMultigrid() = default;

void BandMultigrid::UpdateRowWeights() {
  std::vector<double> weights;
  for (size_t l = 0; l < levels_.size(); ++l) {
    Level& level = *levels_[l];
    if (l == 0) {
      weights = level.matrix->rows().weight;
    } else if (levels_[l - 1]->matrix->Crowded()) {
      level.own->SetGram(levels_[l - 1]->matrix->Gram().Restricted(*level.transfer));
    } else {
      weights = level.sample->Weights(weights);
      level.own->SetRowWeights(weights);
    }
    level.inverse = level.matrix->InverseAbsoluteRowSums();
  }
  FactorCoarsest();
}

void BandMultigrid::FactorCoarsest() {
  Level& level = *levels_.back();
  const size_t n = level.x.size();
  if (n > 2 * kDirectSize) return;
  Eigen::MatrixXf matrix = level.matrix->Dense();
  // A touch of the diagonal keeps what nothing holds from blowing up.
  for (size_t i = 0; i < n; ++i) matrix(i, i) += level.inverse[i] > 0 ? 1e-5f / level.inverse[i] : 1;
  level.direct.compute(matrix);
}

void BandMultigrid::Cycle(size_t level) {
  Level& fine = *levels_[level];
  const size_t n = fine.x.size();
  if (level + 1 == levels_.size()) {
    if (n <= 2 * kDirectSize && fine.direct.info() == Eigen::Success)
      Eigen::Map<Eigen::VectorXf>(fine.x.data(), n) =
          fine.direct.solve(Eigen::Map<const Eigen::VectorXf>(fine.b.data(), n));
    else
      fine.Clear(), fine.Smooth();
    return;
  }
  Level& coarse = *levels_[level + 1];
  fine.Clear();
  fine.Smooth();
  fine.FinishResidual();
  coarse.transfer->Restrict(fine.residual, coarse.b);
  Accelerated(level + 1);
  std::fill(fine.step.begin(), fine.step.end(), 0.0F);
  coarse.transfer->AddProlonged(coarse.x, fine.step);
  fine.TakeBestStep();
  fine.Smooth();
}

void BandMultigrid::Accelerated(size_t level) {
  Cycle(level);
  if (level + 1 == levels_.size()) return;
  Level& l = *levels_[level];
  const size_t n = l.x.size();
  l.first.swap(l.x);
  l.x.resize(n), l.of_first.resize(n);
  l.matrix->Apply(l.first, l.of_first);
  const double curvature = Dot(l.first, l.of_first);
  if (!(curvature > 0)) {
    l.x.swap(l.first);
    return;
  }
  const double length = Dot(l.first, l.b) / curvature;
  ParallelFor(n, kGrain, [&](size_t i) { l.b[i] -= static_cast<float>(length) * l.of_first[i]; });
  Cycle(level);
  // The second direction made conjugate to the first.
  const double along = Dot(l.x, l.of_first) / curvature;
  ParallelFor(n, kGrain, [&](size_t i) { l.x[i] -= static_cast<float>(along) * l.first[i]; });
  l.matrix->Apply(l.x, l.product);
  const double second = Dot(l.x, l.product);
  const double more = second > 0 ? Dot(l.x, l.b) / second : 0;
  ParallelFor(n, kGrain,
              [&](size_t i) { l.x[i] = static_cast<float>(length) * l.first[i] + static_cast<float>(more) * l.x[i]; });
}

void BandMultigrid::Apply(const std::vector<double>& r, std::vector<double>& z) {
  Level& finest = *levels_[0];
  ParallelFor(r.size(), kGrain, [&](size_t i) { finest.b[i] = static_cast<float>(r[i]); });
  Cycle(0);
  z.resize(r.size());
  ParallelFor(r.size(), kGrain, [&](size_t i) { z[i] = finest.x[i]; });
}

}  // namespace glint
