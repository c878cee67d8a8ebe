#include "arm_statics.h"

#include <algorithm>
#include <cmath>

#include "arm/constant_spec.h"
#include "arm_rod.h"
#include "body_kinematics.h"

namespace softarm::model {
namespace {

using rod::ParameterKind;

// Differences of the laws: a share of the number, or of what it usually is, that loses as little to rounding
// as to curvature.
constexpr double kStep = 1e-5;

/// All that inputs and constants may move of a rod's segments; the last four are the payload and gravity.
std::vector<rod::Parameter> all_parameters(const arm::Arm& arm) {
  std::vector<rod::Parameter> list;
  for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
    for (const int axis : {0, 1}) list.push_back({ParameterKind::kMoment, i, axis});
    for (const int axis : {0, 1}) list.push_back({ParameterKind::kRestCurvature, i, axis});
    for (const ParameterKind kind : {ParameterKind::kBendingCompliance, ParameterKind::kTorsionalCompliance,
                                     ParameterKind::kAxialCompliance, ParameterKind::kShearCompliance,
                                     ParameterKind::kJointCompliance, ParameterKind::kLength})
      list.push_back({kind, i, 0});
  }
  list.push_back({ParameterKind::kLoadMass, rod::kPayloadLoad, 0});
  for (const int axis : {0, 1, 2}) list.push_back({ParameterKind::kGravity, 0, axis});
  return list;
}

constexpr int kLoads = 4;

double value_of(const rod::Rod& rod, const rod::Parameter& parameter) {
  const rod::Segment& segment = rod.segments[static_cast<std::size_t>(parameter.index)];
  switch (parameter.kind) {
    case ParameterKind::kMoment:
      return segment.moment_nm[parameter.component];
    case ParameterKind::kRestCurvature:
      return segment.rest_curvature_per_m[parameter.component];
    case ParameterKind::kBendingCompliance:
      return segment.bending_compliance;
    case ParameterKind::kTorsionalCompliance:
      return segment.torsional_compliance;
    case ParameterKind::kAxialCompliance:
      return segment.axial_compliance;
    case ParameterKind::kShearCompliance:
      return segment.shear_compliance;
    case ParameterKind::kJointCompliance:
      return segment.joint_compliance;
    default:
      return segment.length_m;
  }
}

/// What a rod has of its arm whatever the inputs are. Its layout, and with it the places of the bodies at
/// zero input, stays.
void put_constants(const arm::Arm& arm, rod::Rod& rod) {
  for (std::size_t i = 0; i < rod.segments.size(); ++i) {
    rod.segments[i].rest_curvature_per_m = arm.segments[i].rest_curvature_per_m;
    rod.segments[i].joint_compliance = arm.segments[i].joint_compliance_rad_per_nm.value_or(0.0);
  }
}

std::vector<double> stations(const arm::Arm& arm, const std::vector<double>& points_m) {
  std::vector<double> all = body_stations(arm);
  all.insert(all.end(), points_m.begin(), points_m.end());
  return all;
}

/// Derivatives are those of the last sweep: it must have been so near that even those of an arm that hardly
/// holds its load are right.
rod::SolverOptions fine_options() {
  rod::SolverOptions options = solver_options(1e-10);
  options.linear_correction_rad = 1e-8;
  return options;
}

}  // namespace

double usual_size(arm::InputKind kind) {
  switch (kind) {
    case arm::InputKind::kPressure:
    case arm::InputKind::kVacuum:
      return arm::kUsualPressure_pa;
    default:
      return 1.0;  // N, rad
  }
}

ArmStatics::ArmStatics(const arm::Arm& arm, const std::vector<double>& points_m)
    : arm_(arm),
      parameters_(all_parameters(arm)),
      rod_(rod::make_rod(arm)),
      solver_(rod_, stations(arm, points_m), parameters_, fine_options()) {}

ArmStatics::Outcome ArmStatics::solve(const StaticLoad& load) {
  auto laws = arm::predict(arm_, load.inputs);
  if (!laws) return Outcome::kNoLaws;
  laws_ = std::move(*laws);
  inputs_ = load.inputs;
  rod_.gravity_m_s2 = load.gravity_base;
  rod_.loads[rod::kPayloadLoad].mass_kg = load.payload_kg;
  rod::actuate(arm_, laws_, rod_);
  put_constants(arm_, rod_);
  return solver_.solve(rod_) == rod::SolveStatus::kConverged ? Outcome::kSolved : Outcome::kNoEquilibrium;
}

