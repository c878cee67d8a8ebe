// Decompositions of matrices of any size. What Eigen's templates make of them is compiled once, behind these
// functions: each costs a file that uses it seconds of compilation.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace softarm::math {

/// L D L^T with pivots of a symmetric matrix, as Eigen::LDLT has it.
class SymmetricSolver {
 public:
  /// @param a n x n, symmetric; its lower triangle is read
  explicit SymmetricSolver(const Eigen::MatrixXd& a);
  ~SymmetricSolver();
  SymmetricSolver(SymmetricSolver&&) noexcept;

  bool ok() const;  ///< false where a holds what is not finite
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  Eigen::MatrixXd solve_columns(const Eigen::MatrixXd& b) const;  ///< n x m
  Eigen::MatrixXd inverse() const;
  double least_pivot() const;  ///< of D: positive where a is positive definite

 private:
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

/// x of a x = b.
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
Eigen::MatrixXd inverse_of_symmetric(const Eigen::MatrixXd& a);

/// Some entries of a vector, and the block of a square matrix in those rows and columns.
Eigen::VectorXd rows_of(const Eigen::VectorXd& v, const std::vector<Eigen::Index>& rows);
Eigen::MatrixXd block_of(const Eigen::MatrixXd& a, const std::vector<Eigen::Index>& rows);

/// a = vectors * values.asDiagonal() * vectors^T, values increasing.
struct Eigensystem {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;  ///< one per column
};
Eigensystem eigensystem_of(const Eigen::MatrixXd& a);

/// The same of a matrix by the blocks along its diagonal, beside which it holds zeros.
struct BlockEigensystem {
  Eigen::VectorXd values;                ///< of all blocks, one below the other; increasing in each
  std::vector<Eigen::MatrixXd> vectors;  ///< of each block

  Eigen::MatrixXd turned(const Eigen::MatrixXd& b) const;  ///< vectors^T b, n x m
  Eigen::MatrixXd back(const Eigen::MatrixXd& b) const;    ///< vectors b, n x m
};
/// As one block, whatever it holds.
BlockEigensystem one_block_of(const Eigen::MatrixXd& a);
/// In as many blocks as its zeros make.
BlockEigensystem blocks_of(const Eigen::MatrixXd& a);

/// L of a = L L^T, by Cholesky; nothing else is kept, so that it can be worked out anew without an
/// allocation.
class CholeskyFactor {
 public:
  void compute(const Eigen::MatrixXd& a);
  /// L^-1 b, n x m.
  Eigen::MatrixXd whiten(const Eigen::MatrixXd& b) const;
  Eigen::VectorXd whiten_vector(const Eigen::VectorXd& b) const;
  /// a^-1 b, n x m.
  Eigen::MatrixXd solve_columns(const Eigen::MatrixXd& b) const;

 private:
  Eigen::MatrixXd l_;
};

/// The least squares solution of a x = b by QR with pivots; 0 in what a leaves free.
/// @param threshold pivots below this share of the largest count as none; 0: Eigen's own
Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, double threshold = 0.0);

/// The same of each column of b.
Eigen::MatrixXd least_squares_columns(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// An orthonormal basis of what the columns of a span, one vector per column.
Eigen::MatrixXd basis_of_columns(const Eigen::MatrixXd& a);

}  // namespace softarm::math
