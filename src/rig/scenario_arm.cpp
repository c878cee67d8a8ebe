#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <set>

#include "scenario_parts.h"

namespace softarm::rig {
namespace {

constexpr int kMaxInputs = 16;
constexpr std::size_t kMaxSegments = 8;
constexpr Allowed kSaturationPressure{1.0, 1e9}, kSaturationTension{1e-3, 1e6}, kSaturationAngle{1e-3, 1e6};

/// The inputs of one kind that the segments name: chamber_1, chamber_2 ...
class InputNames {
 public:
  explicit InputNames(std::string kind) : kind_(std::move(kind)) {}

  /// The number, from 0, under the key `input`. Without the key: the next after all so far.
  int take(YamlMap& map) {
    int number = used_.empty() ? 1 : *used_.rbegin() + 1;
    if (map.has("input")) {
      const std::string name = map.word("input");
      const std::string prefix = kind_ + "_";
      const char *begin = name.data() + std::min(prefix.size(), name.size()),
                 *end = name.data() + name.size();
      const auto [stop, error] = std::from_chars(begin, end, number);
      if (name.compare(0, prefix.size(), prefix) != 0 || error != std::errc() || stop != end)
        map.fail("input", fmt::format("value {}, allowed {}1 ... {}{}", name.substr(0, 60), prefix, prefix,
                                      kMaxInputs));
    }
    if (number < 1 || number > kMaxInputs)
      map.fail("input", fmt::format("number {}, allowed 1 ... {}", number, kMaxInputs));
    used_.insert(number);
    return number - 1;
  }

  /// How many there are; all numbers up to the last must be in use.
  int count(const YamlMap& arm) const {
    int expected = 1;
    for (int number : used_)
      if (number != expected++)
        arm.fail("segments", fmt::format("no segment takes input {}_{}, but one takes {}_{}", kind_,
                                         expected - 1, kind_, number));
    return static_cast<int>(used_.size());
  }

