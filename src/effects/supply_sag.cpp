// One source feeds all chambers: what they draw from it together, all of them get less for.
//
// Drawn is what the pressures have risen within a time. What chambers vent is lost where a tank feeds them; a
// line that droops under their demand has that back. Where the time is short it is their flow, through a line
// that all share.
#include <algorithm>

#include "drives.h"
#include "effects.h"
#include "math/linear_algebra.h"

namespace softarm::effects {
namespace {

constexpr double kLongest_s = 60.0;  // of a source that is filled at its own rate alone
// A sensor's noise would count as air that is drawn: what pressures are over this time, and beyond this to
// either side. Noise of 300 Pa at 100 Hz is 70 Pa then.
constexpr double kMean_s = 0.1, kNoise_pa = 500.0;

class SupplySag : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override {
    return rows_of(arm, arm::InputKind::kPressure).size() > 1;
  }
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    const auto one = [](double time_s, double returned, double refill_pa_per_s, double bends) {
      return Values((Values(5) << 0.0, time_s, returned, refill_pa_per_s, bends).finished());
    };
    return {one(0.4, 0.0, 0.0, 0.0), one(4.0, 0.0, 0.0, 0.0), one(15.0, 1.0, 0.0, 0.0),
            one(kLongest_s, 0.0, 4e3, 2.0), one(kLongest_s, 0.0, 12e3, 2.0)};
  }
  bool looks_back() const override { return true; }
  bool drives() const override { return true; }
  void drive(const arm::Arm& arm, const Values& values, Series& series) const override {
    if (values[0] == 0.0) return;
    const Eigen::RowVectorXd x = drawn(arm, values, series) / kReferencePa;
    const Eigen::RowVectorXd left = (1.0 - values[0] * x.array() / (1.0 + values[4] * x.array())).max(0.0);
    for_pressures(arm, series, [&left](auto row) { row.array() *= left.array(); });
  }

 private:
  static Eigen::RowVectorXd drawn(const arm::Arm& arm, const Values& values, const Series& series) {
    const double time_s = std::max(values[1], 1e-2), returned = values[2], refill_pa_per_s = values[3];
    const Rows rows = rows_of(arm, arm::InputKind::kPressure);
    Eigen::RowVectorXd drawn_pa = Eigen::RowVectorXd::Zero(series.inputs.cols());
    if (drawn_pa.size() == 0) return drawn_pa;
    // A trial begins at rest, long settled.
    Eigen::VectorXd mean_pa = math::rows_of(series.inputs.col(0), rows), reached_pa = mean_pa;
    for (Eigen::Index i = 1; i < drawn_pa.size(); ++i) {
      const double dt_s = series.t_s[i] - series.t_s[i - 1];
      if (!(dt_s > 0.0)) {
        drawn_pa[i] = drawn_pa[i - 1];
        continue;
      }
      const Following over = following(dt_s, kMean_s);
      double taken_pa = -refill_pa_per_s * dt_s;
      for (std::size_t k = 0; k < rows.size(); ++k) {
        double& mean = mean_pa[static_cast<Eigen::Index>(k)];
        double& reached = reached_pa[static_cast<Eigen::Index>(k)];
        mean = over.kept * mean + over.weight_last * series.inputs(rows[k], i - 1) +
               over.weight_now * series.inputs(rows[k], i);
        const double now = std::clamp(reached, mean - kNoise_pa, mean + kNoise_pa);
        taken_pa += now > reached ? now - reached : returned * (now - reached);
        reached = now;
      }
      // Taken evenly meanwhile: some of it is made up for already.
      const double kept = following(dt_s, time_s).kept;
      drawn_pa[i] = std::max(0.0, kept * drawn_pa[i - 1] + (1.0 - kept) * time_s / dt_s * taken_pa);
    }
    return drawn_pa;
  }
};

}  // namespace

std::unique_ptr<Effect> make_supply_sag() {
  return std::make_unique<SupplySag>(Info{
      "supply_sag",
      "all pressures fall short together, by more the more air the chambers draw at once from their common "
      "source",
      "acting = p (1 - share x / (1 + bends x)), x = m / 50 kPa, dm/dt = sum max(0, dp/dt) + returned sum "
      "min(0, dp/dt) - refill - m / time, m not below 0, the sums over all chambers, of means over 0.1 s and "
      "without what goes to and fro within "
      "1 kPa",
      "the form is its own; sources and lines: P. Beater, Pneumatic Drives, 2007, "
      "doi:10.1007/978-3-540-69471-7",
      Family::kActuation,
      {{"share", "1", "of the pressures, that is lost per 50 kPa that all together have drawn", 0.0, 4.0,
        0.1},
       {"time_s", "s", "in which the source makes up for what was drawn", 0.05, kLongest_s, 4.0},
       {"returned", "1", "of what chambers vent, that is back at once; 0: a tank, 1: a line", 0.0, 1.0, 0.0},
       {"refill_pa_per_s", "Pa/s", "at which a pump makes up for it beside", 0.0, 1e6, 0.0},
       {"bends", "1", "how the loss falls short of proportion to what was drawn", 0.0, 20.0, 0.0}},
      1,
      {"chamber_bulge", "gain_nonlinearity", "flow_limit", "pressure_lag"},
      {"moment_gain", "elongation"}});
}

}  // namespace softarm::effects
