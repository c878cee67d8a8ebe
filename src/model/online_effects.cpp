#include "online_effects.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace softarm::model {
namespace {

constexpr double kBlock_s = 0.1;  // over which shapes are averaged before memories take notice

std::string with_values(const Present& present) {
  std::string text = present.effect->info().id;
  const std::vector<Parameter>& parameters = present.effect->info().parameters;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    text += fmt::format("{}{} {:.4g}", k == 0 ? " (" : ", ", parameters[k].symbol,
                        present.values[static_cast<Eigen::Index>(k)]);
  return text + ")";
}

void add(const rod::RodState& from, rod::RodState& to) {
  to.s_m = from.s_m;
  to.p += from.p;
  const double sign = to.q.dot(from.q) < 0.0 ? -1.0 : 1.0;
  to.q.coeffs() += sign * from.q.coeffs();
  to.n += from.n;
  to.m += from.m;
  to.u += from.u;
  to.v += from.v;
}

void divide(rod::RodState& state, double by) {
  state.p /= by;
  state.q.normalize();
  state.n /= by;
  state.m /= by;
  state.u /= by;
  state.v /= by;
}

}  // namespace

std::optional<std::vector<arm::SegmentPrediction>> predict(const arm::Arm& arm,
                                                           const arm::InputValues& inputs,
                                                           const arm::InputValues& moment_inputs) {
  auto predictions = arm::predict(arm, inputs);
  if (!predictions || inputs == moment_inputs) return predictions;
  const auto moments = arm::predict(arm, moment_inputs);
  if (!moments) return std::nullopt;
  for (std::size_t i = 0; i < predictions->size(); ++i) {
    (*predictions)[i].moment_nm = (*moments)[i].moment_nm;
    (*predictions)[i].curvature_per_m = (*moments)[i].curvature_per_m;
  }
  return predictions;
}

OnlineEffects::OnlineEffects(const arm::Arm& arm, const std::vector<Present>& effects, const Solving& solving)
    : arm_(arm),
      effects_(choose(effects)),
      solver_(solving.layout != nullptr ? *solving.layout : arm, Mesh::of(effects_, solving.settled_m)),
      history_(arm),
      memories_(effects_),
      unknown_(arm, effects_),
      errors_(arm, effects_) {
  reset();
}

std::vector<Present> OnlineEffects::choose(std::vector<Present> all) {
  std::vector<Present> chosen;
  std::string used;
  std::vector<std::string> others;
  for (Present& present : in_order(std::move(all))) {
    const std::string why_not = present.effect->live_obstacle(present.values);
    if (why_not.empty()) {
      used += (used.empty() ? "" : ", ") + with_values(present);
      looks_back_ = looks_back_ || present.effect->looks_back();
      chosen.push_back(std::move(present));
    } else {
      others.push_back(fmt::format("{} is NOT in the model: {}", with_values(present), why_not));
    }
  }
  if (!used.empty()) notes_.push_back("in the model: " + used);
  notes_.insert(notes_.end(), others.begin(), others.end());
  return chosen;
}

void OnlineEffects::reset() {
  history_.clear();
  near_.reset();
  feedback_ = {};
  memories_.rest();
  unknown_.begin(solver_.fine);
  errors_.rest();
  sum_.reset();
  first_s_.reset();
  last_s_.reset();
  remembered_s_.reset();
  values_ = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(arm_.inputs.scalars.size()));
}

