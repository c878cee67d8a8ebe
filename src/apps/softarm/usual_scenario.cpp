#include "usual_scenario.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "rig_messages.h"

namespace softarm::app {
namespace {

// How far one input bends its segment where it is the only one, of n segments over sqrt(n); how much all of
// them together elongate it, and how much forces along it do.
constexpr double kBend_rad = 2.0, kElongation = 0.3, kStretch = 0.1;
constexpr double kMostPressure_pa = 200e3, kMostTension_n = 200.0, kMostAngle_rad = 6.0;
constexpr double kVacuum_pa = 50e3;
// What the weight would bend the arm by, were it across it everywhere.
constexpr double kBentHanging_rad = 1.5, kBentHorizontal_rad = 0.4, kBentStanding_rad = 0.2;
constexpr double kGravity_m_s2 = 9.80665;
constexpr double kPeriod_s = 32.0;       // of the payload
constexpr double kMostHz = 0.1;          // of the inputs
constexpr double kHzTimesPeriod = 0.08;  // slow against the arm's own period: nearly at rest all the time

double stiffness_of(const arm::Segment& segment) {
  const std::vector<arm::PressureKnot>& knots = segment.bending_stiffness.by_pressure;
  return knots.empty() ? segment.bending_stiffness.base_nm2 : knots.front().bending_stiffness_nm2;
}

/// The most of each input, by name.
class Limits {
 public:
  explicit Limits(const arm::Arm& arm)
      : bend_rad_(kBend_rad / std::sqrt(static_cast<double>(arm.segments.size()))) {
    for (const arm::Segment& segment : arm.segments) add(segment);
  }
  double of(const std::string& input) const { return most_.at(input); }

 private:
  void add(const std::string& input, double most) {
    const auto [found, is_new] = most_.emplace(input, most);
    if (!is_new) found->second = std::min(found->second, most);
  }

  /// @param rad, strain of the segment, per unit of the input; 0: none
  double limit(double rad, double strain, double most) const {
    if (rad > 0.0) most = std::min(most, bend_rad_ / rad);
    if (std::abs(strain) > 0.0) most = std::min(most, kStretch / std::abs(strain));
    return most;
  }

  void add(const arm::Segment& s) {
    const double per_moment = s.length_m / stiffness_of(s);
    const auto strain_of = [&](double force) { return force / s.axial_stiffness_n.value_or(1e12); };
    const auto all = [](const auto& list) { return static_cast<double>(list.size()); };
    for (const arm::Chamber& c : s.chambers)
      add(c.input, limit(c.moment_gain_nm_per_pa * per_moment,
                         (kStretch / kElongation) * all(s.chambers) *
                             (c.near_elongation_m_per_pa + c.far_elongation_m_per_pa) / s.length_m,
                         kMostPressure_pa));
    for (const arm::Tendon& t : s.tendons)
      add(t.input, limit(t.offset_m * per_moment, strain_of(all(s.tendons)), kMostTension_n));
    for (const arm::Cable& c : s.cables)
      add(c.input, limit(c.curvature_gain_per_m_rad * s.length_m, 0.0, kMostAngle_rad));
    if (!s.central_chamber) return;
    const std::vector<arm::PressureKnot>& knots = s.bending_stiffness.by_pressure;
    const double most = knots.empty() ? kMostPressure_pa : std::max(1e3, knots.back().pressure_pa);
    add(s.central_chamber->input, limit(0.0, strain_of(s.central_chamber->area_m2), most));
  }

