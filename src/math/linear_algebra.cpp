#include "linear_algebra.h"

#include <Eigen/Dense>
#include <algorithm>
#include <utility>

namespace softarm::math {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct SymmetricSolver::Factors {
  Eigen::LDLT<MatrixXd> ldlt;
};

SymmetricSolver::SymmetricSolver(const MatrixXd& a) : factors_(new Factors{Eigen::LDLT<MatrixXd>(a)}) {}
SymmetricSolver::~SymmetricSolver() = default;
SymmetricSolver::SymmetricSolver(SymmetricSolver&&) noexcept = default;

bool SymmetricSolver::ok() const {
  return factors_->ldlt.info() == Eigen::Success;
}

VectorXd SymmetricSolver::solve(const VectorXd& b) const {
  return factors_->ldlt.solve(b);
}

MatrixXd SymmetricSolver::solve_columns(const MatrixXd& b) const {
  return factors_->ldlt.solve(b);
}

MatrixXd SymmetricSolver::inverse() const {
  const Eigen::Index n = factors_->ldlt.rows();
  return solve_columns(MatrixXd::Identity(n, n));
}

double SymmetricSolver::least_pivot() const {
  return factors_->ldlt.vectorD().minCoeff();
}

VectorXd solve_symmetric(const MatrixXd& a, const VectorXd& b) {
  return SymmetricSolver(a).solve(b);
}

MatrixXd inverse_of_symmetric(const MatrixXd& a) {
  return SymmetricSolver(a).inverse();
}

VectorXd rows_of(const VectorXd& v, const std::vector<Eigen::Index>& rows) {
  VectorXd out(static_cast<Eigen::Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) out[static_cast<Eigen::Index>(i)] = v[rows[i]];
  return out;
}

MatrixXd block_of(const MatrixXd& a, const std::vector<Eigen::Index>& rows) {
  const auto n = static_cast<Eigen::Index>(rows.size());
  MatrixXd out(n, n);
  for (Eigen::Index j = 0; j < n; ++j) out.col(j) = rows_of(a.col(rows[static_cast<std::size_t>(j)]), rows);
  return out;
}

Eigensystem eigensystem_of(const MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(a);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

MatrixXd BlockEigensystem::turned(const MatrixXd& b) const {
  MatrixXd out(b.rows(), b.cols());
  Eigen::Index row = 0;
  for (const MatrixXd& own : vectors) {
    out.middleRows(row, own.rows()).noalias() = own.transpose() * b.middleRows(row, own.rows());
    row += own.rows();
  }
  return out;
}

MatrixXd BlockEigensystem::back(const MatrixXd& b) const {
  MatrixXd out(b.rows(), b.cols());
  Eigen::Index row = 0;
  for (const MatrixXd& own : vectors) {
    out.middleRows(row, own.rows()).noalias() = own * b.middleRows(row, own.rows());
    row += own.rows();
  }
  return out;
}

BlockEigensystem one_block_of(const MatrixXd& a) {
  Eigensystem whole = eigensystem_of(a);
  return {std::move(whole.values), {std::move(whole.vectors)}};
}

BlockEigensystem blocks_of(const MatrixXd& a) {
  BlockEigensystem all{VectorXd(a.rows()), {}};
  Eigen::Index first = 0, last = 0;  // of the block, as far as is known
  for (Eigen::Index j = 0; j < a.cols(); ++j) {
    last = std::max(last, j);
    for (Eigen::Index i = a.rows() - 1; i > last; --i)
      if (a(i, j) != 0.0) last = i;
    if (last > j) continue;
    const Eigen::Index size = j + 1 - first;
    Eigensystem own = eigensystem_of(a.block(first, first, size, size));
    all.values.segment(first, size) = own.values;
    all.vectors.push_back(std::move(own.vectors));
    first = j + 1;
  }
  return all;
}

void CholeskyFactor::compute(const MatrixXd& a) {
  l_ = a;
  Eigen::LLT<Eigen::Ref<MatrixXd>> in_place(l_);
}

MatrixXd CholeskyFactor::whiten(const MatrixXd& b) const {
  return l_.triangularView<Eigen::Lower>().solve(b);
}

VectorXd CholeskyFactor::whiten_vector(const VectorXd& b) const {
  return l_.triangularView<Eigen::Lower>().solve(b);
}

MatrixXd CholeskyFactor::solve_columns(const MatrixXd& b) const {
  return l_.transpose().triangularView<Eigen::Upper>().solve(whiten(b));
}

VectorXd least_squares(const MatrixXd& a, const VectorXd& b, double threshold) {
  Eigen::ColPivHouseholderQR<MatrixXd> qr;
  if (threshold > 0.0) qr.setThreshold(threshold);
  return qr.compute(a).solve(b);
}

MatrixXd least_squares_columns(const MatrixXd& a, const MatrixXd& b) {
  return Eigen::ColPivHouseholderQR<MatrixXd>(a).solve(b);
}

MatrixXd basis_of_columns(const MatrixXd& a) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(a);
  return qr.householderQ() * MatrixXd::Identity(a.rows(), qr.rank());
}

}  // namespace softarm::math
