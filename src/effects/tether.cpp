// A hose or wire pulls the tip towards an anchor beside where it is when the arm is straight.
#include "effects.h"

namespace softarm::effects {
namespace {

class Tether : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  bool needs_strains() const override { return false; }
  bool needs_shape() const override { return true; }
  bool answers_evenly() const override { return true; }
  std::optional<std::pair<double, double>> place(const arm::Arm& arm, const Values&) const override {
    return std::make_pair(arm.total_length_m(), arm.total_length_m());
  }
  void act(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape* shape,
           const Memory&, rod::Rod& rod) const override {
    // What it hangs on stands still, whatever the arm's base does.
    const rod::Rod& rest = fine.layout();
    const Eigen::Vector3d anchor =
        rest.p_base + rest.q_base * Eigen::Vector3d(values[1], values[2], fine.length_m());
    rod.loads.back().force_n += values[0] * (anchor - shape->stations.back().p);
  }
};

}  // namespace

std::unique_ptr<Effect> make_tether() {
  return std::make_unique<Tether>(
      Info{"tether",
           "something, a hose or a wire, pulls at the tip",
           "F = k (anchor - x(L))",
           "loads on a rod: D. C. Rucker, R. J. Webster, IEEE Trans. Robotics 27, 2011, "
           "doi:10.1109/TRO.2011.2160469",
           Family::kLoad,
           {{"stiffness_n_per_m", "N/m", "of its pull", 0.0, 300.0, 2.0},
            {"anchor_x_m", "m", "place of its anchor along x, from the straight tip", -1.0, 1.0, 0.0},
            {"anchor_y_m", "m", "place of its anchor along y, from the straight tip", -1.0, 1.0, 0.0}},
           1,
           {"tip_mass", "strain_stiffening", "contact"},
           {"bending_stiffness"}});
}

}  // namespace softarm::effects
