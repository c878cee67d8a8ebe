#include "arm_keys.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "actuators/actuator.h"
#include "key_builders.h"

namespace softarm::arm::yaml {
namespace {

std::vector<KeySpec> pose_keys() {
  return {vector("position_m", 3, "m", "[0, 0, 0]", -100, 100, "origin, x y z"),
          vector("quaternion_xyzw", 4, "", kAbsent, -1.001, 1.001,
                 "rotation as unit quaternion x y z w (or rpy_deg)"),
          vector("rpy_deg", 3, "deg", kAbsent, -360, 360,
                 "rotation as roll, pitch, yaw about the fixed axes x, then y, then z (or quaternion_xyzw)")};
}

constexpr char kLabelledMarkersMeaning[] =
    "for drivers that send labelled markers: the markers of this body; empty: one marker, whose label is the "
    "body's name";

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
       list("segments", kMostSegments, kRequired,
            "the arm's segments in series, from base to tip; at least one"),
       number("tip_mass_kg", "kg", "0", 0, 20, "mass of the fitting at the tip"),
       map("payload", "{}", "where a payload hangs and what it may weigh"),
       map("noise", "{}", "how far measurements of bodies are trusted; each body may override it"),
       list("bodies", kMostMeasuredBodies, kRequired, "measured bodies, from base to tip"),
       map("inputs", "{}", "topics, types and units"), map("estimator", "{}", "choices of the estimator"),
       list("effects", kMostOfATable, "[]",
            "physics beyond these laws that the model includes, as `softarm diagnose` found it; `softarm "
            "diagnose --effects` lists ids, parameters and ranges"),
       list("effects_correlations", kMostOfATable, "[]",
            "how errors of the effects' parameters go together, as `softarm diagnose` found it; a pair that "
            "is not given has the correlation 0"),
       word("effects_verdict", {"consistent", "explained", "partly_explained", "unknown", "cannot_tell"},
            kAbsent,
            "verdict of the diagnosis that found the effects; with `unknown` something else is there, too, "
            "and commands that use the effects warn")}};
  return table;
}

const KeyTable& base_keys() {
  static const KeyTable table{
      "base",
      {text("body", kAbsent, "body whose measured pose gives the base's pose (or give fixed)"),
       map("rod_in_body", "{}", "pose of the rod's base frame (z: tangent, x: phi = 0) in that body's frame"),
       list("labelled_markers", kMostOfATable, "[]", kLabelledMarkersMeaning),
       flag("hold_last", "true", "keep the last pose while the body is lost (the mount does not move)"),
       map("fixed", kAbsent, "pose of the rod's base in the mocap frame, where no body measures it")}};
  return table;
}

const KeyTable& fixed_base_keys() {
  static const KeyTable table = [] {
    KeyTable keys{"base.fixed", pose_keys()};
    keys.keys.push_back(
        word("attitude", {"hanging", "standing", "horizontal"}, kAbsent,
             "instead of a rotation: hanging (tangent along gravity), standing (tangent against gravity), "
             "horizontal (tangent along the mocap frame's x, the section's x up)"));
    return keys;
  }();
  return table;
}

const KeyTable& transform_keys() {
  static const KeyTable table{"rod_in_body, section_in_body", pose_keys()};
  return table;
}

const KeyTable& payload_keys() {
  static const KeyTable table{
      "payload",
      {number_or("arclength_m", {"tip"}, "m", "tip", 0, 100,
                 "where the payload hangs along the backbone, at zero input"),
       vector("offset_m", 3, "m", "[0, 0, 0]", -1, 1, "its centre of mass in the section frame there"),
       number("default_kg", "kg", kAbsent, 0, 100,
              "payload that is assumed while no topic gives one; absent: unknown"),
       vector("range_kg", 2, "kg", "[0, 5]", 0, 100, "sanity limits of an estimated payload")}};
  return table;
}

const KeyTable& noise_keys() {
  static const KeyTable table{
      "noise",
      {number("position_sd_m", "m", "0.0005", 1e-6, 0.1, "standard deviation of a position, per coordinate"),
       number("orientation_sd_rad", "rad", "0.02", 1e-5, 1, "standard deviation of a tangent, per axis"),
       number("placement_sd_m", "m", "0.001", 0, 0.1,
              "standard deviation of the bodies' places on the arm, per coordinate; the error is the same in "
              "all frames"),
       number("placement_sd_deg", "deg", "0.5", 0, 30,
              "standard deviation of the bodies' tangents from the arm's, per axis; the error is the same in "
              "all frames")}};
  return table;
}

const KeyTable& body_keys() {
  static const KeyTable table{
      "bodies[]",
      {text("name", kRequired, "the driver's name of the body; replaces <body> in inputs.bodies.topic"),
       word("kind", {"ring", "skin_marker"}, "ring",
            "ring: a rigid body or ring whose pose is the backbone's; skin_marker: one marker on the skin"),
       number_or("arclength_m", {"tip"}, "m", kRequired, 1e-4, 100,
                 "place along the backbone, from the base over all segments, at zero input"),
       flag("orientation_usable", "false", "rings only: the measured tangent can be trusted"),
       map("section_in_body", "{}", "rings only: pose of the backbone's section frame in the body's frame"),
       number("angle_deg", "deg", kAbsent, -360, 360,
              "skin markers only, required: azimuth in the section frame"),
       number("radius_m", "m", kAbsent, 0, 1, "skin markers only, required: distance from the backbone"),
       list("labelled_markers", kMostOfATable, "[]", kLabelledMarkersMeaning),
       integer("markers", "1", 1, 32,
               "for drivers that send only unlabelled points: number of markers of the ring's marker cluster "
               "(1: one point; or 3 and more)"),
       number("marker_cluster_radius_m", "m", kAbsent, 1e-3, 1,
              "with several markers: radius of the marker cluster's circle around the ring's centre"),
       number("position_sd_m", "m", kAbsent, 1e-6, 0.1,
              "standard deviation per coordinate; default: noise.position_sd_m"),
       number("orientation_sd_rad", "rad", kAbsent, 1e-5, 1,
              "rings only: standard deviation of the tangent per axis; default: noise.orientation_sd_rad")}};
  return table;
}

