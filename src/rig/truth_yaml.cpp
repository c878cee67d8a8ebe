#include "truth_yaml.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

namespace softarm::rig {
namespace {

/// The shortest number that reads back to the same value.
std::string shortest(double value) {
  return fmt::format("{}", value);
}

void write(YAML::Emitter& out, const char* key, double value) {
  out << YAML::Key << key << YAML::Value << shortest(value);
}

void write(YAML::Emitter& out, const char* key, const std::optional<double>& value) {
  if (value) write(out, key, *value);
}

std::string grows_with(const StiffnessGrowth& growth) {
  using Of = StiffnessGrowth::Of;
  const bool tensions = growth.of == Of::kTensions, angles = growth.of == Of::kAngles;
  if (growth.by == StiffnessGrowth::By::kOne)
    return fmt::format("{}_{}", tensions ? "tendon" : angles ? "cable" : "chamber", growth.input + 1);
  if (growth.by == StiffnessGrowth::By::kLowest)
    return tensions ? "lowest_tension" : angles ? "lowest_angle" : "lowest_pressure";
  return tensions ? "tensions" : angles ? "angles" : "mean_pressure";
}

void write(YAML::Emitter& out, const std::vector<StiffnessGrowth>& list) {
  if (list.empty()) return;
  out << YAML::Key << "stiffness_growth" << YAML::Value << YAML::BeginSeq;
  for (const StiffnessGrowth& growth : list) {
    out << YAML::Flow << YAML::BeginMap << YAML::Key << "by" << YAML::Value << grows_with(growth);
    write(out, "added_nm2", growth.added_nm2);
    write(out, "at", growth.at);
    write(out, "exponent", growth.exponent);
    out << YAML::EndMap;
  }
  out << YAML::EndSeq;
}

void write(YAML::Emitter& out, const SaturationSpec& saturation) {
  out << YAML::Key << "saturation" << YAML::Value << YAML::Flow << YAML::BeginMap << YAML::Key << "form"
      << YAML::Value << (saturation.exponential ? "exponential" : "hyperbolic");
  write(out, "chambers_pa", saturation.chambers_pa);
  write(out, "tendons_n", saturation.tendons_n);
  write(out, "cables_rad", saturation.cables_rad);
  out << YAML::EndMap;
}

void write(YAML::Emitter& out, const char* key, const std::vector<CreepSpec::Part>& parts) {
  out << YAML::Key << key << YAML::Value << YAML::BeginSeq;
  for (const CreepSpec::Part& part : parts) {
    out << YAML::Flow << YAML::BeginMap;
    write(out, "time_s", part.time_s);
    write(out, "share", part.share);
    write(out, "decades", part.decades);
    out << YAML::EndMap;
  }
  out << YAML::EndSeq;
}

void write(YAML::Emitter& out, const CreepSpec& creep) {
  if (creep.moment.empty() && creep.length.empty()) return;
  out << YAML::Key << "creep" << YAML::Value << YAML::BeginMap;
  write(out, "moment", creep.moment);
  write(out, "length", creep.length);
  write(out, "slows_pa", creep.slows_pa);
  write(out, "grows_pa", creep.grows_pa);
  write(out, "before_moment_x_nm", creep.before_moment_nm.x());
  write(out, "before_moment_y_nm", creep.before_moment_nm.y());
  write(out, "before_length_m", creep.before_length_m);
  out << YAML::EndMap;
}

void write(YAML::Emitter& out, const SegmentSpec& segment) {
  out << YAML::BeginMap;
  write(out, "length_m", segment.length_m);
  write(out, "mass_kg", segment.mass_kg);
  write(out, "stiffness_base_nm2", segment.stiffness_base_nm2);
  write(out, "stiffness_per_min_nm2_per_pa", segment.stiffness_per_min_nm2_per_pa);
  write(out, "stiffness_per_jamming_nm2_per_pa", segment.stiffness_per_jamming_nm2_per_pa);
  write(out, segment.stiffness_growth);
  write(out, segment.saturation);
  write(out, segment.creep);
  if (segment.joint) {
    out << YAML::Key << "joint" << YAML::Value << YAML::Flow << YAML::BeginMap;
    write(out, "stiffness_nm_per_rad", segment.joint->stiffness_nm_per_rad);
    write(out, "length_m", segment.joint->length_m);
    out << YAML::EndMap;
  }
  write(out, "torsional_stiffness_nm2", segment.torsional_stiffness_nm2);
  write(out, "axial_stiffness_n", segment.axial_stiffness_n);
  write(out, "shear_stiffness_n", segment.shear_stiffness_n);
  write(out, "retardation_s", segment.retardation_s);
  if (!segment.stiffness_by_pressure.empty()) {
    out << YAML::Key << "stiffness_by_pressure" << YAML::Value << YAML::BeginSeq;
    for (const StiffnessAtPressure& knot : segment.stiffness_by_pressure) {
      out << YAML::Flow << YAML::BeginMap;
      write(out, "pressure_pa", knot.pressure_pa);
      write(out, "bending_stiffness_nm2", knot.bending_stiffness_nm2);
      out << YAML::EndMap;
    }
    out << YAML::EndSeq;
  }
  if (!segment.chambers.empty()) {
    out << YAML::Key << "chambers" << YAML::Value << YAML::BeginSeq;
    for (const ChamberSpec& chamber : segment.chambers) {
      out << YAML::Flow << YAML::BeginMap;
      out << YAML::Key << "input" << YAML::Value << fmt::format("chamber_{}", chamber.input + 1);
      write(out, "direction_rad", chamber.direction_rad);
      write(out, "moment_gain_nm_per_pa", chamber.moment_gain_nm_per_pa);
      write(out, "near_elongation_m_per_pa", chamber.near_elongation_m_per_pa);
      write(out, "far_elongation_m_per_pa", chamber.far_elongation_m_per_pa);
      write(out, "saturation_pa", chamber.saturation_pa);
      out << YAML::EndMap;
    }
    out << YAML::EndSeq;
  }
  if (!segment.tendons.empty()) {
    out << YAML::Key << "tendons" << YAML::Value << YAML::BeginSeq;
    for (const TendonSpec& tendon : segment.tendons) {
      out << YAML::Flow << YAML::BeginMap;
      out << YAML::Key << "input" << YAML::Value << fmt::format("tendon_{}", tendon.input + 1);
      write(out, "azimuth_rad", tendon.azimuth_rad);
      write(out, "offset_m", tendon.offset_m);
      write(out, "saturation_n", tendon.saturation_n);
      out << YAML::EndMap;
    }
    out << YAML::EndSeq;
  }
  if (!segment.cables.empty()) {
    out << YAML::Key << "cables" << YAML::Value << YAML::BeginSeq;
    for (const CableSpec& cable : segment.cables) {
      out << YAML::Flow << YAML::BeginMap;
      out << YAML::Key << "input" << YAML::Value << fmt::format("servo_{}", cable.input + 1);
      write(out, "azimuth_rad", cable.azimuth_rad);
      write(out, "lever_m", cable.lever_m);
      write(out, "spool_radius_m", cable.spool_radius_m);
      write(out, "saturation_rad", cable.saturation_rad);
      out << YAML::EndMap;
    }
    out << YAML::EndSeq;
  }
  out << YAML::EndMap;
}

}  // namespace

std::string truth_yaml(const Scenario& scenario) {
  YAML::Emitter out;
  out << YAML::BeginMap;
  out << YAML::Key << "scenario" << YAML::Value << scenario.name;
  out << YAML::Key << "seed" << YAML::Value << fmt::format("{}", scenario.seed);
  write(out, "duration_s", scenario.duration_s);
  out << YAML::Key << "hidden" << YAML::Value << YAML::BeginSeq;
  for (const HiddenChoice& choice : scenario.hidden) {
    out << YAML::BeginMap << YAML::Key << "effect" << YAML::Value << choice.effect;
    if (!choice.form.empty()) out << YAML::Key << "form" << YAML::Value << choice.form;
    for (const auto& [key, value] : choice.values) write(out, key.c_str(), value);
    out << YAML::EndMap;
  }
  out << YAML::EndSeq;
  const Eigen::Quaterniond& q = scenario.mount.q_mocap_base;
  out << YAML::Key << "mount" << YAML::Value << YAML::BeginMap << YAML::Key << "quaternion_xyzw"
      << YAML::Value << YAML::Flow << YAML::BeginSeq << shortest(q.x()) << shortest(q.y()) << shortest(q.z())
      << shortest(q.w()) << YAML::EndSeq << YAML::EndMap;
  out << YAML::Key << "mocap" << YAML::Value << YAML::BeginMap;
  write(out, "rate_hz", scenario.mocap.rate_hz);
  write(out, "position_sd_m", scenario.mocap.ring_noise.position_sd_m);
  write(out, "orientation_sd_rad", scenario.mocap.ring_noise.orientation_sd_rad);
  write(out, "dropout_probability", scenario.mocap.dropout_probability);
  out << YAML::EndMap;
  out << YAML::Key << "arm" << YAML::Value << YAML::BeginMap;
  write(out, "tip_mass_kg", scenario.arm.tip_mass_kg);
  write(out, "air_damping_n_s_m2", scenario.arm.air_damping_n_s_m2);
  out << YAML::Key << "segments" << YAML::Value << YAML::BeginSeq;
  for (const SegmentSpec& segment : scenario.arm.segments) write(out, segment);
  out << YAML::EndSeq << YAML::EndMap << YAML::EndMap;
  return std::string("# The truth of a simulated trial. Not for whoever estimates or diagnoses it.\n") +
         out.c_str() + "\n";
}

}  // namespace softarm::rig
