// EI and GJ lower by a share over a short stretch: a seam, a cut, a fitting below the skin.
#include <algorithm>
#include <optional>
#include <utility>

#include "along.h"
#include "effects.h"

namespace softarm::effects {
namespace {

constexpr double kWidth = 0.15;  // of the arm's length, where it is looked for
// Closer to one another where the fitted stiffness makes neighbours differ most.
constexpr double kPlaces[] = {0.075, 0.13, 0.18, 0.22, 0.26, 0.3, 0.34, 0.39, 0.46, 0.55, 0.7, 0.88};

class SoftSpot : public Described {
 public:
  using Described::Described;
  std::vector<Values> grid(const arm::Arm&, const FineRod& fine) const override {
    const double length = fine.length_m(), width = kWidth * length;
    std::vector<Values> list;
    for (const double place : kPlaces) list.push_back(Eigen::Vector3d(0.0, place * length, width));
    return list;
  }
  std::optional<std::pair<double, double>> place(const arm::Arm& arm, const Values& values) const override {
    const double end = arm.total_length_m(), half = 0.5 * values[2];
    return std::make_pair(std::clamp(values[1] - half, 0.0, end), std::clamp(values[1] + half, 0.0, end));
  }
  void act(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape*,
           const Memory&, rod::Rod& rod) const override {
    const double softer = 1.0 / (1.0 - std::min(values[0], kMost)) - 1.0;
    const double centre = values[1], half = 0.5 * values[2], end = fine.length_m();
    const Eigen::VectorXd shares =
        cover(fine, std::clamp(centre - half, 0.0, end), std::clamp(centre + half, 0.0, end));
    for (std::size_t j = 0; j < rod.segments.size(); ++j) {
      const double factor = 1.0 + softer * shares[static_cast<Eigen::Index>(j)];
      rod.segments[j].bending_compliance *= factor;
      rod.segments[j].torsional_compliance *= factor;
    }
  }

 private:
  static constexpr double kMost = 0.95;
};

}  // namespace

std::unique_ptr<Effect> make_soft_spot() {
  return std::make_unique<SoftSpot>(
      Info{"soft_spot",
           "the arm is softer, or stiffer, over a stretch",
           "EI (1 - share) for |s - centre| < width / 2",
           "S. S. Antman, Nonlinear Problems of Elasticity, 2005, doi:10.1007/0-387-27649-1",
           Family::kConstitutive,
           {{"share", "1", "by which EI is lower there", -1.0, 0.95, 0.3},
            {"centre_m", "m", "middle of the stretch, arclength from the base", 0.0, 10.0, 0.1, false, true},
            {"width_m", "m", "length of the stretch", 0.002, 1.0, 0.03}},
           1,
           {"rigid_ends", "contact", "stiffness_taper", "base_compliance"},
           {"bending_stiffness"}});
}

}  // namespace softarm::effects
