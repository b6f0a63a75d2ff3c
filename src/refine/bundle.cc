#include "refine/bundle.h"

#include <ceres/ceres.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <memory>

#include "core/check.h"
#include "core/median.h"
#include "refine/chord_residual.h"
#include "refine/chords.h"

namespace glint {

namespace {

constexpr double kRadians = M_PI / 180;
// Above this many contacts the exact covariance gives way to its diagonal approximation.
constexpr size_t kMaxExactCovariance = 4000;

class Solver {
 public:
  Solver(const std::vector<SurfacePoint>& points, double diagonal, const std::vector<bool>& solve_lights,
         const BundleOptions& options, std::vector<Contact>& contacts, std::vector<Light>& lights,
         const std::vector<Light>& known_lights, const SurfaceQuery* surface)
      : points_(points),
        diagonal_(diagonal),
        solve_lights_(solve_lights),
        options_(options),
        lights_(lights),
        given_lights_(known_lights),
        surface_(surface) {
    for (Contact& contact : contacts)
      if (contact.accepted) contacts_.push_back(&contact);
  }

  BundleSummary Run() {
    BundleSummary summary;
    const std::vector<Contact*> all = contacts_;
    std::vector<Eigen::Vector3d> start;
    for (const Contact* c : all) start.push_back(c->Position());
    for (int round = 0; round < options_.rounds && contacts_.size() >= 3; ++round) {
      chords_ = MakeChords(contacts_, lights_, points_, diagonal_, options_, surface_);
      Solve(round == 0, summary);
      if (!summary.usable) break;
      if (round + 1 < options_.rounds) summary.num_rejected += Reject();
    }
    if (contacts_.size() < 3) chords_ = {};
    Finish(summary);
    std::vector<double> motion;
    for (size_t i = 0; i < all.size(); ++i)
      if (all[i]->accepted) motion.push_back((all[i]->Position() - start[i]).norm() / diagonal_);
    summary.motion_rel = Median(motion);
    return summary;
  }

 private:
  void Solve(bool first, BundleSummary& summary);
  int Reject();
  void Finish(BundleSummary& summary);
  void AddResiduals(ceres::Problem& problem);
  void EstimateCovariance(ceres::Problem& problem, BundleSummary& summary);
  double ChordResidualOf(const Chord& chord) const;
  double PointChordResidualOf(const Chord& chord) const;

