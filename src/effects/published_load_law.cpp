// The moments of the loads as the papers print them, in place of statics: online paper (2), (3); see
// softarm/rod/published.h, LoadLaw::kPrinted. What a fit of an older model may have built on; no arm obeys
// it.
#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Vector3d;

/// Sine of a tangent's angle from the vertical: of an arm that stands or hangs, from its base's axis.
double slope(const rod::RodState& at, const Vector3d& vertical) {
  return (at.q * Vector3d::UnitZ()).cross(vertical).norm();
}

class PublishedLoadLaw : public Described {
 public:
  using Described::Described;
  bool needs_shape() const override { return true; }
  void act(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape* shape,
           const Memory&, rod::Rod& rod) const override {
    const double size = rod.gravity_m_s2.norm();
    if (size == 0.0) return;
    const Vector3d vertical = rod.gravity_m_s2 / size;
    const std::size_t count = rod.segments.size();
    std::vector<Vector3d> printed_less_statics(count, Vector3d::Zero());
    // Point loads: F sin theta(L) [w(L) - w(s)] for F [w(L) - w(s)].
    for (const int load : {rod::kTipMassLoad, rod::kPayloadLoad}) {
      const rod::PointLoad& point = rod.loads[static_cast<std::size_t>(load)];
      std::size_t at = 0;
      while (at + 1 < count && fine.pieces()[at].s_to_m < point.s_m - 1e-9) ++at;
      const rod::RodState& end = shape->stations[at];
      for (std::size_t j = 0; j <= at; ++j)
        printed_less_statics[j] += (slope(end, vertical) - 1.0) *
                                   (end.p - shape->middles[j].p).cross(point.mass_kg * rod.gravity_m_s2);
    }
    // Weight: sin theta(r) [w(L) - w(r)] for [w(r) - w(s)], over what lies beyond s.
    const Vector3d& tip = shape->stations.back().p;
    for (std::size_t j = 0; j < count; ++j) {
      const rod::RodState& here = shape->middles[j];
      const auto add = [&](double mass, const Vector3d& p, double sine) {
        const Vector3d arm = sine * (tip - p) - (p - here.p);
        printed_less_statics[j] += arm.cross(mass * rod.gravity_m_s2);
      };
      // The far half of the piece itself.
      const rod::RodState& end = shape->stations[j];
      add(0.5 * rod.segments[j].mass_kg, 0.5 * (here.p + end.p),
          0.5 * (slope(here, vertical) + slope(end, vertical)));
      for (std::size_t k = j + 1; k < count; ++k)
        add(rod.segments[k].mass_kg, shape->middles[k].p, slope(shape->middles[k], vertical));
    }
    for (std::size_t j = 0; j < count; ++j) {
      Vector3d extra = values[0] * (shape->middles[j].q.conjugate() * printed_less_statics[j]);
      extra.z() = 0.0;  // the papers' arm bends in one plane
      rod.segments[j].moment_nm += extra;
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_published_load_law() {
  return std::make_unique<PublishedLoadLaw>(
      Info{"published_load_law",
           "loads act as the papers print their moments, not as statics has them",
           "moment of a force F at L: share F sin theta(L) (w(L) - w(s)) + (1 - share) F (w(L) - w(s))",
           "Physics-Informed Online Estimation of Stiffness and Shape, equations (2), (3); the arm's model: "
           "P. Fairchild et al., ASME Lett. Dyn. Syst. Control 3, 2023, doi:10.1115/1.4064090",
           Family::kLoad,
           {{"share", "1", "0: statics, 1: as printed", -0.5, 1.5, 0.5}},
           1,
           {"payload_scale", "tip_mass"},
           {"bending_stiffness"}});
}

}  // namespace softarm::effects
