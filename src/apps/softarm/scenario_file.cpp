#include "scenario_file.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "command.h"
#include "output_file.h"
#include "rig_effects.h"
#include "rig_messages.h"
#include "shipped.h"
#include "softarm/arm/arm_file.h"
#include "softarm/effects/arm_effects.h"
#include "usual_scenario.h"

namespace softarm::app {
namespace {

namespace fs = std::filesystem;

constexpr double kDegreesPerRad = 180.0 / M_PI;
constexpr double kHardlyTwists_nm2 = 100.0;  // what is rigid in the arm file; the rig's sections always twist

/// The arm in the keys of a scenario.
class Translated {
 public:
  Translated(const arm::Arm& arm, std::string source) : arm_(arm), source_(std::move(source)) {}

  YAML::Node node() const {
    YAML::Node node;
    node["tip_mass_kg"] = arm_.tip_mass_kg;
    for (std::size_t i = 0; i < arm_.segments.size(); ++i) node["segments"].push_back(segment(i));
    return node;
  }

  /// What the rig has as something hidden.
  std::vector<rig::HiddenChoice> hidden() const {
    std::vector<rig::HiddenChoice> list;
    for (std::size_t i = 0; i < arm_.segments.size(); ++i) {
      const Eigen::Vector3d& u = arm_.segments[i].rest_curvature_per_m;
      if (u.z() != 0.0) fail(fmt::format("segments[{}].rest_curvature_per_m", i), "twist at rest");
      if (u.head<2>().isZero(0.0)) continue;
      list.push_back({"rest_curvature",
                      "",
                      {{"curvature_per_m", u.head<2>().norm()},
                       {"azimuth_deg", kDegreesPerRad * std::atan2(-u.x(), u.y())},
                       {"segment", static_cast<double>(i + 1)}}});
    }
    for (std::size_t i = 0; i < arm_.segments.size(); ++i) {
      const double compliance = arm_.segments[i].joint_compliance_rad_per_nm.value_or(0.0);
      if (compliance == 0.0) continue;
      if (i > 0) fail(fmt::format("segments[{}].joint_compliance_rad_per_nm", i), "a joint between segments");
      list.push_back({"base_compliance", "", {{"stiffness_nm_per_rad", 1.0 / compliance}}});
    }
    const Eigen::Vector3d& offset = arm_.payload.offset_m;
    if (!offset.isZero(0.0))
      list.push_back({"payload_offset",
                      "",
                      {{"axial_m", offset.z()},
                       {"lateral_m", offset.head<2>().norm()},
                       {"azimuth_deg", kDegreesPerRad * std::atan2(offset.y(), offset.x())}}});
    return list;
  }

 private:
  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    throw Failure(fmt::format("{}: key '{}': {} has no counterpart in the virtual rig", source_, key, what));
  }

  /// The rig's name of an input: its number among those of its kind.
  std::string input(const std::string& name, arm::InputKind kind, const std::string& prefix) const {
    int number = 0;
    for (std::size_t one : driven_inputs(arm_, kind)) {
      ++number;
      if (arm_.inputs.scalars[one].name == name) return fmt::format("{}_{}", prefix, number);
    }
    throw std::logic_error("input " + name);
  }

  /// What EI grows with; the rig has its own exponent, of which 1 is ours.
  static void growth(const arm::Segment& from, YAML::Node stiffness) {
    const auto add = [&](const std::optional<double>& slope, const char* key, double at,
                         const char* item = nullptr, std::size_t index = 0) {
      if (slope.value_or(0.0) == 0.0) return;
      YAML::Node one;
      one["added_nm2"] = *slope * at;
      one[key] = at;
      if (item) one[item] = index + 1;
      stiffness["growth"].push_back(one);
    };
    const auto add_lowest = [&](const std::optional<double>& slope, const char* key) {
      const std::size_t before = stiffness["growth"].size();
      add(slope, key, 1.0);
      if (stiffness["growth"].size() > before) stiffness["growth"][before]["lowest"] = true;
    };
    constexpr double kAt_pa = 50e3;
    add(from.bending_stiffness.per_mean_pressure_nm2_per_pa, "at_pa", kAt_pa);
    for (std::size_t k = 0; k < from.chambers.size(); ++k)
      add(from.chambers[k].stiffness_gain_nm2_per_pa, "at_pa", kAt_pa, "chamber", k);
    for (std::size_t k = 0; k < from.tendons.size(); ++k)
      add(from.tendons[k].stiffness_gain_nm2_per_n, "at_n", 1.0, "tendon", k);
    for (std::size_t k = 0; k < from.cables.size(); ++k)
      add(from.cables[k].stiffness_gain_nm2_per_rad, "at_rad", 1.0, "cable", k);
    add_lowest(from.bending_stiffness.per_min_tension_nm2_per_n, "at_n");
    add_lowest(from.bending_stiffness.per_min_angle_nm2_per_rad, "at_rad");
    add(from.bending_stiffness.per_tension_nm2_per_n, "at_n", 1.0);
    add(from.bending_stiffness.per_angle_nm2_per_rad, "at_rad", 1.0);
  }

