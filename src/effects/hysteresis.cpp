// Rate-independent loop between what is commanded and the moment that acts: a play (Prandtl and Ishlinskii's
// operator with one element) of each input, or of several widths.
#include <algorithm>

#include "effects.h"

namespace softarm::effects {
namespace {

// Widths of the plays against the loop's, and their weights: what acts lags by half the loop's width once the
// input has moved by more than the widest.
constexpr double kWidths[] = {0.5, 1.0, 2.0};
constexpr double kWeights[] = {0.3, 0.4, 0.3};

class Hysteresis : public Described {
 public:
  using Described::Described;
  void drive(const Arm& arm, const Values& values, Series& series) const override {
    for (Eigen::Index row = 0; row < series.moment_inputs.rows(); ++row) {
      const InputKind kind = arm.inputs.scalars[static_cast<std::size_t>(row)].kind;
      if (kind == InputKind::kVacuum) continue;
      const double usual = kind == InputKind::kPressure  ? values[1]
                           : kind == InputKind::kTension ? 0.2
                                                         : 0.03;
      double sum[3];
      std::fill_n(sum, 3, series.inputs(row, 0));
      const Eigen::RowVectorXd input = series.moment_inputs.row(row);
      for (Eigen::Index i = 0; i < input.size(); ++i) {
        double acting = 0.0;
        for (int k = 0; k < 3; ++k) {
          const double half = 0.5 * usual * kWidths[k];
          sum[k] = std::clamp(sum[k], input[i] - half, input[i] + half);
          acting += kWeights[k] * sum[k];
        }
        series.moment_inputs(row, i) = input[i] + values[0] * (acting - input[i]);
      }
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_hysteresis() {
  return std::make_unique<Hysteresis>(
      Info{"hysteresis",
           "what acts lags behind what is commanded by a loop that is the same at every speed",
           Family::kMemory,
           {{"share", "1", "of a loop of that width", -0.2, 5.0, 0.5},
            {"width_pa", "Pa", "width of the loop, of pressures", 100.0, 20000.0, 2500.0}},
           1,
           {"creep", "pressure_lag", "clock_offset"},
           {"moment_gain"}});
}

}  // namespace softarm::effects
