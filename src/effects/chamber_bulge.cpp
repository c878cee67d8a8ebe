// Chambers bulge into each other: the moment of one goes with the pressures of the others, too.
#include <algorithm>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

/// Rows of the chambers of the first segment that takes a pressure, by row.
std::vector<Rows> neighbours_of(const arm::Arm& arm) {
  std::vector<Rows> list(arm.inputs.scalars.size());
  for (const arm::Segment& segment : arm.segments) {
    Rows rows;
    for (const arm::Chamber& chamber : segment.chambers) rows.push_back(row_of(arm, chamber.input));
    for (const Eigen::Index row : rows) {
      Rows& others = list[static_cast<std::size_t>(row)];
      if (others.empty())
        std::copy_if(rows.begin(), rows.end(), std::back_inserter(others),
                     [row](Eigen::Index other) { return other != row; });
    }
  }
  return list;
}

class ChamberBulge : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override {
    return std::any_of(arm.segments.begin(), arm.segments.end(),
                       [](const arm::Segment& segment) { return segment.chambers.size() > 1; });
  }
  bool drives() const override { return true; }
  void drive(const arm::Arm& arm, const Values& values, Series& series) const override {
    if (values[0] == 0.0) return;
    const std::vector<Rows> neighbours = neighbours_of(arm);
    const Eigen::MatrixXd alone = series.moment_inputs;
    for (std::size_t i = 0; i < neighbours.size(); ++i) {
      if (neighbours[i].empty()) continue;
      Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(alone.cols());
      for (const Eigen::Index other : neighbours[i])
        mean += alone.row(other) / static_cast<double>(neighbours[i].size());
      const auto row = static_cast<Eigen::Index>(i);
      series.moment_inputs.row(row).array() *= (1.0 + values[0] / kReferencePa * mean.array()).max(0.0);
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_chamber_bulge() {
  return std::make_unique<ChamberBulge>(
      Info{"chamber_bulge",
           "the moment of a chamber also depends on the pressures of its neighbours",
           "M_i = g_i p_i (1 + share p_others / 50 kPa), p_others their mean",
           "chambers of a soft arm: A. D. Marchese, R. K. Katzschmann, D. Rus, Soft Robotics 2, 2015, "
           "doi:10.1089/soro.2014.0022",
           Family::kActuation,
           {{"share", "1", "of the moment, by which it is higher where the others are at 50 kPa", -0.9, 5.0,
             0.15}},
           1,
           {"gain_nonlinearity", "pressure_stiffening", "chamber_mismatch"},
           {"moment_gain", "bending_stiffness"}});
}

}  // namespace softarm::effects