  /// Where actuation is down to half: the inverse of ours. Of the rig's two forms the one that is ours.
  static void saturation(const std::optional<double>& from, const char* key, YAML::Node to) {
    if (from.value_or(0.0) > 0.0) to[key] = 1.0 / *from;
  }
  static void saturation(const arm::Segment& from, YAML::Node to) {
    YAML::Node node;
    node["form"] = "hyperbolic";
    saturation(from.saturation.chambers_per_pa, "chambers_pa", node);
    saturation(from.saturation.tendons_per_n, "tendons_n", node);
    saturation(from.saturation.cables_per_rad, "cables_rad", node);
    to["saturation"] = node;
  }

  /// Each element with its one time, as ours are.
  static void creep(const std::vector<arm::WallElement>& from, const char* key, YAML::Node to) {
    for (const arm::WallElement& element : from) {
      YAML::Node one;
      one["time_s"] = element.time_s;
      one["share"] = element.share;
      one["decades"] = 0.0;
      to["creep"][key].push_back(one);
    }
  }

  void wall(const arm::Wall& from, std::size_t index, YAML::Node to) const {
    if (from.slows_per_pa.value_or(0.0) > 0.0)
      fail(fmt::format("segments[{}].wall.slows_per_pa", index),
           "a wall that pressure slows as this law says");
    if (from.shares_grow_per_pa.value_or(0.0) > 0.0)
      fail(fmt::format("segments[{}].wall.shares_grow_per_pa", index),
           "a wall whose shares grow with pressure as this law says");
    to["retardation_s"] = from.lag_s.value_or(arm::Wall::kUsualLag_s);
    creep(from.bending, "moment", to);
    creep(from.axial, "length", to);
  }

  YAML::Node segment(std::size_t index) const {
    const arm::Segment& from = arm_.segments[index];
    if (!from.stiffness_profile.empty())
      fail(fmt::format("segments[{}].bending_stiffness.profile", index), "a profile");
    YAML::Node to;
    to["length_m"] = from.length_m;
    to["mass_kg"] = from.mass_per_length_kg_m * from.length_m;
    if (from.diameter_m > 0.0) to["diameter_m"] = from.diameter_m;
    YAML::Node stiffness = to["bending_stiffness"];
    stiffness["base_nm2"] = from.bending_stiffness.base_nm2;
    stiffness["per_min_pressure_nm2_per_pa"] = from.bending_stiffness.per_min_pressure_nm2_per_pa;
    stiffness["per_jamming_pressure_nm2_per_pa"] = from.bending_stiffness.per_jamming_pressure_nm2_per_pa;
    for (const arm::PressureKnot& knot : from.bending_stiffness.by_pressure) {
      YAML::Node one;
      one["pressure_pa"] = knot.pressure_pa;
      one["bending_stiffness_nm2"] = knot.bending_stiffness_nm2;
      to["stiffness_by_pressure"].push_back(one);
    }
    growth(from, stiffness);
    saturation(from, to);
    wall(from.wall, index, to);
    to["torsional_stiffness_nm2"] = from.torsional_stiffness_nm2.value_or(kHardlyTwists_nm2);
    if (from.axial_stiffness_n) to["axial_stiffness_n"] = *from.axial_stiffness_n;
    if (from.shear_stiffness_n) to["shear_stiffness_n"] = *from.shear_stiffness_n;
    if (from.material) {
      to["material"]["c10_pa"] = from.material->c10_pa;
      to["material"]["c01_pa"] = from.material->c01_pa;
    }
    for (const arm::Chamber& chamber : from.chambers) {
      YAML::Node one;
      one["input"] = input(chamber.input, arm::InputKind::kPressure, "chamber");
      one["bending_direction_deg"] = kDegreesPerRad * chamber.bending_direction_rad;
      one["moment_gain_nm_per_pa"] = chamber.moment_gain_nm_per_pa;
      one["near_elongation_m_per_pa"] = chamber.near_elongation_m_per_pa;
      one["far_elongation_m_per_pa"] = chamber.far_elongation_m_per_pa;
      saturation(chamber.saturation_per_pa, "saturation_pa", one);
      to["chambers"].push_back(one);
    }
    if (from.central_chamber) {
      to["central_chamber"]["input"] =
          input(from.central_chamber->input, arm::InputKind::kPressure, "chamber");
      to["central_chamber"]["area_m2"] = from.central_chamber->area_m2;
    }
    for (const arm::Tendon& tendon : from.tendons) {
      YAML::Node one;
      one["input"] = input(tendon.input, arm::InputKind::kTension, "tendon");
      one["azimuth_deg"] = kDegreesPerRad * tendon.bending_direction_rad;
      one["offset_m"] = tendon.offset_m;
      saturation(tendon.saturation_per_n, "saturation_n", one);
      to["tendons"].push_back(one);
    }
    for (const arm::Cable& cable : from.cables) {
      // Only spool over lever counts.
      const double lever = from.diameter_m > 0.0 ? 0.5 * from.diameter_m : 0.01;
      YAML::Node one;
      one["input"] = input(cable.input, arm::InputKind::kAngle, "servo");
      one["azimuth_deg"] = kDegreesPerRad * cable.bending_direction_rad;
      one["lever_m"] = lever;
      one["spool_radius_m"] = cable.curvature_gain_per_m_rad * from.length_m * lever;
      saturation(cable.saturation_per_rad, "saturation_rad", one);
      to["cables"].push_back(one);
    }
    return to;
  }

