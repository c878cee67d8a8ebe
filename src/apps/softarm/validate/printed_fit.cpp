#include "printed_fit.h"

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/NonLinearOptimization>

namespace softarm::app::validate {
namespace {

constexpr int kNodes = 101;  // L/4, L/2 ... are nodes of it
constexpr double kLengthScale = 0.1;

struct Problem {
  const std::vector<Eigen::Vector3d>& points;
  const published::PublishedArm& start;
  published::LoadLaw law;

  /// x: curvature components M0 / EI times the length of the start, ln EI over that of the start, L.
  published::PublishedArm arm(const Eigen::VectorXd& x) const {
    published::PublishedArm a = start;
    a.bending_stiffness_nm2 = start.bending_stiffness_nm2 * std::exp(x[2]);
    a.moment_nm = x.head<2>().norm() / start.length_m * a.bending_stiffness_nm2;
    a.direction_rad = std::atan2(x[1], x[0]);
    a.length_m = x[3] * kLengthScale;
    return a;
  }
  std::optional<std::vector<Eigen::Vector3d>> shape(const Eigen::VectorXd& x) const {
    const published::PublishedArm a = arm(x);
    if (!(a.length_m > 0.0) || std::abs(x[2]) > 4.0) return std::nullopt;
    published::PublishedOptions options;
    options.nodes = kNodes;
    options.relaxation = published::settling_relaxation(a);
    const published::PublishedShape s = published::solve_published(a, law, options);
    if (s.status != rod::SolveStatus::kConverged) return std::nullopt;
    std::vector<Eigen::Vector3d> p;
    const int step = (kNodes - 1) / static_cast<int>(points.size());
    for (int i = 1; i <= static_cast<int>(points.size()); ++i) p.emplace_back(s.p_m.col(i * step));
    return p;
  }

  // What Eigen's Levenberg-Marquardt asks for; residuals in mm.
  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& residual) const {
    const auto p = shape(x);
    for (std::size_t i = 0; i < points.size(); ++i)
      residual.segment<3>(3 * static_cast<Eigen::Index>(i)) =
          p ? Eigen::Vector3d(1e3 * ((*p)[i] - points[i])) : Eigen::Vector3d::Constant(1e3);
    return 0;
  }
  int df(const Eigen::VectorXd& x, Eigen::MatrixXd& jacobian) const {
    constexpr double kStep = 1e-4;
    Eigen::VectorXd moved = x, above(jacobian.rows()), below(jacobian.rows());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      moved[i] = x[i] + kStep;
      (*this)(moved, above);
      moved[i] = x[i] - kStep;
      (*this)(moved, below);
      jacobian.col(i) = (above - below) / (2.0 * kStep);
      moved[i] = x[i];
    }
    return 0;
  }
};

}  // namespace

std::optional<PrintedFit> fit_printed(const std::vector<Eigen::Vector3d>& points,
                                      const published::PublishedArm& start, published::LoadLaw law) {
  Problem problem{points, start, law};
  Eigen::VectorXd x(4);
  const double turn = start.moment_nm / start.bending_stiffness_nm2 * start.length_m;
  x << turn * std::cos(start.direction_rad), turn * std::sin(start.direction_rad), 0.0,
      start.length_m / kLengthScale;
  // LevenbergMarquardt sizes its arrays by these.
  struct Functor : Problem {
    explicit Functor(const Problem& p) : Problem(p) {}
    int values() const { return 3 * static_cast<int>(points.size()); }
    int inputs() const { return 4; }
  } functor(problem);
  Eigen::LevenbergMarquardt<Functor> solver(functor);
  solver.parameters.maxfev = 100;
  solver.parameters.ftol = solver.parameters.xtol = 1e-8;
  solver.minimize(x);
  const auto p = problem.shape(x);
  if (!p) return std::nullopt;
  const published::PublishedArm arm = problem.arm(x);
  return PrintedFit{arm.moment_nm, arm.bending_stiffness_nm2, arm.length_m, *p};
}

}  // namespace softarm::app::validate
