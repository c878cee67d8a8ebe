// The keys of segments and of their inputs. What drives a segment has its keys in actuators/.
#include "actuators/actuator.h"
#include "body_source.h"
#include "key_builders.h"
#include "wall_memory.h"

namespace softarm::arm::yaml {

namespace {

void append(const std::vector<KeySpec>& more, std::vector<KeySpec>& keys) {
  keys.insert(keys.end(), more.begin(), more.end());
}

}  // namespace

const KeyTable& segment_keys() {
  static const KeyTable table = [] {
    KeyTable keys{
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
         number("joint_compliance_rad_per_nm", "rad/(N m)", kAbsent, 0, 100,
                "rotation of the joint at the segment's start (to the base, or to the segment before) per "
                "bending moment in it; absent: rigid"),
         vector("rest_curvature_per_m", 3, "1/m", "[0, 0, 0]", -200, 200,
                "strain u at rest in the section frame (x, y: bending, z: twist)"),
         map("material", kAbsent, "rubber whose moduli change with axial stretch; absent: linear"),
         map("wall", kAbsent,
             "viscoelastic wall: shares of the laws' curvature and length come late; absent: all comes at "
             "once")}};
    for (const ActuatorKind* kind : actuator_kinds()) append(kind->segment_keys(), keys.keys);
    return keys;
  }();
  return table;
}

const KeyTable& stiffness_keys() {
  static const KeyTable table = [] {
    KeyTable keys{"segments[].bending_stiffness",
                  {number("base_nm2", "N m^2", kRequired, 1e-6, 1e3, "b1: EI at zero input")}};
    for (const ActuatorKind* kind : actuator_kinds()) append(kind->stiffness_keys(), keys.keys);
    append({vector("range_nm2", 2, "N m^2", "[0.0001, 10]", 1e-7, 1e4, "sanity limits of an estimated EI"),
            list("profile", kMostOfATable, "[]",
                 "knots of a factor on EI and GJ along the segment; empty: uniform")},
           keys.keys);
    return keys;
  }();
  return table;
}

const KeyTable& profile_keys() {
  static const KeyTable table{
      "segments[].bending_stiffness.profile[]",
      {number("fraction", "", kRequired, 0, 1, "s / length, increasing from knot to knot"),
       number("factor", "", kRequired, 0.01, 100,
              "EI(s) / EI at this place; linear in between, constant beyond the ends")}};
  return table;
}

const KeyTable& material_keys() {
  static const KeyTable table{"segments[].material",
                              {number("c10_pa", "Pa", kRequired, -1e9, 1e9,
                                      "C10 of two-term Mooney-Rivlin rubber (hybrid paper (13))"),
                               number("c01_pa", "Pa", kRequired, -1e9, 1e9,
                                      "C01; 6 (C10 + C01), the modulus at rest, must be positive")}};
  return table;
}

const KeyTable& wall_keys() {
  static const KeyTable table{
      "segments[].wall",
      {list("bending", kMostWallElements, "[]",
            "Kelvin-Voigt elements of the curvature that actuation causes"),
       list("axial", kMostWallElements, "[]", "the same for the length"),
       number("slows_per_pa", "1/Pa", kAbsent, 0, 0.001,
              "time constants grow by 1 + this times the mean gauge pressure of the segment's chambers; "
              "absent: not at all"),
       number("shares_grow_per_pa", "1/Pa", kAbsent, 0, 0.001,
              "the ratio of what comes late to what comes at once grows by 1 + this times the same mean "
              "pressure; absent: not at all"),
       number("initial_curvature_sd_per_m", "1/m", kAbsent, 1e-6, 1000,
              "when a recording begins: standard deviation of each element of bending from the laws' value, "
              "per component; default: 0.2 rad over length_m"),
       number("initial_length_sd_m", "m", kAbsent, 1e-9, 1,
              "the same for each axial element; default: 2 % of length_m"),
       number("lag_s", "s", kAbsent, 0, 10,
              "time by which the bent wall lags its moments, including those of loads, where the model "
              "includes motion (diagnose starts its fit here); absent: 0.02")}};
  return table;
}

