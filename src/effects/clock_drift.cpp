// The clocks of motion capture and inputs run at different rates: over the session a frame shows what the
// inputs did longer and longer before. They need not have been alike when it began.
#include "clocks.h"
#include "effects.h"

namespace softarm::effects {
namespace {

class ClockDrift : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override { return !arm.inputs.scalars.empty(); }
  bool looks_back() const override { return true; }
  std::string live_obstacle(const Values&) const override {
    return "it says how far the clocks were apart during the trials diagnosed, not how far they are now";
  }
  bool drives() const override { return true; }
  void drive(const arm::Arm&, const Values& values, Series& series) const override {
    if (values.isZero(0.0) || series.t_s.size() == 0 || series.session_s > kClocksDrift_s) return;
    const Eigen::VectorXd at_s = series.t_s.unaryExpr(
        [&](double t_s) { return t_s - drifted_s(values[0], values[1], series.session_s, t_s); });
    for (Eigen::MatrixXd* inputs : {&series.inputs, &series.moment_inputs})
      *inputs = values_at(series.t_s, *inputs, at_s);
  }
};

}  // namespace

std::unique_ptr<Effect> make_clock_drift() {
  return std::make_unique<ClockDrift>(
      Info{"clock_drift",
           "the clocks of motion capture and inputs run at different rates",
           "pose(t) shows what inputs(t - offset - rate T) did, T the session's time, in its first hour",
           "offsets of clocks, here at a constant rate: P. Furgale, J. Rehder, R. Siegwart, IROS 2013, "
           "doi:10.1109/IROS.2013.6696514",
           Family::kSensor,
           {{"rate", "1", "seconds per second by which the motion capture's clock gets further ahead", -0.05,
             0.05, 0.002},
            {"offset_s", "s", "by which it is ahead when the session begins", -5.0, 5.0, 0.1}},
           2,
           {"clock_offset", "pressure_lag", "drift"},
           {},
           false,
           false,
           false,
           true});
}

}  // namespace softarm::effects
