// A hose or wire pulls the tip towards an anchor beside where it is when the arm is straight: always, or from
// a length on, up to which it is slack. Some of its weight hangs at the tip.
#include <algorithm>
#include <cmath>

#include "effects.h"

namespace softarm::effects {
namespace {

// Looked for with this length of slack, and with the anchor so far beside the arm, over its length.
constexpr double kSlack = 0.1, kFar = 0.4;
constexpr int kDirections = 4;
constexpr double kFarthest_m = 1.0;  // of the anchor from the straight tip, along either axis
constexpr double kNear_m = 1e-4;     // from the anchor, within which the pull has no direction

class Tether : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool needs_strains() const override { return false; }
  bool needs_shape() const override { return true; }
  std::vector<Values> grid(const arm::Arm&, const FineRod& fine) const override {
    const double far_m = kFar * fine.length_m();
    std::vector<Values> list{Values::Zero(5),
                             (Values(5) << 0.0, 0.0, 0.0, 0.0, kSlack * fine.length_m()).finished()};
    // Beside the arm: slack, or always taut, where it is straight.
    for (const double length_m : {0.0, far_m})
      for (int i = 0; i < kDirections; ++i)
        list.push_back((Values(5) << 0.0, 0.0, far_m * std::cos(2.0 * M_PI * i / kDirections),
                        far_m * std::sin(2.0 * M_PI * i / kDirections), length_m)
                           .finished());
    return list;
  }
  std::optional<Values> like(const Effect& other, const Values& wall, const FineRod& fine) const override {
    if (other.info().id != "contact") return std::nullopt;
    // Its anchor is so far on the other side that it pulls nearly along the wall's normal.
    const double far_m = std::min(fine.length_m(), kFarthest_m);
    return (Values(5) << wall[0], 0.0, -far_m * std::cos(wall[2]), -far_m * std::sin(wall[2]),
            std::max(0.0, far_m + wall[3]))
        .finished();
  }
  std::optional<std::pair<double, double>> place(const arm::Arm& arm, const Values&) const override {
    return std::make_pair(arm.total_length_m(), arm.total_length_m());
  }
  void act(const arm::Arm&, const FineRod&, const Values& values, const Instant&, const Shape*, const Memory&,
           rod::Rod& rod) const override {
    rod.loads[rod::kTipMassLoad].mass_kg += values[1];
  }
  bool holds_places() const override { return true; }
  bool needs_whole_derivatives(const Values&) const override { return false; }
  std::vector<double> held_places_m(const FineRod& fine, const Values&) const override {
    return {fine.length_m()};
  }
  Eigen::Vector3d holding_force_n(const FineRod& fine, const Values& values, std::size_t,
                                  const Eigen::Vector3d& place_m, const Memory&) const override {
    // What it hangs on stands still, whatever the arm's base does.
    const rod::Rod& rest = fine.layout();
    const Eigen::Vector3d anchor =
        rest.p_base + rest.q_base * Eigen::Vector3d(values[2], values[3], fine.length_m());
    const Eigen::Vector3d way = anchor - place_m;
    const double far_m = std::sqrt(way.squaredNorm() + kNear_m * kNear_m), beyond_m = far_m - values[4];
    if (beyond_m <= 0.0) return Eigen::Vector3d::Zero();
    return values[0] * beyond_m / far_m * way;
  }
};

}  // namespace

std::unique_ptr<Effect> make_tether() {
  return std::make_unique<Tether>(
      Info{"tether",
           "a hose, a wire or the like pulls at the tip",
           "F = k max(0, |d| - length) d / |d|, d = anchor - x(L), and force mass g",
           "loads on a rod: D. C. Rucker, R. J. Webster, IEEE Trans. Robotics 27, 2011, "
           "doi:10.1109/TRO.2011.2160469",
           Family::kLoad,
           {{"stiffness_n_per_m", "N/m", "of its pull", 0.0, 300.0, 2.0},
            {"mass_kg", "kg", "of it, that hangs at the tip", 0.0, 1.0, 0.01},
            {"anchor_x_m", "m", "place of its anchor along x, from the straight tip", -kFarthest_m,
             kFarthest_m, 0.0},
            {"anchor_y_m", "m", "place of its anchor along y, from the straight tip", -kFarthest_m,
             kFarthest_m, 0.0},
            {"length_m", "m", "up to which it is slack", 0.0, 2.0, 0.0}},
           2,
           {"tip_mass", "strain_stiffening", "contact"},
           {"bending_stiffness"}});
}

}  // namespace softarm::effects
