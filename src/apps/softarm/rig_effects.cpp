#include "rig_effects.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "rig_messages.h"

namespace softarm::app {
namespace {

using rig::HiddenChoice;
using Choices = std::vector<HiddenChoice>;

constexpr double kDegPerRad = 180.0 / M_PI;
// What shares of the catalogue refer to.
constexpr double kPressurePa = 50e3, kVacuumPa = 60e3, kTensionN = 3.0;
constexpr double kGainPerM = 5.0;
constexpr double kLoopPa = 50e3, kLoopN = 4.0, kLoopRad = 0.6, kLoopPerM = 20.0;
constexpr double kNearly = 0.1;      // share by which two numbers may differ that the rig has as one
constexpr double kFlat_per_m = 2.0;  // curvature of a wall: 30 mm beside it, it falls back by 1 mm
constexpr double kMinute_s = 60.0;

/// An effect's numbers by name.
class Numbers {
 public:
  Numbers(const arm::Arm& arm, const model::Present& present) : arm_(arm), present_(present) {}
  double operator()(const std::string& symbol) const {
    const auto& parameters = present_.effect->info().parameters;
    for (std::size_t k = 0; k < parameters.size(); ++k)
      if (parameters[k].symbol == symbol) return present_.values[static_cast<Eigen::Index>(k)];
    throw std::logic_error(present_.effect->info().id + " has no " + symbol);
  }
  double size(const std::string& x, const std::string& y) const { return std::hypot((*this)(x), (*this)(y)); }
  double azimuth_deg(const std::string& x, const std::string& y) const {
    return kDegPerRad * std::atan2((*this)(y), (*this)(x));
  }
  const arm::Arm& arm() const { return arm_; }
  const std::string& id() const { return present_.effect->info().id; }

