// Stiffer by a share on first loading: fully where the curvature has not been so large before, less the
// further it is below the largest one, m (R. W. Ogden, D. G. Roxburgh, Proc. R. Soc. A 455, 1999, for
// bending). What does not come back where it is bent so far again is lost with the largest curvature alone
// (J. C. Simo, Comput. Methods Appl. Mech. Eng. 60, 1987):
//   M = EI u (1 + share erfc((m^2 - u^2) / scale^2) + fresh_share / (1 + m^2 / scale^2))
#include <algorithm>
#include <cmath>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Vector2d;

constexpr int kSteps = 60;
constexpr double kTolerance = 1e-12;  // of the curvature
constexpr double kNothingLeft = 6.0;  // erfc is below 1e-16 from there on

class Mullins : public Described {
 public:
  using Described::Described;
  bool needs_shape() const override { return true; }
  Stage stage() const override { return Stage::kLaws; }
  /// The largest curvature was another, too: an arm that is held where it is largest would seem to answer by
  /// the steep part of the law, with far more stiffness than it has.
  bool needs_whole_derivatives(const Values&) const override { return true; }
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    return {Eigen::Vector3d(0.0, 0.0, 1.5), Eigen::Vector3d(0.0, 0.0, 3.0), Eigen::Vector3d(0.0, 0.0, 6.0)};
  }
  void act(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape* shape,
           const Memory& memory, rod::Rod& rod) const override {
    if (values[0] == 0.0 && values[1] == 0.0) return;
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const rod::RodState& middle = shape->middles[j];
      rod::Segment& piece = rod.segments[j];
      const Vector2d linear = linear_curvature(piece, middle);
      const double wanted = linear.norm();
      if (wanted < 1e-9) continue;
      // At the moment that acts: u (1 + stiffer) = linear.
      const Law law(values, memory.empty() ? 0.0 : memory[j]);
      const double u = law.curvature(wanted, middle.u.head<2>().norm());
      const double tangent = law.stiffer(u) + u * law.slope(u);
      bend_to(u / wanted * linear, slope_about(linear, 1.0 / (1.0 + tangent), u / wanted), middle, piece);
    }
  }
  /// How far it was bent before; no less than nothing.
  std::vector<StartNumber> starts(const arm::Arm& arm, const Values& values) const override {
    std::vector<StartNumber> numbers;
    for (const arm::Segment& segment : arm.segments)
      numbers.push_back({segment.name, "1/m^2", std::pow(std::max(values[2], left_bent_per_m(segment)), 2)});
    return numbers;
  }
  void begin(const arm::Arm& arm, const FineRod& fine, const Values& values, const Eigen::VectorXd& start,
             Memory& memory) const override {
    const std::vector<StartNumber> numbers = starts(arm, values);
    memory.clear();
    for (const Piece& piece : fine.pieces())
      memory.push_back(numbers[static_cast<std::size_t>(piece.segment)].sd *
                       std::max(0.0, start[piece.segment]));
  }
  bool remembers() const override { return true; }
  void remember(const arm::Arm&, const FineRod& fine, const Values&, const Instant&, const Shape& shape,
                Memory& memory) const override {
    memory.resize(fine.pieces().size(), 0.0);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j)
      memory[j] = std::max(memory[j], shape.middles[j].u.head<2>().squaredNorm());
  }

 private:
  /// Share by which the material is stiffer, by curvature.
  class Law {
   public:
    /// @param most square of the largest curvature before
    Law(const Values& values, double most)
        : share_(values[0]),
          fresh_(values[1]),
          scale2_(std::pow(std::max(values[2], 1e-2), 2)),
          most_(most) {}

    double stiffer(double u) const {
      const double most = std::max(most_, u * u);
      const double y = (most - u * u) / scale2_;
      const double of_share = y < kNothingLeft ? share_ * std::erfc(y) : 0.0;
      return of_share + fresh_ / (1.0 + most / scale2_);
    }
    /// Where u (1 + stiffer) is this: by Newton's steps, halved where those leave the bracket.
    /// @param about where it is looked for first
    double curvature(double linear, double about) const {
      auto [low, high] = std::minmax({linear / (1.0 + share_ + fresh_), linear});
      double u = std::clamp(about, low, high);
      for (int i = 0; i < kSteps && high - low > kTolerance * linear; ++i) {
        const double by = stiffer(u), over = u * (1.0 + by) - linear;
        (over < 0.0 ? low : high) = u;
        const double next = u - over / (1.0 + by + u * slope(u));
        if (std::abs(next - u) <= kTolerance * linear) return next;
        u = next > low && next < high ? next : 0.5 * (low + high);
      }
      return u;
    }
    double slope(double u) const {
      const double y = (most_ - u * u) / scale2_;
      if (y >= kNothingLeft) return 0.0;
      if (y > 0.0) return share_ * 4.0 / std::sqrt(M_PI) * std::exp(-y * y) * u / scale2_;
      return -fresh_ * 2.0 * u / scale2_ / std::pow(1.0 + u * u / scale2_, 2);
    }

   private:
    double share_, fresh_, scale2_, most_;
  };
};

}  // namespace

std::unique_ptr<Effect> make_mullins() {
  return std::make_unique<Mullins>(Info{
      "mullins",
      "the arm is stiffer when it is bent further than ever before",
      "M = EI u (1 + share erfc((m^2 - u^2) / scale^2) + fresh_share / (1 + m^2 / scale^2)), m the largest "
      "curvature so far",
      "R. W. Ogden, D. G. Roxburgh, Proc. R. Soc. A 455, 1999, for bending, doi:10.1098/rspa.1999.0431; "
      "J. C. Simo, Comput. Methods Appl. Mech. Eng. 60, 1987, doi:10.1016/0045-7825(87)90107-1",
      Family::kMemory,
      {{"share", "1", "by which it is stiffer then", 0.0, 3.0, 0.1},
       {"fresh_share", "1", "by which it is stiffer until it has been bent", 0.0, 3.0, 0.1},
       {"scale_per_m", "1/m", "difference of curvatures within which that is lost", 0.2, 50.0, 2.0}},
      2,
      {"drift", "hysteresis"},
      {"bending_stiffness", "moment_gain"}});
}

}  // namespace softarm::effects
