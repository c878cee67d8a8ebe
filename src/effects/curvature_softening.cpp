// Softer beyond a curvature: a wall that wrinkles, a section that turns oval. A size of strain_stiffening of
// the other sign would be no such law: its moment falls beyond a curvature, and it has no knee.
#include <algorithm>
#include <cmath>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Vector2d;

constexpr double kKneeRounding = 0.25;  // of the knee
// Looked for where the arm is bent by so much, rad.
constexpr double kKnees_rad[] = {0.35, 0.9};

class CurvatureSoftening : public Described {
 public:
  using Described::Described;
  bool needs_shape() const override { return true; }
  Stage stage() const override { return Stage::kLaws; }
  bool needs_whole_derivatives(const Values&) const override { return false; }
  std::vector<Values> grid(const arm::Arm&, const FineRod& fine) const override {
    std::vector<Values> list;
    for (const double knee_rad : kKnees_rad) list.push_back(Vector2d(0.0, knee_rad / fine.length_m()));
    return list;
  }
  void act(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape* shape,
           const Memory&, rod::Rod& rod) const override {
    const double softer = std::max(0.0, values[0]), knee = std::max(values[1], 1e-3);
    if (softer == 0.0) return;
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      rod::Segment& piece = rod.segments[j];
      const rod::RodState& middle = shape->middles[j];
      const Vector2d& rest = piece.unloaded_curvature_per_m;
      const Vector2d even = linear_curvature(piece, middle) - rest;
      const double size = even.norm();
      if (!(size > 0.0)) continue;
      const double width = kKneeRounding * knee, from = size - knee, root = std::hypot(from, width);
      const double beyond = 0.5 * (from + root + knee - std::hypot(knee, width));
      const double slope = 0.5 * (1.0 + from / root);
      const double more = 1.0 + softer * beyond / size;
      bend_to(rest + more * even, slope_about(even, 1.0 + softer * slope, more), middle, piece);
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_curvature_softening() {
  return std::make_unique<CurvatureSoftening>(Info{
      "curvature_softening",
      "the arm is softer where it is bent beyond a curvature, as if its wall wrinkled or its section turned "
      "oval",
      "u = v + softer R(|v| - knee) v / |v|, v = M / EI, R a ramp that begins over a quarter of the knee",
      "the ramp is a form of its own; a membrane wrinkles where it is pressed: R. L. Comer, S. Levy, AIAA J. "
      "1, "
      "1963, doi:10.2514/3.1873",
      Family::kConstitutive,
      {{"softer", "1", "by which the curvature beyond the knee grows", 0.0, 5.0, 0.3},
       {"knee_per_m", "1/m", "curvature beyond which it is softer", 0.05, 200.0, 3.0}},
      1,
      {"curvature_gain", "gain_nonlinearity", "jamming_yield", "one_sided_softness"},
      {"bending_stiffness", "moment_gain"}});
}

}  // namespace softarm::effects
