#include "seed/positive_solve.h"

#include <omp.h>

#include <Eigen/CholmodSupport>
#include <new>

namespace glint {
namespace {

// CHOLMOD asks for a team of threads a supernode: of systems of this size all its time goes there.
class WithoutTeams {
 public:
  WithoutTeams() : levels_(omp_get_max_active_levels()) { omp_set_max_active_levels(0); }
  ~WithoutTeams() { omp_set_max_active_levels(levels_); }
  WithoutTeams(const WithoutTeams&) = delete;
  WithoutTeams& operator=(const WithoutTeams&) = delete;

 private:
  int levels_;
};

}  // namespace

std::optional<Eigen::MatrixXd> SolvePositive(const Eigen::SparseMatrix<double>& a, const Eigen::MatrixXd& right) {
  const WithoutTeams scope;
  Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>, Eigen::Lower> solver;
  solver.cholmod().print = 0;  // it would write to standard output
  // Eigen goes on with the factor that there is not where the analysis fails.
  const auto failed = [&] {
    if (solver.cholmod().status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    return solver.cholmod().status < CHOLMOD_OK;
  };
  solver.analyzePattern(a);
  if (failed()) return std::nullopt;
  solver.factorize(a);
  if (failed() || solver.info() != Eigen::Success) return std::nullopt;
  Eigen::MatrixXd x = solver.solve(right);
  if (solver.info() != Eigen::Success || !x.allFinite()) return std::nullopt;
  return x;
}

}  // namespace glint
