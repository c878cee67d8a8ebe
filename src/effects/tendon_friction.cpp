// Tendons rub where the arm bends: what passes an angle is between e^(-mu angle) and e^(mu angle) of the
// tension at the motor (capstan), and moves only when friction can no longer hold it: a play of the logarithm
// of the tension. Its half width per angle, `turn`, is a parameter of its own so that the size, mu, acts in
// proportion; the law is exact where both are equal.
#include <algorithm>
#include <cmath>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

constexpr double kSlack_n = 0.01;  // less is no tension
constexpr double kMostExponent = 3.0;

class TendonFriction : public Described {
 public:
  using Described::Described;
  bool applies_to(const arm::Arm& arm) const override {
    return std::any_of(arm.segments.begin(), arm.segments.end(),
                       [](const arm::Segment& segment) { return !segment.tendons.empty(); });
  }
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    return {Eigen::Vector3d(0.0, 0.15, 0.0), Eigen::Vector3d(0.0, 0.15, 1.0)};
  }
  void act(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
           const Shape*, const Memory& memory, rod::Rod& rod) const override {
    if (memory.empty()) return;  // settled, as everything at a trial's beginning
    const double turn = std::max(values[1], 1e-3);
    const double* state = memory.data();
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const double angle = *state++;
      for (const arm::Tendon& tendon : segment_of(arm, fine, j).tendons) {
        const double held = *state++;
        const double tension_n = tension(arm, tendon, instant), x = logarithm(tension_n);
        const double beyond = std::clamp(held, x - turn * angle, x + turn * angle) - x;
        const double more_n =
            tension_n * std::expm1(std::clamp(values[0] / turn * beyond, -kMostExponent, kMostExponent));
        rod::Segment& piece = rod.segments[j];
        piece.moment_nm += more_n * tendon.offset_m *
                           Eigen::Vector3d(-std::sin(tendon.bending_direction_rad),
                                           std::cos(tendon.bending_direction_rad), 0.0);
        piece.length_m -= piece.rest_length_m * more_n * piece.axial_compliance;
      }
    }
  }
  /// Where each tendon's friction stands, as a share of what it can hold.
  std::vector<StartNumber> starts(const arm::Arm& arm, const Values&) const override {
    std::vector<StartNumber> numbers;
    for (const arm::Segment& segment : arm.segments) {
      for (const arm::Tendon& tendon : segment.tendons)
        numbers.push_back({segment.name + "." + tendon.input, "1", kAnywhere});
    }
    return numbers;
  }
  /// Until the first instant has told how far the arm is bent, nothing is held.
  void begin(const arm::Arm& arm, const FineRod& fine, const Values&, const Eigen::VectorXd& start,
             Memory& memory) const override {
    memory.clear();
    for (const Piece& piece : fine.pieces()) {
      memory.push_back(0.0);
      Eigen::Index number = 0;
      for (int i = 0; i < piece.segment; ++i)
        number += static_cast<Eigen::Index>(arm.segments[static_cast<std::size_t>(i)].tendons.size());
      const std::size_t count = arm.segments[static_cast<std::size_t>(piece.segment)].tendons.size();
      for (std::size_t t = 0; t < count; ++t)
        memory.push_back(std::clamp(kAnywhere * start[number++], -1.0, 1.0));
    }
  }
  bool remembers() const override { return true; }
  void remember(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
                const Shape& shape, Memory& memory) const override {
    const double turn = std::max(values[1], 1e-3);
    Memory next;
    std::size_t at = 0;
    double passed = std::max(0.0, values[2]);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const Piece& piece = fine.pieces()[j];
      const double bent = shape.middles[j].u.head<2>().norm() * (piece.s_to_m - piece.s_from_m);
      const double angle = passed + 0.5 * bent;
      passed += bent;
      next.push_back(angle);
      ++at;
      for (const arm::Tendon& tendon : segment_of(arm, fine, j).tendons) {
        const double x = logarithm(tension(arm, tendon, instant));
        const double held = memory.empty()        ? x
                            : instant.dt_s <= 0.0 ? x - memory[at] * turn * angle
                                                  : memory[at];
        next.push_back(std::clamp(held, x - turn * angle, x + turn * angle));
        ++at;
      }
    }
    memory = std::move(next);
  }

 private:
  static const arm::Segment& segment_of(const arm::Arm& arm, const FineRod& fine, std::size_t piece) {
    return arm.segments[static_cast<std::size_t>(fine.pieces()[piece].segment)];
  }
  static double tension(const arm::Arm& arm, const arm::Tendon& tendon, const Instant& instant) {
    const Eigen::Index row = row_of(arm, tendon.input);
    return row < 0 ? 0.0 : std::max(0.0, instant.moment_inputs[row]);
  }
  static double logarithm(double tension_n) { return std::log(std::max(tension_n, kSlack_n)); }
};

}  // namespace

std::unique_ptr<Effect> make_tendon_friction() {
  return std::make_unique<TendonFriction>(
      Info{"tendon_friction",
           "tendons rub where the arm bends: their pull falls along it and comes back late",
           "T(s) between T exp(-mu angle) and T exp(mu angle), a play of log T",
           "capstan equation of Euler and Eytelwein; tendons of a rod: D. C. Rucker, R. J. Webster, IEEE "
           "Trans. Robotics 27, 2011, doi:10.1109/TRO.2011.2160469",
           Family::kActuation,
           {{"coefficient", "1", "of friction", 0.0, 2.0, 0.15},
            {"turn", "1", "change of the logarithm of the tension that turns the friction, per angle", 0.02,
             2.0, 0.15},
            {"routing_rad", "rad", "angle around which tendons are led before the base", 0.0, 20.0, 0.0}},
           1,
           {"actuation_taper", "hysteresis"},
           {"offset"}});
}

}  // namespace softarm::effects
