// EI(s) = EI (1 + a (2 s / L - 1)), along each segment; GJ likewise.
#include "effects.h"

namespace softarm::effects {
namespace {

class StiffnessTaper : public Described {
 public:
  using Described::Described;
  void act(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape*,
           const Memory&, rod::Rod& rod) const override {
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const double factor = 1.0 + values[0] * (2.0 * fine.pieces()[j].middle_fraction() - 1.0);
      rod.segments[j].bending_compliance /= factor;
      rod.segments[j].torsional_compliance /= factor;
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_stiffness_taper() {
  return std::make_unique<StiffnessTaper>(
      Info{"stiffness_taper",
           "the bending stiffness is not the same all along: it falls or rises towards the tip",
           "EI(s) = EI (1 + share (2 s / L - 1))",
           "S. S. Antman, Nonlinear Problems of Elasticity, 2005, doi:10.1007/0-387-27649-1",
           Family::kConstitutive,
           {{"share", "1", "by which EI is higher at the tip, and lower at the base, than its mean", -0.9,
             0.9, 0.2}},
           1,
           {"actuation_taper", "mass_distribution"},
           {"bending_stiffness", "moment_gain"}});
}

}  // namespace softarm::effects
