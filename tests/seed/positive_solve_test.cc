#include "seed/positive_solve.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>
#include <vector>

namespace glint {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

// Of a chain with springs between neighbours, and one of `end` at its end.
SparseMatrix Chain(int n, double end) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i + 1 < n; ++i)
    entries.insert(entries.end(), {{i, i, 1.0}, {i + 1, i + 1, 1.0}, {i, i + 1, -1.0}, {i + 1, i, -1.0}});
  entries.emplace_back(0, 0, end);
  SparseMatrix chain(n, n);
  chain.setFromTriplets(entries.begin(), entries.end());
  return chain;
}

TEST(SolvePositive, IsWhatADenseSolveSays) {
  const SparseMatrix a = Chain(300, 0.5);
  const Eigen::MatrixXd right = Eigen::MatrixXd::Random(300, 3);
  const auto x = SolvePositive(a, right);
  ASSERT_TRUE(x);
  const Eigen::MatrixXd expected = Eigen::MatrixXd(a).lu().solve(right);
  EXPECT_LT((*x - expected).norm(), 1e-9 * expected.norm());
}

TEST(SolvePositive, SaysWhereThereIsNoSolution) {
  EXPECT_FALSE(SolvePositive(Chain(50, -0.5), Eigen::MatrixXd::Ones(50, 1)));  // indefinite
  EXPECT_FALSE(SolvePositive(Chain(50, std::numeric_limits<double>::quiet_NaN()), Eigen::MatrixXd::Ones(50, 1)));
  EXPECT_FALSE(SolvePositive(SparseMatrix(3, 3), Eigen::MatrixXd::Ones(3, 1)));  // of zeros
}

}  // namespace
}  // namespace glint
