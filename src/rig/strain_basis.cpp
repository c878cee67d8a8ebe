#include "strain_basis.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace softarm::rig {

StrainBasis::StrainBasis(int elements) : elements_(elements) {
  if (elements < 1) throw std::invalid_argument("a rod needs at least one element");

  const double inner = std::sqrt(3.0 / 7.0);
  points_ = {0.0, 0.5 * (1.0 - inner), 0.5, 0.5 * (1.0 + inner), 1.0};
  Eigen::Matrix<double, kPoints, kPoints> vandermonde;
  for (int i = 0; i < kPoints; ++i) {
    double power = 1.0;
    for (int j = 0; j < kPoints; ++j, power *= points_[static_cast<std::size_t>(i)])
      vandermonde(i, j) = power;
  }
  monomial_from_values_ = vandermonde.inverse();
  for (int i = 0; i < kPoints; ++i)
    integration_.row(i) = integrated_lagrange(points_[static_cast<std::size_t>(i)]).transpose();
  integration_.row(0).setZero();

  weights_.assign(static_cast<std::size_t>(stations()), 0.0);
  for (int e = 0; e < elements; ++e)
    for (int j = 0; j < kPoints; ++j)
      weights_[static_cast<std::size_t>(e * kIntervals + j)] += element_size() * integration_(kPoints - 1, j);

  for (int i = 0; i < 3; ++i) knots_.push_back(0.0);
  for (int i = 0; i <= elements; ++i) knots_.push_back(static_cast<double>(i) / elements);
  for (int i = 0; i < 3; ++i) knots_.push_back(1.0);

  // Five Lobatto points integrate degree 7: products of cubics exactly.
  gram_ = Eigen::MatrixXd::Zero(functions(), functions());
  integral_ = Eigen::VectorXd::Zero(functions());
  const double half_gauss = 0.5 / std::sqrt(3.0);
  for (int e = 0; e < elements; ++e) {
    for (int j = 0; j < kPoints; ++j) {
      const LocalBasis b = evaluate(e, (e + points_[static_cast<std::size_t>(j)]) / elements);
      const double weight = element_size() * integration_(kPoints - 1, j);
      for (int m = 0; m < 4; ++m) {
        integral_(e + m) += weight * b[static_cast<std::size_t>(m)];
        for (int n = 0; n < 4; ++n)
          gram_(e + m, e + n) += weight * b[static_cast<std::size_t>(m)] * b[static_cast<std::size_t>(n)];
      }
    }
    for (int i = 0; i < kIntervals; ++i) {
      const double from = points_[static_cast<std::size_t>(i)], to = points_[static_cast<std::size_t>(i) + 1];
      const double middle = 0.5 * (from + to), offset = half_gauss * (to - from);
      gauss_.push_back(
          {evaluate(e, (e + middle - offset) / elements), evaluate(e, (e + middle + offset) / elements)});
    }
  }
}

int StrainBasis::element_of(double fraction) const {
  return std::clamp(static_cast<int>(std::floor(fraction * elements_)), 0, elements_ - 1);
}

LocalBasis StrainBasis::evaluate(int element, double fraction) const {
  // Cox-de Boor recursion on the knot span [knots(element + 3), knots(element + 4)].
  const auto span = static_cast<std::size_t>(element) + 3;
  LocalBasis b{1.0, 0.0, 0.0, 0.0};
  std::array<double, 4> left{}, right{};
  for (std::size_t degree = 1; degree <= 3; ++degree) {
    left[degree] = fraction - knots_[span + 1 - degree];
    right[degree] = knots_[span + degree] - fraction;
    double saved = 0.0;
    for (std::size_t r = 0; r < degree; ++r) {
      const double term = b[r] / (right[r + 1] + left[degree - r]);
      b[r] = saved + right[r + 1] * term;
      saved = left[degree - r] * term;
    }
    b[degree] = saved;
  }
  return b;
}

Eigen::Matrix<double, StrainBasis::kPoints, 1> StrainBasis::integrated_lagrange(double xi) const {
  Eigen::Matrix<double, kPoints, 1> monomials;
  double power = xi;
  for (int j = 0; j < kPoints; ++j, power *= xi) monomials(j) = power / (j + 1);
  return monomial_from_values_.transpose() * monomials;
}

Eigen::Matrix<double, StrainBasis::kPoints, 1> StrainBasis::lagrange(double xi) const {
  Eigen::Matrix<double, kPoints, 1> monomials;
  double power = 1.0;
  for (int j = 0; j < kPoints; ++j, power *= xi) monomials(j) = power;
  return monomial_from_values_.transpose() * monomials;
}

}  // namespace softarm::rig
