#include "input_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace softarm::identify {
namespace {

constexpr double kAlike = 0.9;  // direction cosine from which a zero and a constant are one number

const char* unit_of_input(arm::InputKind kind) {
  if (kind == arm::InputKind::kTension) return "N";
  return kind == arm::InputKind::kAngle ? "rad" : "Pa";
}

/// Of those that drive the arm.
std::vector<std::string> unmeasured(const arm::Arm& arm, const SensorErrors& errors) {
  std::set<int> used;
  for (const arm::Segment& segment : arm.segments)
    for (const int input : arm::inputs_of(arm, segment)) used.insert(input);
  std::vector<std::string> names;
  for (const int input : used) {
    const arm::ScalarInput& one = arm.inputs.scalars[static_cast<std::size_t>(input)];
    if (errors.noise_sd.size() > 0 && !one.noise_sd_si && !errors.noise_sd.col(input).any())
      names.push_back(one.name);
  }
  return names;
}

std::string zeros_line(const InputErrors& one) {
  std::string text = fmt::format("  zero of {}, sd {:.3g} {} as stated:", one.input, one.zero_sd, one.unit);
  for (const FittedZero& zero : one.zeros)
    text += fmt::format(" {} {:.3g} +- {:.2g};", zero.trial, zero.value, zero.sd);
  text.back() = '\n';
  for (const std::string& name : one.confused_with)
    text +=
        fmt::format("  zero of {}: its part that all trials share cannot be told from {}; hold one of them\n",
                    one.input, name);
  return text;
}

}  // namespace

void report_input_errors(const arm::Arm& arm, const std::vector<trial::Trial>& trials,
                         const SensorErrors& errors, const JointProblem& problem,
                         const Eigen::VectorXd& scale, Result& result) {
  result.unmeasured_inputs = unmeasured(arm, errors);
  if (!errors.any()) return;
  const NoiseAtBodies noise = problem.noise_at_bodies();
  const Eigen::MatrixXd of_x =
      scale.cwiseInverse().asDiagonal() * result.covariance * scale.cwiseInverse().asDiagonal();
  const auto zeros = problem.zeros(of_x, result.uncertainty_factor);
  const Eigen::MatrixXd alike = problem.alike();
  for (std::size_t k = 0; k < arm.inputs.scalars.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const arm::ScalarInput& input = arm.inputs.scalars[k];
    InputErrors one;
    one.input = input.name;
    one.unit = unit_of_input(input.kind);
    one.noise_sd =
        std::sqrt(errors.noise_sd.col(column).squaredNorm() / static_cast<double>(errors.noise_sd.rows()));
    one.stated = input.noise_sd_si.has_value();
    one.at_bodies_m = std::sqrt(noise.square_m2[k]);
    one.zero_sd = errors.zero_sd[column];
    for (const auto& [trial, found] : zeros) {
      if (one.zero_sd > 0.0)
        one.zeros.push_back(
            {trials[trial].name, one.zero_sd * found.value[column], one.zero_sd * found.sd[column]});
    }
    for (Eigen::Index j = 0; j < alike.cols() && one.zero_sd > 0.0; ++j) {
      if (std::abs(alike(column, j)) >= kAlike)
        one.confused_with.push_back(result.constants[static_cast<std::size_t>(j)].name);
    }
    if (one.at_bodies_m > 0.0 || one.zero_sd > 0.0) result.input_errors.push_back(std::move(one));
  }
  const double all_m2 = result.position_rms_m * result.position_rms_m;
  result.noise_share = all_m2 > 0.0 ? std::min(1.0, noise.all_m2 / all_m2) : 0.0;
}

std::string describe_input_errors(const Result& result) {
  std::string exact;
  if (!result.unmeasured_inputs.empty())
    exact = fmt::format(
        "inputs taken as exact: {}; their values mostly repeat, lie on a line or are few. Where a sensor has "
        "noise, state its noise_sd; where a logger repeats a sensor's values, set between: sampled, and the "
        "noise is measured\n",
        fmt::join(result.unmeasured_inputs, ", "));
  if (result.input_errors.empty()) return exact;
  std::string text = fmt::format(
      "inputs: noise of a value, and what it makes of a body (rms per coordinate); {:.0f} % of the mean "
      "square "
      "of what is left\n",
      100.0 * result.noise_share);
  for (const InputErrors& one : result.input_errors) {
    text += fmt::format("  {:<24}{:>10.3g} {:<4}{:<10}{:>8.2f} mm\n", one.input, one.noise_sd, one.unit,
                        one.stated ? "stated" : "measured", 1e3 * one.at_bodies_m);
  }
  for (const InputErrors& one : result.input_errors) {
    if (one.zero_sd > 0.0) text += zeros_line(one);
  }
  return text + exact;
}

}  // namespace softarm::identify