 private:
  const arm::Arm& arm_;
  const model::Present& present_;
};

HiddenChoice choice(const std::string& id, const std::string& form, std::map<std::string, double> values) {
  return {id, form, std::move(values)};
}

/// The same number under the same name.
std::function<Choices(const Numbers&)> same(const std::string& form, const std::vector<std::string>& names,
                                            const std::map<std::string, double>& more = {}) {
  return [=](const Numbers& v) {
    HiddenChoice one{v.id(), form, more};
    for (const std::string& name : names) one.values[name] = v(name);
    return Choices{one};
  };
}

bool nearly(double a, double b) {
  return std::abs(a - b) <= kNearly * std::max(std::abs(a), std::abs(b));
}

/// The choice of what may be one chamber's, which the arm file numbers by all its pressures and the rig by
/// those that drive something; none where it drives nothing.
Choices of_chamber(const Numbers& v, HiddenChoice one) {
  auto left = std::lround(v("chamber"));
  one.values["chamber"] = 0.0;
  if (left == 0) return {one};
  const std::vector<arm::ScalarInput>& inputs = v.arm().inputs.scalars;
  const std::vector<std::size_t> driven = driven_inputs(v.arm(), arm::InputKind::kPressure);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (inputs[i].kind != arm::InputKind::kPressure || --left != 0) continue;
    const auto place = std::find(driven.begin(), driven.end(), i);
    if (place == driven.end()) return {};
    one.values["chamber"] = static_cast<double>(place - driven.begin() + 1);
    return {one};
  }
  return {};
}

Choices hysteresis(const Numbers& v) {
  const int of = static_cast<int>(std::lround(v("of")));
  const double loop = v("share") * v("width_pa") / kLoopPa, width = v("width_pa") / kLoopPa;
  if (of == 1)
    return {choice("hysteresis", "material",
                   {{"loop_per_m", loop * kLoopPerM}, {"yield_per_m", 0.5 * width * kLoopPerM}})};
  const HiddenChoice play = choice("hysteresis", "play",
                                   {{"loop_pa", of == 0 ? loop * kLoopPa : 0.0},
                                    {"loop_n", of == 2 ? loop * kLoopN : 0.0},
                                    {"loop_rad", of == 3 ? loop * kLoopRad : 0.0}});
  return of == 0 ? of_chamber(v, play) : Choices{play};
}

Choices leak(const Numbers& v) {
  return of_chamber(v, choice("pressure_leak", v("in_holds") > 0.5 ? "in_holds" : "steady",
                              {{"share", v("share")}, {"time_s", v("time_s")}}));
}

Choices chamber_mismatch(const Numbers& v) {
  return of_chamber(v, choice("chamber_mismatch", "", {{"share", v("share")}}));
}

Choices pressure_offset(const Numbers& v) {
  Choices list;
  int sensor = 0, pressures = 0, vacuums = 0;
  for (const arm::ScalarInput& input : v.arm().inputs.scalars) {
    const bool vacuum = input.kind == arm::InputKind::kVacuum;
    if (!vacuum && input.kind != arm::InputKind::kPressure) continue;
    const int number = vacuum ? ++vacuums : ++pressures;
    if (++sensor > 8) break;
    const double offset_pa = v(fmt::format("offset_{}_pa", sensor));
    if (offset_pa != 0.0)
      list.push_back(choice("pressure_offset", vacuum ? "vacuum" : "pressure",
                            {{"number", static_cast<double>(number)}, {"offset_pa", offset_pa}}));
  }
  return list;
}

Choices drift(const Numbers& v) {
  const double fading = v("fading_per_min");
  const bool fades = fading > 1e-6;
  const double minutes = fades ? 1.0 / fading : 1.0;
  return {choice("drift", fades ? "saturating" : "linear",
                 {{"gain_share", minutes * v("gain_per_min")},
                  {"stiffness_share", minutes * v("stiffness_per_min")},
                  {"over_s", minutes * kMinute_s}})};
}

/// The rig has one of the two.
Choices mullins(const Numbers& v) {
  const double share = v("share"), fresh = v("fresh_share");
  if (share > 0.0 && fresh > 0.0)
    throw std::invalid_argument("a share and a fresh share at once have no counterpart in the virtual rig");
  if (fresh == 0.0)
    return {choice("mullins", "ogden_roxburgh", {{"share", share}, {"scale_per_m", v("scale_per_m")}})};
  // Over as many curvatures as its law falls to half.
  return {
      choice("mullins", "softening", {{"share", fresh}, {"scale_per_m", v("scale_per_m") / std::log(2.0)}})};
}

/// The rig has one phase for both.
Choices temperature(const Numbers& v) {
  constexpr double kPerK = -0.01;
  const double stiffness = v.size("stiffness_sin", "stiffness_cos"),
               phase = std::atan2(v("stiffness_cos"), v("stiffness_sin"));
  const double length = v("length_sin") * std::cos(phase) + v("length_cos") * std::sin(phase);
  const double across = v("length_cos") * std::cos(phase) - v("length_sin") * std::sin(phase);
  if (stiffness == 0.0 || std::abs(across) > kNearly * std::max(std::abs(length), 1e-4))
    throw std::invalid_argument(
        "a length that swings otherwise than the stiffness has no counterpart in the virtual rig");
  // Warmer is softer: the sine of the temperature is the stiffness's half a period on.
  return {choice("temperature", "sine",
                 {{"amplitude_k", -stiffness / kPerK},
                  {"period_s", kMinute_s * v("period_min")},
                  {"phase_deg", kDegPerRad * std::remainder(phase + M_PI, 2.0 * M_PI)},
                  {"stiffness_share_per_k", kPerK},
                  {"expansion_share_per_k", length / stiffness * kPerK}})};
}

Choices base_free_play(const Numbers& v) {
  return {choice("base_free_play", "ring", {{"play_deg", kDegPerRad * v("play_rad")}})};
}

Choices curvature_softening(const Numbers& v) {
  // The catalogue's curvature grows by `softer` for the moment beyond: the stiffness there falls by this.
  return {choice(
      "curvature_softening", "wrinkling",
      {{"share", std::min(0.85, v("softer") / (1.0 + v("softer")))}, {"knee_per_m", v("knee_per_m")}})};
}

Choices axial_memory(const Numbers& v) {
  return {choice("axial_memory", "spectrum",
                 {{"share", v("share")}, {"time_s", v("time_s")}, {"before_share", 0.0}})};
}

Choices torsion(const Numbers& v) {
  if (v("twist_rad") == 0.0) return {};
  const double twist_deg = kDegPerRad * v("twist_rad");
  for (const arm::Segment& segment : v.arm().segments) {
    if (!segment.chambers.empty() || segment.central_chamber)
      return {choice("torsion", "pressure", {{"twist_deg", twist_deg}, {"reference_pa", kPressurePa}})};
  }
  return {choice("torsion", "tension", {{"twist_deg", twist_deg}, {"reference_n", kTensionN}})};
}

Choices soft_spot(const Numbers& v) {
  const double length = v.arm().total_length_m();
  return {choice("soft_spot", "even",
                 {{"centre_fraction", v("centre_m") / length},
                  {"width_fraction", v("width_m") / length},
                  {"share", v("share")}})};
}

Choices base_compliance(const Numbers& v) {
  return {choice("base_compliance", "", {{"stiffness_nm_per_rad", 1.0 / v("compliance_rad_per_nm")}})};
}

Choices base_tilt(const Numbers& v) {
  return {choice("base_tilt", "",
                 {{"angle_deg", kDegPerRad * v.size("towards_x_rad", "towards_y_rad")},
                  {"azimuth_deg", v.azimuth_deg("towards_x_rad", "towards_y_rad")}})};
}

Choices gravity_direction(const Numbers& v) {
  return {choice("gravity_direction", "",
                 {{"angle_deg", kDegPerRad * v.size("towards_x_rad", "towards_y_rad")},
                  {"azimuth_deg", v.azimuth_deg("towards_x_rad", "towards_y_rad")}})};
}

Choices pressure_dead_zone(const Numbers& v) {
  if (!nearly(v("lost_pa"), v("edge_pa")))
    throw std::invalid_argument("lost_pa differs from edge_pa, which the virtual rig has as one");
  return of_chamber(v, choice("pressure_dead_zone", "sharp", {{"pressure_pa", v("lost_pa")}}));
}

Choices tendon_slack(const Numbers& v) {
  if (!nearly(v("lost_rad"), v("edge_rad")))
    throw std::invalid_argument("lost_rad differs from edge_rad, which the virtual rig has as one");
  return {choice("tendon_slack", "taut", {{"angle_deg", kDegPerRad * v("lost_rad")}})};
}

/// The rig's cables lack one by one what the segments before have of their lengths, and all that are there
/// add up.
Choices tendon_length(const Numbers& v) {
  std::optional<double> together;  // of the cables of a segment, of a bend towards which they pull
  const std::vector<arm::Segment>& segments = v.arm().segments;
  for (std::size_t i = 1; i < segments.size(); ++i) {
    if (segments[i].cables.empty()) continue;
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    for (const arm::Cable& cable : segments[i].cables) {
      const Eigen::Vector2d towards(std::cos(cable.bending_direction_rad),
                                    std::sin(cable.bending_direction_rad));
      sum += towards * towards.transpose();
    }
    // Its eigenvalues: alike all round, or of one direction alone.
    const double half = 0.5 * sum.trace(), apart = std::sqrt(std::max(0.0, half * half - sum.determinant()));
    const bool one_way = half - apart < kNearly * half;
    if (!(one_way || apart < kNearly * half) || (together && !nearly(*together, half + apart)))
      throw std::invalid_argument(
          "cables of which some directions or segments have more than others have no counterpart in the "
          "virtual rig");
    together = half + apart;
  }
  return {choice("tendon_length", "held", {{"share", v("share") / together.value_or(1.0)}})};
}

Choices pressure_lag(const Numbers& v) {
  if (!nearly(v("fall"), 1.0))
    throw std::invalid_argument("the virtual rig's first-order line falls as fast as it rises");
  return of_chamber(v, choice("pressure_lag", "first_order", {{"time_constant_s", v("delay_s")}}));
}

Choices supply_sag(const Numbers& v) {
  if (v("returned") > kNearly)
    throw std::invalid_argument(
        "a source that has back at once what chambers vent has no counterpart in the virtual rig");
  if (v("bends") > kNearly)
    throw std::invalid_argument("the loss of the virtual rig's tank does not bend, it ends");
  // A tank gives no less once what was taken of it has reached the reference: as far off as the rig lets it
  // be.
  constexpr double kMost = 0.9;
  return {choice("supply_sag", "tank",
                 {{"share", kMost},
                  {"reference_pa", kMost * kPressurePa / v("share")},
                  {"refill_pa_per_s", v("refill_pa_per_s") + kPressurePa / v("time_s")}})};
}

Choices skin_marker(const Numbers& v) {
  const double body = v("body") > 0.5 ? v("body") : -1.0;
  Choices list;
  if (v("across_m2") != 0.0)
    list.push_back(
        choice("skin_marker", "sleeve",
               {{"body", body}, {"way_m2", v("across_m2")}, {"saturates_per_m", 1e6}, {"tilt_rad_m", 0.0}}));
  if (v.size("slide_x_m2", "slide_y_m2") > 0.0)
    list.push_back(choice("skin_marker", "patch",
                          {{"body", body},
                           {"way_m2", v.size("slide_x_m2", "slide_y_m2")},
                           {"side_deg", v.azimuth_deg("slide_x_m2", "slide_y_m2")},
                           {"patch_m", 1e-3}}));
  return list;
}

Choices camera_scale(const Numbers& v) {
  const double share = v("share"), heights = share + v("height_share");
  if (v("warms_min") > 0.0) {
    if (heights != share)
      throw std::invalid_argument(
          "cameras that stretch heights by a share of their own while they warm up are nothing the virtual "
          "rig has");
    return {choice("camera_scale", "warming",
                   {{"share", share}, {"warms_s", 60.0 * v("warms_min") / std::log(2.0)}})};
  }
  if (share == 0.0 && heights != 0.0)
    throw std::invalid_argument(
        "a mocap of which the heights alone are too long has no counterpart in the virtual rig");
  return {choice("camera_scale", "axes",
                 {{"share", share}, {"height_ratio", share == 0.0 ? 1.0 : heights / share}})};
}

Choices camera_bow(const Numbers& v) {
  return {choice("camera_bow", "fading", {{"off", v("bow_per_m2")}, {"fades_m", 100.0}})};
}

Choices flow_limit(const Numbers& v) {
  if (!nearly(v("share"), 1.0))
    throw std::invalid_argument("a limit that is kept by a share only has no counterpart in the virtual rig");
  const bool shared = nearly(v("together"), 1.0);
  if (!shared && v("together") > kNearly)
    throw std::invalid_argument(
        "a limit that chambers have partly in common has no counterpart in the virtual rig: together must be "
        "0 or 1");
  return {choice("flow_limit", shared ? "shared" : "slew",
                 {{"rise_pa_per_s", v("rise_pa_per_s")}, {"fall_pa_per_s", v("fall") * v("rise_pa_per_s")}})};
}

/// Of one input: its clock is behind all others.
Choices clock_offset(const Numbers& v) {
  const auto of = static_cast<std::size_t>(std::lround(v("input")));
  if (of == 0) return {choice("clock_offset", "", {{"offset_s", v("offset_s")}})};
  const std::vector<arm::ScalarInput>& inputs = v.arm().inputs.scalars;
  const arm::ScalarInput& input = inputs.at(of - 1);
  if (input.type != "sensor_msgs/FluidPressure" || input.stamp != arm::StampSource::kHeader)
    throw std::invalid_argument(fmt::format(
        "a clock of its own of {}, whose messages have no stamp, has no counterpart in the virtual rig",
        input.name));
  const bool vacuum = input.kind == arm::InputKind::kVacuum;
  const std::vector<std::size_t> driven = driven_inputs(v.arm(), input.kind);
  const auto place = std::find(driven.begin(), driven.end(), of - 1);
  if (place == driven.end()) return {};  // the rig does not send what drives nothing
  return {choice("input_clock", vacuum ? "vacuum" : "pressure",
                 {{"number", vacuum ? 1.0 : static_cast<double>(place - driven.begin() + 1)},
                  {"offset_s", -v("offset_s")}})};
}

/// The catalogue's session goes by the clock of the bodies, the rig's by the other one.
Choices clock_drift(const Numbers& v) {
  Choices choices{choice("clock_drift", "", {{"drift_ppm", 1e6 * v("rate") / (1.0 - v("rate"))}})};
  if (v("offset_s") != 0.0) choices.push_back(choice("clock_offset", "", {{"offset_s", v("offset_s")}}));
  return choices;
}

Choices rest_curvature(const Numbers& v) {
  return {choice("rest_curvature", "",
                 {{"curvature_per_m", v.size("towards_x_per_m", "towards_y_per_m")},
                  {"azimuth_deg", v.azimuth_deg("towards_x_per_m", "towards_y_per_m")},
                  {"segment", static_cast<double>(static_cast<int>(v("segment") + 0.5))}})};
}

Choices contact(const Numbers& v) {
  if (v("friction") > kNearly)
    throw std::invalid_argument(
        "friction where a wall touches at one place has no counterpart in the virtual rig");
  if (v("curvature_per_m") > kFlat_per_m)
    throw std::invalid_argument(
        "a round post that touches at one place has no counterpart in the virtual rig");
  if (v("extent_m") > 0.0)
    throw std::invalid_argument(
        "a wall that touches as a spring all along a stretch of the arm has no counterpart in the virtual "
        "rig");
  return {choice("contact", "spring_wall",
                 {{"stiffness_n_per_m", v("stiffness_n_per_m")},
                  {"distance_m", v("distance_m")},
                  {"azimuth_deg", std::remainder(kDegPerRad * v("azimuth_rad"), 360.0)},
                  {"fraction", std::min(1.0, v("place_m") / v.arm().total_length_m())}})};
}

Choices tether(const Numbers& v) {
  const double anchor_m = v.size("anchor_x_m", "anchor_y_m");
  const bool spring = v("mass_kg") == 0.0 && v("length_m") == 0.0;
  if (!spring && v("length_m") < anchor_m)
    throw std::invalid_argument(
        "a tether that weighs, or is slack at times, and pulls at the straight arm is nothing the virtual "
        "rig has");
  std::map<std::string, double> numbers{{"stiffness_n_per_m", v("stiffness_n_per_m")},
                                        {"anchor_distance_m", anchor_m},
                                        {"azimuth_deg", v.azimuth_deg("anchor_x_m", "anchor_y_m")}};
  if (spring) return {choice("tether", "spring", numbers)};
  numbers["slack_m"] = v("length_m") - anchor_m;
  numbers["hose_kg"] = 2.0 * v("mass_kg");  // of which half hangs at the tip
  return {choice("tether", "hose", numbers)};
}

Choices payload_offset(const Numbers& v) {
  return {choice("payload_offset", "",
                 {{"axial_m", v("z_m")},
                  {"lateral_m", v.size("x_m", "y_m")},
                  {"azimuth_deg", v.azimuth_deg("x_m", "y_m")}})};
}

Choices jamming_yield(const Numbers& v) {
  if (!nearly(v("share"), 1.0))
    throw std::invalid_argument("a core of which only a share slips has no counterpart in the virtual rig");
  const bool gradual = v("spread") > 0.5;
  return {
      choice("jamming_yield", gradual ? "bouc_wen" : "elastoplastic", {{"yield_per_m", v("yield_per_m")}})};
}

Choices marker_slip(const Numbers& v) {
  return {choice("marker_bias", "given",
                 {{"body", v("body")}, {"x_m", v("x_m")}, {"y_m", v("y_m")}, {"z_m", v("z_m")}})};
}

Choices bending_plane_offset(const Numbers& v) {
  return {choice("bending_plane_offset", "", {{"angle_deg", kDegPerRad * v("angle_rad")}})};
}

Choices chamber_bulge(const Numbers& v) {
  std::size_t most = 0;
  for (const arm::Segment& segment : v.arm().segments) {
    if (segment.chambers.size() < 2) continue;
    if (most > 0 && segment.chambers.size() != most)
      throw std::invalid_argument(
          "chambers that bulge into another number of neighbours in each segment have no counterpart in the "
          "virtual rig");
    most = segment.chambers.size();
  }
  // The rig takes the sum of the others' pressures, the catalogue their mean.
  return {choice("chamber_bulge", "linear",
                 {{"share", v("share") / static_cast<double>(most - 1)}, {"reference_pa", kPressurePa}})};
}

/// T of M = EI (I + T) u as a share along one direction. The rig leaves EI across it as it is: softer by so
/// much beforehand, see for_the_rig().
Choices plane_stiffness(const Numbers& v) {
  const double uneven = v.size("towards_x", "diagonal");
  return {choice("plane_stiffness", "oval",
                 {{"share", 2.0 * uneven / (1.0 - uneven)},
                  {"azimuth_deg", 0.5 * v.azimuth_deg("towards_x", "diagonal")}})};
}

Choices one_sided_softness(const Numbers& v) {
  return {
      choice("one_sided_softness", "buckles",
             {{"share", v("softer")}, {"azimuth_deg", kDegPerRad * v("side_rad")}, {"to_fraction", 1.0}})};
}

/// The rig has all bending creep or only what the drives make; what is between is nearer to one of them.
bool is_of_the_drives(double driven) {
  return driven > 0.5;
}

/// See also for_the_rig().
Choices creep(const Numbers& v) {
  const bool driven = is_of_the_drives(v("driven"));
  const std::vector<arm::Segment>& segments = v.arm().segments;
  if (driven && std::any_of(segments.begin(), segments.end(),
                            [](const arm::Segment& segment) { return !segment.tendons.empty(); }))
    throw std::invalid_argument(
        "tendons whose pull creeps beyond its law have no counterpart in the virtual rig");
  return {choice("creep", driven ? "wall" : "maxwell", {{"share", v("share")}, {"time_s", v("time_s")}})};
}

Choices curvature_gain(const Numbers& v) {
  const double length_m = v.arm().segments.front().length_m;
  for (const arm::Segment& segment : v.arm().segments)
    if (!nearly(segment.length_m, length_m))
      throw std::invalid_argument("segments of different lengths have no counterpart in the virtual rig");
  return {choice("curvature_gain", "", {{"share_per_rad", v("share") / (kGainPerM * length_m)}})};
}

using Translation = std::function<Choices(const Numbers&)>;

const std::map<std::string, Translation>& translations() {
  static const auto nothing = [](const Numbers&) { return Choices(); };
  static const std::map<std::string, Translation> table{
      {"stiffness_taper", same("linear", {"share"})},
      {"actuation_taper", same("linear", {"share"})},
      {"rigid_ends", same("", {"base_m", "tip_m"})},
      {"soft_spot", soft_spot},
      {"base_compliance", base_compliance},
      {"base_free_play", base_free_play},
      {"base_tilt", base_tilt},
      {"gravity_direction", gravity_direction},
      {"axial_compliance", nothing},
      {"shear", nothing},
      {"torsion", torsion},
      {"pressure_elongation", same("", {"share"}, {{"reference_pa", kPressurePa}})},
      {"vacuum_shortening", same("", {"share"}, {{"reference_pa", kVacuumPa}})},
      {"vacuum_gain", same("", {"share"}, {{"reference_pa", kVacuumPa}})},
      {"strain_stiffening", same("cubic", {"beta_m2"})},
      {"curvature_softening", curvature_softening},
      {"plane_stiffness", plane_stiffness},
      {"one_sided_softness", one_sided_softness},
      {"gain_nonlinearity", same("quadratic", {"share"}, {{"reference_pa", kPressurePa}})},
      {"chamber_bulge", chamber_bulge},
      {"curvature_gain", curvature_gain},
      {"pressure_stiffening", same("linear", {"share"}, {{"reference_pa", kPressurePa}})},
      {"radial_expansion", same("square", {"share"}, {{"reference_pa", kPressurePa}})},
      {"pressure_dead_zone", pressure_dead_zone},
      {"hysteresis", hysteresis},
      {"creep", creep},
      {"axial_memory", axial_memory},
      {"pressure_lag", pressure_lag},
      {"flow_limit", flow_limit},
      {"supply_sag", supply_sag},
      {"clock_offset", clock_offset},
      {"clock_drift", clock_drift},
      {"pressure_leak", leak},
      {"pressure_offset", pressure_offset},
      {"rest_curvature", rest_curvature},
      {"mullins", mullins},
      {"drift", drift},
      {"temperature", temperature},
      {"contact", contact},
      {"tether", tether},
      {"payload_offset", payload_offset},
      {"tip_mass", same("", {"mass_kg"})},
      {"mass_distribution", same("taper", {"share"})},
      {"payload_scale", same("", {"share"})},
      {"jamming_memory", same("", {"share"})},
      {"jamming_yield", jamming_yield},
      {"marker_slip", marker_slip},
      {"skin_marker", skin_marker},
      {"camera_scale", camera_scale},
      {"camera_bow", camera_bow},
      {"bending_plane_offset", bending_plane_offset},
      {"chamber_mismatch", chamber_mismatch},
      {"tendon_slack", tendon_slack},
      {"tendon_length", tendon_length},
      {"tendon_friction", same("", {"coefficient", "routing_rad"})},
  };
  return table;
}

}  // namespace

