// The arm stretches under the weights that hang on it: strain = N / EA.
#include "effects.h"

namespace softarm::effects {
namespace {

class AxialCompliance : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  void act(const arm::Arm&, const FineRod&, const Values& values, const Instant&, const Shape*, const Memory&,
           rod::Rod& rod) const override {
    for (rod::Segment& piece : rod.segments) piece.axial_compliance += values[0];
  }
};

}  // namespace

std::unique_ptr<Effect> make_axial_compliance() {
  return std::make_unique<AxialCompliance>(
      Info{"axial_compliance",
           "the arm stretches under its weight and its payload, more than the arm file says",
           "strain = N (1/EA + compliance), N the pull of the weights",
           "S. S. Antman, Nonlinear Problems of Elasticity, 2005, doi:10.1007/0-387-27649-1",
           Family::kConstitutive,
           {{"compliance_per_n", "1/N", "strain per pull, 1/EA, beyond the arm file's", 0.0, 0.1, 0.005}},
           1,
           {"pressure_elongation", "vacuum_shortening"},
           {"length", "axial_stiffness"}});
}

}  // namespace softarm::effects
