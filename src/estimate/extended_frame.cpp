#include "extended_frame.h"

#include <algorithm>
#include <cmath>

#include "model/body_kinematics.h"
#include "policy.h"

namespace softarm::estimate {
namespace {

using Eigen::VectorXd;

// Steps of differences, by parameter of a segment and of the payload: bodies move by about a millimetre.
constexpr double kStep[kSegmentParameters] = {0.02, 0.02, 0.03, 0.005};
constexpr double kPayloadStep = 0.05;
constexpr int kHalvings = 4;  // of the way to where the arm has no equilibrium with effects
constexpr double kNotThere_sd = 2.0 * kPolicy.effects.agrees_sd;  // of a line that is not where the fit is

}  // namespace

ExtendedFrame::ExtendedFrame(const arm::Arm& arm, const std::vector<model::Present>& effects,
                             const Problem& problem)
    : arm_(arm), online_(arm, effects) {
  at_.x = VectorXd::Zero(problem.NumParameters());
  at_.errors = VectorXd::Zero(online_.size_errors());
  at_.errors_as_x = Eigen::MatrixXd::Zero(problem.NumParameters(), online_.size_errors());
  other_drives_.resize(static_cast<std::size_t>(online_.size_errors()));
  const auto bodies = static_cast<Eigen::Index>(arm.bodies.size());
  solved_by_laws_ = {Eigen::Matrix3Xd::Zero(3, bodies), Eigen::Matrix3Xd::Zero(3, bodies)};
  for (std::size_t b = 0; b < arm.bodies.size(); ++b) {
    EffectsAt::OnBody body;
    body.p_by_x = Eigen::Matrix3Xd::Zero(3, problem.NumParameters());
    body.tangent_by_x = body.p_by_x;
    body.p_by_error = body.tangent_by_error = Eigen::Matrix3Xd::Zero(3, online_.size_errors());
    body.p_beyond_x = body.tangent_beyond_x = body.p_by_error;
    at_.bodies.push_back(std::move(body));
  }
}

void ExtendedFrame::reset() {
  online_.reset();
  line_ = false;
  near_tip_.reset();
  off_sd_per_way_.reset();
  solved_x_.reset();
  derivative_of_.clear();
  at_.errors.setZero();
}

const trial::Frame& ExtendedFrame::begin(const trial::Frame& frame, const Eigen::Isometry3d& base) {
  std::optional<double> payload_kg = arm_.payload.default_kg;
  if (frame.payload_kg && std::isfinite(*frame.payload_kg)) payload_kg = frame.payload_kg;
  const model::OnlineEffects::Driven& driven =
      online_.begin(frame.stamp_s(), frame.inputs, payload_kg, base, frame.samples);
  frame_ = frame;
  frame_.inputs = driven.inputs;
  frame_.payload_kg = driven.payload_kg;
  moment_inputs_ = driven.moment_inputs;
  of_this_frame_ = false;
  solved_x_.reset();
  return frame_;
}

VectorXd ExtendedFrame::within_range(const Problem& problem, const VectorXd& x) const {
  VectorXd y = x;
  for (int i = 0; i < static_cast<int>(arm_.segments.size()); ++i) {
    const arm::Range& range = arm_.segments[static_cast<std::size_t>(i)].bending_stiffness_range_nm2;
    const double reference = problem.reference_stiffness(i);
    double& c = y[Problem::column(i, 2)];
    c = std::clamp(c, reference / range.high, reference / range.low);
    double& l = y[Problem::column(i, 3)];
    l = std::clamp(l, kPolicy.effects.least_length, kPolicy.effects.most_length);
  }
  double& payload = y[problem.payload_column()];
  payload = std::clamp(payload, arm_.payload.range_kg.low / Problem::kPayloadUnit,
                       arm_.payload.range_kg.high / Problem::kPayloadUnit);
  return y;
}

std::vector<arm::SegmentPrediction> ExtendedFrame::segments_at(
    const Problem& problem, const VectorXd& x, const std::vector<arm::SegmentPrediction>& laws) const {
  std::vector<arm::SegmentPrediction> segments = laws;
  for (int i = 0; i < static_cast<int>(segments.size()); ++i) {
    arm::SegmentPrediction& segment = segments[static_cast<std::size_t>(i)];
    const double rest = problem.rest_length(i);
    segment.bending_stiffness_nm2 = problem.reference_stiffness(i) / x[Problem::column(i, 2)];
    segment.moment_nm = segment.bending_stiffness_nm2 / rest * x.segment<2>(Problem::column(i, 0)).matrix();
    segment.curvature_per_m.setZero();
    segment.length_m = rest * x[Problem::column(i, 3)];
  }
  return segments;
}

Eigen::Quaterniond ExtendedFrame::turned(const Problem& problem) const {
  return near_tip_ ? problem.solver().q_tip() * near_tip_->conjugate() : Eigen::Quaterniond::Identity();
}

bool ExtendedFrame::solve(const Problem& problem, const VectorXd& x,
                          const std::vector<arm::SegmentPrediction>& laws) {
  if (solved_x_ && *solved_x_ == x) return true;
  solved_x_.reset();
  if (!online_.solve(segments_at(problem, x, laws), Problem::kPayloadUnit * x[problem.payload_column()],
                     turned(problem)))
    return false;
  solved_tip_ = problem.solver().q_tip();
  solved_x_ = x;
  return true;
}

std::optional<ExtendedFrame::Difference> ExtendedFrame::difference(
    Problem& problem, const VectorXd& x, const std::vector<arm::SegmentPrediction>& laws) {
  // A fit may have run beyond a buckling load, from where no step leads back; the last shape is on this side.
  const bool evaluated = problem.evaluate(x) || (near_tip_ && problem.evaluate(x, near_tip_));
  if (!evaluated || !solve(problem, x, laws)) return std::nullopt;
  const model::Bodies& with = online_.bodies();
  Difference d{with.p, Eigen::Matrix3Xd::Zero(3, with.p.cols())};
  for (int b = 0; b < static_cast<int>(with.p.cols()); ++b) {
    Observation o;
    o.body = b;
    solved_by_laws_.p.col(b) = problem.position_by_laws(o);
    solved_by_laws_.tangent.col(b) = model::tangent_of(problem.solver().station(b));
    d.p.col(b) -= solved_by_laws_.p.col(b);
    d.tangent.col(b) =
        with.q[static_cast<std::size_t>(b)] * Eigen::Vector3d::UnitZ() - solved_by_laws_.tangent.col(b);
  }
  return d;
}

VectorXd ExtendedFrame::reach(const Problem& problem) const {
  VectorXd far(problem.NumParameters());
  for (int i = 0; i < static_cast<int>(arm_.segments.size()); ++i) {
    for (int k = 0; k < kSegmentParameters; ++k) {
      const int j = Problem::column(i, k);
      far[j] = k == 2 ? kPolicy.effects.slope_holds[k] * std::abs(derivative_x_[j])
                      : kPolicy.effects.slope_holds[k];
    }
  }
  far[problem.payload_column()] = kPolicy.effects.slope_holds_payload;
  return far;
}

double ExtendedFrame::way_to(const Problem& problem, const VectorXd& x) const {
  return ((x - at_.x).array() / reach(problem).array()).matrix().lpNorm<Eigen::Infinity>();
}

std::optional<double> ExtendedFrame::expected_off_sd(const Problem& problem, const VectorXd& x) const {
  if (!of_this_frame_ || !off_sd_per_way_) return std::nullopt;
  return *off_sd_per_way_ * way_to(problem, x);
}

void ExtendedFrame::start_here() {
  online_.start_here();
  near_tip_ = solved_tip_;
}

bool ExtendedFrame::derivative_holds(const Problem& problem, const VectorXd& x) const {
  return derivative_of_ == problem.free() &&
         ((x - derivative_x_).cwiseAbs().array() < reach(problem).array()).all() &&
         (problem.rod().gravity_m_s2 - derivative_gravity_).norm() <
             kPolicy.effects.slope_holds_gravity_m_s2 &&
         std::abs(frame_.stamp_s() - derivative_stamp_s_) < kPolicy.effects.slope_holds_s;
}

bool ExtendedFrame::line_reaches(const Problem& problem, const VectorXd& x) const {
  return line_ && derivative_holds(problem, within_range(problem, x));
}

bool ExtendedFrame::differentiate(Problem& problem, const VectorXd& x,
                                  const std::vector<arm::SegmentPrediction>& laws, const Difference& here) {
  for (EffectsAt::OnBody& body : at_.bodies) {
    body.p_by_x.setZero();
    body.tangent_by_x.setZero();
  }
  for (int j = 0; j < problem.NumParameters(); ++j) {
    if (!problem.free()[static_cast<std::size_t>(j)]) continue;
    const double size = j == problem.payload_column() ? kPayloadStep : kStep[j % kSegmentParameters];
    std::optional<Difference> there;
    double step = size;
    for (const double side : {1.0, -1.0}) {
      VectorXd y = x;
      y[j] += side * size;
      there = difference(problem, y, laws);
      step = side * size;
      if (there) break;
    }
    if (!there) return false;
    for (std::size_t b = 0; b < at_.bodies.size(); ++b) {
      const auto column = static_cast<Eigen::Index>(b);
      at_.bodies[b].p_by_x.col(j) = (there->p.col(column) - here.p.col(column)) / step;
      at_.bodies[b].tangent_by_x.col(j) = (there->tangent.col(column) - here.tangent.col(column)) / step;
    }
  }
  derivative_x_ = x;
  derivative_of_ = problem.free();
  derivative_gravity_ = problem.rod().gravity_m_s2;
  derivative_stamp_s_ = frame_.stamp_s();
  return true;
}

void ExtendedFrame::put_line(const VectorXd& x, const Difference& difference) {
  at_.x = x;
  for (std::size_t b = 0; b < at_.bodies.size(); ++b) {
    at_.bodies[b].p = difference.p.col(static_cast<Eigen::Index>(b));
    at_.bodies[b].tangent = difference.tangent.col(static_cast<Eigen::Index>(b));
  }
  line_ = true;
  of_this_frame_ = true;
}

bool ExtendedFrame::linearise(Problem& problem, const VectorXd& x,
                              const std::vector<arm::SegmentPrediction>& laws, bool anew) {
  const VectorXd y = within_range(problem, x);
  const std::optional<Difference> here = difference(problem, y, laws);
  if (!here) return false;
  start_here();
  if (anew || !derivative_holds(problem, y)) {
    look_at_errors(problem, y, laws);
    if (!differentiate(problem, y, laws, *here)) {
      derivative_of_.clear();
      return false;
    }
    if (errors() > 0 && problem.evaluate(y)) split_errors(problem);
  }
  put_line(y, *here);
  return true;
}

std::optional<double> ExtendedFrame::move_line(Problem& problem, const VectorXd& x,
                                               const std::vector<arm::SegmentPrediction>& laws) {
  VectorXd y = within_range(problem, x);
  std::optional<Difference> here = difference(problem, y, laws);
  // A parameter that the bodies hardly tell may run far with an old line: then part of the way.
  const bool arrived = here.has_value();
  for (int i = 0; i < kHalvings && !here; ++i) {
    y = 0.5 * (y + at_.x);
    here = difference(problem, y, laws);
  }
  if (y != x) problem.evaluate(x);
  if (!here) return std::nullopt;
  start_here();
  const VectorXd way = y - at_.x;
  const double share = way_to(problem, y);
  double off_sd = 0.0;
  Difference more = *here;
  for (std::size_t b = 0; b < at_.bodies.size(); ++b) {
    const EffectsAt::OnBody& body = at_.bodies[b];
    more.p.col(static_cast<Eigen::Index>(b)) -= body.p + body.p_by_x * way;
    more.tangent.col(static_cast<Eigen::Index>(b)) -= body.tangent + body.tangent_by_x * way;
  }
  for (const Observation& o : problem.observations()) {
    off_sd = std::max(off_sd, more.p.col(o.body).norm() / problem.position_sd(o));
    if (o.tangent) off_sd = std::max(off_sd, more.tangent.col(o.body).norm() / problem.tangent_sd(o));
  }
  off_sd_per_way_ = std::max(off_sd / std::max(share, kPolicy.effects.typical_way),
                             kPolicy.effects.forgets * off_sd_per_way_.value_or(0.0));
  if (share > kPolicy.effects.short_way) correct_derivative(problem, way, more);
  put_line(y, *here);
  return arrived ? off_sd : std::max(off_sd, kNotThere_sd);
}

void ExtendedFrame::correct_derivative(const Problem& problem, const VectorXd& way, const Difference& more) {
  const VectorXd far = reach(problem);
  VectorXd weight = VectorXd::Zero(way.size());
  for (int j = 0; j < problem.NumParameters(); ++j) {
    if (problem.free()[static_cast<std::size_t>(j)]) weight[j] = way[j] / (far[j] * far[j]);
  }
  const double square = weight.dot(way);
  if (!(square > kPolicy.effects.short_way * kPolicy.effects.short_way)) return;
  weight /= square;
  for (std::size_t b = 0; b < at_.bodies.size(); ++b) {
    at_.bodies[b].p_by_x += more.p.col(static_cast<Eigen::Index>(b)) * weight.transpose();
    at_.bodies[b].tangent_by_x += more.tangent.col(static_cast<Eigen::Index>(b)) * weight.transpose();
  }
}

double ExtendedFrame::errors_off_sd(const Problem& problem) const {
  double most = 0.0;
  if (at_.errors.isZero(0.0)) return most;
  for (const Observation& o : problem.observations()) {
    const EffectsAt::OnBody& body = at_.bodies[static_cast<std::size_t>(o.body)];
    most = std::max(most, (body.p_by_error * at_.errors).norm() / problem.position_sd(o));
  }
  return most;
}

bool ExtendedFrame::is_solved_near(const Problem& problem) const {
  if (!solved_x_) return false;
  return std::all_of(problem.observations().begin(), problem.observations().end(), [&](const Observation& o) {
    const double moved_m = (problem.position_by_laws(o) - solved_by_laws_.p.col(o.body)).norm();
    if (moved_m >= kPolicy.effects.agrees_sd * problem.position_sd(o)) return false;
    const Eigen::Vector3d tangent = model::tangent_of(problem.solver().station(o.body));
    const double turned = (tangent - solved_by_laws_.tangent.col(o.body)).norm();
    return !o.tangent || turned < kPolicy.effects.agrees_sd * problem.tangent_sd(o);
  });
}

bool ExtendedFrame::keep(const Problem& problem, const VectorXd& x,
                         const std::vector<arm::SegmentPrediction>& laws) {
  if (errors_off_sd(problem) >= kPolicy.effects.agrees_sd) {
    const VectorXd y = within_range(problem, x);
    solved_x_.reset();
    if (!online_.solve_leaning(at_.errors, segments_at(problem, y, laws),
                               Problem::kPayloadUnit * y[problem.payload_column()], turned(problem)))
      return false;
    solved_tip_ = problem.solver().q_tip();
  } else if (!is_solved_near(problem) && !solve(problem, within_range(problem, x), laws)) {
    return false;
  }
  online_.keep();
  near_tip_ = solved_tip_;
  return true;
}

}  // namespace softarm::estimate
