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
  void act(const Arm& arm, const FineRod& fine, const Values& values, const Instant& instant, const Shape*,
           const Memory& memory, rod::Rod& rod) const override {
    if (memory.empty()) return;
    const std::vector<double> cores = core_of_segments(arm, instant);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const double now = cores[static_cast<std::size_t>(fine.pieces()[j].segment)];
      rod::Segment& piece = rod.segments[j];
      const Core core = read(memory, j, now);
      // M = EI (u - u*) - lost (u - e), e what of the curvature is elastic for the core. One that slipped
      // goes on slipping, with the same e; one that did not keeps u - e.
      const double lost = std::min(values[0] * now, kMostLost / piece.bending_compliance);
      if (core.slips) {
        const Vector2d rest = piece.rest_curvature_per_m.head<2>();
        piece.moment_nm.head<2>() += lost * (rest - core.elastic);
        piece.bending_compliance /= 1.0 - lost * piece.bending_compliance;
      } else {
        piece.moment_nm.head<2>() += lost * core.slipped;
      }
    }
  }
  bool remembers() const override { return true; }
  void remember(const Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
                const Shape& shape, Memory& memory) const override {
    const std::vector<double> cores = core_of_segments(arm, instant);
    const double yield = std::max(values[1], 1e-3);
    if (memory.empty()) memory.assign(fine.pieces().size() * kSize, 0.0);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const double now = cores[static_cast<std::size_t>(fine.pieces()[j].segment)];
      const Core core = read(memory, j, now);
      const Vector2d u = shape.middles[j].u.head<2>();
      Vector2d elastic = u - core.slipped;
      const bool slips = elastic.norm() > yield;
      if (slips) elastic *= yield / elastic.norm();
      double* to = &memory[j * kSize];
      to[0] = u.x() - elastic.x();
      to[1] = u.y() - elastic.y();
      to[2] = elastic.x();
      to[3] = elastic.y();
      to[4] = slips ? 1.0 : 0.0;
      to[5] = now;
    }
  }

 private:
  struct Core {
    Vector2d slipped = Vector2d::Zero(), elastic = Vector2d::Zero();  ///< curvature is their sum
    bool slips = false;
  };
  static constexpr std::size_t kSize = 6;

  static std::vector<double> core_of_segments(const Arm& arm, const Instant& instant) {
    std::vector<double> list;
    for (const Segment& segment : arm.segments)
      list.push_back(core_stiffness_nm2(arm, segment, instant.inputs));
    return list;
  }
  /// What stiffness comes in with the vacuum has not slipped yet.
  static Core read(const Memory& memory, std::size_t piece, double now_nm2) {
    const double* from = &memory[piece * kSize];
    const double older = now_nm2 > from[5] ? from[5] / now_nm2 : 1.0;
    return {older * Vector2d(from[0], from[1]), {from[2], from[3]}, from[4] > 0.5};
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
