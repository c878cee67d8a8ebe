// One source feeds all chambers: what they draw from it together, all of them get less for.
//
// Drawn is what the pressures have risen within a time. Where that is short it is their flow, through a line
// that all share. A source that is not filled again during a trial would go by their sum: that is a
// saturation, which the arm file's laws have, and stands for too much else.
#include <algorithm>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

constexpr double kTimes_s[] = {0.4, 4.0};

class SupplySag : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override {
    return rows_of(arm, arm::InputKind::kPressure).size() > 1;
  }
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    std::vector<Values> list;
    for (const double time_s : kTimes_s) list.push_back(Eigen::Vector2d(0.0, time_s));
    return list;
  }
  bool looks_back() const override { return true; }
  void drive(const arm::Arm& arm, const Values& values, Series& series) const override {
    if (values[0] == 0.0) return;
    const Eigen::RowVectorXd drawn_pa = drawn(arm, std::max(values[1], 1e-2), series);
    const Eigen::RowVectorXd left = (1.0 - values[0] / kReferencePa * drawn_pa.array()).max(0.0);
    for_pressures(arm, series, [&left](auto row) { row.array() *= left.array(); });
  }

 private:
  static Eigen::RowVectorXd drawn(const arm::Arm& arm, double time_s, const Series& series) {
    Eigen::RowVectorXd sum_pa = Eigen::RowVectorXd::Zero(series.inputs.cols());
    for (const Eigen::Index row : rows_of(arm, arm::InputKind::kPressure)) {
      const auto u = series.inputs.row(row);
      double filled = u.size() > 0 ? u[0] : 0.0;  // a trial begins at rest, long settled
      for (Eigen::Index i = 1; i < u.size(); ++i) {
        const Following f = following(series.t_s[i] - series.t_s[i - 1], time_s);
        filled = f.kept * filled + f.weight_last * u[i - 1] + f.weight_now * u[i];
        sum_pa[i] += std::max(0.0, u[i] - filled);
      }
    }
    return sum_pa;
  }
};

}  // namespace

std::unique_ptr<Effect> make_supply_sag() {
  return std::make_unique<SupplySag>(Info{
      "supply_sag",
      "all pressures fall short together, the more air the chambers draw at once from their common source",
      "acting = p (1 - share sum max(0, p - w) / 50 kPa), time dw/dt = p - w, the sum over all chambers",
      "the form is its own; sources and lines: P. Beater, Pneumatic Drives, 2007, "
      "doi:10.1007/978-3-540-69471-7",
      Family::kActuation,
      {{"share", "1", "of the pressures, that is lost when all together have drawn 50 kPa", 0.0, 2.0, 0.1},
       {"time_s", "s", "in which the source makes up for what was drawn", 0.05, 20.0, 4.0}},
      1,
      {"chamber_bulge", "gain_nonlinearity", "flow_limit", "pressure_lag"},
      {"moment_gain", "elongation"}});
}

}  // namespace softarm::effects
