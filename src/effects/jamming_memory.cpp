// The jammed core keeps the curvature at which it was jammed: what stiffness comes in with the vacuum is
// without moment at the curvature of its coming, by a share. Moment of the core = K (u - share r), r the mean
// of those curvatures.
#include <limits>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Vector2d;

class JammingMemory : public Described {
 public:
  using Described::Described;
  bool applies_to(const arm::Arm& arm) const override { return has_core(arm); }
  void act(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
           const Shape*, const Memory& memory, rod::Rod& rod) const override {
    if (memory.empty()) return;
    const std::vector<double> k = cores(arm, instant);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const double now = k[static_cast<std::size_t>(fine.pieces()[j].segment)];
      const double* m = &memory[j * kSize];
      const Vector2d kept = values[0] * now * reference(m, now, {m[2], m[3]});
      rod.segments[j].moment_nm.head<2>() += kept;
    }
  }
  std::vector<StartNumber> starts(const arm::Arm& arm, const Values&) const override {
    return curvature_starts(arm, segment_has_core, left_bent_per_m);
  }
  void begin(const arm::Arm& arm, const FineRod& fine, const Values& values, const Eigen::VectorXd& start,
             Memory& memory) const override {
    const auto jammed = started_curvatures(arm, segment_has_core, starts(arm, values), start);
    memory.assign(fine.pieces().size() * kSize, 0.0);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const Vector2d& u = jammed[static_cast<std::size_t>(fine.pieces()[j].segment)];
      double* to = &memory[j * kSize];
      to[0] = u.x();
      to[1] = u.y();
      to[kSize - 1] = std::numeric_limits<double>::infinity();  // whatever vacuum there is has done so
    }
  }
  bool remembers() const override { return true; }
  void remember(const arm::Arm& arm, const FineRod& fine, const Values&, const Instant& instant,
                const Shape& shape, Memory& memory) const override {
    const std::vector<double> k = cores(arm, instant);
    const bool begins = memory.empty() || instant.dt_s <= 0.0;
    memory.resize(fine.pieces().size() * kSize, 0.0);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const double now = k[static_cast<std::size_t>(fine.pieces()[j].segment)];
      const Vector2d u = shape.middles[j].u.head<2>();
      double* m = &memory[j * kSize];
      // A trial that begins jammed was jammed straight, or as it was found.
      const Vector2d r = begins ? Vector2d(m[0], m[1]) : reference(m, now, 0.5 * (u + Vector2d(m[2], m[3])));
      m[0] = r.x();
      m[1] = r.y();
      m[2] = u.x();
      m[3] = u.y();
      m[4] = now;
    }
  }

 private:
  static constexpr std::size_t kSize = 5;  ///< of a piece: r, curvature and K of the last instant

  static std::vector<double> cores(const arm::Arm& arm, const Instant& instant) {
    std::vector<double> k;
    for (const arm::Segment& segment : arm.segments)
      k.push_back(core_stiffness_nm2(arm, segment, instant.inputs));
    return k;
  }
  static Vector2d reference(const double* memory, double now_nm2, const Vector2d& u) {
    const Vector2d r(memory[0], memory[1]);
    if (!(now_nm2 > memory[4])) return r;
    return r + (now_nm2 - memory[4]) / now_nm2 * (u - r);
  }
};

}  // namespace

std::unique_ptr<Effect> make_jamming_memory() {
  return std::make_unique<JammingMemory>(
      Info{"jamming_memory",
           "the jammed core keeps the shape in which the vacuum was applied",
           "M_core = K (u - share r), r the curvature at which the core's stiffness K came in",
           "jammed layers: Y. S. Narang, J. J. Vlassak, R. D. Howe, Adv. Funct. Mater. 28, 2018, "
           "doi:10.1002/adfm.201707136",
           Family::kMemory,
           {{"share", "1", "of the curvature of that moment, that the core keeps", 0.0, 1.2, 0.5}},
           1,
           {"rest_curvature", "jamming_yield", "vacuum_gain"},
           {"per_jamming_pressure"}});
}

}  // namespace softarm::effects
