// Sparse symmetric positive definite systems.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <optional>

namespace glint {

// x of A x = right, a column each; of A the lower triangle is read. Supernodal Cholesky [Chen, Davis, Hager &
// Rajamanickam 2008, CHOLMOD]. None if A is not positive definite, or x not finite.
std::optional<Eigen::MatrixXd> SolvePositive(const Eigen::SparseMatrix<double>& a, const Eigen::MatrixXd& right);

}  // namespace glint
