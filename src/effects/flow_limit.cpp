// Pressures rise and fall no faster than the valves let them.
//
// Of the limit all where the share is 1; it is a share so that the size acts in proportion.
#include <algorithm>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

class FlowLimit : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override { return has(arm, arm::InputKind::kPressure); }
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    std::vector<Values> list;
    for (const double rise_pa_per_s : {4e3, 10e3, 25e3})
      list.push_back(Eigen::Vector3d(0.0, rise_pa_per_s, 1.0));
    return list;
  }
  bool looks_back() const override { return true; }
  void drive(const arm::Arm& arm, const Values& values, Series& series) const override {
    if (values[0] == 0.0) return;
    const double rise = std::max(values[1], 1.0), fall = std::max(values[2], 1e-3) * rise;
    for_pressures(arm, series, [&](auto row) {
      double reached = row[0];
      for (Eigen::Index i = 1; i < row.size(); ++i) {
        const double dt_s = series.t_s[i] - series.t_s[i - 1];
        reached = std::clamp(row[i], reached - fall * dt_s, reached + rise * dt_s);
        row[i] -= values[0] * (row[i] - reached);
      }
    });
  }
};

}  // namespace

std::unique_ptr<Effect> make_flow_limit() {
  return std::make_unique<FlowLimit>(Info{
      "flow_limit",
      "pressures rise and fall no faster than the valves let them: fast ramps come late, slow ones do not",
      "acting = u - share (u - w), -fall rise <= dw/dt <= rise",
      "a constant rate is a form of its own; pneumatics of a soft arm: A. D. Marchese, R. K. Katzschmann, D. "
      "Rus, Soft Robotics 2, 2015, doi:10.1089/soro.2014.0022",
      Family::kActuation,
      {{"share", "1", "of the limit; 1: all of it", 0.0, 1.5, 0.5},
       {"rise_pa_per_s", "Pa/s", "at which pressures rise at most", 200.0, 1e6, 10e3},
       {"fall", "1", "rate at which they fall at most, over that", 0.05, 20.0, 1.0}},
      1,
      {"pressure_lag", "clock_offset", "hysteresis"},
      {}});
}

}  // namespace softarm::effects