 private:
  std::string kind_;
  std::set<int> used_;
};

struct Names {
  InputNames chambers{"chamber"}, tendons{"tendon"}, servos{"servo"};
};

std::optional<double> optional_number(YamlMap& map, const char* key, const Allowed& allowed) {
  return map.has(key) ? std::optional(map.number(key, allowed)) : std::nullopt;
}

/// One entry of `growth`: what EI grows with is said by the unit of `at_...`.
StiffnessGrowth parse_growth(YamlMap& entry, const SegmentSpec& segment) {
  StiffnessGrowth growth;
  growth.added_nm2 = entry.number("added_nm2", {0.0, 1e3});
  growth.exponent = entry.number("exponent", {0.1, 10.0}, growth.exponent);
  const auto need = [&](bool present, const char* key, const char* what) {
    if (!present) entry.fail(key, fmt::format("the segment has no {}", what));
  };
  const auto one_of = [&](const char* key, const auto& items) {
    if (!entry.has(key)) return;
    growth.by = StiffnessGrowth::By::kOne;
    const int number = entry.integer(key, {1, static_cast<double>(items.size())}, 1);
    growth.input = items[static_cast<std::size_t>(number - 1)].input;
  };
  if (entry.has("lowest") && entry.boolean("lowest", false)) growth.by = StiffnessGrowth::By::kLowest;
  if (entry.has("at_n")) {
    growth.of = StiffnessGrowth::Of::kTensions;
    growth.at = entry.number("at_n", {1e-3, 1e4});
    need(!segment.tendons.empty(), "at_n", "tendons");
    one_of("tendon", segment.tendons);
  } else if (entry.has("at_rad")) {
    growth.of = StiffnessGrowth::Of::kAngles;
    growth.at = entry.number("at_rad", {1e-3, 1e3});
    need(!segment.cables.empty(), "at_rad", "cables");
    one_of("cable", segment.cables);
  } else {
    growth.at = entry.number("at_pa", {1.0, 1e7});
    need(!segment.chambers.empty(), "at_pa", "chambers");
    one_of("chamber", segment.chambers);
  }
  return growth;
}

void parse_saturation(YamlMap& map, SegmentSpec& segment) {
  if (!map.has("saturation")) return;
  YamlMap entry = map.map("saturation");
  const std::string form = entry.has("form") ? entry.word("form") : "exponential";
  if (form != "exponential" && form != "hyperbolic")
    entry.fail("form", fmt::format("value {}, allowed exponential, hyperbolic", form.substr(0, 60)));
  segment.saturation.exponential = form == "exponential";
  segment.saturation.chambers_pa = optional_number(entry, "chambers_pa", kSaturationPressure);
  segment.saturation.tendons_n = optional_number(entry, "tendons_n", kSaturationTension);
  segment.saturation.cables_rad = optional_number(entry, "cables_rad", kSaturationAngle);
  entry.finish();
}

std::vector<CreepSpec::Part> parse_creep_parts(YamlMap& map, const char* key) {
  std::vector<CreepSpec::Part> parts;
  double sum = 0.0;
  for (YamlMap& entry : map.maps(key)) {
    CreepSpec::Part part;
    part.time_s = entry.number("time_s", {1e-3, 1e5});
    part.share = entry.number("share", {0.0, 0.98});
    part.decades = entry.number("decades", {0.0, 2.0}, part.decades);
    sum += part.share;
    if (sum > 0.98)
      entry.fail("share",
                 fmt::format("value {}, with the others {}, allowed together [0, 0.98]", part.share, sum));
    entry.finish();
    parts.push_back(part);
  }
  return parts;
}

void parse_creep(YamlMap& map, SegmentSpec& segment) {
  if (!map.has("creep")) return;
  YamlMap entry = map.map("creep");
  segment.creep.moment = parse_creep_parts(entry, "moment");
  segment.creep.length = parse_creep_parts(entry, "length");
  if (entry.has("before_moment_nm")) {
    const std::vector<double> before = entry.numbers("before_moment_nm", {-100.0, 100.0}, 2, 2);
    segment.creep.before_moment_nm = {before[0], before[1]};
  }
  segment.creep.slows_pa = optional_number(entry, "slows_pa", kSaturationPressure);
  segment.creep.grows_pa = optional_number(entry, "grows_pa", kSaturationPressure);
  segment.creep.before_length_m = entry.number("before_length_m", {-1.0, 1.0}, 0.0);
  entry.finish();
}

void parse_joint(YamlMap& map, SegmentSpec& segment) {
  if (!map.has("joint")) return;
  YamlMap entry = map.map("joint");
  JointSpec joint;
  joint.stiffness_nm_per_rad = entry.number("stiffness_nm_per_rad", {1e-4, 1e6});
  joint.length_m =
      entry.number("length_m", {0.01 * segment.length_m, 0.5 * segment.length_m}, 0.02 * segment.length_m);
  entry.finish();
  segment.joint = joint;
}

void parse_stiffness(YamlMap& map, SegmentSpec& segment) {
  double last_pa = -1e9;
  for (YamlMap& entry : map.maps("stiffness_by_pressure")) {
    StiffnessAtPressure knot;
    knot.pressure_pa = entry.number("pressure_pa", kGaugePressure);
    knot.bending_stiffness_nm2 = entry.number("bending_stiffness_nm2", {1e-6, 1e3});
    if (!(knot.pressure_pa > last_pa))
      entry.fail("pressure_pa", fmt::format("value {} after {}, must increase", knot.pressure_pa, last_pa));
    last_pa = knot.pressure_pa;
    entry.finish();
    segment.stiffness_by_pressure.push_back(knot);
  }
  const bool tabled = !segment.stiffness_by_pressure.empty();
  if (tabled && !segment.central_chamber)
    map.fail("stiffness_by_pressure", "needs a central_chamber, on whose pressure it depends");
  YamlMap stiffness = tabled ? map.map("bending_stiffness") : map.required_map("bending_stiffness");
  segment.stiffness_base_nm2 =
      tabled ? stiffness.number("base_nm2", {1e-6, 1e3},
                                segment.stiffness_by_pressure.front().bending_stiffness_nm2)
             : stiffness.number("base_nm2", {1e-6, 1e3});
  segment.stiffness_per_min_nm2_per_pa = stiffness.number("per_min_pressure_nm2_per_pa", {-1e-4, 1e-4}, 0.0);
  segment.stiffness_per_jamming_nm2_per_pa =
      stiffness.number("per_jamming_pressure_nm2_per_pa", {-1e-4, 1e-4}, 0.0);
  for (YamlMap& entry : stiffness.maps("growth")) {
    segment.stiffness_growth.push_back(parse_growth(entry, segment));
    entry.finish();
  }
  stiffness.finish();
  segment.torsional_stiffness_nm2 =
      map.number("torsional_stiffness_nm2", {1e-7, 1e4}, segment.stiffness_base_nm2);
  if (map.has("axial_stiffness_n")) segment.axial_stiffness_n = map.number("axial_stiffness_n", {1e-2, 1e8});
  if (map.has("shear_stiffness_n")) segment.shear_stiffness_n = map.number("shear_stiffness_n", {1e-2, 1e8});
  if (map.has("material")) {
    YamlMap entry = map.map("material");
    MaterialSpec material;
    material.c10_pa = entry.number("c10_pa", {-1e9, 1e9});
    material.c01_pa = entry.number("c01_pa", {-1e9, 1e9});
    if (!(material.c10_pa + material.c01_pa > 0.0))
      entry.fail("c01_pa", fmt::format("value {}, allowed above {}: c10_pa + c01_pa must be > 0",
                                       material.c01_pa, -material.c10_pa));
    if (!segment.axial_stiffness_n)
      map.fail("material", "needs axial_stiffness_n, which says how far it stretches");
    entry.finish();
    segment.material = material;
  }
}

SegmentSpec parse_segment(YamlMap& map, Names& names) {
  SegmentSpec segment;
  segment.length_m = map.number("length_m", {0.01, 10.0});
  segment.mass_kg = map.number("mass_kg", {1e-4, 100.0});
  segment.diameter_m = map.number("diameter_m", {5e-4, 1.0}, segment.diameter_m);
  segment.retardation_s = map.number("retardation_s", {0.0, 10.0}, segment.retardation_s);
  for (YamlMap& entry : map.maps("chambers")) {
    ChamberSpec chamber;
    chamber.input = names.chambers.take(entry);
    chamber.direction_rad = kRadPerDeg * entry.number("bending_direction_deg", {-360.0, 360.0});
    chamber.moment_gain_nm_per_pa = entry.number("moment_gain_nm_per_pa", {0.0, 1e-3});
    chamber.near_elongation_m_per_pa = entry.number("near_elongation_m_per_pa", {-1e-5, 1e-5}, 0.0);
    chamber.far_elongation_m_per_pa = entry.number("far_elongation_m_per_pa", {-1e-5, 1e-5}, 0.0);
    chamber.saturation_pa = optional_number(entry, "saturation_pa", kSaturationPressure);
    entry.finish();
    segment.chambers.push_back(chamber);
  }
  if (map.has("central_chamber")) {
    YamlMap entry = map.map("central_chamber");
    CentralChamberSpec chamber;
    chamber.input = names.chambers.take(entry);
    chamber.area_m2 = entry.number("area_m2", {1e-9, 1.0});
    entry.finish();
    segment.central_chamber = chamber;
  }
  for (YamlMap& entry : map.maps("tendons")) {
    TendonSpec tendon;
    tendon.input = names.tendons.take(entry);
    tendon.azimuth_rad = kRadPerDeg * entry.number("azimuth_deg", {-360.0, 360.0});
    tendon.offset_m = entry.number("offset_m", {0.0, 1.0});
    tendon.saturation_n = optional_number(entry, "saturation_n", kSaturationTension);
    entry.finish();
    segment.tendons.push_back(tendon);
  }
  for (YamlMap& entry : map.maps("cables")) {
    CableSpec cable;
    cable.input = names.servos.take(entry);
    cable.azimuth_rad = kRadPerDeg * entry.number("azimuth_deg", {-360.0, 360.0});
    cable.lever_m = entry.number("lever_m", {1e-4, 1.0});
    cable.spool_radius_m = entry.number("spool_radius_m", {1e-4, 1.0});
    cable.saturation_rad = optional_number(entry, "saturation_rad", kSaturationAngle);
    entry.finish();
    segment.cables.push_back(cable);
  }
  parse_stiffness(map, segment);
  parse_saturation(map, segment);
  parse_creep(map, segment);
  parse_joint(map, segment);
  return segment;
}

}  // namespace

ArmSpec parse_arm_spec(YamlMap map) {
  ArmSpec arm;
  Names names;
  arm.tip_mass_kg = map.number("tip_mass_kg", {0.0, 100.0}, arm.tip_mass_kg);
  arm.air_damping_n_s_m2 = map.number("air_damping_n_s_m2", {0.0, 1e3}, arm.air_damping_n_s_m2);
  if (map.has("segments")) {
    for (YamlMap& entry : map.maps("segments")) {
      arm.segments.push_back(parse_segment(entry, names));
      entry.finish();
    }
    if (arm.segments.empty() || arm.segments.size() > kMaxSegments)
      map.fail("segments", fmt::format("{} segments, allowed 1 ... {}", arm.segments.size(), kMaxSegments));
  } else {
    arm.segments.push_back(parse_segment(map, names));
  }
  arm.chambers = names.chambers.count(map);
  arm.tendons = names.tendons.count(map);
  arm.servos = names.servos.count(map);
  map.finish();
  return arm;
}

}  // namespace softarm::rig