  const std::vector<SurfacePoint>& points_;
  const double diagonal_;
  const std::vector<bool>& solve_lights_;
  const BundleOptions& options_;
  std::vector<Light>& lights_;
  const std::vector<Light> given_lights_;
  const SurfaceQuery* const surface_;
  std::vector<Contact*> contacts_;
  Chords chords_;
};

double Solver::ChordResidualOf(const Chord& chord) const {
  const Contact &a = *contacts_[chord.a], &b = *contacts_[chord.b];
  const ChordResidual residual{{a, lights_[a.light]}, {b, lights_[b.light]}, 1 / chord.sigma, chord.offset};
  double r;
  residual(&a.depth, &b.depth, lights_[a.light].vector.data(), lights_[b.light].vector.data(), &r);
  return r;
}

double Solver::PointChordResidualOf(const Chord& chord) const {
  const Contact& a = *contacts_[chord.a];
  const SurfacePoint& p = points_[chord.b];
  const PointChordResidual residual{{a, lights_[a.light]}, p.position, p.normal, 1 / chord.sigma, chord.offset};
  double r;
  residual(&a.depth, lights_[a.light].vector.data(), &r);
  return r;
}

void Solver::AddResiduals(ceres::Problem& problem) {
  for (size_t k = 0; k < lights_.size(); ++k) {
    double* light = lights_[k].vector.data();
    problem.AddParameterBlock(light, 3);
    if (lights_[k].type == LightType::kDistant) problem.SetManifold(light, new ceres::SphereManifold<3>());
    if (!solve_lights_[k]) problem.SetParameterBlockConstant(light);
  }
  for (const Chord& chord : chords_.between) {
    Contact &a = *contacts_[chord.a], &b = *contacts_[chord.b];
    auto* residual = new ChordResidual{{a, lights_[a.light]}, {b, lights_[b.light]}, 1 / chord.sigma, chord.offset};
    double *light_a = lights_[a.light].vector.data(), *light_b = lights_[b.light].vector.data();
    if (a.light == b.light)
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<ChordResidual, 1, 1, 1, 3>(residual),
                               new ceres::CauchyLoss(2), &a.depth, &b.depth, light_a);
    else
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<ChordResidual, 1, 1, 1, 3, 3>(residual),
                               new ceres::CauchyLoss(2), &a.depth, &b.depth, light_a, light_b);
  }
  for (const Chord& chord : chords_.to_points) {
    Contact& a = *contacts_[chord.a];
    const SurfacePoint& p = points_[chord.b];
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PointChordResidual, 1, 1, 3>(new PointChordResidual{
                                 {a, lights_[a.light]}, p.position, p.normal, 1 / chord.sigma, chord.offset}),
                             new ceres::CauchyLoss(2), &a.depth, lights_[a.light].vector.data());
  }
  for (Contact* c : contacts_) {
    const double facing = std::max(0.2, -c->direction.dot(ContactNormal(*c, lights_[c->light])));
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<PriorResidual<1>, 1, 1>(new PriorResidual<1>{
            Eigen::Matrix<double, 1, 1>(c->prior_depth), facing / (options_.prior_sigma_rel * diagonal_)}),
        nullptr, &c->depth);
  }
  for (size_t k = 0; k < lights_.size(); ++k)
    if (solve_lights_[k] && given_lights_[k].sigma > 0) {
      const double unit = given_lights_[k].type == LightType::kDistant ? kRadians : 1.0;
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PriorResidual<3>, 3, 3>(
                                   new PriorResidual<3>{given_lights_[k].vector, 1 / (given_lights_[k].sigma * unit)}),
                               nullptr, lights_[k].vector.data());
    }
}

void Solver::Solve(bool first, BundleSummary& summary) {
  ceres::Problem problem;
  AddResiduals(problem);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 50;
  options.num_threads = 1;  // Ceres adds up costs in the order of its threads: more would not be deterministic
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary report;
  ceres::Solve(options, &problem, &report);
  if (first) summary.initial_cost = report.initial_cost;
  summary.final_cost = report.final_cost;
  summary.usable = report.IsSolutionUsable();
  summary.message = report.BriefReport();
  if (summary.usable) EstimateCovariance(problem, summary);
}

// Standard deviations of depths and lights from the inverse of JᵀJ.
void Solver::EstimateCovariance(ceres::Problem& problem, BundleSummary& summary) {
  ceres::Problem::EvaluateOptions options;
  for (Contact* c : contacts_) options.parameter_blocks.push_back(&c->depth);
  std::vector<size_t> free_lights;
  for (size_t k = 0; k < lights_.size(); ++k)
    if (solve_lights_[k]) {
      options.parameter_blocks.push_back(lights_[k].vector.data());
      free_lights.push_back(k);
    }
  ceres::CRSMatrix crs;
  problem.Evaluate(options, nullptr, nullptr, nullptr, &crs);
  const Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>> jacobian(
      crs.num_rows, crs.num_cols, crs.values.size(), crs.rows.data(), crs.cols.data(), crs.values.data());
  const Eigen::SparseMatrix<double> normal_matrix = Eigen::SparseMatrix<double>(jacobian.transpose()) * jacobian;
  summary.lights.assign(lights_.size(), {});
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(normal_matrix);
  if (factor.info() != Eigen::Success) return;
  const auto variance = [&](int column) {
    Eigen::VectorXd unit = Eigen::VectorXd::Zero(crs.num_cols);
    unit[column] = 1;
    return std::max(0.0, factor.solve(unit)[column]);
  };
  for (size_t i = 0; i < contacts_.size(); ++i)
    contacts_[i]->sigma_depth = contacts_.size() <= kMaxExactCovariance ? std::sqrt(variance(static_cast<int>(i)))
                                                                        : 1 / std::sqrt(normal_matrix.coeff(i, i));
  int column = static_cast<int>(contacts_.size());
  for (size_t k : free_lights) {
    const bool distant = lights_[k].type == LightType::kDistant;
    const int size = distant ? 2 : 3;
    double worst = 0;
    for (int d = 0; d < size; ++d) worst = std::max(worst, variance(column + d));
    summary.lights[k].sigma = std::sqrt(worst) / (distant ? kRadians : diagonal_);
    column += size;
  }
}

