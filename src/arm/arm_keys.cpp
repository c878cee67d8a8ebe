#include "arm_keys.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

namespace softarm::yaml {
namespace {

using Words = std::vector<std::string>;

KeySpec number(std::string name, std::string unit, std::string fallback, double low, double high,
               std::string meaning) {
  return {std::move(name),   KeyKind::kNumber, std::move(fallback), std::move(unit), low, high, 1, {},
          std::move(meaning)};
}

KeySpec number_or(std::string name, Words words, std::string unit, std::string fallback, double low,
                  double high, std::string meaning) {
  return {std::move(name),  KeyKind::kNumberOrWord, std::move(fallback), std::move(unit), low, high, 1,
          std::move(words), std::move(meaning)};
}

KeySpec integer(std::string name, std::string fallback, int low, int high, std::string meaning) {
  return {std::move(name),
          KeyKind::kInteger,
          std::move(fallback),
          "",
          static_cast<double>(low),
          static_cast<double>(high),
          1,
          {},
          std::move(meaning)};
}

KeySpec vector(std::string name, int count, std::string unit, std::string fallback, double low, double high,
               std::string meaning) {
  return {std::move(name),   KeyKind::kVector, std::move(fallback), std::move(unit), low, high, count, {},
          std::move(meaning)};
}

KeySpec word(std::string name, Words words, std::string fallback, std::string meaning) {
  return {std::move(name),  KeyKind::kWord,    std::move(fallback), "", 0, 0, 1,
          std::move(words), std::move(meaning)};
}

KeySpec other(std::string name, KeyKind kind, std::string fallback, std::string meaning) {
  return {std::move(name), kind, std::move(fallback), "", 0, 0, 1, {}, std::move(meaning)};
}

KeySpec text(std::string name, std::string fallback, std::string meaning) {
  return other(std::move(name), KeyKind::kText, std::move(fallback), std::move(meaning));
}

KeySpec flag(std::string name, std::string fallback, std::string meaning) {
  return other(std::move(name), KeyKind::kFlag, std::move(fallback), std::move(meaning));
}

KeySpec map(std::string name, std::string fallback, std::string meaning) {
  return other(std::move(name), KeyKind::kMap, std::move(fallback), std::move(meaning));
}

KeySpec list(std::string name, std::string fallback, std::string meaning) {
  return other(std::move(name), KeyKind::kList, std::move(fallback), std::move(meaning));
}

std::vector<KeySpec> pose_keys() {
  return {vector("position_m", 3, "m", "[0, 0, 0]", -100, 100, "origin, x y z"),
          vector("quaternion_xyzw", 4, "", kAbsent, -1.001, 1.001,
                 "rotation as unit quaternion x y z w (or rpy_deg)"),
          vector("rpy_deg", 3, "deg", kAbsent, -360, 360,
                 "rotation as roll, pitch, yaw about the fixed axes x, then y, then z (or quaternion_xyzw)")};
}

}  // namespace

const KeySpec* KeyTable::find(const std::string& name) const {
  for (const KeySpec& key : keys) {
    if (key.name == name) return &key;
  }
  return nullptr;
}

const KeyTable& arm_keys() {
  static const KeyTable table{
      "(top)",
      {integer("format", kRequired, 1, 1, "version of this format"),
       text("name", kRequired, "the arm's name: letters, digits, _"),
       vector("gravity_m_s2", 3, "m/s^2", "[0, 0, -9.80665]", -30, 30, "gravity in the mocap frame"),
       map("base", kRequired, "where the arm is mounted"),
       list("segments", kRequired, "the arm's segments in series, from base to tip; at least one"),
       number("tip_mass_kg", "kg", "0", 0, 20, "mass of the fitting at the tip"),
       map("payload", "{}", "where a payload hangs and what it may weigh"),
       map("noise", "{}", "what measurements of bodies are trusted to; each body may override it"),
       list("bodies", kRequired, "measured bodies, from base to tip"),
       map("inputs", "{}", "topics, types and units"), map("estimator", "{}", "choices of the estimator")}};
  return table;
}

const KeyTable& base_keys() {
  static const KeyTable table{
      "base",
      {text("body", kAbsent, "body whose measured pose carries the base (or give fixed)"),
       map("rod_in_body", "{}", "pose of the rod's base frame (z: tangent, x: phi = 0) in that body's frame"),
       flag("hold_last", "true", "keep the last pose while the body is lost (the mount does not move)"),
       map("fixed", kAbsent, "pose of the rod's base in the mocap frame where no body measures it")}};
  return table;
}

const KeyTable& fixed_base_keys() {
  static const KeyTable table = [] {
    KeyTable keys{"base.fixed", pose_keys()};
    keys.keys.push_back(word("attitude", {"hanging", "standing", "horizontal"}, kAbsent,
                             "instead of a rotation: hanging (tangent along gravity), standing (against it), "
                             "horizontal (along the mocap frame's x)"));
    return keys;
  }();
  return table;
}

const KeyTable& transform_keys() {
  static const KeyTable table{"rod_in_body, section_in_body", pose_keys()};
  return table;
}

const KeyTable& segment_keys() {
  static const KeyTable table{
      "segments[]",
      {text("name", kRequired, "unique name: letters, digits, _"),
       number("length_m", "m", kRequired, 0.005, 10, "backbone length at zero input"),
       vector("length_range_m", 2, "m", kAbsent, 0.001, 20,
              "sanity limits of an estimated length; default: 0.7 and 1.5 times length_m"),
       number("mass_per_length_kg_m", "kg/m", kRequired, 0, 50, "mass per length, uniform"),
       number("diameter_m", "m", kRequired, 0.0005, 1, "outer diameter (pictures, markers on the skin)"),
       map("bending_stiffness", kRequired, "EI and how pressures change it"),
       number_or("torsional_stiffness_nm2", {"rigid"}, "N m^2", "rigid", 1e-7, 1e4, "GJ"),
       number_or("axial_stiffness_n", {"rigid"}, "N", "rigid", 0.1, 1e8, "EA"),
       number_or("shear_stiffness_n", {"rigid"}, "N", "rigid", 0.1, 1e8, "GA"),
       vector("rest_curvature_per_m", 3, "1/m", "[0, 0, 0]", -200, 200,
              "strain u at rest in the section frame (x, y: bending, z: twist)"),
       list("chambers", "[]", "pneumatic chambers along the segment"),
       text("jamming_input", kAbsent, "vacuum input of the jamming core; absent: no core")}};
  return table;
}

const KeyTable& stiffness_keys() {
  static const KeyTable table{
      "segments[].bending_stiffness",
      {number("base_nm2", "N m^2", kRequired, 1e-6, 1e3, "b1: EI at zero input"),
       number("per_min_pressure_nm2_per_pa", "N m^2/Pa", "0", 0, 1e-4,
              "b2: EI per Pa of the lowest chamber pressure"),
       number("per_jamming_pressure_nm2_per_pa", "N m^2/Pa", "0", 0, 1e-4,
              "b3: EI per Pa of vacuum plus mean chamber pressure"),
       vector("range_nm2", 2, "N m^2", "[0.0001, 10]", 1e-7, 1e4, "sanity limits of an estimated EI"),
       list("profile", "[]", "knots of a factor on EI and GJ along the segment; empty: uniform")}};
  return table;
}

const KeyTable& profile_keys() {
  static const KeyTable table{
      "segments[].bending_stiffness.profile[]",
      {number("fraction", "", kRequired, 0, 1, "s / length, increasing from knot to knot"),
       number("factor", "", kRequired, 0.01, 100,
              "EI(s) / EI there; linear in between, constant beyond the ends")}};
  return table;
}

const KeyTable& chamber_keys() {
  static const KeyTable table{
      "segments[].chambers[]",
      {text("input", kRequired, "name of the pressure input (inputs.pressures) that feeds it"),
       number("bending_direction_deg", "deg", kRequired, -360, 360,
              "azimuth towards which the arm bends when it is inflated"),
       number("moment_gain_nm_per_pa", "N m/Pa", kRequired, 0, 1e-3, "c: bending moment per gauge pressure"),
       number("near_elongation_m_per_pa", "m/Pa", "0", -1e-5, 1e-5,
              "a1, a3, a5: elongation at the chamber's side"),
       number("far_elongation_m_per_pa", "m/Pa", "0", -1e-5, 1e-5,
              "a2, a4, a6: elongation opposite the chamber")}};
  return table;
}

const KeyTable& payload_keys() {
  static const KeyTable table{
      "payload",
      {number_or("arclength_m", {"tip"}, "m", "tip", 0, 100,
                 "where it hangs along the backbone, at zero input"),
       vector("offset_m", 3, "m", "[0, 0, 0]", -1, 1, "its centre of mass in the section frame there"),
       number("default_kg", "kg", kAbsent, 0, 100, "assumed while no topic tells it; absent: unknown"),
       vector("range_kg", 2, "kg", "[0, 5]", 0, 100, "sanity limits of an estimated payload")}};
  return table;
}

const KeyTable& noise_keys() {
  static const KeyTable table{
      "noise",
      {number("position_sd_m", "m", "0.0005", 1e-6, 0.1, "standard deviation of a position, per coordinate"),
       number("orientation_sd_rad", "rad", "0.02", 1e-5, 1, "standard deviation of a tangent, per axis")}};
  return table;
}

const KeyTable& body_keys() {
  static const KeyTable table{
      "bodies[]",
      {text("name", kRequired, "what the driver calls it; replaces <body> in inputs.bodies.topic"),
       word("kind", {"ring", "skin_marker"}, "ring",
            "ring: a rigid body or ring whose pose is the backbone's; skin_marker: one marker on the skin"),
       number_or("arclength_m", {"tip"}, "m", kRequired, 1e-4, 100,
                 "where along the backbone, from the base over all segments, at zero input"),
       flag("orientation_usable", "false", "rings only: the measured tangent can be trusted"),
       map("section_in_body", "{}", "rings only: pose of the backbone's section frame in the body's frame"),
       number("angle_deg", "deg", kAbsent, -360, 360,
              "skin markers only, required: azimuth in the section frame"),
       number("radius_m", "m", kAbsent, 0, 1, "skin markers only, required: distance from the backbone"),
       number("position_sd_m", "m", kAbsent, 1e-6, 0.1,
              "standard deviation per coordinate; default: noise.position_sd_m"),
       number("orientation_sd_rad", "rad", kAbsent, 1e-5, 1,
              "rings only: standard deviation of the tangent per axis; default: noise.orientation_sd_rad")}};
  return table;
}

const KeyTable& inputs_keys() {
  static const KeyTable table{
      "inputs",
      {map("bodies", "{}", "poses of base and measured bodies"), list("pressures", "[]", "pressure inputs"),
       number("ambient_pressure_pa", "Pa", "101325", 5e4, 1.2e5, "ambient pressure, for absolute pressures"),
       number("input_max_age_s", "s", "0.5", 0.001, 3600, "a pressure older than this is missing"),
       text("payload_topic", "/payload", "std_msgs/Float64, known payload in kg")}};
  return table;
}

const KeyTable& body_input_keys() {
  static const KeyTable table{
      "inputs.bodies",
      {text("topic", "/mocap/<body>/pose", "topic; <body> is replaced by the body's name"),
       word("type", {"geometry_msgs/PoseStamped"}, "geometry_msgs/PoseStamped", "message type"),
       word("unit", {"m", "cm", "mm"}, "m", "unit of its positions"),
       number("sync_tolerance_s", "s", "0.002", 1e-6, 1, "stamps closer than this belong to one frame")}};
  return table;
}

const KeyTable& pressure_input_keys() {
  static const KeyTable table{
      "inputs.pressures[]",
      {text("name", kRequired, "unique name that chambers refer to"), text("topic", kRequired, "topic"),
       word("type",
            {"sensor_msgs/FluidPressure", "std_msgs/Float64", "std_msgs/Float32MultiArray",
             "std_msgs/Float64MultiArray"},
            "sensor_msgs/FluidPressure", "message type"),
       integer("element", "0", 0, 1023, "index in an array message"),
       word("unit", {"Pa", "kPa", "MPa", "bar", "mbar", "psi"}, "Pa", "unit of the values"),
       word("reference", {"absolute", "gauge"}, "absolute", "zero of the values: vacuum or ambient"),
       flag("vacuum", "false", "evacuates a jamming core: the value used is ambient minus absolute")}};
  return table;
}

const KeyTable& estimator_keys() {
  static const KeyTable table{
      "estimator",
      {word("method", {"full_points", "end_orientation", "cc_points", "cc_endpoint"}, "full_points",
            "full_points: eq. (7) of the online paper; end_orientation: eq. (8); cc_...: constant curvature"),
       word("unknown", {"stiffness", "payload"}, "stiffness",
            "what is estimated; the other one must be known"),
       word("objective", {"least_squares", "sum_of_distances"}, "least_squares",
            "what is minimised; sum_of_distances is the paper's"),
       word("weights", {"noise", "paper"}, kAbsent,
            "noise: 1/sd; paper: 1/arclength; default: noise for least_squares, paper for sum_of_distances"),
       flag("robust", "true", "bound the influence of an outlying body and set it aside"),
       number("tells_relative_sd", "", "0.25", 0.001, 10,
              "a frame tells a parameter at this relative standard deviation or better"),
       map("prior", "{}", "trust in the arm's pressure laws")}};
  return table;
}

const KeyTable& prior_keys() {
  static const KeyTable table{
      "estimator.prior",
      {flag("enabled", "false", "use the pressure laws as a prior"),
       number("moment_sd_nm", "N m", "0.02", 1e-6, 100, "standard deviation per component of the moment"),
       number("bending_stiffness_sd_rel", "", "0.2", 0.001, 10, "relative standard deviation of EI"),
       number("length_sd_m", "m", "0.003", 1e-6, 1, "standard deviation of the length")}};
  return table;
}

std::vector<const KeyTable*> all_key_tables() {
  return {&arm_keys(),        &base_keys(),           &fixed_base_keys(), &transform_keys(),
          &segment_keys(),    &stiffness_keys(),      &profile_keys(),    &chamber_keys(),
          &payload_keys(),    &noise_keys(),          &body_keys(),       &inputs_keys(),
          &body_input_keys(), &pressure_input_keys(), &estimator_keys(),  &prior_keys()};
}

std::string allowed_values(const KeySpec& key) {
  const std::string range =
      fmt::format("[{:g}, {:g}]{}", key.low, key.high, key.unit.empty() ? "" : " " + key.unit);
  switch (key.kind) {
    case KeyKind::kNumber:
    case KeyKind::kInteger:
      return range;
    case KeyKind::kNumberOrWord:
      return fmt::format("{} or {}", range, fmt::join(key.words, ", "));
    case KeyKind::kVector:
      return fmt::format("{} numbers in {}", key.count, range);
    case KeyKind::kWord:
      return fmt::format("{}", fmt::join(key.words, ", "));
    case KeyKind::kFlag:
      return "true, false";
    case KeyKind::kText:
      return "text";
    case KeyKind::kMap:
      return "section";
    case KeyKind::kList:
      return "list of sections";
  }
  return "";
}

}  // namespace softarm::yaml
