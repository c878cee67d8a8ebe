// Choices of the estimator, checked against what the arm offers.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "actuators/actuator.h"
#include "arm_parts.h"
#include "softarm/arm/arm_file.h"

namespace softarm::arm::yaml {
namespace {

/// "chambers, a central_chamber, tendons or cables"
std::string ways_to_drive() {
  std::vector<std::string> words;
  for (const ActuatorKind* kind : actuator_kinds()) {
    if (kind->traits().drives) words.emplace_back(kind->traits().words);
  }
  const std::string last = words.back();
  words.pop_back();
  return fmt::format("{} or {}", fmt::join(words, ", "), last);
}

LawPrior read_prior(const Section& section, const Arm& arm) {
  LawPrior prior;
  prior.enabled = section.flag("enabled");
  prior.moment_sd_nm = section.number("moment_sd_nm");
  prior.bending_stiffness_sd_rel = section.number("bending_stiffness_sd_rel");
  prior.length_sd_m = section.number("length_sd_m");
  prior.axial_stiffness_sd_rel = section.number("axial_stiffness_sd_rel");
  prior.moment_sd_rel = section.number("moment_sd_rel");
  prior.moment_jitter_sd_nm = section.number("moment_jitter_sd_nm");
  prior.length_jitter_sd_m = section.number("length_jitter_sd_m");
  if (prior.enabled && std::none_of(arm.segments.begin(), arm.segments.end(), is_driven)) {
    section.fail_value("enabled", "needs segments with " + ways_to_drive());
  }
  return prior;
}

bool has_tip_orientation(const Arm& arm) {
  constexpr double kAtTipM = 1e-6;
  return std::any_of(arm.bodies.begin(), arm.bodies.end(), [&arm](const MeasuredBody& body) {
    return body.orientation_usable && body.arclength_m >= arm.total_length_m() - kAtTipM;
  });
}

}  // namespace

EstimatorOptions read_estimator(const Section& section, const Arm& arm) {
  EstimatorOptions options;
  options.method = parse_method(section.word("method"));
  if (options.method == Method::kEndOrientation && !has_tip_orientation(arm)) {
    section.fail_value("method", fmt::format("needs a ring at the tip ({:g} m) with orientation_usable: true",
                                             arm.total_length_m()));
  }
  options.unknown = parse_unknown(section.word("unknown"));
  options.objective = parse_objective(section.word("objective"));
  if (section.has("weights")) {
    options.weights = section.word("weights") == "paper" ? Weights::kPaper : Weights::kNoise;
  }
  options.robust = section.flag("robust");
  options.identifiable_relative_sd = section.number("identifiable_relative_sd");
  options.window_s = section.number("window_s");
  options.dynamics = parse_dynamics(section.word("dynamics"));
  options.prior = read_prior(section.section("prior", prior_keys()), arm);
  return options;
}

}  // namespace softarm::arm::yaml