// Leaves out contacts that most of their chords contradict while the neighbours agree among themselves.
int Solver::Reject() {
  std::vector<std::vector<double>> residuals(contacts_.size());
  for (const Chord& chord : chords_.between) {
    const double r = std::abs(ChordResidualOf(chord));
    residuals[chord.a].push_back(r);
    residuals[chord.b].push_back(r);
  }
  for (const Chord& chord : chords_.to_points) residuals[chord.a].push_back(std::abs(PointChordResidualOf(chord)));
  std::vector<double> score(contacts_.size());
  for (size_t i = 0; i < contacts_.size(); ++i) score[i] = Median(residuals[i]);
  // Only the worst of each neighbourhood goes, the others are judged again without it.
  std::vector<bool> worst(contacts_.size(), true);
  for (const Chord& chord : chords_.between) {
    if (score[chord.a] < score[chord.b]) worst[chord.a] = false;
    if (score[chord.b] < score[chord.a]) worst[chord.b] = false;
  }
  std::vector<Contact*> kept;
  int rejected = 0;
  for (size_t i = 0; i < contacts_.size(); ++i) {
    contacts_[i]->accepted = !(worst[i] && score[i] > options_.reject_sigmas);
    if (contacts_[i]->accepted)
      kept.push_back(contacts_[i]);
    else
      ++rejected;
  }
  contacts_ = std::move(kept);
  return rejected;
}

void Solver::Finish(BundleSummary& summary) {
  summary.num_contacts = static_cast<int>(contacts_.size());
  summary.num_chords = static_cast<int>(chords_.between.size());
  summary.num_point_chords = static_cast<int>(chords_.to_points.size());
  summary.lights.resize(lights_.size());
  for (const Contact* c : contacts_) ++summary.lights[c->light].contacts;
  double sum = 0;
  for (const Chord& chord : chords_.between) {
    const double r = ChordResidualOf(chord);
    sum += r * r / (1 + r * r / 4);  // as the loss weighs it
  }
  summary.chord_rms_sigmas = chords_.between.empty() ? 0 : std::sqrt(sum / static_cast<double>(chords_.between.size()));
  for (size_t k = 0; k < lights_.size(); ++k) {
    const Eigen::Vector3d &before = given_lights_[k].vector, &after = lights_[k].vector;
    summary.lights[k].change = lights_[k].type == LightType::kDistant
                                   ? std::atan2(before.cross(after).norm(), before.dot(after)) / kRadians
                                   : (after - before).norm() / diagonal_;
  }
}

}  // namespace

BundleSummary SolveBundle(const std::vector<SurfacePoint>& points, double diagonal,
                          const std::vector<bool>& solve_lights, const BundleOptions& options,
                          std::vector<Contact>& contacts, std::vector<Light>& lights,
                          const std::vector<Light>* known_lights, const SurfaceQuery* surface) {
  GLINT_CHECK_EQ(solve_lights.size(), lights.size());
  GLINT_CHECK(!known_lights || known_lights->size() == lights.size());
  GLINT_CHECK_GT(diagonal, 0);
  for (const Contact& contact : contacts) GLINT_CHECK_LT(contact.light, static_cast<int>(lights.size()));
  return Solver(points, diagonal, solve_lights, options, contacts, lights, known_lights ? *known_lights : lights,
                surface)
      .Run();
}

}  // namespace glint