Eigen::Vector3d ArmStatics::body_position(int i) const {
  return position_on(arm_.bodies[static_cast<std::size_t>(i)], solver_.station(i));
}

Eigen::Vector3d ArmStatics::body_tangent(int i) const {
  return tangent_of(solver_.station(i));
}

bool ArmStatics::rod_values(const arm::Arm& arm, const arm::InputValues& inputs, Eigen::VectorXd& out) const {
  const auto laws = arm::predict(arm, inputs);
  if (!laws) return false;
  rod::Rod rod = rod_;
  rod::actuate(arm, *laws, rod);
  put_constants(arm, rod);
  out.resize(static_cast<Eigen::Index>(parameters_.size()) - kLoads);
  for (Eigen::Index k = 0; k < out.size(); ++k)
    out[k] = value_of(rod, parameters_[static_cast<std::size_t>(k)]);
  return true;
}

Eigen::VectorXd ArmStatics::difference(double step,
                                       const std::function<bool(double, Eigen::VectorXd&)>& values_at) const {
  Eigen::VectorXd above, below;
  double span = 2.0 * step;
  // A constant may stand at the edge of what the laws allow.
  if (!values_at(step, above)) {
    span -= step;
    values_at(0.0, above);
  }
  if (!values_at(-step, below)) {
    span -= step;
    values_at(0.0, below);
  }
  Eigen::VectorXd by = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(parameters_.size()));
  if (span > 0.0) by.head(above.size()) = (above - below) / span;
  return by;
}

Eigen::MatrixXd ArmStatics::by_rod() const {
  Eigen::MatrixXd by(3 * solver_.stations(), static_cast<Eigen::Index>(parameters_.size()));
  for (int i = 0; i < solver_.stations(); ++i) {
    if (i < bodies()) {
      by.middleRows<3>(3 * i) = position_by_rod(arm_.bodies[static_cast<std::size_t>(i)], i, solver_);
    } else {
      by.middleRows<3>(3 * i) = solver_.dp(i);
    }
  }
  return by;
}

Eigen::MatrixXd ArmStatics::by_inputs() const {
  const Eigen::MatrixXd rod = by_rod();
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(rod.rows(), static_cast<Eigen::Index>(inputs_.size()));
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    if (!inputs_[i]) continue;
    const double step = kStep * std::max(std::abs(*inputs_[i]), usual_size(arm_.inputs.scalars[i].kind));
    by.col(static_cast<Eigen::Index>(i)) = rod * difference(step, [&](double change, Eigen::VectorXd& out) {
                                             arm::InputValues changed = inputs_;
                                             *changed[i] += change;
                                             return rod_values(arm_, changed, out);
                                           });
  }
  return by;
}

Eigen::VectorXd ArmStatics::by_payload() const {
  return by_rod().col(static_cast<Eigen::Index>(parameters_.size()) - kLoads);
}

Eigen::MatrixXd ArmStatics::by_gravity() const {
  return by_rod().rightCols<3>();
}

Eigen::MatrixXd ArmStatics::by_constants(const std::vector<arm::ConstantRef>& constants) const {
  const Eigen::MatrixXd rod = by_rod();
  Eigen::MatrixXd by(rod.rows(), static_cast<Eigen::Index>(constants.size()));
  for (std::size_t j = 0; j < constants.size(); ++j) {
    const arm::ConstantRef& constant = constants[j];
    const double value = arm::value_of(arm_, constant);
    const arm::Range range = arm::allowed_range(arm_, constant);
    // Where it is 0, a share of what it may be: the laws are smooth over that.
    const double step = kStep * (value != 0.0 ? std::abs(value) : std::min(1.0, 1e-3 * range.high));
    by.col(static_cast<Eigen::Index>(j)) =
        rod * difference(step, [&](double change, Eigen::VectorXd& out) {
          arm::Arm changed = arm_;
          // As identification: a length changes what the laws say of it, the layout carries the bodies along.
          for (const int i : arm::segments_of(constant))
            arm::spec_of(constant.kind)
                .set(changed.segments[static_cast<std::size_t>(i)], constant.index, value + change);
          return rod_values(changed, inputs_, out);
        });
  }
  return by;
}

}  // namespace softarm::model
