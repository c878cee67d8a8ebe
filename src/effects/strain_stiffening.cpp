// M = EI k (1 + beta k^2): the wall is stiffer where it is bent far.
#include <cmath>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Vector2d;

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
  Stage stage() const override { return Stage::kLaws; }
  bool needs_whole_derivatives(const Values&) const override { return false; }
  void act(const arm::Arm&, const FineRod&, const Values& values, const Instant&, const Shape* shape,
           const Memory&, rod::Rod& rod) const override {
    const double beta = std::fmax(0.0, values[0]);
    if (beta == 0.0) return;
    for (std::size_t j = 0; j < rod.segments.size(); ++j) {
      rod::Segment& piece = rod.segments[j];
      const rod::RodState& middle = shape->middles[j];
      const Vector2d& rest = piece.unloaded_curvature_per_m;
      const Vector2d even = linear_curvature(piece, middle) - rest;
      const double linear = even.norm();
      if (!(linear > 0.0)) continue;
      const double u = bent(linear, beta);
      bend_to(rest + u / linear * even, slope_about(even, 1.0 / (1.0 + 3.0 * beta * u * u), u / linear),
              middle, piece);
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