const OnlineEffects::Driven& OnlineEffects::begin(double stamp_s, const arm::InputValues& inputs,
                                                  std::optional<double> payload_kg,
                                                  const Eigen::Isometry3d& base,
                                                  const std::vector<trial::InputSample>& samples) {
  if (last_s_ && !(stamp_s > *last_s_ && stamp_s - *last_s_ < kLongestPause_s)) reset();
  if (!first_s_) first_s_ = stamp_s;
  last_s_ = stamp_s;
  const auto known = [&](std::size_t k) {
    return k < inputs.size() && inputs[k] && std::isfinite(*inputs[k]);
  };
  for (Eigen::Index k = 0; k < values_.size(); ++k) {
    if (known(static_cast<std::size_t>(k))) values_[k] = *inputs[static_cast<std::size_t>(k)];
  }
  const double t_s = stamp_s - *first_s_;
  Series series;
  if (looks_back_) {
    history_.add(stamp_s, values_, samples);
    series = history_.series(*first_s_, payload_kg.value_or(0.0));
  } else {
    series.t_s = Eigen::VectorXd::Constant(1, t_s);
    series.inputs = series.moment_inputs = values_;
    series.payload_kg = Eigen::VectorXd::Constant(1, payload_kg.value_or(0.0));
  }
  const Series undriven = unknown_.empty() && errors_.count() == 0 ? Series() : series;
  drive(arm_, effects_, series);
  unknown_.drive(undriven, series);
  errors_.drive(undriven);
  const Eigen::Index end = series.t_s.size() - 1;

  now_.t_s = t_s;
  now_.dt_s = remembered_s_ ? t_s - *remembered_s_ : 0.0;
  now_.inputs = series.inputs.col(end);
  now_.moment_inputs = series.moment_inputs.col(end);
  now_.payload_kg = series.payload_kg[end];
  now_.gravity_base = base.linear().transpose() * arm_.gravity_m_s2;
  now_.q_base_mocap = Eigen::Quaterniond(base.linear()).conjugate();
  now_.base_in_mocap_m = base.translation();
  now_.session_s = t_s;

  given_inputs_ = inputs;
  given_payload_kg_ = payload_kg;
  driven_ = driven(now_);
  return driven_;
}

OnlineEffects::Driven OnlineEffects::driven(const Instant& instant) const {
  Driven out{given_inputs_, given_inputs_, given_payload_kg_};
  for (std::size_t k = 0; k < given_inputs_.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    if (row >= values_.size() || !given_inputs_[k] || !std::isfinite(*given_inputs_[k])) continue;
    out.inputs[k] = instant.inputs[row];
    out.moment_inputs[k] = instant.moment_inputs[row];
  }
  if (out.payload_kg) out.payload_kg = instant.payload_kg;
  return out;
}

OnlineEffects::Driven OnlineEffects::driven_by_error(int k, bool& differs) const {
  Instant there = now_;
  errors_.drive(k, there);
  differs = there.inputs != now_.inputs || there.moment_inputs != now_.moment_inputs ||
            there.payload_kg != now_.payload_kg;
  return differs ? driven(there) : driven_;
}

std::optional<OnlineEffects::Moved> OnlineEffects::moved_by_error(
    int k, const std::vector<arm::SegmentPrediction>& segments, double payload_kg) {
  static const Dynamics kStill{false, 0.0};
  static const Motion kNoMotion;
  if (!last_.solved) return std::nullopt;
  Predicted there = last_;
  errors_.drive(k, there.instant);
  there.instant.payload_kg = payload_kg;
  Feedback feedback = feedback_;
  const InstantSolver::Context context{arm_, errors_.memories(k), kStill, kNoMotion, feedback, &segments};
  if (!solver_.settle(context, errors_.effects(k), &last_.q_tip, &last_.shape, there)) return std::nullopt;
  Bodies bodies;
  solver_.bodies_of_solution(bodies);
  model::observe(arm_, errors_.effects(k), there.instant, bodies);
  Moved moved{errors_.scale(k) * (bodies.p - bodies_.p), bodies.p};
  for (std::size_t b = 0; b < bodies.q.size(); ++b)
    moved.tangent.col(static_cast<Eigen::Index>(b)) =
        errors_.scale(k) *
        ((bodies.q[b] * Eigen::Vector3d::UnitZ()) - bodies_.q[b] * Eigen::Vector3d::UnitZ());
  return moved;
}

bool OnlineEffects::solve(const std::vector<arm::SegmentPrediction>& segments, double payload_kg,
                          const Eigen::Quaterniond& turned) {
  return solve(effects_, segments, payload_kg, turned);
}

bool OnlineEffects::solve_leaning(const Eigen::VectorXd& by_sd,
                                  const std::vector<arm::SegmentPrediction>& segments, double payload_kg,
                                  const Eigen::Quaterniond& turned) {
  return solve(errors_.leaning(by_sd), segments, payload_kg, turned);
}

