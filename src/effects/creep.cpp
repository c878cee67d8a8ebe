// The curvature grows under a held load by a share, with a time constant or with a spectrum of them, level
// over some decades: standard linear solids in series,
//   u = e + share sum_i g_i w_i,  tau_i w_i' = c - w_i,  moment = EI e.
// What creeps, c, is all elastic curvature, e; or what drives the arm comes late through its wall, and weight
// does not: then c is the curvature d that the drives alone would make; or a mixture of both.
#include <array>
#include <vector>

#include "drives.h"
#include "effects.h"
#include "relaxation.h"
#include "softarm/arm/laws.h"

namespace softarm::effects {
namespace {

using Eigen::Vector2d;

/// Curvature that the drives alone make, about the section's axes, per segment; 0 where the laws do not hold.
std::vector<Vector2d> driven_per_m(const arm::Arm& arm, const Instant& instant) {
  const Eigen::VectorXd& inputs = instant.moment_inputs;
  const auto laws = arm::predict(arm, arm::InputValues(inputs.data(), inputs.data() + inputs.size()));
  std::vector<Vector2d> list(arm.segments.size(), Vector2d::Zero());
  for (std::size_t i = 0; laws && i < laws->size(); ++i) {
    const Vector2d towards = (*laws)[i].actuation_nm() / (*laws)[i].bending_stiffness_nm2;
    list[i] = {-towards.y(), towards.x()};
  }
  return list;
}

class Creep : public Described {
 public:
  using Described::Described;
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    std::vector<Values> list;
    for (const double time_s : {0.5, 2.0, 8.0, 30.0})
      list.push_back((Values(4) << 0.0, time_s, 0.5, 0.0).finished());
    list.push_back((Values(4) << 0.0, 8.0, 3.0, 0.0).finished());
    for (const double time_s : {4.0, 30.0}) list.push_back((Values(4) << 0.0, time_s, 0.5, 1.0).finished());
    return list;
  }
  void act(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
           const Shape*, const Memory& memory, rod::Rod& rod) const override {
    const std::vector<Vector2d> driven = driven_of(arm, values, instant);
    const Relaxing over = relaxing(instant.dt_s, values[1], values[2]);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const Bent bent = bent_by(together(each_before(memory, j, instant.dt_s, over)), values,
                                driven[static_cast<std::size_t>(fine.pieces()[j].segment)]);
      rod::Segment& piece = rod.segments[j];
      // 1 / EI is for what is beyond the rest curvature, and all of that crept.
      piece.bending_compliance *= bent.softer;
      piece.rest_curvature_per_m.head<2>() += bent.beyond;
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
      for (std::size_t i = 0; i < kRelaxation.size(); ++i) put(w, &memory[j * kSize + 2 * i]);
    }
  }
  bool remembers() const override { return true; }
  void remember(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
                const Shape& shape, Memory& memory) const override {
    const Memory last = memory;
    const std::vector<Vector2d> driven = driven_of(arm, values, instant);
    const Relaxing over = relaxing(instant.dt_s, values[1], values[2]);
    memory.resize(fine.pieces().size() * kSize);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const auto i = static_cast<std::size_t>(fine.pieces()[j].segment);
      const Vector2d bent = shape.middles[j].u.head<2>() - arm.segments[i].rest_curvature_per_m.head<2>();
      const Spectrum each = each_before(last, j, instant.dt_s, over);
      const Bent by = bent_by(together(each), values, driven[i]);
      const Vector2d elastic = (bent - by.beyond) / by.softer;
      const Vector2d creeping = values[3] * driven[i] + (1.0 - values[3]) * elastic;
      double* to = &memory[j * kSize];
      for (std::size_t k = 0; k < each.size(); ++k)
        put(each[k].already + each[k].by_now * creeping, to + 2 * k);
      put(creeping, to + 2 * each.size());
    }
  }

 private:
  /// Of each time w, then c, of two axes.
  static constexpr std::size_t kSize = 2 * kRelaxation.size() + 2;

  /// w = already + by_now c, with c what creeps at this instant.
  struct Crept {
    Vector2d already = Vector2d::Zero();
    double by_now = 1.0;
  };
  /// u = softer e + beyond.
  struct Bent {
    double softer;
    Vector2d beyond;
  };
  using Spectrum = std::array<Crept, kRelaxation.size()>;

  static void put(const Vector2d& curvature, double* to) {
    to[0] = curvature.x();
    to[1] = curvature.y();
  }
  /// At the beginning all has crept that will, and what the trial found beyond that.
  static Spectrum each_before(const Memory& memory, std::size_t piece, double dt_s, const Relaxing& over) {
    Spectrum each;
    if (memory.empty()) return each;
    const double* from = &memory[piece * kSize];
    const Vector2d last(from[2 * each.size()], from[2 * each.size() + 1]);
    for (std::size_t k = 0; k < each.size(); ++k) {
      const Vector2d w(from[2 * k], from[2 * k + 1]);
      if (dt_s <= 0.0)
        each[k] = {w, 1.0};
      else
        each[k] = {over[k].kept * w + over[k].weight_last * last, over[k].weight_now};
    }
    return each;
  }
  static Crept together(const Spectrum& each) {
    Crept sum{Vector2d::Zero(), 0.0};
    for (std::size_t k = 0; k < each.size(); ++k) {
      sum.already += kRelaxation[k].weight * each[k].already;
      sum.by_now += kRelaxation[k].weight * each[k].by_now;
    }
    return sum;
  }
  static Bent bent_by(const Crept& crept, const Values& values, const Vector2d& driven) {
    const double now = values[0] * crept.by_now;
    return {1.0 + (1.0 - values[3]) * now, values[0] * crept.already + values[3] * now * driven};
  }
  static std::vector<Vector2d> driven_of(const arm::Arm& arm, const Values& values, const Instant& instant) {
    return values[3] > 0.0 ? driven_per_m(arm, instant)
                           : std::vector<Vector2d>(arm.segments.size(), Vector2d::Zero());
  }
};

}  // namespace

std::unique_ptr<Effect> make_creep() {
  return std::make_unique<Creep>(
      Info{"creep",
           "the arm keeps bending while its inputs and loads are held",
           "u = e + share w, w the mean of w_i, time_i dw_i/dt = c - w_i, M = EI e, times level over decades "
           "about time; c = driven d + (1 - driven) e, d what the drives alone would bend",
           "standard linear solid; R. M. Christensen, Theory of Viscoelasticity, 1982, isbn:0121742520",
           Family::kMemory,
           {{"share", "1", "by which the curvature grows in the end", 0.0, 5.0, 0.1},
            {"time_s", "s", "time constant, that in the middle where there are several", 0.1, 600.0, 20.0},
            {"decades", "1", "over which time constants are spread, each as often; 0: one", 0.0, 5.0, 0.0},
            {"driven", "1", "0: all bending creeps; 1: only what the drives make, not what weight does", 0.0,
             1.0, 0.0}},
           1,
           {"hysteresis", "pressure_leak", "pressure_lag"},
           {"moment_gain", "bending_stiffness"}});
}

}  // namespace softarm::effects
