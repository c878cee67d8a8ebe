// The gain of one chamber is not as the arm file says.
#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

class ChamberMismatch : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool applies_to(const arm::Arm& arm) const override { return chamber_rows(arm).size() > 1; }
  std::vector<Values> grid(const arm::Arm& arm, const FineRod&) const override {
    std::vector<Values> list;
    for (const double chamber : chamber_numbers(arm, chamber_rows(arm)))
      if (chamber > 0.0) list.push_back(Eigen::Vector2d(0.0, chamber));
    return list;
  }
  bool drives() const override { return true; }
  void drive(const arm::Arm& arm, const Values& values, Series& series) const override {
    for (const Eigen::Index row : rows_of_chamber(arm, chamber_rows(arm), values[1]))
      series.moment_inputs.row(row) *= 1.0 + values[0];
  }
};

}  // namespace

std::unique_ptr<Effect> make_chamber_mismatch() {
  return std::make_unique<ChamberMismatch>(Info{
      "chamber_mismatch",
      "one chamber bends the arm more or less than the arm file says",
      "M_i = g_i (1 + share) p_i, of one chamber i",
      "chambers side by side: P. Fairchild et al., ASME Lett. Dyn. Syst. Control 3, 2023, "
      "doi:10.1115/1.4064090",
      Family::kActuation,
      {{"share", "1", "of its gain, by which it is higher", -0.95, 10.0, 0.05},
       {"chamber", "1", "number of the chamber in the arm file's list of pressures", 1.0, 64.0, 1.0, true}},
      1,
      {"bending_plane_offset", "pressure_leak"},
      {"moment_gain"}});
}

}  // namespace softarm::effects
