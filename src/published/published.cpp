#include "published.h"

#include <cmath>

namespace softarm::published {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kMostNodes = 1000000;

bool physical(const PublishedArm& arm) {
  const auto positive = [](double x) { return std::isfinite(x) && x > 0.0; };
  const auto not_negative = [](double x) { return std::isfinite(x) && x >= 0.0; };
  return not_negative(arm.moment_nm) && std::isfinite(arm.direction_rad) &&
         positive(arm.bending_stiffness_nm2) && positive(arm.length_m) && not_negative(arm.payload_n) &&
         not_negative(arm.weight_n);
}

bool usable(const PublishedOptions& options) {
  return options.nodes >= 3 && options.nodes <= kMostNodes && options.relaxation > 0.0 &&
         options.relaxation <= 1.0 && options.max_iterations >= 1 && std::isfinite(options.tolerance_rad) &&
         options.tolerance_rad > 0.0;
}

/// Integral of f from the base to each node.
VectorXd integral(const VectorXd& f, double spacing) {
  VectorXd sum(f.size());
  sum[0] = 0.0;
  for (Index i = 1; i < f.size(); ++i) sum[i] = sum[i - 1] + 0.5 * spacing * (f[i - 1] + f[i]);
  return sum;
}

/// Integral of f from each node to the tip.
VectorXd integral_to_tip(const VectorXd& f, double spacing) {
  const VectorXd sum = integral(f, spacing);
  return sum[sum.size() - 1] - sum.array();
}

class Iteration {
 public:
  Iteration(const PublishedArm& arm, LoadLaw law, int nodes)
      : arm_(arm),
        law_(law),
        sign_(arm.mounting == Mounting::kStanding ? 1.0 : -1.0),
        spacing_(arm.length_m / (nodes - 1)),
        s_(VectorXd::LinSpaced(nodes, 0.0, arm.length_m)),
        curvature_(VectorXd::Constant(nodes, arm.moment_nm / arm.bending_stiffness_nm2)) {
    bend();
  }

  /// Curvature that the moments of the present shape give, less the present one.
  VectorXd update() const {
    const VectorXd moment = arm_.moment_nm + sign_ * load_moment().array();
    return moment / arm_.bending_stiffness_nm2 - curvature_;
  }

  void change_curvature(const VectorXd& by) {
    curvature_ += by;
    bend();
  }

  double tip_angle() const { return theta_[theta_.size() - 1]; }

  void write(PublishedShape& shape) const {
    shape.s_m = s_;
    shape.theta_rad = theta_;
    shape.w_m = w_;
    shape.curvature_per_m = curvature_;
    shape.p_m.resize(3, s_.size());  // (6); w is the integral of sin theta
    shape.p_m.row(0) = std::cos(arm_.direction_rad) * w_;
    shape.p_m.row(1) = std::sin(arm_.direction_rad) * w_;
    shape.p_m.row(2) = integral(theta_.array().cos(), spacing_);
  }

 private:
  void bend() {
    theta_ = integral(curvature_, spacing_);        // (4)
    w_ = integral(theta_.array().sin(), spacing_);  // (5)
  }

  VectorXd load_moment() const {
    const double per_length = arm_.weight_n / arm_.length_m;
    const VectorXd beyond = w_[w_.size() - 1] - w_.array();  // w(L) - w(s)
    if (law_ == LoadLaw::kPrinted) {
      return arm_.payload_n * std::sin(tip_angle()) * beyond +                               // (2)
             per_length * integral_to_tip(theta_.array().sin() * beyond.array(), spacing_);  // (3)
    }
    const VectorXd lever = integral_to_tip(w_, spacing_).array() - w_.array() * (arm_.length_m - s_.array());
    return arm_.payload_n * beyond + per_length * lever;
  }

  PublishedArm arm_;
  LoadLaw law_;
  double sign_;
  double spacing_;
  VectorXd s_, curvature_, theta_, w_;
};

}  // namespace

PublishedShape solve_published(const PublishedArm& arm, LoadLaw law, const PublishedOptions& options) {
  PublishedShape shape;
  if (!physical(arm) || !usable(options)) return shape;
  shape.status = rod::SolveStatus::kNoConvergence;
  Iteration iteration(arm, law, options.nodes);
  while (shape.iterations < options.max_iterations) {
    shape.largest_tip_angle_rad = std::fmax(shape.largest_tip_angle_rad, std::abs(iteration.tip_angle()));
    const VectorXd update = iteration.update();
    ++shape.iterations;
    if (!update.allFinite()) break;  // overflow of absurd values
    if (update.cwiseAbs().maxCoeff() * arm.length_m <= options.tolerance_rad) {
      shape.status = rod::SolveStatus::kConverged;
      iteration.write(shape);
      break;
    }
    iteration.change_curvature(options.relaxation * update);
  }
  return shape;
}

double settling_relaxation(const PublishedArm& arm) {
  if (!physical(arm)) return 1.0;
  const double length2_over_ei = arm.length_m * arm.length_m / arm.bending_stiffness_nm2;
  return 1.0 / (1.0 + length2_over_ei * (4.0 * arm.payload_n / (M_PI * M_PI) + arm.weight_n / 7.8373));
}

}  // namespace softarm::published
