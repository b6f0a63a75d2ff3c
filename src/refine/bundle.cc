#include "refine/bundle.h"

#include <ceres/ceres.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "core/check.h"
#include "core/median.h"
#include "refine/chord_residual.h"
#include "refine/neighbors.h"

namespace glint {

void BundleOptions::Visit(OptionVisitor& v) {
  v.Field({.name = "neighbors", .help = "chords of a contact to its neighbours", .min = 2, .max = 100}, neighbors);
  v.Field({.name = "max_normal_angle_deg",
           .help = "no chord between contacts whose normals differ by more",
           .unit = "deg",
           .min = 1,
           .max = 90},
          max_normal_angle_deg);
  v.Field({.name = "prior_sigma_rel",
           .help = "how far the seed may be from the surface; a weak pull that decides only where nothing else does",
           .unit = "fraction of the diagonal",
           .min = 1e-4,
           .max = 1},
          prior_sigma_rel);
  v.Field({.name = "point_normal_sigma_deg",
           .help = "standard deviation of the current surface's normal at a sparse point",
           .unit = "deg",
           .min = 0.1,
           .max = 60},
          point_normal_sigma_deg);
  v.Field(
      {.name = "reject_sigmas",
       .help = "a contact whose chords contradict its neighbours by more (median, in standard deviations) is left out",
       .min = 1,
       .max = 100},
      reject_sigmas);
  v.Field({.name = "rounds", .help = "solves with neighbours chosen anew in between", .min = 1, .max = 50}, rounds);
}

namespace {

constexpr double kRadians = M_PI / 180;
// Share of the squared angle between two normals that a chord may be off by because curvature changes along it.
constexpr double kCurvatureChange = 0.1;
// What of that is left once the current surface's own offset is taken off.
constexpr double kCorrected = 0.3;
// How far the surface may be from the middle of a chord: times its sag, and of the diagonal beyond that.
constexpr double kSagShare = 2, kSheetRel = 0.01, kSheetCosine = 0.5;
// Above this many contacts the exact covariance gives way to its diagonal approximation.
constexpr size_t kMaxExactCovariance = 4000;

struct Chord {
  int a, b;  // b: contact, or point for point chords
  double sigma;
  double offset;  // of the current surface, see ChordResidual
};

// What (m_a + m_b)/|m_a + m_b| · (s_b − s_a) is on the current surface; none where its normals are not to be relied on.
std::optional<double> SurfaceOffset(const Eigen::Vector3d& s_a, const Eigen::Vector3d& m_a, const Eigen::Vector3d& s_b,
                                    const Eigen::Vector3d& m_b) {
  if (m_a.isZero() || m_b.isZero()) return std::nullopt;
  return (m_a + m_b).normalized().dot(s_b - s_a);
}

// Whether the surface follows the chord between two places on it with these normals, as far as its bend lets it: a
// chord of length c whose normals differ by θ sags by cθ/8, and the normals on the way lie between them.
bool OnOneSheet(const SurfaceQuery& surface, const Eigen::Vector3d& a, const Eigen::Vector3d& normal_a,
                const Eigen::Vector3d& b, const Eigen::Vector3d& normal_b, double diagonal) {
  const double angle = std::acos(std::clamp(normal_a.dot(normal_b), -1.0, 1.0));
  const double reach = kSagShare * (b - a).norm() * angle / 8 + kSheetRel * diagonal;
  const Eigen::Vector3d mean_normal = (normal_a + normal_b).normalized();
  for (const double t : {0.25, 0.5, 0.75}) {
    const auto near = surface.closest.Find(a + t * (b - a), reach);
    if (!near || FaceNormal(surface.mesh, near->face).dot(mean_normal) < kSheetCosine) return false;
  }
  return true;
}

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
    std::vector<Eigen::Vector3d> start;
    for (const Contact* c : contacts_) start.push_back(c->Position());
    for (int round = 0; round < options_.rounds && contacts_.size() >= 3; ++round) {
      BuildChords();
      Solve(round == 0, summary);
      if (!summary.usable) break;
      if (round + 1 < options_.rounds) summary.num_rejected += Reject();
    }
    if (contacts_.size() < 3) chords_.clear(), point_chords_.clear();
    Finish(summary);
    std::vector<double> motion;
    // Contacts rejected on the way do not count; `start` is matched by walking the survivors in order.
    for (size_t i = 0, k = 0; i < start_order_.size() && k < contacts_.size(); ++i) {
      if (start_order_[i] != contacts_[k]) continue;
      motion.push_back((contacts_[k]->Position() - start[i]).norm() / diagonal_);
      ++k;
    }
    summary.motion_rel = Median(motion);
    return summary;
  }

  void RememberOrder() { start_order_.assign(contacts_.begin(), contacts_.end()); }

 private:
  void BuildChords();
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
  std::vector<const Contact*> start_order_;
  std::vector<Chord> chords_, point_chords_;
};

