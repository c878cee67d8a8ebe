// Stiffer by a share on first loading: fully where the curvature has not been so large before, less the
// further it is below the largest one, m (R. W. Ogden, D. G. Roxburgh, Proc. R. Soc. A 455, 1999, for
// bending):
//   M = EI u (1 + share erfc((m^2 - u^2) / scale^2))
#include <algorithm>
#include <cmath>

#include "drives.h"
#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Vector2d;

constexpr int kBisections = 60;

class Mullins : public Described {
 public:
  using Described::Described;
  bool needs_shape() const override { return true; }
  std::vector<Values> grid(const arm::Arm&, const FineRod&) const override {
    return {Eigen::Vector2d(0.0, 1.5), Eigen::Vector2d(0.0, 3.0), Eigen::Vector2d(0.0, 6.0)};
  }
  void act(const arm::Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape* shape,
           const Memory& memory, rod::Rod& rod) const override {
    if (values[0] == 0.0) return;
    const double scale2 = std::pow(std::max(values[1], 1e-2), 2);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const rod::RodState& middle = shape->middles[j];
      rod::Segment& piece = rod.segments[j];
      const Vector2d linear = linear_curvature(piece, middle);
      const double wanted = linear.norm();
      if (wanted < 1e-9) continue;
      // At the moment that acts: u (1 + share erfc(...)) = linear.
      const double most = memory.empty() ? 0.0 : memory[j];
      double low = wanted / (1.0 + values[0]), high = wanted;
      for (int i = 0; i < kBisections; ++i) {
        const double u = 0.5 * (low + high);
        (u * (1.0 + stiffer(values[0], scale2, most, u)) < wanted ? low : high) = u;
      }
      const double u = 0.5 * (low + high), y = (most - u * u) / scale2;
      double tangent = stiffer(values[0], scale2, most, u);
      if (y > 0.0) tangent += values[0] * 4.0 / std::sqrt(M_PI) * std::exp(-y * y) * u * u / scale2;
      bend_to(u / wanted * linear, 1.0 + tangent, middle, piece);
    }
  }
  /// How far it was bent before; no less than nothing.
  std::vector<StartNumber> starts(const arm::Arm& arm, const Values& values) const override {
    std::vector<StartNumber> numbers;
    for (const arm::Segment& segment : arm.segments)
      numbers.push_back({segment.name, "1/m^2", std::pow(std::max(values[1], left_bent_per_m(segment)), 2)});
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
  /// Share by which the material is stiffer at a curvature; most: square of the largest one before.
  static double stiffer(double share, double scale2, double most, double u) {
    return share * std::erfc(std::max(0.0, most - u * u) / scale2);
  }
};

}  // namespace

std::unique_ptr<Effect> make_mullins() {
  return std::make_unique<Mullins>(
      Info{"mullins",
           "the arm is stiffer when it is bent so far for the first time",
           "M = EI u (1 + share erfc((m^2 - u^2) / scale^2)), m the largest curvature so far",
           "R. W. Ogden, D. G. Roxburgh, Proc. R. Soc. A 455, 1999, for bending, doi:10.1098/rspa.1999.0431",
           Family::kMemory,
           {{"share", "1", "by which it is stiffer then", 0.0, 3.0, 0.1},
            {"scale_per_m", "1/m", "difference of curvatures within which that is lost", 0.2, 50.0, 2.0}},
           1,
           {"drift", "hysteresis"},
           {"bending_stiffness", "moment_gain"}});
}

}  // namespace softarm::effects
