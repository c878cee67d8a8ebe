#include "extended_statics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "arm/constant_spec.h"

namespace softarm::model {
namespace {

// Differences of solutions: by what moves a place so far, if the laws alone did, though not by more than a
// share of the number itself or of what it usually is.
constexpr double kMoves_m = 5e-4, kShareOfNumber = 0.02;
constexpr double kUsualPayload_kg = 0.1, kUsualGravity_m_s2 = 9.81;
constexpr double kFine_m =
    1e-8;  // to which solutions agree with what they cause, for the sake of differences

/// @param by of the places by the number, as the laws alone have it
double step_of(const Eigen::VectorXd& by, double number, double usual) {
  const double most = kShareOfNumber * std::max(std::abs(number), usual);
  const double moves = by.size() > 0 ? by.cwiseAbs().maxCoeff() : 0.0;
  return moves * most > kMoves_m ? kMoves_m / moves : most;
}

}  // namespace

ExtendedStatics::ExtendedStatics(const arm::Arm& arm, std::vector<Present> effects,
                                 const std::vector<double>& points_m)
    : arm_(arm), effects_(std::move(effects)), points_m_(points_m), plain_(arm, points_m) {
  if (!effects_.empty()) online_.emplace(arm_, effects_, OnlineEffects::Solving{kFine_m, nullptr});
}

std::vector<std::string> ExtendedStatics::notes() const {
  return online_ ? online_->notes() : std::vector<std::string>();
}

Eigen::Isometry3d ExtendedStatics::base_under(const Eigen::Vector3d& gravity_base) const {
  Eigen::Isometry3d base = arm_.base.body ? Eigen::Isometry3d::Identity() : arm_.base.fixed_pose;
  const Eigen::Vector3d as_it_is = base.linear().transpose() * arm_.gravity_m_s2;
  if (gravity_base.norm() > 0.0 && as_it_is.norm() > 0.0)
    base.linear() = base.linear() * Eigen::Quaterniond::FromTwoVectors(gravity_base, as_it_is);
  return base;
}

ExtendedStatics::Outcome ExtendedStatics::solve(OnlineEffects& online, const arm::Arm& arm, double stamp_s,
                                                const StaticLoad& load,
                                                std::vector<arm::SegmentPrediction>& laws) const {
  const OnlineEffects::Driven& driven =
      online.begin(stamp_s, load.inputs, load.payload_kg, base_under(load.gravity_base));
  online.set_gravity(load.gravity_base);
  auto predictions = model::predict(arm, driven.inputs, driven.moment_inputs);
  if (!predictions) return Outcome::kNoLaws;
  laws = std::move(*predictions);
  return online.solve(laws, driven.payload_kg.value_or(load.payload_kg)) ? Outcome::kSolved
                                                                         : Outcome::kNoEquilibrium;
}

ExtendedStatics::Outcome ExtendedStatics::solve(const StaticLoad& load) {
  if (!online_) return plain_.solve(load);
  load_ = load;
  online_->reset();
  return solve(*online_, arm_, 0.0, load, laws_);
}

void ExtendedStatics::begin_trial() {
  if (online_) online_->reset();
}

ExtendedStatics::Outcome ExtendedStatics::solve_next(double stamp_s, const StaticLoad& load) {
  if (!online_) return plain_.solve(load);
  load_ = load;
  const Outcome outcome = solve(*online_, arm_, stamp_s, load, laws_);
  if (outcome == Outcome::kSolved) online_->keep();
  return outcome;
}

rod::RodState ExtendedStatics::point(int i) const {
  return online_ ? online_->at(points_m_[static_cast<std::size_t>(i)]) : plain_.point(i);
}

Eigen::Vector3d ExtendedStatics::body_position(int i) const {
  return online_ ? Eigen::Vector3d(online_->bodies().p.col(i)) : plain_.body_position(i);
}

Eigen::Vector3d ExtendedStatics::body_tangent(int i) const {
  return online_ ? online_->bodies().q[static_cast<std::size_t>(i)] * Eigen::Vector3d::UnitZ()
                 : plain_.body_tangent(i);
}

Eigen::VectorXd ExtendedStatics::places(const OnlineEffects& online) const {
  const auto bodies = static_cast<Eigen::Index>(arm_.bodies.size());
  Eigen::VectorXd all(3 * (bodies + static_cast<Eigen::Index>(points_m_.size())));
  all.head(3 * bodies) = Eigen::Map<const Eigen::VectorXd>(online.bodies().p.data(), 3 * bodies);
  for (std::size_t i = 0; i < points_m_.size(); ++i)
    all.segment<3>(3 * (bodies + static_cast<Eigen::Index>(i))) = online.at(points_m_[i]).p;
  return all;
}

Eigen::VectorXd ExtendedStatics::difference(double step, const Changed& changed) const {
  Eigen::VectorXd above, below;
  const bool up = changed(step, above), down = changed(-step, below);
  if (up && down) return (above - below) / (2.0 * step);
  Eigen::VectorXd here, beyond;
  const double aside = up ? step : -step;
  // At the edge of what is allowed: of the parabola through three places on this side.
  if ((up || down) && changed(0.0, here) && changed(2.0 * aside, beyond))
    return (4.0 * (up ? above : below) - 3.0 * here - beyond) / (2.0 * aside);
  return Eigen::VectorXd::Constant(3 * static_cast<Eigen::Index>(arm_.bodies.size() + points_m_.size()),
                                   std::numeric_limits<double>::quiet_NaN());
}

Eigen::VectorXd ExtendedStatics::by_load(double step,
                                         const std::function<void(StaticLoad&, double)>& change) {
  OnlineEffects other(arm_, effects_, {kFine_m, nullptr});
  return difference(step, [&](double by, Eigen::VectorXd& out) {
    StaticLoad load = load_;
    change(load, by);
    if (load.payload_kg < 0.0) return false;
    other.reset();
    std::vector<arm::SegmentPrediction> laws;
    if (solve(other, arm_, 0.0, load, laws) != Outcome::kSolved) return false;
    out = places(other);
    return true;
  });
}

Eigen::MatrixXd ExtendedStatics::by_inputs() {
  if (!online_) return plain_.by_inputs();
  const bool solved = plain_.solve(load_) == Outcome::kSolved;
  const Eigen::MatrixXd by_laws = solved ? plain_.by_inputs() : Eigen::MatrixXd();
  Eigen::MatrixXd by =
      Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(arm_.bodies.size() + points_m_.size()),
                            static_cast<Eigen::Index>(load_.inputs.size()));
  for (std::size_t i = 0; i < load_.inputs.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    if (!load_.inputs[i]) continue;
    const double step = step_of(solved ? Eigen::VectorXd(by_laws.col(column)) : Eigen::VectorXd(),
                                *load_.inputs[i], usual_size(arm_.inputs.scalars[i].kind));
    by.col(column) = by_load(step, [i](StaticLoad& load, double change) { *load.inputs[i] += change; });
  }
  return by;
}

