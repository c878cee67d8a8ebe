// The jammed core slips: beyond an elastic curvature its moment no longer grows, and it keeps what it
// slipped.
#include <algorithm>
#include <limits>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Vector2d;

constexpr double kMostLost = 0.98;  // of EI, while slipping

class JammingYield : public Described {
 public:
  using Described::Described;
  bool applies_to(const arm::Arm& arm) const override { return has_core(arm); }
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    std::vector<Values> list;
    for (const double yield_per_m : {1.0, 1.4, 2.0, 2.8, 4.0, 5.6})
      list.push_back((Values(2) << 0.0, yield_per_m).finished());
    return list;
  }
  bool needs_shape() const override { return true; }
  void act(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
           const Shape* shape, const Memory& memory, rod::Rod& rod) const override {
    if (values[0] == 0.0) return;
    const std::vector<double> cores = core_of_segments(arm, instant);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const double now = cores[static_cast<std::size_t>(fine.pieces()[j].segment)];
      rod::Segment& piece = rod.segments[j];
      const rod::RodState& middle = shape->middles[j];
      // M = EI (u - u*) - lost (u - e), with e = u - slipped, no more than the yield. At the moment that
      // acts, v = u - slipped before is along what it would be without yield, z.
      const double lost = std::min(values[0] * now * piece.bending_compliance, kMostLost);
      const double yield = std::max(values[1], 1e-3);
      const Vector2d before = slipped(memory, j, now);
      const Vector2d z = linear_curvature(piece, middle) - (1.0 - lost) * before;
      const double size = z.norm();
      if (size <= yield) {
        bend_to(before + z, 1.0, middle, piece);
      } else {
        bend_to(before + (size - lost * yield) / (1.0 - lost) / size * z, 1.0 - lost, middle, piece);
      }
    }
  }
  std::vector<StartNumber> starts(const arm::Arm& arm, const Values&) const override {
    return curvature_starts(arm, segment_has_core, left_bent_per_m);
  }
  void begin(const arm::Arm& arm, const FineRod& fine, const Values& values, const Eigen::VectorXd& start,
             Memory& memory) const override {
    const auto slid = started_curvatures(arm, segment_has_core, starts(arm, values), start);
    memory.assign(fine.pieces().size() * kSize, 0.0);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const Vector2d& u = slid[static_cast<std::size_t>(fine.pieces()[j].segment)];
      double* to = &memory[j * kSize];
      to[0] = u.x();
      to[1] = u.y();
      to[kSize - 1] = std::numeric_limits<double>::infinity();  // whatever vacuum there is has done so
    }
  }
  bool remembers() const override { return true; }
  void remember(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
                const Shape& shape, Memory& memory) const override {
    const std::vector<double> cores = core_of_segments(arm, instant);
    const double yield = std::max(values[1], 1e-3);
    if (memory.empty()) memory.assign(fine.pieces().size() * kSize, 0.0);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const double now = cores[static_cast<std::size_t>(fine.pieces()[j].segment)];
      const Vector2d u = shape.middles[j].u.head<2>();
      const Vector2d before = slipped(memory, j, now);
      Vector2d elastic = u - before;
      if (elastic.norm() > yield) elastic *= yield / elastic.norm();
      double* to = &memory[j * kSize];
      to[0] = u.x() - elastic.x();
      to[1] = u.y() - elastic.y();
      to[2] = now;
    }
  }

 private:
  static constexpr std::size_t kSize = 2 + 1;  ///< of a piece: curvature that slipped, stiffness

  static std::vector<double> core_of_segments(const arm::Arm& arm, const Instant& instant) {
    std::vector<double> list;
    for (const arm::Segment& segment : arm.segments)
      list.push_back(core_stiffness_nm2(arm, segment, instant.inputs));
    return list;
  }
  /// What stiffness comes in with the vacuum has not slipped yet.
  static Vector2d slipped(const Memory& memory, std::size_t piece, double now_nm2) {
    if (memory.empty()) return Vector2d::Zero();
    const double* from = &memory[piece * kSize];
    return (now_nm2 > from[2] ? from[2] / now_nm2 : 1.0) * Vector2d(from[0], from[1]);
  }
};

}  // namespace

std::unique_ptr<Effect> make_jamming_yield() {
  return std::make_unique<JammingYield>(
      Info{"jamming_yield",
           "the jammed core slips when it is bent far",
           "M_core = K (1 - share) u + K share e, e = u - slipped, |e| <= yield",
           "elastic and perfectly plastic element of Prandtl; jammed layers: Y. S. Narang, J. J. Vlassak, R. "
           "D. Howe, Adv. Funct. Mater. 28, 2018, doi:10.1002/adfm.201707136",
           Family::kMemory,
           {{"share", "1", "of the core that slips", 0.0, 1.0, 0.5},
            {"yield_per_m", "1/m", "elastic curvature at which it slips", 0.05, 100.0, 3.0}},
           1,
           {"strain_stiffening", "vacuum_gain", "jamming_memory"},
           {"per_jamming_pressure"}});
}

}  // namespace softarm::effects
