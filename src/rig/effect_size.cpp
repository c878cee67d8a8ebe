#include "effect_size.h"

#include <algorithm>
#include <map>

namespace softarm::rig {
namespace {

/// Effects, or one form of them, of which it is not the first parameter that says how large they are, or not
/// alone, or inversely.
const std::map<std::string, EffectSize>& exceptions() {
  static const std::map<std::string, EffectSize> list{
      {"soft_spot", {{"share"}, false}},
      {"rigid_ends", {{"base_m", "tip_m"}, false}},
      {"axial_compliance", {{"axial_stiffness_n"}, true}},
      {"shear", {{"shear_stiffness_n"}, true}},
      {"base_compliance", {{"stiffness_nm_per_rad"}, true}},
      {"jamming_yield", {{"yield_per_m"}, true}},
      {"payload_offset", {{"axial_m", "lateral_m"}, false}},
      {"flow_limit", {{"rise_pa_per_s", "fall_pa_per_s"}, true}},
      {"regulator_error", {{"offset_pa", "dead_band_pa"}, false}},
      {"pressure_lag", {{"time_constant_s", "vent_time_constant_s"}, false}},
      {"hysteresis", {{"loop_pa", "loop_n", "loop_rad", "loop_per_m"}, false}},
      {"drift", {{"gain_share", "stiffness_share"}, false}},
      {"correlated_noise", {{"position_sd_m", "orientation_sd_rad"}, false}},
      {"marker_bias", {{"position_sd_m", "orientation_sd_rad", "x_m", "y_m", "z_m"}, false}},
      {"marker_slip", {{"along_m", "sideways_m"}, false}},
      {"wobbling_ring", {{"tilt_deg_per_g", "shift_m_per_g"}, false}},
      {"bumped_cameras", {{"x_m", "y_m", "z_m", "turn_x_deg", "turn_y_deg", "turn_z_deg"}, false}},
      {"jumps", {{"probability"}, false}},
      {"pressure_offset", {{"offset_pa"}, false}},
      {"torsion/compliance", {{"stiffness_ratio"}, true}},
      {"torsion", {{"twist_deg"}, false}},
  };
  return list;
}

}  // namespace

EffectSize size_of(const HiddenEffect& effect, const std::string& form) {
  EffectSize size;
  auto found = exceptions().find(effect.id + "/" + form);
  if (found == exceptions().end()) found = exceptions().find(effect.id);
  if (found != exceptions().end()) size.inverse = found->second.inverse;
  for (const HiddenParameter& parameter : effect.parameters) {
    if (parameter.whole || !parameter.is_of(form)) continue;
    if (found == exceptions().end()) return {{parameter.key}, false};
    const std::vector<std::string>& keys = found->second.keys;
    if (std::find(keys.begin(), keys.end(), parameter.key) != keys.end()) size.keys.push_back(parameter.key);
  }
  return size;
}

HiddenChoice scaled(const HiddenChoice& choice, double factor) {
  HiddenChoice result = choice;
  const HiddenEffect* effect = find_hidden_effect(choice.effect);
  if (effect == nullptr) return result;
  const EffectSize size = size_of(*effect, choice.form);
  for (const HiddenParameter& parameter : effect->parameters) {
    if (std::find(size.keys.begin(), size.keys.end(), parameter.key) == size.keys.end()) continue;
    const auto value = result.values.find(parameter.key);
    if (value == result.values.end() || value->second == 0.0) continue;
    value->second = std::clamp(size.inverse ? value->second / factor : value->second * factor, parameter.low,
                               parameter.high);
  }
  return result;
}

}  // namespace softarm::rig
