// The jammed core slips: beyond an elastic curvature its moment no longer grows, and it keeps what it
// slipped.
#include <algorithm>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Vector2d;

constexpr double kMostLost = 0.98;  // of EI, while slipping

class JammingYield : public Described {
 public:
  using Described::Described;
  bool applies_to(const Arm& arm) const override { return has_core(arm); }
  std::vector<Values> grid(const Arm&, const FineRod&) const override {
    std::vector<Values> list;
    for (const double yield_per_m : {1.0, 1.7, 3.0, 5.0})
      list.push_back((Values(2) << 0.0, yield_per_m).finished());
    return list;
  }
  bool needs_shape() const override { return true; }
  void act(const Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
           const Shape* shape, const Memory& memory, rod::Rod& rod) const override {
    if (values[0] == 0.0) return;
    const std::vector<double> cores = core_of_segments(arm, instant);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const double now = cores[static_cast<std::size_t>(fine.pieces()[j].segment)];
      rod::Segment& piece = rod.segments[j];
      const Vector2d u = shape->middles[j].u.head<2>();
      const Core core = bend(memory, j, now, values, u);
      // M = EI (u - u*) - lost (u - e), e what of the curvature is elastic for the core. While it slips its
      // stiffness is lost along the bending and not across it: the shape is found with half of it.
      const double lost = std::min(values[0] * now, kMostLost / piece.bending_compliance);
      const double softer = core.slips ? 0.5 * lost * piece.bending_compliance : 0.0;
      const Vector2d rest = piece.rest_curvature_per_m.head<2>();
      piece.moment_nm.head<2>() += lost * (u - core.elastic) - softer / piece.bending_compliance * (u - rest);
      piece.bending_compliance /= 1.0 - softer;
    }
  }
  bool remembers() const override { return true; }
  void remember(const Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
                const Shape& shape, Memory& memory) const override {
    const std::vector<double> cores = core_of_segments(arm, instant);
    if (memory.empty()) memory.assign(fine.pieces().size() * kSize, 0.0);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const double now = cores[static_cast<std::size_t>(fine.pieces()[j].segment)];
      const Vector2d u = shape.middles[j].u.head<2>();
      const Core core = bend(memory, j, now, values, u);
      double* to = &memory[j * kSize];
      to[0] = u.x() - core.elastic.x();
      to[1] = u.y() - core.elastic.y();
      to[2] = now;
    }
  }

 private:
  struct Core {
    Vector2d elastic = Vector2d::Zero();
    bool slips = false;
  };
  static constexpr std::size_t kSize = 3;  ///< of a piece: curvature that slipped, stiffness

  static std::vector<double> core_of_segments(const Arm& arm, const Instant& instant) {
    std::vector<double> list;
    for (const Segment& segment : arm.segments)
      list.push_back(core_stiffness_nm2(arm, segment, instant.inputs));
    return list;
  }
  /// What stiffness comes in with the vacuum has not slipped yet.
  static Core bend(const Memory& memory, std::size_t piece, double now_nm2, const Values& values,
                   const Vector2d& u) {
    Core core;
    core.elastic = u;
    if (!memory.empty()) {
      const double* from = &memory[piece * kSize];
      core.elastic -= (now_nm2 > from[2] ? from[2] / now_nm2 : 1.0) * Vector2d(from[0], from[1]);
    }
    const double yield = std::max(values[1], 1e-3), size = core.elastic.norm();
    core.slips = size > yield;
    if (core.slips) core.elastic *= yield / size;
    return core;
  }
};

}  // namespace

std::unique_ptr<Effect> make_jamming_yield() {
  return std::make_unique<JammingYield>(
      Info{"jamming_yield",
           "the jammed core slips when it is bent far",
           Family::kMemory,
           {{"share", "1", "of the core that slips", 0.0, 1.0, 0.5},
            {"yield_per_m", "1/m", "elastic curvature at which it slips", 0.05, 100.0, 3.0}},
           1,
           {"strain_stiffening", "vacuum_gain", "jamming_memory"},
           {"per_jamming_pressure"}});
}

}  // namespace softarm::effects
