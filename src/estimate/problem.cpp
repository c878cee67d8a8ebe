#include "problem.h"

#include <algorithm>
#include <cmath>

#include "math/so3.h"
#include "model/arm_rod.h"
#include "model/body_kinematics.h"
#include "policy.h"

namespace softarm::estimate {
namespace {

using Eigen::Vector3d;

constexpr double kSumOfDistancesSmoothing = 1e-5;  // m: below it the distance is rounded to a parabola
constexpr double kRejected = 1e8;  // residual where the rod has no equilibrium: the step is refused
// A step this small in flexibility stands for none, where a moment is a curvature over a flexibility.
constexpr double kLeastFlexibility = 1e-6;
constexpr double kFarthestTurn_rad = 1.0;  // of the tip, that a step may ask for

/// The rod's parameters behind those of the fit: of the segments, then the payload.
std::vector<rod::Parameter> rod_parameters(const arm::Arm& arm, bool gravity) {
  std::vector<rod::Parameter> list = model::segment_parameters(arm);
  list.push_back({rod::ParameterKind::kLoadMass, rod::kPayloadLoad, 0});
  for (int c = 0; c < 3 && gravity; ++c) list.push_back({rod::ParameterKind::kGravity, 0, c});
  return list;
}

std::vector<double> stations(const arm::Arm& arm) {
  std::vector<double> list = model::body_stations(arm);
  double end = 0.0;
  for (const arm::Segment& segment : arm.segments) list.push_back(end += segment.length_m);
  return list;
}

bool has_constant_curvature(arm::Method method) {
  return method == arm::Method::kCcPoints || method == arm::Method::kCcEndpoint;
}

rod::Rod layout(const arm::Arm& arm, bool constant_curvature) {
  rod::Rod rod = rod::make_rod(arm);
  if (constant_curvature) {  // arcs are the shapes of a rod without load
    for (rod::Segment& segment : rod.segments) segment.mass_kg = 0.0;
    for (rod::PointLoad& load : rod.loads) load.mass_kg = 0.0;
  }
  return rod;
}

}  // namespace

Problem::Problem(const arm::Arm& arm, const arm::EstimatorOptions& options)
    : arm_(arm),
      options_(options),
      noise_weights_(options.weights ? *options.weights == arm::Weights::kNoise
                                     : options.objective == arm::Objective::kLeastSquares),
      constant_curvature_(has_constant_curvature(options.method)),
      free_(arm.segments.size() * kSegmentParameters + 1, true),
      rod_(layout(arm, constant_curvature_)),
      unactuated_(rod_),
      solver_(rod_, stations(arm), rod_parameters(arm, options.window_s > 0.0), model::solver_options(1e-9)),
      x_(Eigen::VectorXd::Zero(static_cast<int>(free_.size()))),
      last_x_(x_),
      anchor_{Eigen::Quaterniond::Identity(), x_, Eigen::Matrix3Xd::Zero(3, x_.size())},
      block_(Eigen::Matrix3Xd::Zero(3, static_cast<int>(free_.size()))) {
  accepted_x_ = x_;
  for (const arm::Segment& segment : arm.segments)
    reference_stiffness_.push_back(segment.bending_stiffness.base_nm2);
  const double placed = options.window_s > 0.0 && !constant_curvature_ ? 1.0 : 0.0;
  for (const arm::MeasuredBody& body : arm.bodies) {
    position_sd_.push_back(std::hypot(body.position_sd_m, placed * body.placement_sd_m));
    tangent_sd_.push_back(std::hypot(body.orientation_sd_rad, placed * body.placement_sd_rad));
  }
}

void Problem::set_laws(const std::optional<std::vector<arm::SegmentPrediction>>& predictions) {
  if (predictions) {
    rod::actuate(arm_, *predictions, rod_);
    return;
  }
  for (std::size_t i = 0; i < rod_.segments.size(); ++i) {
    const rod::Segment& rest = unactuated_.segments[i];
    rod_.segments[i].torsional_compliance = rest.torsional_compliance;
    rod_.segments[i].axial_compliance = rest.axial_compliance;
    rod_.segments[i].shear_compliance = rest.shear_compliance;
  }
}

void Problem::set_belief(const std::optional<Belief>& belief) {
  belief_ = belief;
  if (belief_) belief_rows_ = belief_->rows();
}

void Problem::begin() {
  valid_ = false;
  rod_solves_ = 0;
  rows_ = 0;
  for (const Observation& o : observations_) {
    if (o.used) rows_ += o.tangent ? 6 : 3;
  }
  if (belief_) rows_ += NumParameters();
  rows_ += static_cast<int>(arm_.segments.size()) + 1;
}

double Problem::paper_weight(const Observation& o) const {
  return 1.0 / ((o.body + 1) * arm_.total_length_m());
}

double Problem::position_weight(const Observation& o) const {
  // Laws that are believed would take what the bodies have in common for a body far off.
  if (noise_weights_) return 1.0 / (belief_ ? std::hypot(position_sd(o), displaced_sd(o)) : position_sd(o));
  // Least squares weights distances squared, the sum of distances weights distances: c_i in either.
  const double c = paper_weight(o) * arm_.total_length_m();
  return (options_.objective == arm::Objective::kSumOfDistances ? c : std::sqrt(c)) / position_sd(o);
}

double Problem::tangent_weight(const Observation& o) const {
  // Equation (8): C = L / (2 pi) weighs angles against distances; by the noise, their standard deviations do.
  return noise_weights_ ? 1.0 / tangent_sd(o) : position_weight(o) * arm_.total_length_m() / (2.0 * M_PI);
}

double Problem::bounded_influence(double distance) const {
  return options_.robust && distance > kPolicy.bodies.huber ? kPolicy.bodies.huber / distance : 1.0;
}

void Problem::apply(const Eigen::VectorXd& x) const {
  for (int i = 0; i < static_cast<int>(rod_.segments.size()); ++i) {
    rod::Segment& segment = rod_.segments[static_cast<std::size_t>(i)];
    const double rest = segment.rest_length_m;
    double flexibility = x[column(i, 2)];
    if (std::abs(flexibility) < kLeastFlexibility)
      flexibility = std::copysign(kLeastFlexibility, flexibility);
    segment.bending_compliance = flexibility / reference_stiffness(i);
    // Bending towards the azimuth (a, b) is a turn about (-b, a).
    segment.moment_nm =
        Vector3d(-x[column(i, 1)], x[column(i, 0)], 0.0) / (rest * segment.bending_compliance);
    segment.length_m = x[column(i, 3)] * rest;
  }
  rod_.loads[rod::kPayloadLoad].mass_kg = constant_curvature_ ? 0.0 : x[payload_column()] * kPayloadUnit;
}

bool Problem::evaluate(const Eigen::VectorXd& x, const std::optional<Eigen::Quaterniond>& q_tip_start) const {
  if (valid_ && !q_tip_start && x == last_x_) return true;
  apply(x);
  ++rod_solves_;
  rod::SolveStatus status = rod::SolveStatus::kNoConvergence;
  if (q_tip_start) {
    status = solver_.solve(rod_, *q_tip_start);
  } else if (anchored_) {
    // The tip turns as the last equilibrium says it would. A step too large for that is refused: the next is
    // smaller.
    if (const auto q_tip = anchor_.tip_at(x, kFarthestTurn_rad)) status = solver_.solve(rod_, *q_tip);
    // The way back from a refused step may be longer than the step was.
    if (status != rod::SolveStatus::kConverged && x == accepted_x_)
      status = solver_.solve(rod_, accepted_tip_);
  } else {
    status = solver_.solve(rod_);
  }
  valid_ = status == rod::SolveStatus::kConverged;
  if (valid_) {
    last_x_ = x;
    anchored_ = true;
    anchor_.x = x;
    anchor_.q_tip = solver_.q_tip();
    chain(solver_.drotation_tip(), anchor_.tip_by_x);
  }
  return valid_;
}

void Problem::chain(const Eigen::Ref<const Eigen::Matrix3Xd>& by_rod, Eigen::Matrix3Xd& by_x) const {
  by_x.setZero();
  for (int i = 0; i < static_cast<int>(rod_.segments.size()); ++i) {
    const rod::Segment& segment = rod_.segments[static_cast<std::size_t>(i)];
    const int first = i * model::kSegmentColumns;
    const double curvature_to_moment = 1.0 / (segment.rest_length_m * segment.bending_compliance);
    by_x.col(column(i, 0)) = curvature_to_moment * by_rod.col(first + model::kMomentY);
    by_x.col(column(i, 1)) = -curvature_to_moment * by_rod.col(first + model::kMomentX);
    // At a given actuation curvature a more flexible segment has a smaller moment.
    by_x.col(column(i, 2)) = (by_rod.col(first + model::kBendingCompliance) -
                              (segment.moment_nm.x() * by_rod.col(first + model::kMomentX) +
                               segment.moment_nm.y() * by_rod.col(first + model::kMomentY)) /
                                  segment.bending_compliance) /
                             reference_stiffness(i);
    by_x.col(column(i, 3)) = segment.rest_length_m * by_rod.col(first + model::kLengthColumn);
  }
  by_x.col(payload_column()) = constant_curvature_
                                   ? Vector3d(Vector3d::Zero())
                                   : Vector3d(kPayloadUnit * by_rod.col(rod_payload_column()));
  for (int j = 0; j < by_x.cols(); ++j) {
    if (!free_[static_cast<std::size_t>(j)]) by_x.col(j).setZero();
  }
}

Vector3d Problem::position(const Observation& o) const {
  if (effects_ == nullptr) return position_by_laws(o);
  const EffectsAt::OnBody& effect = effects_->bodies[static_cast<std::size_t>(o.body)];
  return position_by_laws(o) + effect.p + effect.p_by_x * (last_x_ - effects_->x) +
         effect.p_by_error * effects_->errors;
}

Vector3d Problem::tangent(const Observation& o) const {
  const Vector3d by_laws = model::tangent_of(solver_.station(o.body));
  if (effects_ == nullptr) return by_laws;
  const EffectsAt::OnBody& effect = effects_->bodies[static_cast<std::size_t>(o.body)];
  return (by_laws + effect.tangent + effect.tangent_by_x * (last_x_ - effects_->x) +
          effect.tangent_by_error * effects_->errors)
      .normalized();
}

Vector3d Problem::measured_for_laws(const Observation& o) const {
  if (effects_ == nullptr) return o.p;
  const EffectsAt::OnBody& effect = effects_->bodies[static_cast<std::size_t>(o.body)];
  return o.p - effect.p - effect.p_by_error * effects_->errors;
}

Vector3d Problem::tangent_for_laws(const Observation& o) const {
  if (effects_ == nullptr) return *o.tangent;
  return (*o.tangent - effects_->bodies[static_cast<std::size_t>(o.body)].tangent).normalized();
}

Vector3d Problem::position_by_laws(const Observation& o) const {
  return model::position_on(body_of(o), solver_.station(o.body));
}

Eigen::Index Problem::errors() const {
  return (effects_ == nullptr ? 0 : effects_->errors.size()) +
         (motion_ == nullptr || motion_->p.empty() ? 0 : motion_->p[0].cols());
}

Eigen::Matrix3Xd Problem::position_by_errors(const Observation& o, const Eigen::Matrix3Xd& j) const {
  const auto body = static_cast<std::size_t>(o.body);
  Eigen::Matrix3Xd by(3, errors());
  if (effects_ != nullptr && effects_->errors.size() > 0)
    by.leftCols(effects_->errors.size()) = j * effects_->errors_as_x + effects_->bodies[body].p_beyond_x;
  if (motion_ != nullptr && !motion_->p.empty()) by.rightCols(motion_->p[body].cols()) = motion_->p[body];
  return by;
}

Eigen::Matrix3Xd Problem::tangent_by_errors(const Observation& o, const Eigen::Matrix3Xd& j) const {
  const auto body = static_cast<std::size_t>(o.body);
  Eigen::Matrix3Xd by(3, errors());
  if (effects_ != nullptr && effects_->errors.size() > 0)
    by.leftCols(effects_->errors.size()) =
        j * effects_->errors_as_x + effects_->bodies[body].tangent_beyond_x;
  if (motion_ != nullptr && !motion_->tangent.empty())
    by.rightCols(motion_->tangent[body].cols()) = motion_->tangent[body];
  return by;
}

double Problem::displaced_sd(const Observation& o) const {
  const auto body = static_cast<std::size_t>(o.body);
  double square = 0.0;
  if (effects_ != nullptr) square += effects_->bodies[body].p_by_error.squaredNorm();
  if (motion_ != nullptr && !motion_->p.empty()) square += motion_->p[body].squaredNorm();
  return std::sqrt(square / 3.0);
}

void Problem::position_jacobian_by_laws(const Observation& o, Eigen::Matrix3Xd& j) const {
  if (model::is_off_axis(body_of(o))) {
    chain(model::position_by_rod(body_of(o), o.body, solver_), j);
  } else {  // the same without a copy
    chain(solver_.dp(o.body), j);
  }
}

void Problem::position_jacobian(const Observation& o, Eigen::Matrix3Xd& j) const {
  position_jacobian_by_laws(o, j);
  if (effects_ != nullptr) add_free(effects_->bodies[static_cast<std::size_t>(o.body)].p_by_x, j);
}

void Problem::add_free(const Eigen::Matrix3Xd& by_x, Eigen::Matrix3Xd& j) const {
  for (int k = 0; k < j.cols(); ++k) {
    if (free_[static_cast<std::size_t>(k)]) j.col(k) += by_x.col(k);
  }
}

Vector3d Problem::position_by_payload(const Observation& o) const {
  if (model::is_off_axis(body_of(o)))
    return model::position_by_rod(body_of(o), o.body, solver_).col(rod_payload_column());
  return solver_.dp(o.body).col(rod_payload_column());
}

Vector3d Problem::tangent_by_payload(const Observation& o) const {
  const Eigen::Matrix3Xd turned = solver_.drotation(o.body).col(rod_payload_column());
  return model::tangent_derivative(solver_.station(o.body), turned);
}

Eigen::Matrix3d Problem::position_by_gravity(const Observation& o) const {
  if (model::is_off_axis(body_of(o)))
    return model::position_by_rod(body_of(o), o.body, solver_).rightCols<3>();
  return solver_.dp(o.body).rightCols<3>();
}

Eigen::Matrix3d Problem::tangent_by_gravity(const Observation& o) const {
  return model::tangent_derivative(solver_.station(o.body), solver_.drotation(o.body).rightCols<3>());
}

void Problem::tangent_jacobian_by_laws(const Observation& o, Eigen::Matrix3Xd& j) const {
  chain(solver_.drotation(o.body), j);
  j = model::tangent_derivative(solver_.station(o.body), j);
}

void Problem::tangent_jacobian(const Observation& o, Eigen::Matrix3Xd& j) const {
  tangent_jacobian_by_laws(o, j);
  if (effects_ != nullptr) add_free(effects_->bodies[static_cast<std::size_t>(o.body)].tangent_by_x, j);
}

template <typename Columns>
void Problem::add_block(const Vector3d& e, const Columns& de, double weight, bool robust, int row,
                        double* residuals, double* jacobian) const {
  // The block is weight * e; rho(s) is its cost as a function of the squared norm s. With h = sqrt(rho / s)
  // the block h * weight * e has the squared norm rho, and the derivative h (I + 2 h'/h w e (w e)^T) w de.
  const Vector3d f = weight * e;
  const double s = f.squaredNorm();
  double h = 1.0, slope = 0.0;  // slope = 2 h' / h
  if (options_.objective == arm::Objective::kSumOfDistances) {
    const double smoothing = kSumOfDistancesSmoothing * weight;
    const double root = std::sqrt(s + smoothing * smoothing);
    // rho = 2 (root - smoothing) = 2 s / (root + smoothing)
    const double rho_over_s = 2.0 / (root + smoothing);
    h = std::sqrt(rho_over_s);
    slope = -0.5 / (root * (root + smoothing));  // d ln(rho / s) / ds
  } else if (robust && s > kPolicy.bodies.huber * kPolicy.bodies.huber) {
    const double root = std::sqrt(s);
    const double rho = 2.0 * kPolicy.bodies.huber * root - kPolicy.bodies.huber * kPolicy.bodies.huber;
    h = std::sqrt(rho / s);
    slope = kPolicy.bodies.huber / (root * rho) - 1.0 / s;
  }
  Eigen::Map<Vector3d> out(residuals + row);
  out = h * f;
  if (jacobian == nullptr) return;
  const double scale = h * weight;
  for (int j = 0; j < de.cols(); ++j) {
    const Vector3d d = de.col(j);
    Eigen::Map<Vector3d>(jacobian + j * rows_ + row) = scale * (d + slope * f.dot(d) * f);
  }
}

bool Problem::operator()(const double* x, double* residuals, double* jacobian) const {
  x_ = Eigen::Map<const Eigen::VectorXd>(x, NumParameters());
  if (!evaluate(x_)) {
    std::fill(residuals, residuals + rows_, kRejected);
    if (jacobian != nullptr) std::fill(jacobian, jacobian + rows_ * NumParameters(), 0.0);
    return true;
  }
  if (jacobian != nullptr) {
    accepted_x_ = x_;
    accepted_tip_ = solver_.q_tip();
  }
  int row = 0;
  for (const Observation& o : observations_) {
    if (!o.used) continue;
    if (jacobian != nullptr) position_jacobian(o, block_);
    add_block(position(o) - o.p, block_, position_weight(o), options_.robust, row, residuals, jacobian);
    row += 3;
    if (o.tangent) {
      if (jacobian != nullptr) tangent_jacobian(o, block_);
      add_block(tangent(o) - *o.tangent, block_, tangent_weight(o), options_.robust, row, residuals,
                jacobian);
      row += 3;
    }
  }
  if (belief_) {
    const int count = NumParameters();
    Eigen::Map<Eigen::VectorXd>(residuals + row, count) = belief_rows_ * (x_ - belief_->mean);
    if (jacobian != nullptr) {
      Eigen::Map<Eigen::MatrixXd> j(jacobian, rows_, count);
      for (int k = 0; k < count; ++k) {
        if (free_[static_cast<std::size_t>(k)])
          j.block(row, k, count, 1) = belief_rows_.col(k);
        else
          j.block(row, k, count, 1).setZero();
      }
    }
    row += count;
  }
  const auto weak = [&](int j, double offset, double sd) {
    const bool on = free_[static_cast<std::size_t>(j)];
    residuals[row] = on ? (x_[j] - offset) / sd : 0.0;
    if (jacobian != nullptr) {
      for (int k = 0; k < NumParameters(); ++k) jacobian[k * rows_ + row] = 0.0;
      if (on) jacobian[j * rows_ + row] = 1.0 / sd;
    }
    ++row;
  };
  for (int i = 0; i < static_cast<int>(arm_.segments.size()); ++i)
    weak(column(i, 2), 1.0, kPolicy.fit.weak_flexibility_sd);
  weak(payload_column(), 0.0, kPolicy.fit.weak_payload_sd_kg / kPayloadUnit);
  return true;
}

bool Problem::evaluate_free_tip(const double* x, const Eigen::Quaterniond& q_tip, double base_sd_rad,
                                double* residuals, double* jacobian, int rows) const {
  const int count = NumParameters();
  valid_ = false;
  x_ = Eigen::Map<const Eigen::VectorXd>(x, count);
  apply(x_);
  if (solver_.shoot(rod_, q_tip) != rod::SolveStatus::kConverged) return false;
  Eigen::Map<Eigen::VectorXd> r(residuals, rows);
  Eigen::Map<Eigen::MatrixXd> j(jacobian, rows, count + 3);
  const auto put = [&](int row, const Vector3d& e, const Eigen::Matrix3Xd& by_x,
                       const Eigen::Matrix3d& by_tip, double weight) {
    r.segment<3>(row) = weight * e;
    if (jacobian == nullptr) return;
    j.block(row, 0, 3, count) = weight * by_x;
    j.block<3, 3>(row, count) = weight * by_tip;
  };
  int row = 0;
  for (const Observation& o : observations_) {
    if (!o.used) continue;
    // Rings and markers alike by the backbone's place: this is only a way to a start.
    chain(solver_.dp(o.body), block_);
    put(row, solver_.station(o.body).p - measured_for_laws(o), block_, solver_.dp_by_tip(o.body),
        1.0 / position_sd(o));
    row += 3;
    if (o.tangent) {  // as if the body sat at the tip, which for end_orientation it does
      const Vector3d tangent = solver_.station(o.body).q * Vector3d::UnitZ();
      chain(solver_.drotation(o.body), block_);
      put(row, tangent - tangent_for_laws(o), -math::skew(tangent) * block_, -math::skew(tangent),
          1.0 / tangent_sd(o));
      row += 3;
    }
  }
  chain(solver_.dbase(), block_);
  put(row, solver_.base_error(), block_,
      math::left_jacobian_inverse(solver_.base_error()) * solver_.base_per_tip_rotation(), 1.0 / base_sd_rad);
  row += 3;
  // The flexibility stays near its start unless the shape says otherwise.
  for (int i = 0; i < static_cast<int>(rod_.segments.size()); ++i) {
    r[row] = x_[column(i, 2)] - 1.0;
    if (jacobian != nullptr) {
      j.row(row).setZero();
      if (free_[static_cast<std::size_t>(column(i, 2))]) j(row, column(i, 2)) = 1.0;
    }
    ++row;
  }
  return true;
}

}  // namespace softarm::estimate