const KeyTable& labelled_marker_keys() {
  static const KeyTable table{
      "labelled_markers[]",
      {text("label", kRequired,
            "the driver's name of the marker (or subject/marker; phasespace: its id, in quotes)"),
       vector("position_m", 3, "m", kAbsent, -10, 10,
              "place of the marker in the body's frame; if all of three or more markers have one, any three "
              "of them determine the body's pose; absent: the body's position is the centroid of its "
              "markers, all of which must be seen")}};
  return table;
}

const KeyTable& estimator_keys() {
  static const KeyTable table{
      "estimator",
      {word("method", {"full_points", "end_orientation", "cc_points", "cc_endpoint"}, "full_points",
            "full_points: eq. (7) of the online paper; end_orientation: eq. (8); cc_...: constant curvature"),
       word("unknown", {"stiffness", "payload", "both"}, "stiffness",
            "what is estimated; stiffness and payload each need the other one to be known; both needs the "
            "prior"),
       word("objective", {"least_squares", "sum_of_distances"}, "least_squares",
            "what is minimised; the paper uses sum_of_distances"),
       word("weights", {"noise", "paper"}, kAbsent,
            "noise: 1/sd; paper: 1/arclength; default: noise for least_squares, paper for sum_of_distances"),
       flag("robust", "true", "bound the influence of an outlying body, and set it aside"),
       number("identifiable_relative_sd", "", "0.25", 0.001, 10,
              "a parameter is identifiable in a frame at this relative standard deviation or better"),
       number("window_s", "s", "0", 0, 60,
              "frames within this last time share EI and payload; 0: each frame by itself"),
       word(
           "dynamics", {"static", "modal"}, "static",
           "static: each frame is fitted as if at rest; modal: swings are followed in the arm's first modes"),
       map("prior", "{}", "trust in the arm's laws")}};
  return table;
}

const KeyTable& prior_keys() {
  static const KeyTable table{
      "estimator.prior",
      {flag("enabled", "false", "use the laws' predictions from the inputs as a prior"),
       number(
           "moment_sd_nm", "N m", "0.02", 1e-6, 100,
           "lasting error of the laws: standard deviation per component of the moment (cables: of EI times "
           "curvature)"),
       number("moment_sd_rel", "", "0", 0, 10,
              "the same as a share of the moment; the squares of both are added"),
       number("bending_stiffness_sd_rel", "", "0.2", 0.001, 10, "relative standard deviation of EI"),
       number("length_sd_m", "m", "0.003", 1e-6, 1, "standard deviation of the length"),
       number("axial_stiffness_sd_rel", "", "0.5", 0, 10,
              "relative standard deviation of EA, where EA is given: the stretch by a load is as uncertain; "
              "the default is for an EA that nobody has measured"),
       number("moment_jitter_sd_nm", "N m", "0.002", 0, 100,
              "error that changes from frame to frame, per component of the moment"),
       number("length_jitter_sd_m", "m", "0.0005", 0, 1, "the same for the length")}};
  return table;
}

const KeyTable& effect_keys() {
  static const KeyTable table{"effects[]",
                              {text("id", kRequired, "id of the catalogue: base_compliance, soft_spot, ..."),
                               other("parameters", KeyKind::kNumbers, kRequired,
                                     "the effect's parameters by name, SI units; one that is left out has "
                                     "its usual value, or 0 if it is a size"),
                               other("sd", KeyKind::kNumbers, "{}",
                                     "standard deviations of some parameters, >= 0; the uncertainty of "
                                     "estimates with this effect includes them")}};
  return table;
}

const KeyTable& correlation_keys() {
  static const KeyTable table{
      "effects_correlations[]",
      {text("of", kRequired,
            "a parameter with an `sd`: creep.share; where the effect stands there several times with its "
            "number, marker_slip.2.x_m"),
       other("with", KeyKind::kNumbers, kRequired,
             "other such parameters with their correlations in [-1, 1], each pair once; all together those "
             "of a covariance")}};
  return table;
}

std::vector<const KeyTable*> all_key_tables() {
  std::vector<const KeyTable*> all{&arm_keys(),       &base_keys(),    &fixed_base_keys(),
                                   &transform_keys(), &segment_keys(), &stiffness_keys()};
  const auto append = [&](const std::vector<const KeyTable*>& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  for (const ActuatorKind* kind : actuator_kinds()) append(kind->stiffness_tables());
  append({&profile_keys(), &material_keys(), &wall_keys(), &bending_element_keys(), &axial_element_keys()});
  for (const ActuatorKind* kind : actuator_kinds()) append(kind->segment_tables());
  append({&payload_keys(), &noise_keys(), &body_keys(), &labelled_marker_keys(), &inputs_keys(),
          &body_input_keys(), &base_input_keys(), &pressure_input_keys(), &tension_input_keys(),
          &angle_input_keys(), &estimator_keys(), &prior_keys(), &effect_keys(), &correlation_keys()});
  return all;
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
      return fmt::format("list of up to {:g} sections", key.high);
    case KeyKind::kNumbers:
      return "name: number, ...";
  }
  return "";
}

}  // namespace softarm::arm::yaml
