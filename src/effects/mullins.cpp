// Stiffer by a share on first loading: fully where the curvature has not been so large before, less the
// further it is below the largest one, m (R. W. Ogden, D. G. Roxburgh, Proc. R. Soc. A 455, 1999, for
// bending):
//   M = EI u (1 + share erfc((m^2 - u^2) / scale^2))
#include <algorithm>
#include <cmath>

#include "effects.h"

namespace softarm::effects {
namespace {

using Eigen::Vector2d;

class Mullins : public Described {
 public:
  using Described::Described;
  bool needs_shape() const override { return true; }
  std::vector<Values> grid(const Arm&, const FineRod&) const override {
    return {Eigen::Vector2d(0.0, 1.5), Eigen::Vector2d(0.0, 3.0), Eigen::Vector2d(0.0, 6.0)};
  }
  void act(const Arm&, const FineRod& fine, const Values& values, const Instant&, const Shape* shape,
           const Memory& memory, rod::Rod& rod) const override {
    if (values[0] == 0.0) return;
    const double scale2 = std::pow(std::max(values[1], 1e-2), 2);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
      const Vector2d u = shape->middles[j].u.head<2>();
      const double square = u.squaredNorm();
      const double most = memory.empty() ? square : std::max(square, memory[j]);
      const double y = (most - square) / scale2;
      const double secant = values[0] * std::erfc(y);
      double tangent = secant;
      if (y > 0.0) tangent += values[0] * 4.0 / std::sqrt(M_PI) * std::exp(-y * y) * square / scale2;
      // Straight on from the shape, along its tangent.
      rod::Segment& piece = rod.segments[j];
      const Vector2d elastic = u - piece.rest_curvature_per_m.head<2>() + secant * u;
      piece.bending_compliance /= 1.0 + tangent;
      piece.rest_curvature_per_m.head<2>() = u - elastic / (1.0 + tangent);
    }
  }
  bool remembers() const override { return true; }
  void remember(const Arm&, const FineRod& fine, const Values&, const Instant&, const Shape& shape,
                Memory& memory) const override {
    memory.resize(fine.pieces().size(), 0.0);
    for (std::size_t j = 0; j < fine.pieces().size(); ++j)
      memory[j] = std::max(memory[j], shape.middles[j].u.head<2>().squaredNorm());
  }
};

}  // namespace

std::unique_ptr<Effect> make_mullins() {
  return std::make_unique<Mullins>(
      Info{"mullins",
           "the arm is stiffer when it is bent so far for the first time",
           Family::kMemory,
           {{"share", "1", "by which it is stiffer then", 0.0, 3.0, 0.1},
            {"scale_per_m", "1/m", "difference of curvatures within which that is lost", 0.2, 50.0, 2.0}},
           1,
           {"drift", "hysteresis"},
           {"bending_stiffness", "moment_gain"}});
}

}  // namespace softarm::effects
