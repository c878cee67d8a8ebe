// The real pressure is below the commanded one by a share of it: always, or growing while the command holds.
#include <algorithm>
#include <cmath>
#include <vector>

#include "drives.h"
#include "effects.h"
#include "math/statistics.h"

namespace softarm::effects {
namespace {

constexpr double kUsual_s = 5.0;
constexpr double kRefill_s = 0.1;   // in which the regulator makes up for what was lost
constexpr double kWindow_s = 0.3;   // in which a command that holds does not move
constexpr double kStill_pa = 40.0;  // by which it may move then
constexpr double kNoise = 6.0;      // and this times what it moves from frame to frame, mostly its noise

/// Whether the command holds, frame by frame.
std::vector<bool> holds(const Eigen::VectorXd& t, const Eigen::RowVectorXd& u) {
  const Eigen::Index n = u.size();
  std::vector<double> steps;
  for (Eigen::Index i = 1; i < n; ++i) steps.push_back(std::abs(u[i] - u[i - 1]));
  const double step = math::median(std::move(steps));
  std::vector<bool> out(static_cast<std::size_t>(n));
  Eigen::Index first = 0, last = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    while (t[i] - t[first] > 0.5 * kWindow_s) ++first;
    while (last + 1 < n && t[last + 1] - t[i] <= 0.5 * kWindow_s) ++last;
    const auto part = u.segment(first, last - first + 1);
    out[static_cast<std::size_t>(i)] = part.maxCoeff() - part.minCoeff() <= kStill_pa + kNoise * step;
  }
  return out;
}

class PressureLeak : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override { return has(arm, arm::InputKind::kPressure); }
  std::vector<Values> grid(const arm::Arm& arm, const FineRod&) const override {
    std::vector<Values> list;
    for (const double time_s : {0.0, 2.0, 10.0}) {
      for (const double chamber : chamber_numbers(arm, rows_of(arm, arm::InputKind::kPressure)))
        list.push_back(
            Eigen::Vector4d(0.0, chamber, time_s > 0.0 ? 1.0 : 0.0, time_s > 0.0 ? time_s : kUsual_s));
    }
    return list;
  }
  bool looks_back() const override { return true; }
  std::string live_obstacle(const Values& values) const override {
    return values[2] < 0.5 ? "" : "only what comes after a command shows whether it is held";
  }
  bool drives() const override { return true; }
  void drive(const arm::Arm& arm, const Values& values, Series& series) const override {
    if (values[0] == 0.0 || series.t_s.size() == 0) return;
    const Rows pressures = rows_of(arm, arm::InputKind::kPressure);
    for (const Eigen::Index row : rows_of_chamber(arm, pressures, values[1])) {
      const Eigen::RowVectorXd left =
          1.0 - values[0] * lost(series.t_s, series.inputs.row(row), values).array();
      series.inputs.row(row).array() *= left.array();
      series.moment_inputs.row(row).array() *= left.array();
    }
  }

 private:
  /// Over what is lost in the end, frame by frame.
  static Eigen::RowVectorXd lost(const Eigen::VectorXd& t, const Eigen::RowVectorXd& u,
                                 const Values& values) {
    if (values[2] < 0.5) return Eigen::RowVectorXd::Ones(u.size());
    const double time_s = std::max(values[3], 1e-2);
    const std::vector<bool> held = holds(t, u);
    Eigen::RowVectorXd out(u.size());
    double state = 1.0;  // a trial begins at rest, long settled
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      const bool still = held[static_cast<std::size_t>(i)];
      if (i > 0) {
        const double goal = still ? 1.0 : 0.0;
        state = goal + (state - goal) * std::exp(-(t[i] - t[i - 1]) / (still ? time_s : kRefill_s));
      }
      out[i] = state;
    }
    return out;
  }
};

}  // namespace

std::unique_ptr<Effect> make_pressure_leak() {
  return std::make_unique<PressureLeak>(
      Info{"pressure_leak",
           "the real pressure falls below the commanded one",
           "acting = p (1 - share c), c = 1, or growing as 1 - exp(-t / time) while the command holds",
           "pneumatics of a soft arm: A. D. Marchese, R. K. Katzschmann, D. Rus, Soft Robotics 2, 2015, "
           "doi:10.1089/soro.2014.0022",
           Family::kActuation,
           {{"share", "1", "of the pressure, that is lost in the end", 0.0, 0.95, 0.03},
            chamber_parameter(),
            {"in_holds", "1", "0: always lost; 1: lost little by little while the command holds", 0.0, 1.0,
             0.0, true},
            {"time_s", "s", "time constant of the loss while the command holds", 0.1, 300.0, kUsual_s}},
           1,
           {"creep", "chamber_mismatch", "gain_nonlinearity"},
           {"moment_gain", "elongation"}});
}

}  // namespace softarm::effects
