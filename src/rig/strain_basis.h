// Cubic B-splines on [0, 1] and the quadrature that goes with them: private to the rig.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace softarm::rig {

/// Values of the four cubic B-splines that are not zero in an element.
using LocalBasis = std::array<double, 4>;

/// Uniform elements on [0, 1], clamped cubic B-splines over them (elements + 3 of them; functions e ... e + 3
/// live in element e), and five Gauss-Lobatto points in each element; neighbours share their end points.
class StrainBasis {
 public:
  static constexpr int kPoints = 5;  ///< Lobatto points per element, both ends included
  static constexpr int kIntervals = kPoints - 1;

  /// @throws std::invalid_argument for less than one element
  explicit StrainBasis(int elements);

  int elements() const { return elements_; }
  int functions() const { return elements_ + 3; }
  int stations() const { return kIntervals * elements_ + 1; }
  /// Where a station is, 0 ... 1.
  double fraction_of(std::size_t station) const {
    return (static_cast<double>(station / kIntervals) + points_[station % kIntervals]) / elements_;
  }
  double element_size() const { return 1.0 / elements_; }

  /// Lobatto points within an element, 0 ... 1.
  const std::array<double, kPoints>& points() const { return points_; }
  /// Quadrature weight of every station; they sum to 1.
  const std::vector<double>& weights() const { return weights_; }
  /// Entry (i, j): integral from 0 to point i of the Lagrange polynomial of point j, for an element of
  /// size 1.
  const Eigen::Matrix<double, kPoints, kPoints>& integration() const { return integration_; }
  /// Gram matrix of the splines (exact), functions x functions.
  const Eigen::MatrixXd& gram() const { return gram_; }
  /// Integral of each spline.
  const Eigen::VectorXd& integral() const { return integral_; }
  /// Splines of element e at the two Gauss points of the interval between Lobatto points i and i + 1.
  const std::array<LocalBasis, 2>& at_gauss(int element, int interval) const {
    return gauss_[static_cast<std::size_t>(element * kIntervals + interval)];
  }

  int element_of(double fraction) const;
  LocalBasis evaluate(int element, double fraction) const;
  /// Integrals from 0 to xi of the Lagrange polynomials of the Lobatto points of an element of size 1.
  Eigen::Matrix<double, kPoints, 1> integrated_lagrange(double xi) const;
  Eigen::Matrix<double, kPoints, 1> lagrange(double xi) const;

 private:
  int elements_;
  std::array<double, kPoints> points_;
  Eigen::Matrix<double, kPoints, kPoints> monomial_from_values_;
  Eigen::Matrix<double, kPoints, kPoints> integration_;
  std::vector<double> weights_;
  std::vector<double> knots_;
  Eigen::MatrixXd gram_;
  Eigen::VectorXd integral_;
  std::vector<std::array<LocalBasis, 2>> gauss_;
};

}  // namespace softarm::rig
