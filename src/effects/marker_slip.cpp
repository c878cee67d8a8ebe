// One ring sits elsewhere than the arm file says.
#include "effects.h"

namespace softarm::effects {
namespace {

class MarkerSlip : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  std::vector<Values> grid(const arm::Arm& arm, const FineRod&) const override {
    std::vector<Values> list;
    for (std::size_t b = 0; b < arm.bodies.size(); ++b)
      list.push_back((Values(4) << 0.0, 0.0, 0.0, static_cast<double>(b + 1)).finished());
    return list;
  }
  std::optional<std::pair<double, double>> place(const arm::Arm& arm, const Values& values) const override {
    const double s = arm.bodies[static_cast<std::size_t>(values[3] + 0.5) - 1].arclength_m;
    return std::make_pair(s, s);
  }
  bool observes() const override { return true; }
  void observe(const arm::Arm&, const Values& values, const Instant&, Bodies& bodies) const override {
    const auto b = static_cast<std::size_t>(values[3] + 0.5) - 1;
    if (b >= bodies.q.size()) return;
    bodies.p.col(static_cast<Eigen::Index>(b)) += bodies.q[b] * values.head<3>();
  }
};

}  // namespace

std::unique_ptr<Effect> make_marker_slip() {
  return std::make_unique<MarkerSlip>(Info{
      "marker_slip",
      "a ring sits elsewhere than the arm file says",
      "x_body = x(s) + R(s) (x, y, z)",
      "markers on a skin: A. Leardini et al., Gait & Posture 21, 2005, doi:10.1016/j.gaitpost.2004.05.002",
      Family::kSensor,
      {{"x_m", "m", "offset across the arm, along x of its section", -0.1, 0.1, 0.001},
       {"y_m", "m", "offset across the arm, along y of its section", -0.1, 0.1, 0.001},
       {"z_m", "m", "offset along the arm", -0.1, 0.1, 0.001},
       {"body", "1", "its number, from the base", 1.0, 64.0, 1.0, true}},
      3,
      {"pressure_elongation"},
      {},
      true});
}

}  // namespace softarm::effects
