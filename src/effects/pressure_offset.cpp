// Zeros of the pressure sensors: what is published is off by a constant.
#include <string>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

constexpr int kMostSensors = 8;

class PressureOffset : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override { return !gas_rows(arm).empty(); }
  bool has_parameter(const arm::Arm& arm, int parameter) const override {
    return parameter < static_cast<int>(gas_rows(arm).size());
  }
  bool drives() const override { return true; }
  void drive(const arm::Arm& arm, const Values& values, Series& series) const override {
    const Rows rows = gas_rows(arm);
    for (std::size_t k = 0; k < rows.size() && k < kMostSensors; ++k) {
      const bool vacuum =
          arm.inputs.scalars[static_cast<std::size_t>(rows[k])].kind == arm::InputKind::kVacuum;
      const double by = (vacuum ? 1.0 : -1.0) * values[static_cast<Eigen::Index>(k)];
      series.inputs.row(rows[k]).array() += by;
      series.moment_inputs.row(rows[k]).array() += by;
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_pressure_offset() {
  std::vector<Parameter> parameters;
  for (int k = 1; k <= kMostSensors; ++k)
    parameters.push_back({"offset_" + std::to_string(k) + "_pa", "Pa",
                          "by which sensor " + std::to_string(k) +
                              " of the arm file's list reads too high (of vacuum: the absolute pressure)",
                          -50e3, 50e3, 1000.0});
  return std::make_unique<PressureOffset>(
      Info{"pressure_offset",
           "pressure sensors do not read zero when there is no pressure",
           "acting = published - offset, of each sensor",
           "errors of instruments: JCGM 100:2008, doi:10.59161/JCGM100-2008E",
           Family::kSensor,
           parameters,
           kMostSensors,
           {"rest_curvature", "pressure_dead_zone", "base_tilt"},
           {"moment_gain", "rest_curvature"}});
}

}  // namespace softarm::effects
