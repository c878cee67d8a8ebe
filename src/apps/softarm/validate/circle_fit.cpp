#include "circle_fit.h"

#include <cmath>
#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>

namespace softarm::app::validate {
namespace {

/// Distances are rounded off below this: the sum has no derivative where one is zero.
constexpr double kRoundM = 1e-5;

struct Arc {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };
  const std::vector<Eigen::Vector3d>* points;
  double guess_m;

  int inputs() const { return 3; }
  int values() const { return 3 * static_cast<int>(points->size()); }

  /// x: bending angle towards x and y, length over the guess.
  std::vector<Eigen::Vector3d> shape(const Eigen::VectorXd& x) const {
    const double angle = x.head<2>().norm(), length = x[2] * guess_m;
    const Eigen::Vector2d direction =
        angle > 0.0 ? Eigen::Vector2d(x.head<2>() / angle) : Eigen::Vector2d::UnitX();
    std::vector<Eigen::Vector3d> p;
    for (std::size_t i = 1; i <= points->size(); ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(points->size());
      const double turn = share * angle, half = 0.5 * turn;
      const double chord = share * length * (half < 1e-9 ? 1.0 : std::sin(half) / half);
      const double side = chord * std::sin(half);
      p.emplace_back(side * direction.x(), side * direction.y(), chord * std::cos(half));
    }
    return p;
  }
  /// Vectors whose squared norms are the weighted distances.
  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& residual) const {
    const std::vector<Eigen::Vector3d> p = shape(x);
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Eigen::Vector3d error = p[i] - (*points)[i];
      const double distance = std::sqrt(error.squaredNorm() + kRoundM * kRoundM);
      residual.segment<3>(3 * static_cast<Eigen::Index>(i)) =
          error / std::sqrt(static_cast<double>(i + 1) * distance);
    }
    return 0;
  }
};

}  // namespace

std::vector<Eigen::Vector3d> fit_circle(const std::vector<Eigen::Vector3d>& points, double length_m) {
  Eigen::NumericalDiff<Arc, Eigen::Central> arc;
  arc.points = &points;
  arc.guess_m = length_m;
  const Eigen::Vector3d& tip = points.back();
  const double side = tip.head<2>().norm(), angle = 2.0 * std::atan2(side, tip.z());
  Eigen::VectorXd x(3);
  x << (side > 0.0 ? Eigen::Vector2d(angle * tip.head<2>() / side) : Eigen::Vector2d::Zero()), 1.0;
  Eigen::LevenbergMarquardt<Eigen::NumericalDiff<Arc, Eigen::Central>> solver(arc);
  solver.minimize(x);
  return arc.shape(x);
}

}  // namespace softarm::app::validate
