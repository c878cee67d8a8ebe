// The jammed core slips: beyond an elastic curvature its moment no longer grows, and it keeps what it
// slipped. All of it at one curvature, or some layers before others: elements of Prandtl in parallel, whose
// yields are spread up to an exponential distribution. Then the moment goes with 1 - exp(-u / yield) at
// first.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Vector2d;

constexpr double kMostLost = 0.98;  // of EI, while slipping

/// Means of an exponential distribution of mean 1 over equally likely fifths.
constexpr std::array<double, 5> kSpread{{0.1074258, 0.3600973, 0.6998954, 1.2231436, 2.6094379}};
constexpr std::size_t kElements = kSpread.size();

/// Curvatures at which the elements slip, 1/m; their mean is the yield.
std::array<double, kElements> yields_of(const Values& values) {
  std::array<double, kElements> yields{};
  for (std::size_t i = 0; i < kElements; ++i)
    yields[i] = std::max(values[1], 1e-3) * (1.0 + values[2] * (kSpread[i] - 1.0));
  return yields;
}

/// The elastic part of a curvature beyond what slipped: no more than the yield.
Vector2d elastic_of(const Vector2d& beyond, double yield) {
  const double size = beyond.norm();
  return size > yield ? Vector2d(yield / size * beyond) : beyond;
}

/// Where each element of a piece is.
struct Elements {
  std::array<Vector2d, kElements> slipped;
  std::array<double, kElements> yields;

  /// What the linear law gives for the moment at which the curvature is u, 1/m: u less what its elements do
  /// not bear, each one a part `lost` of EI. @param slope of it by u, and the least of EI that is felt
  Vector2d linear(const Vector2d& u, double lost, Eigen::Matrix2d& slope, double& stiffness) const {
    Vector2d sum = u;
    slope.setIdentity();
    stiffness = 1.0;
    for (std::size_t i = 0; i < kElements; ++i) {
      const Vector2d beyond = u - slipped[i], elastic = elastic_of(beyond, yields[i]);
      sum -= lost * (u - elastic);
      slope -= lost * Eigen::Matrix2d::Identity();
      const double size = beyond.norm();
      if (size <= yields[i]) {
        slope += lost * Eigen::Matrix2d::Identity();
        continue;
      }
      stiffness -= lost;
      slope += lost * yields[i] / size *
               (Eigen::Matrix2d::Identity() - beyond * beyond.transpose() / (size * size));
    }
    return sum;
  }
  /// The curvature at which linear() is l: the root of a gradient of a convex function, by Newton's steps.
  Vector2d curvature(const Vector2d& l, double lost, Vector2d u, double& stiffness) const {
    Eigen::Matrix2d slope;
    Vector2d off = linear(u, lost, slope, stiffness) - l;
    for (int step = 0; step < kSteps && off.norm() > kExact_per_m; ++step) {
      const Vector2d towards = -slope.inverse() * off;
      double part = 1.0;
      Vector2d next = off;
      do {  // elements begin and cease to slip on the way
        next = linear(u + part * towards, lost, slope, stiffness) - l;
        part *= 0.5;
      } while (next.norm() >= off.norm() && part > 1e-3);
      u += 2.0 * part * towards;
      off = next;
    }
    return u;
  }

 private:
  static constexpr int kSteps = 30;
  static constexpr double kExact_per_m = 1e-10;
};

