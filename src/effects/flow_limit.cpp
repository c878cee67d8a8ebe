// Pressures rise and fall no faster than the valves let them.
//
// Of the limit all where the share is 1; it is a share so that the size acts in proportion. Valves have it
// each for itself; or what feeds them all has it, and what rises together rises more slowly.
#include <algorithm>

#include "drives.h"
#include "effects.h"
#include "math/linear_algebra.h"

namespace softarm::effects {
namespace {

/// What each of several pressures has reached that are filled from one source.
class Together {
 public:
  Together(const Eigen::VectorXd& begin_pa, double rise_pa_per_s, double fall_pa_per_s)
      : rise_(rise_pa_per_s), fall_(fall_pa_per_s), reached_(begin_pa) {}

  const Eigen::VectorXd& reach(const Eigen::VectorXd& command_pa, double dt_s) {
    behind_ = (command_pa - reached_).cwiseMax(0.0);
    reached_ = reached_.cwiseMin(command_pa.cwiseMax((reached_.array() - fall_ * dt_s).matrix()));
    double left_pa = std::max(0.0, rise_ * dt_s);
    if (behind_.sum() <= left_pa) {
      reached_ += behind_;
      return reached_;
    }
    // Through valves that are alike, as the roots of what drives it; what one does not need the others have.
    for (Eigen::Index full = 0; full < behind_.size() && left_pa > 0.0; ++full) {
      const Eigen::VectorXd roots = behind_.cwiseSqrt();
      const double all = roots.sum();
      if (!(all > 0.0)) break;
      const Eigen::VectorXd given = (left_pa / all * roots).cwiseMin(behind_);
      reached_ += given;
      behind_ -= given;
      left_pa -= given.sum();
    }
    return reached_;
  }

 private:
  const double rise_, fall_;
  Eigen::VectorXd reached_, behind_;
};

class FlowLimit : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override { return has(arm, arm::InputKind::kPressure); }
  std::vector<Values> grid(const arm::Arm& arm, const FineRod&) const override {
    std::vector<Values> list;
    for (const double rise_pa_per_s : {4e3, 10e3, 25e3})
      list.push_back(Eigen::Vector4d(0.0, rise_pa_per_s, 1.0, 0.0));
    if (rows_of(arm, arm::InputKind::kPressure).size() < 2) return list;
    for (const double rise_pa_per_s : {10e3, 25e3, 60e3})
      list.push_back(Eigen::Vector4d(0.0, rise_pa_per_s, 1.0, 1.0));
    return list;
  }
  bool looks_back() const override { return true; }
  bool drives() const override { return true; }
  void drive(const arm::Arm& arm, const Values& values, Series& series) const override {
    if (values[0] == 0.0) return;
    const double rise = std::max(values[1], 1.0), fall = std::max(values[2], 1e-3) * rise;
    const double share = values[0] * (1.0 - values[3]), together = values[0] * values[3];
    const Rows rows = rows_of(arm, arm::InputKind::kPressure);
    limit(rows, share, together, rise, fall, series.t_s, series.inputs);
    limit(rows, share, together, rise, fall, series.t_s, series.moment_inputs);
  }

 private:
  static void limit(const Rows& rows, double share, double together, double rise, double fall,
                    const Eigen::VectorXd& t_s, Eigen::MatrixXd& inputs) {
    if (inputs.cols() == 0) return;
    Eigen::VectorXd alone = math::rows_of(inputs.col(0), rows);
    Together shared(alone, rise, fall);
    for (Eigen::Index i = 1; i < inputs.cols(); ++i) {
      const double dt_s = t_s[i] - t_s[i - 1];
      const Eigen::VectorXd command = math::rows_of(inputs.col(i), rows);
      alone = command.cwiseMax((alone.array() - fall * dt_s).matrix())
                  .cwiseMin((alone.array() + rise * dt_s).matrix());
      Eigen::VectorXd acting = command - share * (command - alone);
      if (together != 0.0) acting -= together * (command - shared.reach(command, dt_s));
      for (std::size_t k = 0; k < rows.size(); ++k) inputs(rows[k], i) = acting[static_cast<Eigen::Index>(k)];
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_flow_limit() {
  return std::make_unique<FlowLimit>(Info{
      "flow_limit",
      "pressures rise and fall no faster than the valves let them: fast ramps come late, slow ones do not",
      "acting = u - share (u - w), -fall rise <= dw/dt <= rise; together: the sum of all that rises <= rise",
      "a constant rate is a form of its own; pneumatics of a soft arm: A. D. Marchese, R. K. Katzschmann, D. "
      "Rus, Soft Robotics 2, 2015, doi:10.1089/soro.2014.0022",
      Family::kActuation,
      {{"share", "1", "of the limit; 1: all of it", 0.0, 1.5, 0.5},
       {"rise_pa_per_s", "Pa/s", "at which pressures rise at most", 200.0, 1e6, 10e3},
       {"fall", "1", "rate at which they fall at most, over that", 0.05, 20.0, 1.0},
       {"together", "1", "0: each rises as fast; 1: all that rise share the rate", 0.0, 1.0}},
      1,
      {"pressure_lag", "clock_offset", "hysteresis", "supply_sag"},
      {}});
}

}  // namespace softarm::effects
