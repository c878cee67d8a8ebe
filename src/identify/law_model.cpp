#include "law_model.h"

#include <cmath>

#include "math/so3.h"
#include "model/body_kinematics.h"
#include "softarm/arm/laws.h"

namespace softarm::identify {
namespace {

using Eigen::Vector3d;
using rod::ParameterKind;

constexpr double kWarmTurn_rad = 0.5;  // a tip predicted to turn further is solved from nothing

/// Rod parameters that the laws or the constants change; the first four of a segment always.
std::vector<rod::Parameter> rod_parameters(const arm::Arm& arm, const std::vector<ConstantRef>& constants) {
  std::vector<rod::Parameter> list;
  for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
    list.push_back({ParameterKind::kMoment, i, 0});
    list.push_back({ParameterKind::kMoment, i, 1});
    list.push_back({ParameterKind::kBendingCompliance, i, 0});
    list.push_back({ParameterKind::kLength, i, 0});
  }
  const auto add = [&](ParameterKind kind, int segment, int component) {
    for (const rod::Parameter& p : list) {
      if (p.kind == kind && p.index == segment && p.component == component) return;
    }
    list.push_back({kind, segment, component});
  };
  const auto add_for = [&](const ConstantRef& constant, int i) {
    const arm::Segment& segment = arm.segments[static_cast<std::size_t>(i)];
    if (constant.kind == ConstantKind::kTendonOffset && segment.torsional_stiffness_nm2)
      add(ParameterKind::kTorsionalCompliance, i, 0);
    if (constant.kind == ConstantKind::kAxialStiffness) {
      add(ParameterKind::kAxialCompliance, i, 0);
      // The modulus goes with the stretch.
      if (segment.torsional_stiffness_nm2) add(ParameterKind::kTorsionalCompliance, i, 0);
      if (segment.shear_stiffness_n) add(ParameterKind::kShearCompliance, i, 0);
    }
    if (constant.kind == ConstantKind::kRestCurvatureX) add(ParameterKind::kRestCurvature, i, 0);
    if (constant.kind == ConstantKind::kRestCurvatureY) add(ParameterKind::kRestCurvature, i, 1);
  };
  for (const ConstantRef& constant : constants) {
    for (const int i : segments_of(constant)) add_for(constant, i);
  }
  return list;
}

std::vector<double> stations(const arm::Arm& arm) {
  std::vector<double> list;
  for (const arm::MeasuredBody& body : arm.bodies) list.push_back(body.arclength_m);
  return list;
}

rod::SolverOptions solver_options() {
  rod::SolverOptions options;
  options.linear_correction_rad = 1e-4;
  options.orientation_tolerance_rad = 1e-9;
  options.position_tolerance = 1e-6;
  return options;
}

/// In the fit a length changes what the laws say of it; the layout of the rod, which carries the bodies
/// along, keeps the arm's own.
void set_law(arm::Arm& arm, const ConstantRef& constant, double value) {
  if (constant.kind == ConstantKind::kLength) {
    for (const int i : segments_of(constant)) arm.segments[static_cast<std::size_t>(i)].length_m = value;
  } else {
    set_value(arm, constant, value);
  }
}

void put_rest_curvature(const arm::Arm& arm, rod::Rod& rod) {
  for (std::size_t i = 0; i < rod.segments.size(); ++i)
    rod.segments[i].rest_curvature_per_m = arm.segments[i].rest_curvature_per_m;
}

}  // namespace

LawModel::LawModel(const arm::Arm& arm, const std::vector<ConstantRef>& constants,
                   const Eigen::VectorXd& step)
    : constants_(constants),
      step_(step),
      bodies_(arm.bodies),
      arm_(arm),
      above_(constants.size(), arm),
      below_(constants.size(), arm),
      parameters_(rod_parameters(arm, constants)),
      rod_(rod::make_rod(arm)),
      varied_(rod_),
      solver_(rod_, stations(arm), parameters_, solver_options()),
      rod_by_theta_(static_cast<int>(parameters_.size()), static_cast<int>(constants.size())),
      laws_by_theta_(kLaws * static_cast<int>(arm.segments.size()), static_cast<int>(constants.size())) {}

void LawModel::set(const Eigen::VectorXd& theta) {
  theta_ = theta;
  for (std::size_t j = 0; j < constants_.size(); ++j) {
    const int column = static_cast<int>(j);
    set_law(arm_, constants_[j], theta[column]);
    for (std::size_t k = 0; k < constants_.size(); ++k) {
      set_law(above_[k], constants_[j], theta[column] + (j == k ? step_[column] : 0.0));
      set_law(below_[k], constants_[j], theta[column] - (j == k ? step_[column] : 0.0));
    }
  }
}

double LawModel::parameter(const rod::Rod& rod, const rod::Parameter& which) const {
  const rod::Segment& segment = rod.segments[static_cast<std::size_t>(which.index)];
  switch (which.kind) {
    case ParameterKind::kMoment:
      return segment.moment_nm[which.component];
    case ParameterKind::kBendingCompliance:
      return segment.bending_compliance;
    case ParameterKind::kTorsionalCompliance:
      return segment.torsional_compliance;
    case ParameterKind::kAxialCompliance:
      return segment.axial_compliance;
    case ParameterKind::kShearCompliance:
      return segment.shear_compliance;
    case ParameterKind::kLength:
      return segment.length_m;
    default:
      return segment.rest_curvature_per_m[which.component];
  }
}