Eigen::VectorXd ExtendedStatics::by_payload() {
  if (!online_) return plain_.by_payload();
  const bool solved = plain_.solve(load_) == Outcome::kSolved;
  const double step =
      step_of(solved ? plain_.by_payload() : Eigen::VectorXd(), load_.payload_kg, kUsualPayload_kg);
  return by_load(step, [](StaticLoad& load, double change) { load.payload_kg += change; });
}

Eigen::MatrixXd ExtendedStatics::by_gravity() {
  if (!online_) return plain_.by_gravity();
  const bool solved = plain_.solve(load_) == Outcome::kSolved;
  const Eigen::MatrixXd by_laws = solved ? plain_.by_gravity() : Eigen::MatrixXd();
  Eigen::MatrixXd by(3 * static_cast<Eigen::Index>(arm_.bodies.size() + points_m_.size()), 3);
  for (int axis = 0; axis < 3; ++axis) {
    const double step = step_of(solved ? Eigen::VectorXd(by_laws.col(axis)) : Eigen::VectorXd(),
                                load_.gravity_base[axis], kUsualGravity_m_s2);
    by.col(axis) =
        by_load(step, [axis](StaticLoad& load, double change) { load.gravity_base[axis] += change; });
  }
  return by;
}

Eigen::MatrixXd ExtendedStatics::by_constants(const std::vector<arm::ConstantRef>& constants) {
  if (!online_) return plain_.by_constants(constants);
  const bool solved = plain_.solve(load_) == Outcome::kSolved;
  const Eigen::MatrixXd by_laws = solved ? plain_.by_constants(constants) : Eigen::MatrixXd();
  Eigen::MatrixXd by(3 * static_cast<Eigen::Index>(arm_.bodies.size() + points_m_.size()),
                     static_cast<Eigen::Index>(constants.size()));
  for (std::size_t j = 0; j < constants.size(); ++j) {
    const arm::ConstantRef& constant = constants[j];
    const auto column = static_cast<Eigen::Index>(j);
    const double value = arm::value_of(arm_, constant);
    const arm::Range range = arm::allowed_range(arm_, constant);
    const double usual = value != 0.0 ? std::abs(value) : std::min(1.0, 1e-3 * range.high);
    const double step =
        step_of(solved ? Eigen::VectorXd(by_laws.col(column)) : Eigen::VectorXd(), value, usual);
    by.col(column) = difference(step, [&](double change, Eigen::VectorXd& out) {
      if (value + change < range.low || value + change > range.high) return false;
      arm::Arm changed = arm_;
      // As ArmStatics: the layout carries the bodies along.
      for (const int i : arm::segments_of(constant))
        arm::spec_of(constant.kind)
            .set(changed.segments[static_cast<std::size_t>(i)], constant.index, value + change);
      OnlineEffects other(changed, effects_, {kFine_m, &arm_});
      std::vector<arm::SegmentPrediction> laws;
      if (solve(other, changed, 0.0, load_, laws) != Outcome::kSolved) return false;
      out = places(other);
      return true;
    });
  }
  return by;
}

}  // namespace softarm::model