std::vector<HiddenChoice> in_the_rig(const arm::Arm& arm, const model::Present& present) {
  const model::Info& info = present.effect->info();
  if (present.values.head(info.sizes).isZero(0.0)) return {};
  const auto found = translations().find(info.id);
  if (found == translations().end())
    throw std::invalid_argument(fmt::format("value '{}' has no counterpart in the virtual rig", info.id));
  return found->second(Numbers(arm, present));
}

namespace {

void stiffen(double factor, arm::Segment& segment) {
  arm::StiffnessLaw& law = segment.bending_stiffness;
  for (double* part : {&law.base_nm2, &law.per_min_pressure_nm2_per_pa, &law.per_jamming_pressure_nm2_per_pa})
    *part *= factor;
  for (arm::PressureKnot& knot : law.by_pressure) knot.bending_stiffness_nm2 *= factor;
  for (std::optional<double>* part :
       {&law.per_mean_pressure_nm2_per_pa, &law.per_tension_nm2_per_n, &law.per_min_tension_nm2_per_n,
        &law.per_angle_nm2_per_rad, &law.per_min_angle_nm2_per_rad})
    if (*part) **part *= factor;
  for (arm::Chamber& chamber : segment.chambers)
    if (chamber.stiffness_gain_nm2_per_pa) *chamber.stiffness_gain_nm2_per_pa *= factor;
  for (arm::Tendon& tendon : segment.tendons)
    if (tendon.stiffness_gain_nm2_per_n) *tendon.stiffness_gain_nm2_per_n *= factor;
  for (arm::Cable& cable : segment.cables)
    if (cable.stiffness_gain_nm2_per_rad) *cable.stiffness_gain_nm2_per_rad *= factor;
}

void drive_more(double factor, arm::Segment& segment) {
  for (arm::Chamber& chamber : segment.chambers) chamber.moment_gain_nm_per_pa *= factor;
  for (arm::Cable& cable : segment.cables) cable.curvature_gain_per_m_rad *= factor;
}

}  // namespace

arm::Arm for_the_rig(arm::Arm arm, const std::vector<model::Present>& effects) {
  const auto soften = [](std::optional<double>& stiffness, double compliance) {
    if (compliance != 0.0) stiffness = 1.0 / ((stiffness ? 1.0 / *stiffness : 0.0) + compliance);
  };
  for (const model::Present& present : effects) {
    const std::string& id = present.effect->info().id;
    for (arm::Segment& segment : arm.segments) {
      if (id == "axial_compliance") soften(segment.axial_stiffness_n, present.values[0]);
      if (id == "shear") soften(segment.shear_stiffness_n, present.values[0]);
      if (id == "torsion") soften(segment.torsional_stiffness_nm2, present.values[0]);
      if (id == "plane_stiffness") stiffen(1.0 - present.values.head<2>().norm(), segment);
      // In the end the rig's drives do what its laws say, the catalogue's so much more.
      if (id == "creep" && is_of_the_drives(present.values[3])) drive_more(1.0 + present.values[0], segment);
    }
  }
  return arm;
}

}  // namespace softarm::app
