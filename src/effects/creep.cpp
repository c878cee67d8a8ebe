// The curvature grows under a held load by a share, with a time constant: a standard linear solid,
//   u = e + share w,  tau w' = e - w,  moment = EI e.
#include <algorithm>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Vector2d;

class Creep : public Described {
 public:
  using Described::Described;
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    std::vector<Values> list;
    for (const double time_s : {0.5, 2.0, 8.0, 30.0}) list.push_back((Values(2) << 0.0, time_s).finished());
    return list;
  }
  void act(const arm::Arm&, const FineRod& fine, const Values& values, const Instant& instant, const Shape*,
           const Memory& memory, rod::Rod& rod) const override {
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const Crept crept = before(memory, j, values, instant);
      rod::Segment& piece = rod.segments[j];
      const double softer = 1.0 + values[0] * crept.by_elastic;
      // 1 / EI is for what is beyond the rest curvature, and all of that crept.
      piece.bending_compliance *= softer;
      piece.rest_curvature_per_m.head<2>() += values[0] * crept.already;
    }
  }
  std::vector<StartNumber> starts(const arm::Arm& arm, const Values&) const override {
    return curvature_starts(arm, any_segment, left_bent_per_m);
  }
  void begin(const arm::Arm& arm, const FineRod& fine, const Values& values, const Eigen::VectorXd& start,
             Memory& memory) const override {
    const auto crept = started_curvatures(arm, any_segment, starts(arm, values), start);
    memory.assign(fine.pieces().size() * kSize, 0.0);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const Vector2d& w = crept[static_cast<std::size_t>(fine.pieces()[j].segment)];
      memory[j * kSize] = w.x();
      memory[j * kSize + 1] = w.y();
    }
  }
  bool remembers() const override { return true; }
  void remember(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
                const Shape& shape, Memory& memory) const override {
    const Memory last = memory;
    memory.resize(fine.pieces().size() * kSize);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const auto i = static_cast<std::size_t>(fine.pieces()[j].segment);
      const Vector2d bent = shape.middles[j].u.head<2>() - arm.segments[i].rest_curvature_per_m.head<2>();
      const Crept crept = before(last, j, values, instant);
      const Vector2d elastic = (bent - values[0] * crept.already) / (1.0 + values[0] * crept.by_elastic);
      const Vector2d w = crept.already + crept.by_elastic * elastic;
      double* to = &memory[j * kSize];
      to[0] = w.x();
      to[1] = w.y();
      to[2] = elastic.x();
      to[3] = elastic.y();
    }
  }

 private:
  static constexpr std::size_t kSize = 4;

  /// w = already + by_elastic e, with e the elastic curvature of this instant.
  struct Crept {
    Vector2d already = Vector2d::Zero();
    double by_elastic = 1.0;
  };
  /// At the beginning all has crept that will, and what the trial found beyond that.
  static Crept before(const Memory& memory, std::size_t piece, const Values& values, const Instant& instant) {
    if (memory.empty()) return {};
    const double* from = &memory[piece * kSize];
    if (instant.dt_s <= 0.0) return {Vector2d(from[0], from[1]), 1.0};
    const Following f = following(instant.dt_s, std::max(values[1], 1e-2));
    return {f.kept * Vector2d(from[0], from[1]) + f.weight_last * Vector2d(from[2], from[3]), f.weight_now};
  }
};

}  // namespace

std::unique_ptr<Effect> make_creep() {
  return std::make_unique<Creep>(
      Info{"creep",
           "the arm goes on bending while what drives and loads it is held",
           "u = e + share w, time dw/dt = e - w, M = EI e",
           "standard linear solid; R. M. Christensen, Theory of Viscoelasticity, 1982, isbn:0121742520",
           Family::kMemory,
           {{"share", "1", "by which the curvature grows in the end", 0.0, 5.0, 0.1},
            {"time_s", "s", "time constant", 0.1, 600.0, 20.0}},
           1,
           {"hysteresis", "pressure_leak", "pressure_lag"},
           {"moment_gain", "bending_stiffness"}});
}

}  // namespace softarm::effects
