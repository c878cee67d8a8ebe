// Pressures begin to act late: from a pressure on, a constant one is missing; below, in proportion.
//
// Sharp, without any moment up to the pressure that is lost, where both parameters are equal. The edge is a
// parameter of its own so that the size acts in proportion.
#include <algorithm>
#include <cmath>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

class PressureDeadZone : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override { return !chamber_rows(arm).empty(); }
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    return {Eigen::Vector2d(0.0, 1500.0), Eigen::Vector2d(0.0, 3000.0), Eigen::Vector2d(0.0, 6000.0)};
  }
  void drive(const arm::Arm& arm, const Values& values, Series& series) const override {
    if (values[0] == 0.0) return;
    const double edge_pa = std::max(values[1], 1.0);
    for (const Eigen::Index row : chamber_rows(arm)) {
      for (Eigen::Index i = 0; i < series.moment_inputs.cols(); ++i) {
        double& p = series.moment_inputs(row, i);
        const double left = std::abs(p) - values[0] * std::min(1.0, std::abs(p) / edge_pa);
        p = std::copysign(std::max(0.0, left), p);
      }
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_pressure_dead_zone() {
  return std::make_unique<PressureDeadZone>(
      Info{"pressure_dead_zone",
           "small pressures do not bend the arm",
           "M = g (p - lost min(1, p / edge))",
           "chambers of a soft arm: A. D. Marchese, R. K. Katzschmann, D. Rus, Soft Robotics 2, 2015, "
           "doi:10.1089/soro.2014.0022",
           Family::kActuation,
           {{"lost_pa", "Pa", "pressure that does not act", 0.0, 50e3, 3000.0},
            {"edge_pa", "Pa", "pressure from which on all of it is lost", 200.0, 50e3, 3000.0}},
           1,
           {"gain_nonlinearity", "pressure_offset"},
           {"moment_gain"}});
}

}  // namespace softarm::effects
