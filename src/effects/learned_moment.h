// A term of a discovered law: a moment that goes with what drives or loads the arm.
#pragma once

#include "effects.h"

namespace softarm::effects {

/// What a term goes with: the parameter `of`.
enum class Regressor {
  kInput = 0,
  kProduct = 1,
  kPlay = 2,
  kLag = 3,
  kPayload = 4,
  kAttitude = 5,
  kDriveLag = 6,
  kCurvatureLag = 7,
  kCurvature = 8,
};

/// M = (sizes) b(z) / z_max in the section, z the regressor. Up to the ends of [from, to] b(z) = z; at a
/// distance d beyond an end it is z exp(-4 d^2 / (to - from)^2): smooth, bounded, and nothing far outside.
class LearnedMoment : public Described {
 public:
  enum Index { kX, kY, kOf, kFirst, kSecond, kScale, kRising, kFrom, kTo, kCount };
  explicit LearnedMoment(Info info) : Described(std::move(info)) {}

  bool remembers() const override { return true; }
  void act(const Arm& arm, const FineRod& fine, const Values& values, const Instant& instant, const Shape*,
           const Memory& memory, rod::Rod& rod) const override;
  void remember(const Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
                const Shape& shape, Memory& memory) const override;

  /// z at a piece, as it is: of scalars (z, 0). In the SI unit that unit_of() says.
  Eigen::Vector2d regressor(const Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
                            const Memory& memory, std::size_t piece) const;
  /// Whether z has a direction in the section: along which the first size then is, the second across it.
  static bool is_vector(Regressor of);
  static Regressor of(const Values& values);
  /// Of z, for a person: "Pa", "Pa^2".
  static std::string unit_of(const Arm& arm, const Values& values);
  /// b(z) as it is above; of one with a direction, of its length.
  static Eigen::Vector2d bounded(const Values& values, const Eigen::Vector2d& z);
};

/// No effect of the catalogue: it is not looked for, but learnt where nothing in the catalogue fits.
const LearnedMoment& learned_moment();

}  // namespace softarm::effects