namespace {

std::vector<KeySpec> element_keys() {
  return {
      number("time_s", "s", kRequired, kLeastWallTime_s, kMostWallTime_s, "time constant without pressure"),
      number("share", "", kRequired, 0, kMostWallShare,
             "share of the laws' value that comes with this time constant; the shares of a list add up to at "
             "most 0.98")};
}

}  // namespace

const KeyTable& bending_element_keys() {
  static const KeyTable table{"segments[].wall.bending[]", element_keys()};
  return table;
}

const KeyTable& axial_element_keys() {
  static const KeyTable table{"segments[].wall.axial[]", element_keys()};
  return table;
}

const KeyTable& inputs_keys() {
  static const KeyTable table{
      "inputs",
      {map("bodies", "{}", "topics of the poses or points of base and measured bodies"),
       map("base", kAbsent, "topic of the base's body, where it comes another way than the others"),
       list("pressures", kMostInputs, "[]", "pressure inputs"),
       list("tensions", kMostInputs, "[]", "tension inputs of tendons"),
       list("angles", kMostInputs, "[]", "angle inputs of servos"),
       number("ambient_pressure_pa", "Pa", "101325", 5e4, 1.2e5,
              "ambient pressure, from which absolute pressures are counted"),
       number("input_max_age_s", "s", "0.5", 0.001, 3600,
              "a pressure, tension or angle older than this counts as missing"),
       text("payload_topic", "/payload", "topic of the known payload, std_msgs/Float64 in kg")}};
  return table;
}

namespace {

constexpr char kFieldMeaning[] =
    "where the number is in a message of another type: effort[2], chambers[0].pressure";
constexpr char kStampMeaning[] =
    "which stamp counts: that of the header (of receipt where there is none), or that of receipt";
constexpr char kLatencyMeaning[] =
    "subtracted from every stamp (of the header, or of receipt): the delay, plus the time by which the clock "
    "of the stamps is ahead";

KeySpec noise_sd_key() {
  return number("noise_sd", "", kAbsent, 0, 1e6,
                "standard deviation of one value's noise, in that unit, for identify; absent: measured from "
                "the recording");
}

KeySpec zero_sd_key() {
  return number("zero_sd", "", "0", 0, 1e6,
                "standard deviation of an error of the zero, in that unit; identify fits one per trial");
}

KeySpec between_key() {
  return word("between", {"sampled", "held"}, kAbsent,
              "value between two samples: sampled (of a sensor): a straight line from one to the next; held "
              "(a latched command): the last sample; absent: sampled if samples come at a steady rate of 2 "
              "Hz or more, else held");
}

}  // namespace

namespace {

std::vector<KeySpec> body_source_keys() {
  Words types;
  for (const BodyType& known : body_types()) types.push_back(known.type);
  return {text("topic", "/mocap/<body>/pose",
               "topic; <body> is replaced by the body's name; a topic whose messages hold all bodies has no "
               "<body>"),
          word("type", types, "geometry_msgs/PoseStamped",
               "message type (doc/drivers.md: which driver sends what)"),
          word("unit", {"m", "cm", "mm"}, kAbsent,
               "unit of the positions; default: mm for vicon_bridge/Markers, else m"),
          text("axes", "x y z",
               "the driver's axes along the mocap frame's x, y and z: \"x -z y\" if the driver's y is up, "
               "\"x z y\" if it is a mirror image"),
          text("frame", kAbsent,
               "frame_id that is read; others are rejected (leading slashes do not matter); absent: any "
               "frame_id, taken for the mocap frame"),
          text("child_frame", "<body>", "tf only: a body's frame"),
          word("stamp", {"header", "receipt", "server"}, "header",
               "which stamp counts: that of the header (of receipt where there is none), that of receipt, or "
               "phasespace's own time of each marker"),
          flag("labels", "true",
               "lists of markers only; false: their labels are not reliable, and the points are associated"),
          number("marker_tolerance_m", "m", "0.005", 1e-5, 0.1,
                 "labelled markers only: largest rms distance from their places on the body")};
}

}  // namespace

