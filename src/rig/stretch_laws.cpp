#include "stretch_laws.h"

#include <algorithm>
#include <cmath>

#include "ramp.h"

namespace softarm::rig {
namespace {

/// Remembers whether it folds, how far the fold is closed (0 ... 1), and the direction of the fold's bending.
class KinkingWall : public SectionLaw {
 public:
  explicit KinkingWall(const Kink& kink) : kink_(kink) {}
  std::size_t memory_size() const override { return 4; }

  void add(const SectionStep& step, const double* before, double* after, SectionResponse& to) const override {
    const bool folds = before[kFolds] > 0.0;
    const Eigen::Vector2d plane(before[kAlongX], before[kAlongY]);
    // Given by what was: within a step the wall is linear. Statics: closed or open.
    double closed = before[kClosed];
    if (step.dt_s > 0.0 && folds)
      closed += step.dt_s / kFolding_s;
    else if (step.dt_s > 0.0 && plane.dot(step.last_curvature) < kink_.unfold_per_m)
      closed -= step.dt_s / kFolding_s;
    closed = std::clamp(closed, 0.0, 1.0);
    std::copy(before, before + memory_size(), after);
    after[kClosed] = closed;
    remember(step, after);
    if (closed <= 0.0) return;

    const double k = step.stiffness_nm2 * kink_.share * smooth(closed), along = plane.dot(step.curvature);
    to.moment_nm -= k * (along + plane.dot(step.lag_per_m)) * plane;
    to.tangent_nm2 -= (1.0 + step.lag_slope) * k * plane * plane.transpose();
    to.stored_j_per_m += 0.5 * k * (kink_.unfold_per_m * kink_.unfold_per_m - along * along);
  }

 private:
  enum Memory { kFolds, kClosed, kAlongX, kAlongY };
  static constexpr double kFolding_s = 0.05;

  /// 0 ... 1, with two derivatives that vanish at both ends.
  static double smooth(double x) { return x * x * x * (10.0 + x * (6.0 * x - 15.0)); }

  /// Begins to fold or to unfold at the end of a step, with what of the step came after it.
  void remember(const SectionStep& step, double* memory) const {
    const Eigen::Vector2d& u = step.curvature;
    const bool folds = memory[kFolds] > 0.0;
    if (!folds && memory[kClosed] <= 0.0 && u.norm() > kink_.fold_per_m)
      Eigen::Map<Eigen::Vector2d>(memory + kAlongX) = u.normalized();
    const Eigen::Map<const Eigen::Vector2d> plane(memory + kAlongX);
    const double now = plane.dot(u), last = plane.dot(step.last_curvature);
    const double edge = folds ? kink_.unfold_per_m : kink_.fold_per_m;
    const bool turns = folds ? step.dt_s > 0.0 && now < edge : now > edge;
    if (!turns) return;
    memory[kFolds] = folds ? 0.0 : 1.0;
    const double beyond =
        std::abs(now - last) > 0.0 ? std::clamp((now - edge) / (now - last), 0.0, 1.0) : 0.0;
    const double way = step.dt_s > 0.0 ? beyond * step.dt_s / kFolding_s : 1.0;
    memory[kClosed] = std::clamp(memory[kClosed] + (folds ? -way : way), 0.0, 1.0);
  }

  Kink kink_;
};

/// With x the curvature that the actuation does not make, and the play per length: g = EI (soft x +
/// (1 - soft) ramp(|x| - play) x / |x|) in place of EI x. What lags is g itself, so that the moment grows
/// with the angle however fast the stop is hit. Remembers g of three instants.
class PlayingJoint : public SectionLaw {
 public:
  explicit PlayingJoint(double play_rad) : play_rad_(play_rad) {}
  std::size_t memory_size() const override { return 6; }

  void add(const SectionStep& step, const double* before, double* after, SectionResponse& to) const override {
    constexpr double kSoft = 0.01, kOnset = 0.1;  // of the stiffness; of the play
    if (play_rad_ <= 0.0) return;
    const double play = play_rad_ / step.length_m, ei = step.stiffness_nm2;
    const Eigen::Vector2d x = step.curvature - step.driven_per_m;
    const double size = x.norm();
    const Ramp ramp(size - play, kOnset * play);
    const double grip = size > 0.0 ? ramp.value / size : 0.0;
    Eigen::Matrix2d held = grip * Eigen::Matrix2d::Identity();
    if (size > 0.0) held += (ramp.slope - grip) / (size * size) * x * x.transpose();
    const Eigen::Vector2d moment = ei * (kSoft + (1.0 - kSoft) * grip) * x;

    Eigen::Vector2d lag = step.lag_slope * moment;
    for (std::size_t i = 0; i < step.lag_past.size(); ++i)
      lag += step.lag_past[i] * Eigen::Map<const Eigen::Vector2d>(before + 2 * i);
    to.moment_nm += moment - ei * x + lag - ei * step.lag_per_m;
    to.tangent_nm2 += (1.0 + step.lag_slope) * ei * (1.0 - kSoft) * (held - Eigen::Matrix2d::Identity());
    to.stored_j_per_m += ei * (1.0 - kSoft) * (ramp.integral - 0.5 * size * size);

    for (std::size_t i = 0; i < step.lag_past.size(); ++i) {
      const Eigen::Map<const Eigen::Vector2d> old(before + 2 * (i > 0 ? i - 1 : 0));
      Eigen::Map<Eigen::Vector2d>(after + 2 * i) = i > 0 && step.dt_s > 0.0 ? Eigen::Vector2d(old) : moment;
    }
  }

 private:
  double play_rad_;
};

}  // namespace

SectionLawPtr kink_law(const Kink& kink) {
  return std::make_shared<KinkingWall>(kink);
}
SectionLawPtr joint_play_law(double play_rad) {
  return std::make_shared<PlayingJoint>(play_rad);
}

}  // namespace softarm::rig
