// The clock of the motion capture is ahead of that of the inputs: a frame shows what they did before.
#include <fmt/format.h>

#include "clocks.h"
#include "effects.h"

namespace softarm::effects {
namespace {

class ClockOffset : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override { return !arm.inputs.scalars.empty(); }
  bool looks_back() const override { return true; }
  std::vector<Values> grid(const arm::Arm& arm, const FineRod&) const override {
    std::vector<Values> list{Values::Zero(2)};
    // Of a single input both are one.
    for (std::size_t k = 1; arm.inputs.scalars.size() > 1 && k <= arm.inputs.scalars.size(); ++k)
      list.push_back(Eigen::Vector2d(0.0, static_cast<double>(k)));
    return list;
  }
  std::string live_obstacle(const Values& values) const override {
    if (values[0] >= 0.0) return "";
    return fmt::format(
        "the inputs of a frame come {:.3g} s after it; account for that by latency_s of the inputs",
        -values[0]);
  }
  bool drives() const override { return true; }
  void drive(const arm::Arm&, const Values& values, Series& series) const override {
    if (values[0] == 0.0 || series.t_s.size() == 0) return;
    const Eigen::VectorXd at_s = series.t_s.array() - values[0];
    const auto only = static_cast<Eigen::Index>(values[1] + 0.5) - 1;
    for (Eigen::MatrixXd* inputs : {&series.inputs, &series.moment_inputs}) {
      if (only < 0)
        *inputs = values_at(series.t_s, *inputs, at_s);
      else if (only < inputs->rows())
        inputs->row(only) = values_at(series.t_s, inputs->row(only), at_s);
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_clock_offset() {
  return std::make_unique<ClockOffset>(Info{
      "clock_offset",
      "the clocks of motion capture and inputs differ",
      "pose(t) shows what inputs(t - offset) did, or one of them",
      "offsets of clocks: P. Furgale, J. Rehder, R. Siegwart, IROS 2013, doi:10.1109/IROS.2013.6696514",
      Family::kSensor,
      {{"offset_s", "s", "by which the motion capture's clock is ahead", -5.0, 5.0, 0.1},
       {"input", "1", "number of the input whose clock alone differs, 0: all of them", 0.0, 64.0, 0.0, true}},
      1,
      {"pressure_lag", "hysteresis", "clock_drift"},
      {},
      false,
      true,
      true});
}

}  // namespace softarm::effects
