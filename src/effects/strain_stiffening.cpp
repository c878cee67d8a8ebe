// M = EI k (1 + beta k^2): the wall is stiffer where it is bent far.
#include <cmath>

#include "effects.h"

namespace softarm::effects {
namespace {

/// x (1 + b x^2) = y, b >= 0.
double bent(double y, double b) {
  double x = y / (1.0 + b * y * y / (1.0 + b * y * y));
  for (int i = 0; i < 50; ++i) {
    const double step = (x * (1.0 + b * x * x) - y) / (1.0 + 3.0 * b * x * x);
    x -= step;
    if (std::abs(step) < 1e-14 * y) break;
  }
  return x;
}

class StrainStiffening : public Described {
 public:
  using Described::Described;
  bool needs_shape() const override { return true; }
  void act(const arm::Arm&, const FineRod&, const Values& values, const Instant&, const Shape* shape,
           const Memory&, rod::Rod& rod) const override {
    // Solved for the curvature at the moment of the shape: this depends on the shape much less than the
    // curvature itself, which would ask for more rounds.
    for (std::size_t j = 0; j < rod.segments.size(); ++j) {
      rod::Segment& piece = rod.segments[j];
      const rod::RodState& at = shape->middles[j];
      const Eigen::Vector3d moment = at.q.conjugate() * at.m + piece.moment_nm;
      const double linear = piece.bending_compliance * moment.head<2>().norm();
      if (linear > 0.0) piece.bending_compliance *= bent(linear, std::fmax(0.0, values[0])) / linear;
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_strain_stiffening() {
  return std::make_unique<StrainStiffening>(
      Info{"strain_stiffening",
           "the arm is stiffer where it is bent far",
           "M = EI u (1 + beta u^2)",
           "S. S. Antman, Nonlinear Problems of Elasticity, 2005, doi:10.1007/0-387-27649-1",
           Family::kConstitutive,
           {{"beta_m2", "m^2", "beta in M = EI k (1 + beta k^2), k the curvature", 0.0, 0.05, 0.001}},
           1,
           {"pressure_stiffening", "contact", "gain_nonlinearity"},
           {"bending_stiffness", "moment_gain"}});
}

}  // namespace softarm::effects
