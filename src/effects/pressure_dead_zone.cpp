// Pressures begin to act late: from a pressure on, a constant one is missing; below, in proportion.
//
// Sharp, without any moment up to the pressure that is lost, where both numbers are equal. The edge is a
// parameter of its own so that the size acts in proportion. Walls of one make that take up a pressure before
// they bend do so in all chambers. In one chamber alone it is the supply's or the sensor's, so that the
// pressure itself is missing, to the length and the stiffness, too.
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
  std::vector<Values> grid(const arm::Arm& arm, const FineRod&) const override {
    std::vector<Values> list;
    for (const double chamber : chamber_numbers(arm, chamber_rows(arm)))
      for (const double edge_pa : {1500.0, 3000.0, 6000.0})
        list.push_back(Eigen::Vector3d(0.0, edge_pa, chamber));
    return list;
  }
  bool drives() const override { return true; }
  void drive(const arm::Arm& arm, const Values& values, Series& series) const override {
    if (values[0] == 0.0) return;
    for (const Eigen::Index row : rows_of_chamber(arm, chamber_rows(arm), values[2])) {
      lose(values, series.moment_inputs.row(row));
      if (values[2] > 0.5) lose(values, series.inputs.row(row));
    }
  }

 private:
  static void lose(const Values& values, Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>> row) {
    const double edge_pa = std::max(values[1], 1.0);
    for (Eigen::Index i = 0; i < row.size(); ++i) {
      double& p = row[i];
      const double left = std::abs(p) - values[0] * std::min(1.0, std::abs(p) / edge_pa);
      p = std::copysign(std::max(0.0, left), p);
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_pressure_dead_zone() {
  return std::make_unique<PressureDeadZone>(
      Info{"pressure_dead_zone",
           "small pressures do not bend the arm",
           "M = g (p - lost min(1, p / edge)), or of one chamber acting = p - lost min(1, p / edge)",
           "chambers of a soft arm: A. D. Marchese, R. K. Katzschmann, D. Rus, Soft Robotics 2, 2015, "
           "doi:10.1089/soro.2014.0022",
           Family::kActuation,
           {{"lost_pa", "Pa", "pressure that does not act", 0.0, 50e3, 3000.0},
            {"edge_pa", "Pa", "pressure from which on all of it is lost", 200.0, 50e3, 3000.0},
            chamber_parameter()},
           1,
           {"gain_nonlinearity", "pressure_offset", "pressure_leak", "chamber_mismatch"},
           {"moment_gain", "elongation"}});
}

}  // namespace softarm::effects
