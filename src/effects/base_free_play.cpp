// The clamp has clearance: a small moment turns the base as far as it goes, a large one no further.
#include <cmath>

#include "effects.h"

namespace softarm::effects {
namespace {

// Looked for where the weight of the arm alone would bring it to its stop, and where it just does: shares of
// the moment of the weight about the base of an arm held level.
constexpr double kOnsetShares[] = {0.03, 0.3};
constexpr double kStandard_m_s2 = 9.81, kLeastOnset_nm = 1e-6;

class BaseFreePlay : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool needs_strains() const override { return false; }
  bool needs_shape() const override { return true; }
  std::optional<std::pair<double, double>> place(const arm::Arm&, const Values&) const override {
    return std::make_pair(0.0, 0.0);
  }
  std::vector<Values> grid(const arm::Arm& arm, const FineRod& fine) const override {
    double weight_n = 0.0;
    for (const arm::Segment& segment : arm.segments)
      weight_n += kStandard_m_s2 * segment.mass_per_length_kg_m * segment.length_m;
    std::vector<Values> list;
    for (const double share : kOnsetShares)
      list.push_back(Eigen::Vector2d(0.0, std::fmax(1e-4, share * 0.5 * weight_n * fine.length_m())));
    return list;
  }
  void act(const arm::Arm&, const FineRod&, const Values& values, const Instant&, const Shape* shape,
           const Memory&, rod::Rod& rod) const override {
    const double onset_nm = std::fmax(values[1], kLeastOnset_nm);
    // As a joint of that secant compliance: only how large the moment is then has to agree with the shape,
    // and not its direction, which turns with every small load where the play is large.
    rod.segments.front().joint_compliance +=
        values[0] / std::hypot(shape->base_moment_nm.head<2>().norm(), onset_nm);
  }
};

}  // namespace

std::unique_ptr<Effect> make_base_free_play() {
  return std::make_unique<BaseFreePlay>(
      Info{"base_free_play",
           "the base has free play: a small load turns it to its limit, though the body measured as the base "
           "does not turn",
           "turn of the base = play M / sqrt(|M|^2 + onset^2), M the bending moment that the clamp bears",
           "the smooth law is a form of its own; joints with clearance have stops: J. Ambrosio, J. Pombo, "
           "Multibody System Dynamics 42, 2018, doi:10.1007/s11044-018-9613-z",
           Family::kBoundary,
           {{"play_rad", "rad", "how far it turns to every side", 0.0, 0.5, 0.01},
            {"onset_nm", "N m", "moment that turns it by 71 % of that", 1e-5, 10.0, 0.02}},
           1,
           {"base_compliance", "rigid_ends", "shear"},
           {"bending_stiffness", "joint_compliance"}});
}

}  // namespace softarm::effects