  const arm::Arm& arm_;
  const std::string source_;
};

YAML::Node node_of(const rig::HiddenChoice& choice) {
  YAML::Node node;
  node["effect"] = choice.effect;
  if (!choice.form.empty()) node["form"] = choice.form;
  for (const auto& [key, value] : choice.values) {
    // The rig's reader takes whole numbers as such.
    if (value == std::floor(value) && std::abs(value) < 1e9)
      node[key] = static_cast<long>(value);
    else
      node[key] = value;
  }
  return node;
}

YAML::Node node_of(const Eigen::Vector3d& p) {
  YAML::Node node;
  for (const double x : {p.x(), p.y(), p.z()}) node.push_back(x);
  return node;
}

YAML::Node node_of(const Eigen::Quaterniond& rotation) {
  YAML::Node node;
  for (double x : {rotation.x(), rotation.y(), rotation.z(), rotation.w()}) node.push_back(x);
  return node;
}

void place(const Eigen::Isometry3d& pose, YAML::Node node) {
  node["position_m"] = node_of(Eigen::Vector3d(pose.translation()));
  node["quaternion_xyzw"] = node_of(Eigen::Quaterniond(pose.linear()).normalized());
}

/// The body's frame in that of its section.
Eigen::Isometry3d in_section(const arm::MeasuredBody& body) {
  Eigen::Isometry3d pose = body.section_in_body.inverse();
  if (body.kind == arm::BodyKind::kSkinMarker)
    pose = Eigen::Translation3d(body.radius_m * std::cos(body.angle_rad),
                                body.radius_m * std::sin(body.angle_rad), 0.0);
  return pose;
}

/// The scenario measures the arm file's bodies; it may say where they are only if it says the same.
void measure(const fs::path& scenario, const arm::Arm& arm, const std::string& arm_source, YAML::Node mocap) {
  if (mocap["rings"])
    throw Failure(
        fmt::format("{}: key 'mocap.rings': given beside the arm file {}, whose bodies are measured",
                    scenario.string(), arm_source));
  if (const YAML::Node told = mocap["ring_fractions"]) {
    bool same = told.IsSequence() && told.size() == arm.bodies.size();
    for (std::size_t i = 0; same && i < told.size(); ++i)
      same = std::abs(told[i].as<double>(-1.0) - arm.bodies[i].arclength_m / arm.total_length_m()) < 1e-4;
    if (!same)
      throw Failure(
          fmt::format("{}: key 'mocap.ring_fractions': other places than those of the {} bodies of {}; "
                      "leave it out, they are measured",
                      scenario.string(), arm.bodies.size(), arm_source));
    mocap.remove("ring_fractions");
  }
  for (const arm::MeasuredBody& body : arm.bodies) {
    YAML::Node ring;
    ring["name"] = body.name;
    ring["fraction"] = std::clamp(body.arclength_m / arm.total_length_m(), 0.0, 1.0);
    place(in_section(body), ring);
    mocap["rings"].push_back(ring);
  }
  YAML::Node base = mocap["base"];
  base["measured"] = arm.base.body.has_value();
  if (!arm.base.body) return;
  base["name"] = *arm.base.body;
  place(arm.base.rod_in_body.inverse(), base);
}

/// The clamp, and gravity, in the rig's mocap frame, whose z is up.
void mount(const fs::path& scenario, const arm::Arm& arm, const std::string& arm_source,
           YAML::Node document) {
  if (!document["gravity_m_s2"]) document["gravity_m_s2"] = arm.gravity_m_s2.norm();
  if (!document["pressures"]["ambient_pa"])
    document["pressures"]["ambient_pa"] = arm.inputs.ambient_pressure_pa;
  if (!document["vacuum"] && !driven_inputs(arm, arm::InputKind::kVacuum).empty())
    document["vacuum"]["schedule"].push_back(YAML::Load("{t_s: 0, vacuum_pa: 0}"));
  if (arm.base.body) return;
  if (document["mount"])
    throw Failure(
        fmt::format("{}: key 'mount': given beside the arm file {}, whose base.fixed says where the arm is",
                    scenario.string(), arm_source));
  place(Eigen::Isometry3d(to_arms_mocap(arm).inverse()) * arm.base.fixed_pose, document["mount"]);
}

/// What the arm file's laws and effects are in the scenario's keys.
void put_arm(const arm::ArmText& file, const arm::Arm& arm, YAML::Node document) {
  const std::vector<arm::EffectEntry> entries = arm::parse_effect_entries(file.text, file.source);
  const std::vector<model::Present> effects = effects::effects_of(arm, entries);
  const arm::Arm changed = for_the_rig(arm, effects);
  const Translated translated(changed, file.source);
  document["arm"] = translated.node();
  std::vector<rig::HiddenChoice> hidden = translated.hidden();
  for (std::size_t i = 0; i < effects.size(); ++i) {
    try {
      for (const rig::HiddenChoice& choice : in_the_rig(arm, effects[i])) hidden.push_back(choice);
    } catch (const std::invalid_argument& error) {
      throw Failure(fmt::format("{}: key 'effects[{}].id': {}", entries[i].place, i, error.what()));
    }
  }
  if (!document["hidden"] && !hidden.empty()) document["hidden"] = YAML::Node(YAML::NodeType::Sequence);
  for (const rig::HiddenChoice& choice : hidden) document["hidden"].push_back(node_of(choice));
  if (!document["payload"]["fraction"] && arm.payload.arclength_m < arm.total_length_m())
    document["payload"]["fraction"] = arm.payload.arclength_m / arm.total_length_m();
}

/// @throws Failure where the rig cannot send what the arm file listens to
void refuse_messages(const arm::Arm& arm, const std::string& arm_source) {
  std::vector<std::size_t> driven;
  for (const arm::InputKind kind :
       {arm::InputKind::kPressure, arm::InputKind::kVacuum, arm::InputKind::kTension, arm::InputKind::kAngle})
    for (std::size_t input : driven_inputs(arm, kind)) driven.push_back(input);
  try {
    LabMessages(arm.inputs, driven);
  } catch (const std::invalid_argument& error) {
    throw Failure(fmt::format("{}: {}", arm_source, error.what()));
  }
}

/// The scenario of an arm file, told in the rig's keys.
LoadedScenario of_arm(const fs::path& scenario, const arm::ArmText& file, YAML::Node document) {
  const arm::Arm arm = arm::parse_arm(file.text, file.source);
  const bool is_arm_file = !document.IsMap();
  if (is_arm_file) document = usual_scenario(arm);
  refuse_messages(arm, file.source);
  put_arm(file, arm, document);
  measure(scenario, arm, file.source, document["mocap"]);
  mount(scenario, arm, file.source, document);
  YAML::Emitter out;
  out << document;
  return {rig::parse_scenario(out.c_str(), scenario.string()), is_arm_file, arm};
}

arm::ArmText arm_beside(const fs::path& scenario, const std::string& name) {
  std::error_code ignored;
  const fs::path beside = scenario.parent_path() / name;
  const std::string found =
      fs::path(name).is_relative() && fs::is_regular_file(beside, ignored) ? beside.string() : name;
  return arm::read_arm_text(found, config_folders("arms"));
}

}  // namespace

LoadedScenario load_scenario(const std::string& name) {
  const fs::path path = find_config("scenarios", name);
  const std::string text = read_text(path);
  YAML::Node document;
  try {
    document = YAML::Load(text);
  } catch (const YAML::Exception&) {  // the rig's own reader says where
  }
  if (document.IsMap() && document["segments"] && !document["arm"])
    return of_arm(path, {text, path.string()}, {});
  if (document.IsMap() && document["arm"] && document["arm"].IsScalar())
    return of_arm(path, arm_beside(path, document["arm"].Scalar()), document);
  return {rig::parse_scenario(text, path.string()), false, {}};
}

}  // namespace softarm::app