const KeyTable& body_input_keys() {
  static const KeyTable table = [] {
    KeyTable keys{"inputs.bodies", body_source_keys()};
    keys.keys.push_back(
        number("sync_tolerance_s", "s", "0.002", 1e-6, 1, "stamps closer than this belong to one frame"));
    keys.keys.push_back(number("latency_s", "s", "0", -3600, 3600, kLatencyMeaning));
    return keys;
  }();
  return table;
}

const KeyTable& base_input_keys() {
  static const KeyTable table{"inputs.base", body_source_keys()};
  return table;
}

const KeyTable& pressure_input_keys() {
  static const KeyTable table{
      "inputs.pressures[]",
      {text("name", kRequired, "unique over all inputs; chambers refer to it"),
       text("topic", kRequired, "topic"),
       text("type", "sensor_msgs/FluidPressure",
            "message type: sensor_msgs/FluidPressure, std_msgs/Float64, std_msgs/Float32MultiArray, "
            "std_msgs/Float64MultiArray, or any other with field"),
       integer("element", "0", 0, 1023, "index in an array message"), text("field", kAbsent, kFieldMeaning),
       word("stamp", {"header", "receipt"}, "header", kStampMeaning),
       word("unit", {"Pa", "kPa", "MPa", "bar", "mbar", "psi"}, "Pa", "unit of the values"),
       word("reference", {"absolute", "gauge"}, "absolute", "zero of the values: vacuum or ambient"),
       number("zero", "", "0", -1e7, 1e7,
              "amount by which the sensor reads too high, in that unit; it is subtracted"),
       noise_sd_key(), zero_sd_key(),
       flag("vacuum", "false",
            "true: this input evacuates a jamming core, and the value used is ambient minus absolute"),
       number("latency_s", "s", "0", -3600, 3600, kLatencyMeaning), between_key()}};
  return table;
}

namespace {

/// What a topic of plain numbers says of itself.
std::vector<KeySpec> number_topic_keys(std::string who_refers) {
  return {
      text("name", kRequired, "unique over all inputs; " + std::move(who_refers) + " refer to it"),
      text("topic", kRequired, "topic"),
      text("type", "std_msgs/Float64",
           "message type: std_msgs/Float64, std_msgs/Float32MultiArray, std_msgs/Float64MultiArray, or any "
           "other with field"),
      integer("element", "0", 0, 1023, "index in an array message"),
      text("field", kAbsent, kFieldMeaning),
      word("stamp", {"header", "receipt"}, "header", kStampMeaning),
      number("latency_s", "s", "0", -3600, 3600, kLatencyMeaning),
      between_key()};
}

}  // namespace

const KeyTable& tension_input_keys() {
  static const KeyTable table = [] {
    KeyTable keys{"inputs.tensions[]", number_topic_keys("tendons")};
    keys.keys.push_back(word("unit", {"N", "mN", "kgf", "gf"}, "N", "unit of the values"));
    keys.keys.push_back(number("zero", "", "0", -1e6, 1e6, "value when the tendon is slack, in that unit"));
    keys.keys.push_back(noise_sd_key());
    keys.keys.push_back(zero_sd_key());
    return keys;
  }();
  return table;
}

const KeyTable& angle_input_keys() {
  static const KeyTable table = [] {
    KeyTable keys{"inputs.angles[]", number_topic_keys("cables")};
    keys.keys.push_back(word("unit", {"rad", "deg"}, "rad", "unit of the values"));
    keys.keys.push_back(number("rad_per_unit", "rad", kAbsent, -1e3, 1e3,
                               "instead of unit: rad per count, for example of a PWM; negative if counts "
                               "grow in the opposite direction"));
    keys.keys.push_back(
        number("zero", "", "0", -1e6, 1e6, "value when the arm is straight, in that unit or in counts"));
    keys.keys.push_back(noise_sd_key());
    keys.keys.push_back(zero_sd_key());
    return keys;
  }();
  return table;
}

}  // namespace softarm::arm::yaml
