// What moves with the arm beyond its known masses and its known viscoelastic lag.
#include "effects.h"

namespace softarm::effects {
namespace {

class Inertia : public Described {
 public:
  using Described::Described;
  bool needs_shape() const override { return true; }
  bool needs_motion() const override { return true; }
  /// Of the shape it looks at the motion alone, which the first order has as that of the arm's own inertia.
  bool needs_whole_derivatives(const Values&) const override { return false; }
  model::Sluggishness sluggishness(const Values& values) const override { return {values[0], values[1]}; }
  void act(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape* shape,
           const Memory&, rod::Rod& rod) const override {
    const Motion& motion = shape->motion;
    if (motion.acceleration_m_s2.empty()) return;
    const Eigen::VectorXd masses = fine.station_masses_kg(rod);
    for (std::size_t j = 0; j < motion.acceleration_m_s2.size(); ++j) {
      rod.loads[FineRod::kFirstStation + j].force_n -=
          values[0] * masses[static_cast<Eigen::Index>(j)] * motion.acceleration_m_s2[j];
      rod.segments[j].rest_curvature_per_m.head<2>() -= values[1] * motion.curvature_rate[j].head<2>();
    }
  }
};

}  // namespace

std::unique_ptr<Effect> make_inertia() {
  return std::make_unique<Inertia>(
      Info{"inertia",
           "the arm moves more slowly than its mass and its wall explain: unweighed mass moves along, or "
           "something damps it",
           "f = -share rho d^2x/dt^2 along the arm, u -= delay du/dt",
           "d'Alembert's forces, wall of Kelvin and Voigt; J. Till, V. Aloi, C. Rucker, Int. J. Robotics "
           "Research 38, 2019, doi:10.1177/0278364919842269",
           Family::kMemory,
           {{"mass_share", "1", "of arm and payload, moved along beside them", -0.5, 10.0, 0.5},
            {"delay_s", "s", "by which the wall's bending lags its moment", -0.05, 2.0, 0.02}},
           2,
           {"pressure_lag", "clock_offset"},
           {}});
}

}  // namespace softarm::effects
