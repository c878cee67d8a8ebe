// A body that sits on the skin moves against the backbone as the arm bends.
#include "effects.h"

namespace softarm::effects {
namespace {

class SkinMarker : public Described {
 public:
  using Described::Described;
  bool varies_along() const override { return false; }
  std::vector<Values> grid(const arm::Arm& arm, const FineRod&) const override {
    std::vector<Values> list;
    for (std::size_t b = arm.bodies.size() > 1 ? 0 : 1; b <= arm.bodies.size(); ++b)
      list.push_back((Values(4) << 0.0, 0.0, 0.0, static_cast<double>(b)).finished());
    return list;
  }
  std::optional<std::pair<double, double>> place(const arm::Arm& arm, const Values& values) const override {
    const std::size_t b = number(values);
    if (b == 0 || b > arm.bodies.size()) return std::nullopt;
    return std::make_pair(arm.bodies[b - 1].arclength_m, arm.bodies[b - 1].arclength_m);
  }
  bool observes() const override { return true; }
  void observe(const arm::Arm&, const Values& values, const Instant&, Bodies& bodies) const override {
    const std::size_t only = number(values);
    for (std::size_t b = 0; b < bodies.q.size(); ++b) {
      if (only != 0 && only != b + 1) continue;
      const auto column = static_cast<Eigen::Index>(b);
      // Bent towards x is turned about y.
      const double x = bodies.u(1, column), y = -bodies.u(0, column);
      bodies.p.col(column) +=
          bodies.q[b] * Eigen::Vector3d(values[0] * x, values[0] * y, values[1] * x + values[2] * y);
    }
  }

 private:
  static std::size_t number(const Values& values) { return static_cast<std::size_t>(values[3] + 0.5); }
};

}  // namespace

std::unique_ptr<Effect> make_skin_marker() {
  return std::make_unique<SkinMarker>(Info{
      "skin_marker",
      "a ring or marker sits on a skin that slides as the arm bends there",
      "x_body = x(s) + R(s) (across k, slide . k), k the curvature at s towards x and y of the section",
      "markers on a skin: A. Leardini et al., Gait & Posture 21, 2005, doi:10.1016/j.gaitpost.2004.05.002",
      Family::kSensor,
      {{"across_m2", "m^2", "way across the arm over the curvature, towards the inside of the bend", -0.01,
        0.01, 2e-4},
       {"slide_x_m2", "m^2", "way along the arm over the curvature towards x of the section", -0.01, 0.01,
        2e-4},
       {"slide_y_m2", "m^2", "way along the arm over the curvature towards y of the section", -0.01, 0.01,
        2e-4},
       {"body", "1", "its number, from the base; 0: all of them", 0.0, 64.0, 0.0, true}},
      3,
      {"marker_slip", "curvature_gain", "radial_expansion"},
      {}});
}

}  // namespace softarm::effects