bool OnlineEffects::solve(const std::vector<Present>& effects,
                          const std::vector<arm::SegmentPrediction>& segments, double payload_kg,
                          const Eigen::Quaterniond& turned) {
  static const Dynamics kStill{false, 0.0};
  static const Motion kNoMotion;
  last_.instant = now_;
  last_.instant.payload_kg = payload_kg;
  Feedback feedback = feedback_;
  const InstantSolver::Context context{arm_, memories_.all(), kStill, kNoMotion, feedback, &segments};
  const Eigen::Quaterniond tip = near_ ? turned * near_->q_tip : turned;
  last_.solved =
      solver_.settle(context, effects, near_ ? &tip : nullptr, near_ ? &near_->shape : nullptr, last_);
  if (!last_.solved) return false;
  feedback_ = feedback;
  observe(effects);
  return true;
}

std::vector<Eigen::Vector2d> OnlineEffects::start_variance(
    const std::vector<arm::SegmentPrediction>& segments, double payload_kg) {
  const bool known = unknown_.empty() || (!near_ && !solve(segments, payload_kg));
  if (known) return std::vector<Eigen::Vector2d>(arm_.segments.size(), Eigen::Vector2d::Zero());
  Instant instant = now_;
  instant.payload_kg = payload_kg;
  return unknown_.curvature_variance(solver_, memories_.all(), instant, near_ ? near_->shape : last_.shape,
                                     segments);
}

void OnlineEffects::observe(const std::vector<Present>& effects) {
  solver_.bodies_of_solution(bodies_);
  model::observe(arm_, effects, last_.instant, bodies_);
}

void OnlineEffects::start_here() {
  if (last_.solved) near_ = last_;
}

void OnlineEffects::keep() {
  start_here();
  const bool remembers = std::any_of(effects_.begin(), effects_.end(),
                                     [](const Present& present) { return present.effect->remembers(); });
  if (!remembers || !last_.solved) return;
  // By the stamps, so that it does not matter with which frame a stream began.
  const double block = std::floor(*last_s_ / kBlock_s);
  if (sum_ && sum_->block != block) remember();
  const Instant& now = last_.instant;
  if (!sum_) {
    sum_ = Sum{block, 1, now, last_.shape};
    return;
  }
  Sum& sum = *sum_;
  ++sum.count;
  sum.instant.t_s += now.t_s;
  sum.instant.inputs += now.inputs;
  sum.instant.moment_inputs += now.moment_inputs;
  sum.instant.payload_kg += now.payload_kg;
  sum.instant.gravity_base = now.gravity_base;
  sum.instant.q_base_mocap = now.q_base_mocap;
  sum.instant.base_in_mocap_m = now.base_in_mocap_m;
  for (std::size_t j = 0; j < sum.shape.middles.size(); ++j)
    add(last_.shape.middles[j], sum.shape.middles[j]);
  for (std::size_t j = 0; j < sum.shape.stations.size(); ++j)
    add(last_.shape.stations[j], sum.shape.stations[j]);
  sum.shape.base_moment_nm += last_.shape.base_moment_nm;
  sum.shape.base_force_n += last_.shape.base_force_n;
}

void OnlineEffects::remember() {
  Sum mean = std::move(*sum_);
  sum_.reset();
  const double count = mean.count;
  mean.instant.t_s /= count;
  mean.instant.inputs /= count;
  mean.instant.moment_inputs /= count;
  mean.instant.payload_kg /= count;
  mean.instant.dt_s = remembered_s_ ? mean.instant.t_s - *remembered_s_ : 0.0;
  mean.instant.session_s = mean.instant.t_s;
  for (rod::RodState& middle : mean.shape.middles) divide(middle, count);
  for (rod::RodState& station : mean.shape.stations) divide(station, count);
  mean.shape.base_moment_nm /= count;
  mean.shape.base_force_n /= count;
  memories_.remember(arm_, solver_.fine, mean.instant, mean.shape);
  unknown_.remember(solver_.fine, mean.instant, mean.shape, memories_.all());
  errors_.remember(solver_.fine, mean.instant, mean.shape);
  remembered_s_ = mean.instant.t_s;
}

}  // namespace softarm::model
