#include "law_model.h"

#include <algorithm>
#include <cmath>

#include "model/body_kinematics.h"
#include "softarm/arm/laws.h"

namespace softarm::identify {
namespace {

using rod::ParameterKind;

constexpr double kWarmTurn_rad = 0.5;  // a tip predicted to turn further is solved from nothing

/// Rod parameters that the laws or the constants change; the first four of a segment always.
std::vector<rod::Parameter> rod_parameters(const arm::Arm& arm, const std::vector<ConstantRef>& constants) {
  std::vector<rod::Parameter> list = model::segment_parameters(arm);
  const auto add = [&](ParameterKind kind, int segment, int component) {
    for (const rod::Parameter& p : list) {
      if (p.kind == kind && p.index == segment && p.component == component) return;
    }
    list.push_back({kind, segment, component});
  };
  const auto add_for = [&](const ConstantRef& constant, int i) {
    const arm::Segment& segment = arm.segments[static_cast<std::size_t>(i)];
    const unsigned moves = arm::spec_of(constant.kind).moves;
    const bool modulus = (moves & arm::kMovesModulus) != 0;
    if (modulus && segment.axial_stiffness_n) add(ParameterKind::kAxialCompliance, i, 0);
    if ((modulus || (moves & arm::kMovesTwist) != 0) && segment.torsional_stiffness_nm2)
      add(ParameterKind::kTorsionalCompliance, i, 0);
    if (modulus && segment.shear_stiffness_n) add(ParameterKind::kShearCompliance, i, 0);
    if ((moves & arm::kMovesJoint) != 0) add(ParameterKind::kJointCompliance, i, 0);
    if ((moves & arm::kMovesRestX) != 0) add(ParameterKind::kRestCurvature, i, 0);
    if ((moves & arm::kMovesRestY) != 0) add(ParameterKind::kRestCurvature, i, 1);
  };
  for (const ConstantRef& constant : constants) {
    for (const int i : segments_of(constant)) add_for(constant, i);
  }
  return list;
}

/// What inputs do not change.
void put_constants(const arm::Arm& arm, rod::Rod& rod) {
  for (std::size_t i = 0; i < rod.segments.size(); ++i) {
    rod.segments[i].rest_curvature_per_m = arm.segments[i].rest_curvature_per_m;
    rod.segments[i].joint_compliance = arm.segments[i].joint_compliance_rad_per_nm.value_or(0.0);
  }
}

}  // namespace

LawModel::LawModel(const arm::Arm& arm, const std::vector<ConstantRef>& constants)
    : constants_(constants),
      bodies_(arm.bodies),
      arm_(arm),
      parameters_(rod_parameters(arm, constants)),
      rod_(rod::make_rod(arm)),
      solver_(rod_, model::body_stations(arm), parameters_, model::solver_options(1e-9)),
      rod_by_theta_(static_cast<int>(parameters_.size()), static_cast<int>(constants.size())),
      laws_by_theta_(kLaws * static_cast<int>(arm.segments.size()), static_cast<int>(constants.size())) {
  std::vector<double> sd;
  for (const arm::Segment& segment : arm.segments) {
    const Eigen::VectorXd own = arm::WallMemory(segment).start_sd();
    sd.insert(sd.end(), own.data(), own.data() + own.size());
  }
  start_sd_ = Eigen::Map<const Eigen::VectorXd>(sd.data(), static_cast<Eigen::Index>(sd.size()));
}

void LawModel::set_start(std::size_t trial, const Eigen::VectorXd& start) {
  starts_[trial] = start;
  walks_.erase(trial);
}

void LawModel::set(const Eigen::VectorXd& theta) {
  theta_ = theta;
  walks_.clear();
  for (std::size_t j = 0; j < constants_.size(); ++j) {
    const ConstantRef& constant = constants_[j];
    // In the fit a length changes what the laws say of it; the layout of the rod, which carries the bodies
    // along, keeps the arm's own: hence not set_value().
    for (const int i : segments_of(constant))
      arm::spec_of(constant.kind)
          .set(arm_.segments[static_cast<std::size_t>(i)], constant.index, theta[static_cast<int>(j)]);
  }
}

bool LawModel::apply(const trial::StaticFrame& frame) {
  const arm::InputReader inputs(arm_, frame.inputs);
  responses_.clear();
  laws_.clear();
  for (const arm::Segment& segment : arm_.segments) {
    const auto response = arm::respond(segment, inputs);
    if (!response) return false;
    responses_.push_back(*response);
    laws_.push_back(response->prediction);
  }
  walked_ = nullptr;
  if (frame.drive && start_sd_.size() > 0 && !keep_back(frame)) return false;
  rod_.gravity_m_s2 = frame.gravity_base;
  rod_.loads[rod::kPayloadLoad].mass_kg = frame.payload_kg;
  rod::actuate(arm_, laws_, rod_);
  put_constants(arm_, rod_);
  rod_by_theta_.setZero();
  laws_by_theta_.setZero();
  for (std::size_t j = 0; j < constants_.size(); ++j) {
    for (const int i : segments_of(constants_[j])) {
      if (!differentiate(inputs, static_cast<int>(j), i)) return false;
    }
  }
  return true;
}

double LawModel::parameter_derivative(const rod::Parameter& which, const arm::SegmentDerivative& by) const {
  const auto index = static_cast<std::size_t>(which.index);
  const arm::Segment& segment = arm_.segments[index];
  const rod::Segment& rod = rod_.segments[index];
  const arm::SegmentPrediction& p = by.prediction;
  const auto compliance = [](double value, double stiffness) { return -value * value * stiffness; };
  switch (which.kind) {
    case ParameterKind::kMoment: {
      // Bending towards phi is a turn about the axis at phi + 90 degrees.
      const Eigen::Vector2d actuation = by.actuation_nm(laws_[index]);
      return which.component == 0 ? -actuation.y() : actuation.x();
    }
    case ParameterKind::kBendingCompliance:
      return compliance(rod.bending_compliance, p.bending_stiffness_nm2);
    case ParameterKind::kTorsionalCompliance:
      return compliance(
          rod.torsional_compliance,
          segment.torsional_stiffness_nm2.value_or(0.0) * p.modulus_ratio + p.tendon_torsional_stiffness_nm2);
    case ParameterKind::kAxialCompliance:
      return compliance(rod.axial_compliance, by.axial_stiffness_n * laws_[index].modulus_ratio +
                                                  segment.axial_stiffness_n.value_or(0.0) * p.modulus_ratio);
    case ParameterKind::kShearCompliance:
      return compliance(rod.shear_compliance, segment.shear_stiffness_n.value_or(0.0) * p.modulus_ratio +
                                                  p.tendon_shear_stiffness_n);
    case ParameterKind::kJointCompliance:
      return by.joint_compliance_rad_per_nm;
    case ParameterKind::kLength:
      return p.length_m;
    default:
      return by.rest_curvature_per_m[which.component];
  }
}

std::optional<arm::SegmentDerivative> LawModel::by_constant(const ConstantRef& constant, std::size_t segment,
                                                            const arm::SegmentResponse& at,
                                                            const arm::InputReader& inputs) const {
  arm::Change change;
  if (!arm::spec_of(constant.kind).change(arm_.segments[segment], constant.index, inputs, change))
    return std::nullopt;
  return arm::differentiate(arm_.segments[segment], at, change);
}

bool LawModel::differentiate(const arm::InputReader& inputs, int column, int index) {
  const auto i = static_cast<std::size_t>(index);
  const ConstantRef& constant = constants_[static_cast<std::size_t>(column)];
  std::optional<arm::SegmentDerivative> by = by_constant(constant, i, responses_[i], inputs);
  if (!by) return false;
  if (walked_ != nullptr) arm::take_off(walked_->by[instant_].block<3, 1>(3 * index, column), by->prediction);
  for (std::size_t r = 0; r < parameters_.size(); ++r) {
    if (parameters_[r].index == index)
      rod_by_theta_(static_cast<int>(r), column) += parameter_derivative(parameters_[r], *by);
  }
  const Eigen::Vector2d moment = by->actuation_nm(laws_[i]);
  laws_by_theta_.col(column).segment<kLaws>(kLaws * index) += Eigen::Vector4d(
      moment.x(), moment.y(), by->prediction.bending_stiffness_nm2 / laws_[i].bending_stiffness_nm2,
      by->prediction.length_m);
  return true;
}

void LawModel::body_derivative(int body, const Eigen::MatrixXd& rod_by_x, Eigen::Ref<Eigen::MatrixXd> dp,
                               Eigen::Ref<Eigen::MatrixXd> dtangent) const {
  dp = model::position_by_rod(bodies_[static_cast<std::size_t>(body)], body, solver_) * rod_by_x;
  dtangent = model::tangent_by_rod(body, solver_) * rod_by_x;
}

bool LawModel::predict(const trial::StaticFrame& frame, std::optional<model::Equilibrium>& state,
                       Prediction& out) {
  if (!apply(frame)) return false;
  rod::SolveStatus status = rod::SolveStatus::kNoConvergence;
  if (state) {
    if (const auto q_tip = state->tip_at(theta_, kWarmTurn_rad)) status = solver_.solve(rod_, *q_tip);
  }
  if (status != rod::SolveStatus::kConverged) status = solver_.solve(rod_);
  if (status != rod::SolveStatus::kConverged) return false;
  state = {solver_.q_tip(), theta_, solver_.drotation_tip() * rod_by_theta_};

  const int count = static_cast<int>(frame.bodies.size());
  const int constants = static_cast<int>(constants_.size());
  out.p.resize(3, count);
  out.tangent.resize(3, count);
  out.dp.resize(3 * count, constants);
  out.dtangent.resize(3 * count, constants);
  const Eigen::MatrixXd by_start = rod_by_start();
  out.dp_by_start.resize(3 * count, by_start.cols());
  out.dtangent_by_start.resize(3 * count, by_start.cols());
  for (int k = 0; k < count; ++k) {
    const int body = frame.bodies[static_cast<std::size_t>(k)].body;
    const arm::MeasuredBody& measured = bodies_[static_cast<std::size_t>(body)];
    const rod::RodState& at = solver_.station(body);
    out.p.col(k) = model::position_on(measured, at);
    out.tangent.col(k) = model::tangent_of(at);
    if (walked_ != nullptr)
      body_derivative(body, by_start, out.dp_by_start.middleRows(3 * k, 3),
                      out.dtangent_by_start.middleRows(3 * k, 3));
    body_derivative(body, rod_by_theta_, out.dp.middleRows(3 * k, 3), out.dtangent.middleRows(3 * k, 3));
  }
  out.laws.resize(kLaws * static_cast<int>(laws_.size()));
  for (std::size_t i = 0; i < laws_.size(); ++i) {
    const Eigen::Vector2d moment = laws_[i].actuation_nm();
    out.laws.segment<kLaws>(kLaws * static_cast<int>(i)) << moment.x(), moment.y(),
        std::log(laws_[i].bending_stiffness_nm2), laws_[i].length_m;
  }
  out.dlaws = laws_by_theta_;
  out.near_buckling = model::near_buckling(solver_);
  return true;
}

std::optional<Eigen::VectorXd> LawModel::laws_of(const arm::InputValues& inputs) const {
  Eigen::VectorXd laws(kLaws * static_cast<int>(arm_.segments.size()));
  for (std::size_t i = 0; i < arm_.segments.size(); ++i) {
    const auto response = arm::respond(arm_.segments[i], arm::InputReader(arm_, inputs));
    if (!response) return std::nullopt;
    const Eigen::Vector2d moment = response->prediction.actuation_nm();
    laws.segment<kLaws>(kLaws * static_cast<int>(i)) << moment.x(), moment.y(),
        std::log(response->prediction.bending_stiffness_nm2), response->prediction.length_m;
  }
  return laws;
}

Eigen::MatrixXd LawModel::laws_by_inputs(const trial::StaticFrame& frame,
                                         const Eigen::VectorXd& steps) const {
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(kLaws * static_cast<int>(arm_.segments.size()), steps.size());
  for (int k = 0; k < steps.size(); ++k) {
    const auto input = static_cast<std::size_t>(k);
    if (!(steps[k] > 0.0) || input >= frame.inputs.size() || !frame.inputs[input]) continue;
    arm::InputValues low = frame.inputs, high = frame.inputs;
    low[input] = *low[input] - steps[k];
    high[input] = *high[input] + steps[k];
    const auto before = laws_of(low), after = laws_of(high);
    if (before && after) by.col(k) = (*after - *before) / (2.0 * steps[k]);
  }
  return by;
}

void LawModel::derivative_by_laws(const trial::StaticFrame& frame, Eigen::MatrixXd& dp,
                                  Eigen::MatrixXd& dtangent) const {
  const int columns = kLaws * static_cast<int>(laws_.size());
  Eigen::MatrixXd rod_by_laws = Eigen::MatrixXd::Zero(static_cast<int>(parameters_.size()), columns);
  for (int i = 0; i < static_cast<int>(laws_.size()); ++i) {
    // The order of rod_parameters(). Bending towards the azimuth (a, b) is a turn about (-b, a).
    const int column = kLaws * i;
    rod_by_laws(column + model::kMomentY, column) = 1.0;
    rod_by_laws(column + model::kMomentX, column + 1) = -1.0;
    rod_by_laws(column + model::kBendingCompliance, column + 2) =
        -rod_.segments[static_cast<std::size_t>(i)].bending_compliance;
    rod_by_laws(column + model::kLengthColumn, column + 3) = 1.0;
  }
  const int count = static_cast<int>(frame.bodies.size());
  dp.resize(3 * count, columns);
  dtangent.resize(3 * count, columns);
  for (int k = 0; k < count; ++k) {
    body_derivative(frame.bodies[static_cast<std::size_t>(k)].body, rod_by_laws, dp.middleRows(3 * k, 3),
                    dtangent.middleRows(3 * k, 3));
  }
}

}  // namespace softarm::identify