  double bend_rad_;
  std::map<std::string, double> most_;
};

bool something_bends(const arm::Arm& arm) {
  return std::any_of(arm.segments.begin(), arm.segments.end(), [](const arm::Segment& s) {
    return !s.chambers.empty() || !s.tendons.empty() || !s.cables.empty();
  });
}

/// Cosine between the base's tangent and gravity: 1 hanging, 0 horizontal, -1 standing.
double hangs(const arm::Arm& arm) {
  if (arm.base.body) return something_bends(arm) ? 1.0 : 0.0;
  const Eigen::Vector3d tangent = arm.base.fixed_pose.linear() * arm.base.rod_in_body.linear().col(2);
  const double gravity = arm.gravity_m_s2.norm();
  return gravity > 0.0 ? tangent.dot(arm.gravity_m_s2) / gravity : 1.0;
}

/// The weight that the arm carries, and how it moves with it.
struct Load {
  double kg = 0.0, least_kg = 0.0;
  double period_s = 1.0;       ///< of the arm's slowest motion, about
  double damping_n_s_m = 1.0;  ///< of the hand that hangs it on
};

/// What a force across the tip bends the arm by, all segments together, rad/N.
double bend_per_newton(const arm::Arm& arm) {
  double sum = 0.0, begin_m = 0.0;
  for (const arm::Segment& segment : arm.segments) {
    const double loaded_m = std::clamp(arm.payload.arclength_m - begin_m, 0.0, segment.length_m);
    sum += loaded_m * (arm.payload.arclength_m - begin_m - 0.5 * loaded_m) / stiffness_of(segment);
    begin_m += segment.length_m;
  }
  return std::max(sum, 1e-6);
}

Load load_of(const arm::Arm& arm) {
  double mass_kg = arm.tip_mass_kg;
  for (const arm::Segment& segment : arm.segments) mass_kg += segment.mass_per_length_kg_m * segment.length_m;
  const double cosine = hangs(arm), bend = bend_per_newton(arm), length_m = arm.total_length_m();
  const double size = cosine > 0.5    ? kBentHanging_rad
                      : cosine > -0.5 ? kBentHorizontal_rad
                                      : kBentStanding_rad;
  Load load;
  load.least_kg = arm.payload.range_kg.low;
  load.kg = std::clamp(size / (kGravity_m_s2 * bend), load.least_kg,
                       std::max(load.least_kg, 0.9 * arm.payload.range_kg.high));
  const double spring = 1.5 / (bend * length_m);  // as of a uniform arm: 3 EI / L^3
  const double moving_kg = load.kg + 0.25 * mass_kg;
  load.period_s = 2.0 * M_PI * std::sqrt(moving_kg / spring);
  load.damping_n_s_m = 2.0 * std::sqrt(spring * moving_kg);
  return load;
}

YAML::Node list_of(const std::vector<double>& values) {
  YAML::Node list(YAML::NodeType::Sequence);
  for (double value : values) list.push_back(value);
  return list;
}

void drive(const arm::Arm& arm, arm::InputKind kind, const std::string& section, const std::string& unit,
           double period_s, YAML::Node document) {
  const std::vector<std::size_t> inputs = driven_inputs(arm, kind);
  if (inputs.empty()) return;
  const Limits limits(arm);
  std::vector<double> most;
  for (std::size_t input : inputs) most.push_back(limits.of(arm.inputs.scalars.at(input).name));
  YAML::Node node = document[section];
  node["settle_s"] = 0.5;
  node["ramp_s"] = 2;
  node["random"]["min_" + unit] = 0;
  node["random"]["max_" + unit] = list_of(most);
  node["random"]["highest_hz"] = std::min(kMostHz, kHzTimesPeriod / period_s);
  node["random"]["lowest_hz"] = 0.25 * std::min(kMostHz, kHzTimesPeriod / period_s);
}

YAML::Node set_at(double t_s, const char* key, double value) {
  YAML::Node node;
  node["t_s"] = t_s;
  node[key] = value;
  return node;
}

void payload(const Load& load, YAML::Node node) {
  node["ramp_s"] = 0.3;
  node["steady_s"] = std::clamp(1.2 * load.period_s, 0.5, 3.0);
  node["hand_damping_n_s_m"] = load.damping_n_s_m;
  node["repeat_s"] = kPeriod_s;
  node["schedule"].push_back(set_at(0.0, "kg", std::max(load.least_kg, 0.6 * load.kg)));
  node["schedule"].push_back(set_at(0.25 * kPeriod_s, "kg", load.kg));
  node["schedule"].push_back(set_at(0.5 * kPeriod_s, "kg", load.least_kg));
  node["schedule"].push_back(set_at(0.75 * kPeriod_s, "kg", std::max(load.least_kg, 0.8 * load.kg)));
}

/// The vacuum that leaves EI within what the file holds for possible.
double vacuum_of(const arm::Arm& arm) {
  double most = kVacuum_pa;
  for (const arm::Segment& s : arm.segments) {
    const double gain = s.bending_stiffness.per_jamming_pressure_nm2_per_pa;
    if (gain > 0.0)
      most = std::min(most, 0.5 * (s.bending_stiffness_range_nm2.high - stiffness_of(s)) / gain);
  }
  return std::max(0.0, most);
}

void mocap(const arm::Arm& arm, YAML::Node node) {
  double position_sd_m = 0.0, orientation_sd_rad = 0.0;
  for (const arm::MeasuredBody& body : arm.bodies) {
    position_sd_m = std::max(position_sd_m, body.position_sd_m);
    orientation_sd_rad = std::max(orientation_sd_rad, body.orientation_sd_rad);
  }
  node["rate_hz"] = 120;
  node["position_sd_m"] = position_sd_m;
  node["orientation_sd_rad"] = orientation_sd_rad;
  node["dropout_probability"] = 0.002;
}

}  // namespace

YAML::Node usual_scenario(const arm::Arm& arm) {
  YAML::Node document;
  document["format"] = 1;
  document["name"] = arm.name;
  document["seed"] = 7;
  document["duration_s"] = 0;
  const Load load = load_of(arm);
  if (arm.base.body) {
    document["mount"]["attitude"] = something_bends(arm) ? "hanging" : "horizontal";
    if (!something_bends(arm)) document["mount"]["rotation_deg"] = 180;
  }
  drive(arm, arm::InputKind::kPressure, "pressures", "pa", load.period_s, document);
  drive(arm, arm::InputKind::kTension, "tensions", "n", load.period_s, document);
  drive(arm, arm::InputKind::kAngle, "angles", "rad", load.period_s, document);
  if (!driven_inputs(arm, arm::InputKind::kVacuum).empty()) {
    // No further: a schedule does not come again.
    for (int i = 0; i < 200; ++i)
      document["vacuum"]["schedule"].push_back(
          set_at(12.0 * i, "vacuum_pa", i % 2 == 0 ? 0.0 : vacuum_of(arm)));
  }
  payload(load, document["payload"]);
  mocap(arm, document["mocap"]);
  return document;
}

}  // namespace softarm::app
