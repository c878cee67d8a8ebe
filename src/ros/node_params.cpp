#include "node_params.h"

#include <fmt/format.h>

#include <stdexcept>

#include "param_reader.h"
#include "softarm/arm/arm_file.h"
#include "softarm/effects/arm_effects.h"

namespace softarm {
namespace {

template <class Parse>
auto parse_or_explain(const ParamReader& reader, const std::string& name, const std::string& word,
                      Parse parse) {
  try {
    return parse(word);
  } catch (const std::invalid_argument& e) {
    throw reader.error(name, std::string("is '") + word + "': " + e.what());
  }
}

}  // namespace

NodeParams NodeParams::read(const ros::NodeHandle& private_nh) {
  ParamReader reader(private_nh);
  NodeParams params;
  const std::optional<std::string> arm = reader.word("arm");
  if (!arm) throw reader.error("arm", "is not set: the path of an arm file, or the name of a shipped arm");
  std::vector<std::string> directories;
  if (const auto directory = reader.word("arms_dir")) directories.push_back(*directory);
  params.arm = arm::load_arm_file(*arm, directories);
  params.effects = effects::load_effects(params.arm, *arm, directories);
  if (const std::string doubt = effects::doubt_about_effects(*arm, directories); !doubt.empty())
    ROS_WARN("%s", doubt.c_str());

  arm::EstimatorOptions& options = params.options;
  options = params.arm.estimator;
  if (const auto word = reader.word("method"))
    options.method = parse_or_explain(reader, "method", *word, arm::parse_method);
  if (const auto word = reader.word("unknown")) {
    options.unknown = parse_or_explain(reader, "unknown", *word, arm::parse_unknown);
  }
  if (const auto word = reader.word("objective")) {
    options.objective = parse_or_explain(reader, "objective", *word, arm::parse_objective);
  }
  if (const auto word = reader.word("dynamics"))
    options.dynamics = parse_or_explain(reader, "dynamics", *word, arm::parse_dynamics);
  if (const auto value = reader.flag("robust")) options.robust = *value;
  if (const auto value = reader.flag("prior")) options.prior.enabled = *value;
  if (const auto value = reader.number("window", 0.0, 60.0)) options.window_s = *value;
  if (const auto value = reader.number("identifiable_relative_sd", 0.001, 10.0))
    options.identifiable_relative_sd = *value;

  if (const auto value = reader.number("body_latency", -3600.0, 3600.0))
    params.arm.inputs.body_latency_s = *value;
  if (const auto value = reader.number("input_latency", -3600.0, 3600.0)) {
    for (arm::ScalarInput& input : params.arm.inputs.scalars) input.latency_s = *value;
  }
  params.frames.mocap = reader.word("mocap_frame").value_or("mocap");
  params.frames.prefix = reader.word("frame_prefix").value_or(params.arm.name);
  params.marker_rate_hz = reader.number("marker_rate", 0.0, 1000.0).value_or(params.marker_rate_hz);
  params.overload_latency_s =
      reader.number("overload_latency", 0.0, 10.0).value_or(params.overload_latency_s);
  params.publish_tf = reader.flag("publish_tf").value_or(params.publish_tf);
  params.reduced_chi_square_warning =
      reader.number("reduced_chi_square_warning", 0.0, 1e9).value_or(params.reduced_chi_square_warning);
  params.monitor = reader.flag("monitor").value_or(params.monitor);
  monitor::MismatchMonitorParams& alarm = params.alarm;
  alarm.threshold_sd = reader.number("alarm_threshold", 3.0, 1e6).value_or(alarm.threshold_sd);
  alarm.payload_hold_off_s = reader.number("alarm_hold_off", 0.0, 600.0).value_or(alarm.payload_hold_off_s);
  alarm.memory_s = reader.number("alarm_memory", 5.0, 86400.0).value_or(alarm.memory_s);
  alarm.accept_after_s = reader.number("alarm_accept_after", 1.0, 86400.0).value_or(alarm.accept_after_s);
  reader.warn_of_unknown();
  return params;
}

}  // namespace softarm
