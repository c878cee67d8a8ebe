#include "wall_creep.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace softarm::rig {
namespace {

/// A log-normal spectrum by five times: nodes (in standard deviations) and weights of Gauss and Hermite.
constexpr std::pair<double, double> kSpectrum[] = {{-2.8569700138728056, 0.011257411327720688},
                                                   {-1.3556261799742659, 0.2220759220056126},
                                                   {0.0, 0.5333333333333333},
                                                   {1.3556261799742659, 0.2220759220056126},
                                                   {2.8569700138728056, 0.011257411327720688}};

}  // namespace

WallCreep::WallCreep(const CreepSpec& spec)
    : slows_pa_(spec.slows_pa),
      grows_pa_(spec.grows_pa),
      before_(spec.before_moment_nm.x(), spec.before_moment_nm.y(), spec.before_length_m) {
  for (const CreepSpec::Part& part : spec.moment) add(part, false);
  for (const CreepSpec::Part& part : spec.length) add(part, true);
}

void WallCreep::add(const CreepSpec::Part& part, bool of_length) {
  (of_length ? late_length_ : late_moment_) += part.share;
  if (part.decades <= 0.0) {
    parts_.push_back({part.time_s, part.share, of_length});
    return;
  }
  for (const auto& [node, weight] : kSpectrum)
    parts_.push_back({part.time_s * std::pow(10.0, part.decades * node), part.share * weight, of_length});
}

/// What comes at once, 1 - S, falls as (1 - S)^(1 + p / grows_pa).
double WallCreep::grown(bool of_length, double pressure_pa) const {
  const double late = of_length ? late_length_ : late_moment_;
  if (!grows_pa_ || !(late > 0.0)) return 1.0;
  return (1.0 - std::pow(1.0 - late, 1.0 + pressure_pa / *grows_pa_)) / late;
}

void WallCreep::act(double t_s, Actuation& actuation) {
  if (parts_.empty()) return;
  const Eigen::Vector3d now(actuation.moment_nm.x(), actuation.moment_nm.y(), actuation.length_m);
  if (!first_s_) first_s_ = t_s;
  if (t_s <= *first_s_) {
    for (Part& part : parts_) part.at = now + before_;
  } else {
    const double step_s = std::max(0.0, t_s - *last_s_);
    const Eigen::Vector3d middle = 0.5 * (last_ + now);
    const double slower =
        slows_pa_ ? std::exp(0.5 * (last_pa_ + actuation.mean_pressure_pa) / *slows_pa_) : 1.0;
    for (Part& part : parts_)
      part.at = middle + (part.at - middle) * std::exp(-step_s / (slower * part.time_s));
  }
  last_ = now;
  last_s_ = t_s;
  last_pa_ = actuation.mean_pressure_pa;
  for (const Part& part : parts_) {
    const Eigen::Vector3d late =
        part.share * grown(part.of_length, actuation.mean_pressure_pa) * (now - part.at);
    if (part.of_length) {
      actuation.length_m -= late.z();
    } else {
      actuation.moment_nm -= late.head<2>();
    }
  }
}

}  // namespace softarm::rig