void Solver::BuildChords() {
  std::vector<Eigen::Vector3d> positions, normals, point_positions, point_normals;
  for (const Contact* c : contacts_) {
    positions.push_back(c->Position());
    normals.push_back(ContactNormal(*c, lights_[c->light]));
  }
  for (const SurfacePoint& p : points_) {
    point_positions.push_back(p.position);
    point_normals.push_back(p.normal);
  }
  NeighborOptions near;
  near.count = options_.neighbors;
  near.max_normal_angle = options_.max_normal_angle_deg * kRadians;
  auto pairs = UniquePairs(SectorNeighbors(positions, normals, positions, normals, near));
  if (surface_)
    std::erase_if(pairs, [&](const auto& pair) {
      const auto& [i, j] = pair;
      return !OnOneSheet(*surface_, contacts_[i]->SurfacePosition(), normals[i], contacts_[j]->SurfacePosition(),
                         normals[j], diagonal_);
    });
  // The peak's uncertainty in the image becomes one of the normal through the curvature that the chords show.
  std::vector<std::vector<double>> curvatures(contacts_.size());
  for (const auto& [i, j] : pairs) {
    const double angle = std::acos(std::clamp(normals[i].dot(normals[j]), -1.0, 1.0));
    const double curvature = angle / std::max((positions[i] - positions[j]).norm(), 1e-6 * diagonal_);
    curvatures[i].push_back(curvature);
    curvatures[j].push_back(curvature);
  }
  std::vector<double> variance(contacts_.size());
  for (size_t i = 0; i < contacts_.size(); ++i) {
    const double shift = contacts_[i]->pixel_angle * contacts_[i]->depth * Median(curvatures[i]);
    variance[i] = contacts_[i]->sigma_normal * contacts_[i]->sigma_normal + shift * shift;
  }
  // Each normal enters about `neighbors` chords; the factor keeps the covariance honest.
  const double shared = std::sqrt(options_.neighbors / 3.0);
  chords_.clear();
  for (const auto& [i, j] : pairs) {
    const double length = (positions[i] - positions[j]).norm();
    const double angle2 = 2 * (1 - std::clamp(normals[i].dot(normals[j]), -1.0, 1.0));
    const auto offset = SurfaceOffset(contacts_[i]->SurfacePosition(), contacts_[i]->surface_normal,
                                      contacts_[j]->SurfacePosition(), contacts_[j]->surface_normal);
    const double model = (offset ? kCorrected : 1.0) * kCurvatureChange * angle2;
    const double sigma = length * std::sqrt((variance[i] + variance[j]) / 4 * shared * shared + model * model);
    chords_.push_back({i, j, std::max(sigma, 1e-5 * diagonal_), offset.value_or(0)});
  }
  point_chords_.clear();
  if (points_.empty()) return;
  near.count = 6;
  const auto near_points = SectorNeighbors(positions, normals, point_positions, point_normals, near);
  for (size_t i = 0; i < near_points.size(); ++i)
    for (int p : near_points[i]) {
      if (surface_ && !OnOneSheet(*surface_, contacts_[i]->SurfacePosition(), normals[i], points_[p].surface_position,
                                  points_[p].normal, diagonal_))
        continue;
      const double length = (positions[i] - points_[p].position).norm();
      const double angle2 = 2 * (1 - std::clamp(normals[i].dot(points_[p].normal), -1.0, 1.0));
      const auto offset = SurfaceOffset(contacts_[i]->SurfacePosition(), contacts_[i]->surface_normal,
                                        points_[p].surface_position, points_[p].normal);
      const double model = (offset ? kCorrected : 1.0) * kCurvatureChange * angle2;
      const double direction = std::hypot(0.5 * options_.point_normal_sigma_deg * kRadians, model);
      point_chords_.push_back(
          {static_cast<int>(i), p, std::hypot(length * direction, points_[p].sigma), offset.value_or(0)});
    }
}

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
  for (const Chord& chord : chords_) {
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
  for (const Chord& chord : point_chords_) {
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
  for (const Chord& chord : chords_) {
    const double r = std::abs(ChordResidualOf(chord));
    residuals[chord.a].push_back(r);
    residuals[chord.b].push_back(r);
  }
  for (const Chord& chord : point_chords_) residuals[chord.a].push_back(std::abs(PointChordResidualOf(chord)));
  std::vector<double> score(contacts_.size());
  for (size_t i = 0; i < contacts_.size(); ++i) score[i] = Median(residuals[i]);
  // Only the worst of each neighbourhood goes, the others are judged again without it.
  std::vector<bool> worst(contacts_.size(), true);
  for (const Chord& chord : chords_) {
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
  summary.num_chords = static_cast<int>(chords_.size());
  summary.num_point_chords = static_cast<int>(point_chords_.size());
  summary.lights.resize(lights_.size());
  for (const Contact* c : contacts_) ++summary.lights[c->light].contacts;
  double sum = 0;
  for (const Chord& chord : chords_) {
    const double r = ChordResidualOf(chord);
    sum += r * r / (1 + r * r / 4);  // as the loss weighs it
  }
  summary.chord_rms_sigmas = chords_.empty() ? 0 : std::sqrt(sum / chords_.size());
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
  Solver solver(points, diagonal, solve_lights, options, contacts, lights, known_lights ? *known_lights : lights,
                surface);
  solver.RememberOrder();
  return solver.Run();
}

}  // namespace glint