class JammingYield : public Described {
 public:
  using Described::Described;
  bool applies_to(const arm::Arm& arm) const override { return has_core(arm); }
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    std::vector<Values> list;
    for (const double yield_per_m : {1.0, 1.6, 2.5, 4.0})
      list.push_back((Values(3) << 0.0, yield_per_m, 0.2).finished());
    for (const double yield_per_m : {1.5, 3.0, 6.0, 12.0})
      list.push_back((Values(3) << 0.0, yield_per_m, 1.0).finished());
    return list;
  }
  bool needs_shape() const override { return true; }
  Stage stage() const override { return Stage::kLaws; }
  /// What slipped before was another, too: an arm that is held where it slips would seem not to.
  bool needs_whole_derivatives(const Values&) const override { return true; }
  void act(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
           const Shape* shape, const Memory& memory, rod::Rod& rod) const override {
    if (values[0] == 0.0) return;
    const std::vector<double> cores = core_of_segments(arm, instant);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const double now = cores[static_cast<std::size_t>(fine.pieces()[j].segment)];
      rod::Segment& piece = rod.segments[j];
      const rod::RodState& middle = shape->middles[j];
      const double lost =
          std::min(values[0] * now * piece.unloaded_bending_compliance, kMostLost) / kElements;
      double stiffness = 1.0;
      const Vector2d u = elements(memory, j, now, values)
                             .curvature(linear_curvature(piece, middle), lost, middle.u.head<2>(), stiffness);
      // As soft across as along: with the law's own slope not every piece settles where elements slip.
      bend_to(u, Eigen::Matrix2d::Identity() / stiffness, middle, piece);
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
      for (std::size_t i = 0; i < kElements; ++i) Eigen::Map<Vector2d>(to + 2 * i) = u;
      to[kSize - 1] = std::numeric_limits<double>::infinity();  // whatever vacuum there is has done so
    }
  }
  bool remembers() const override { return true; }
  void remember(const arm::Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
                const Shape& shape, Memory& memory) const override {
    const std::vector<double> cores = core_of_segments(arm, instant);
    if (memory.empty()) memory.assign(fine.pieces().size() * kSize, 0.0);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const double now = cores[static_cast<std::size_t>(fine.pieces()[j].segment)];
      const Vector2d u = shape.middles[j].u.head<2>();
      const Elements before = elements(memory, j, now, values);
      double* to = &memory[j * kSize];
      for (std::size_t i = 0; i < kElements; ++i)
        Eigen::Map<Vector2d>(to + 2 * i) = u - elastic_of(u - before.slipped[i], before.yields[i]);
      to[kSize - 1] = now;
    }
  }

 private:
  static constexpr std::size_t kSize = 2 * kElements + 1;  ///< of a piece: curvatures that slipped, stiffness

  static std::vector<double> core_of_segments(const arm::Arm& arm, const Instant& instant) {
    std::vector<double> list;
    for (const arm::Segment& segment : arm.segments)
      list.push_back(core_stiffness_nm2(arm, segment, instant.inputs));
    return list;
  }
  /// What stiffness comes in with the vacuum has not slipped yet.
  static Elements elements(const Memory& memory, std::size_t piece, double now_nm2, const Values& values) {
    Elements elements;
    elements.yields = yields_of(values);
    elements.slipped.fill(Vector2d::Zero());
    if (memory.empty()) return elements;
    const double* from = &memory[piece * kSize];
    const double last_nm2 = from[kSize - 1], kept = now_nm2 > last_nm2 ? last_nm2 / now_nm2 : 1.0;
    for (std::size_t i = 0; i < kElements; ++i)
      elements.slipped[i] = kept * Eigen::Map<const Vector2d>(from + 2 * i);
    return elements;
  }
};

}  // namespace

std::unique_ptr<Effect> make_jamming_yield() {
  return std::make_unique<JammingYield>(Info{
      "jamming_yield",
      "the jammed core slips when it is bent far",
      "M_core = K (1 - share) u + K share e, e the mean of e_i = u - slipped_i, |e_i| <= yield_i; yields "
      "all the same, or spread up to an exponential distribution",
      "elastic and perfectly plastic elements of Prandtl, in parallel; jammed layers: Y. S. Narang, J. J. "
      "Vlassak, R. "
      "D. Howe, Adv. Funct. Mater. 28, 2018, doi:10.1002/adfm.201707136",
      Family::kMemory,
      {{"share", "1", "of the core that slips", 0.0, 1.2, 0.5},
       {"yield_per_m", "1/m", "elastic curvature at which it slips, in the mean", 0.05, 100.0, 3.0},
       {"spread", "1", "of its layers' yields; 0: all slip at once, 1: exponentially distributed", 0.0, 1.0,
        0.0}},
      1,
      {"strain_stiffening", "vacuum_gain", "jamming_memory"},
      {"per_jamming_pressure"}});
}

}  // namespace softarm::effects
