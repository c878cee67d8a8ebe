// Pressures follow their command late: acting = u - delay / tau (u - lag of u with time constant tau).
//
// A line of first order where the delay equals the time constant. In slow ramps what acts is late by the
// delay; the time constant is a parameter of its own so that the size acts in proportion.
#include <algorithm>
#include <vector>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

constexpr double kLeastLag_s = 1e-3;

class PressureLag : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override { return has(arm, arm::InputKind::kPressure); }
  std::vector<Values> grid(const arm::Arm& arm, const FineRod&) const override {
    std::vector<Values> list;
    for (const double chamber : chamber_numbers(arm, rows_of(arm, arm::InputKind::kPressure)))
      for (const double time_s : {0.1, 0.25, 0.7, 2.0, 0.03})
        list.push_back(Eigen::Vector4d(0.0, time_s, 1.0, chamber));
    return list;
  }
  bool looks_back() const override { return true; }
  bool drives() const override { return true; }
  void drive(const arm::Arm& arm, const Values& values, Series& series) const override {
    if (values[0] == 0.0) return;
    const double time_s = std::max(values[1], kLeastLag_s), share = values[0] / time_s;
    const std::vector<Following> rising = steps_of(series, time_s);
    const std::vector<Following> falling = values[2] == 1.0 ? rising : steps_of(series, values[2] * time_s);
    const auto follow = [&](auto row) {
      double last = row[0], state = row[0];
      for (Eigen::Index i = 1; i < row.size(); ++i) {
        const double now = row[i];
        const Following& f = (0.5 * (last + now) < state ? falling : rising)[static_cast<std::size_t>(i)];
        state = f.kept * state + f.weight_last * last + f.weight_now * now;
        last = now;
        row[i] = now - share * (now - state);
      }
    };
    const Rows pressures = rows_of(arm, arm::InputKind::kPressure);
    for (const Eigen::Index row : rows_of_chamber(arm, pressures, values[3])) {
      follow(series.inputs.row(row));
      follow(series.moment_inputs.row(row));
    }
  }

 private:
  /// From the frame before to each; the same for all pressures.
  static std::vector<Following> steps_of(const Series& series, double tau_s) {
    std::vector<Following> steps(static_cast<std::size_t>(series.t_s.size()));
    for (Eigen::Index i = 1; i < series.t_s.size(); ++i)
      steps[static_cast<std::size_t>(i)] =
          following(series.t_s[i] - series.t_s[i - 1], std::max(tau_s, kLeastLag_s));
    return steps;
  }
};

}  // namespace

std::unique_ptr<Effect> make_pressure_lag() {
  return std::make_unique<PressureLag>(
      Info{"pressure_lag",
           "pressures lag behind their command, the more the faster it changes",
           "acting = u - (delay / time) (u - w), time dw/dt = u - w",
           "line of first order; pneumatics of a soft arm: A. D. Marchese, R. K. Katzschmann, D. Rus, Soft "
           "Robotics 2, 2015, doi:10.1089/soro.2014.0022",
           Family::kActuation,
           {{"delay_s", "s", "by which they are late in slow ramps", 0.0, 30.0, 0.2},
            {"time_s", "s", "time constant with which they settle after a step", 0.02, 30.0, 0.3},
            {"fall", "1", "time constant of falling pressures over that of rising ones", 0.1, 10.0, 1.0},
            chamber_parameter()},
           1,
           {"clock_offset", "hysteresis", "inertia"},
           {},
           false,
           false,
           true});
}

}  // namespace softarm::effects