bool LawModel::apply(const trial::StaticFrame& frame) {
  auto laws = softarm::arm::predict(arm_, frame.inputs);
  if (!laws) return false;
  laws_ = *laws;
  rod_.gravity_m_s2 = frame.gravity_base;
  rod_.loads[rod::kPayloadLoad].mass_kg = frame.payload_kg;
  rod::actuate(arm_, laws_, rod_);
  put_rest_curvature(arm_, rod_);
  rod_by_theta_.setZero();
  laws_by_theta_.setZero();
  for (std::size_t j = 0; j < constants_.size(); ++j) {
    for (const int i : segments_of(constants_[j])) {
      if (!differentiate(frame, static_cast<int>(j), i, *laws)) return false;
    }
  }
  return true;
}

bool LawModel::differentiate(const trial::StaticFrame& frame, int column, int index,
                             std::vector<arm::SegmentPrediction>& laws) {
  const auto j = static_cast<std::size_t>(column), segment = static_cast<std::size_t>(index);
  const double sides[2] = {1.0, -1.0};
  for (const double side : sides) {
    const arm::Arm& arm = side > 0.0 ? above_[j] : below_[j];
    const auto varied = arm::predict_segment(arm, arm.segments[segment], frame.inputs);
    if (!varied) return false;
    laws[segment] = *varied;
    rod::actuate(arm, laws, varied_);
    put_rest_curvature(arm, varied_);
    laws[segment] = laws_[segment];
    const double weight = side / (2.0 * step_[column]);
    for (std::size_t r = 0; r < parameters_.size(); ++r) {
      if (parameters_[r].index == index)
        rod_by_theta_(static_cast<int>(r), column) += weight * parameter(varied_, parameters_[r]);
    }
    const Eigen::Vector2d moment = varied->actuation_nm();
    laws_by_theta_.col(column).segment<kLaws>(kLaws * index) +=
        weight *
        Eigen::Vector4d(moment.x(), moment.y(), std::log(varied->bending_stiffness_nm2), varied->length_m);
  }
  return true;
}

void LawModel::body_derivative(int body, const Eigen::MatrixXd& rod_by_x, Eigen::Ref<Eigen::MatrixXd> dp,
                               Eigen::Ref<Eigen::MatrixXd> dtangent) const {
  const arm::MeasuredBody& measured = bodies_[static_cast<std::size_t>(body)];
  const rod::RodState& state = solver_.station(body);
  const Eigen::MatrixXd turn = solver_.drotation(body) * rod_by_x;
  Eigen::Matrix3Xd position = solver_.dp(body) * rod_by_x;
  model::carry_position(measured, state, turn, position);
  dp = position;
  dtangent = model::tangent_derivative(state, turn);
}

bool LawModel::predict(const trial::StaticFrame& frame, std::optional<Equilibrium>& state, Prediction& out) {
  if (!apply(frame)) return false;
  rod::SolveStatus status = rod::SolveStatus::kNoConvergence;
  if (state) {
    const Vector3d turn = state->tip_by_theta * (theta_ - state->theta);
    if (turn.norm() < kWarmTurn_rad)
      status = solver_.solve(rod_, (math::exp_so3(turn) * state->q_tip).normalized());
  }
  if (status != rod::SolveStatus::kConverged) status = solver_.solve(rod_);
  if (status != rod::SolveStatus::kConverged) return false;
  if (!state) state.emplace();
  state->q_tip = solver_.q_tip();
  state->theta = theta_;
  state->tip_by_theta = solver_.drotation_tip() * rod_by_theta_;

  const int count = static_cast<int>(frame.bodies.size());
  const int constants = static_cast<int>(constants_.size());
  out.p.resize(3, count);
  out.tangent.resize(3, count);
  out.dp.resize(3 * count, constants);
  out.dtangent.resize(3 * count, constants);
  for (int k = 0; k < count; ++k) {
    const int body = frame.bodies[static_cast<std::size_t>(k)].body;
    const arm::MeasuredBody& measured = bodies_[static_cast<std::size_t>(body)];
    const rod::RodState& at = solver_.station(body);
    out.p.col(k) = model::position_on(measured, at);
    out.tangent.col(k) = model::tangent_of(at);
    body_derivative(body, rod_by_theta_, out.dp.middleRows(3 * k, 3), out.dtangent.middleRows(3 * k, 3));
  }
  out.laws.resize(kLaws * static_cast<int>(laws_.size()));
  for (std::size_t i = 0; i < laws_.size(); ++i) {
    const Eigen::Vector2d moment = laws_[i].actuation_nm();
    out.laws.segment<kLaws>(kLaws * static_cast<int>(i)) << moment.x(), moment.y(),
        std::log(laws_[i].bending_stiffness_nm2), laws_[i].length_m;
  }
  out.dlaws = laws_by_theta_;
  return true;
}

void LawModel::derivative_by_laws(const trial::StaticFrame& frame, Eigen::MatrixXd& dp,
                                  Eigen::MatrixXd& dtangent) const {
  const int columns = kLaws * static_cast<int>(laws_.size());
  Eigen::MatrixXd rod_by_laws = Eigen::MatrixXd::Zero(static_cast<int>(parameters_.size()), columns);
  for (int i = 0; i < static_cast<int>(laws_.size()); ++i) {
    // The order of rod_parameters(). Bending towards the azimuth (a, b) is a turn about (-b, a).
    const int column = kLaws * i;
    rod_by_laws(column + 1, column) = 1.0;
    rod_by_laws(column, column + 1) = -1.0;
    rod_by_laws(column + 2, column + 2) = -rod_.segments[static_cast<std::size_t>(i)].bending_compliance;
    rod_by_laws(column + 3, column + 3) = 1.0;
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
