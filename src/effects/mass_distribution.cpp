// The weight is not the same all along: rho(s) = rho (1 + a (2 s / L - 1)), along each segment.
#include "effects.h"

namespace softarm::effects {
namespace {

class MassDistribution : public Described {
 public:
  using Described::Described;
  void act(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape*,
           const Memory&, rod::Rod& rod) const override {
    for (std::size_t j = 0; j < fine.pieces().size(); ++j)
      rod.segments[j].mass_kg *= 1.0 + values[0] * (2.0 * fine.pieces()[j].middle_fraction() - 1.0);
  }
};

}  // namespace

std::unique_ptr<Effect> make_mass_distribution() {
  return std::make_unique<MassDistribution>(
      Info{"mass_distribution",
           "the arm's weight is not spread evenly: heavier or lighter towards the tip",
           "rho(s) = rho (1 + share (2 s / L - 1))",
           "weight of a rod: D. C. Rucker, R. J. Webster, IEEE Trans. Robotics 27, 2011, "
           "doi:10.1109/TRO.2011.2160469",
           Family::kLoad,
           {{"share", "1", "by which it is heavier at the tip, and lighter at the base, than its mean", -1.0,
             1.0, 0.2}},
           1,
           {"tip_mass", "payload_offset", "stiffness_taper"},
           {"bending_stiffness"}});
}

}  // namespace softarm::effects
