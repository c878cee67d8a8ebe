// How an arm was left before it was first seen: what of it effects still remember is not known.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "effect.h"
#include "instant_solver.h"
#include "softarm/arm/arm.h"

namespace softarm::model {

/// One memory for each number of Effect::starts(), as it would be with that number a standard deviation from
/// rest: what it does otherwise than the memory that began at rest is the standard deviation of a frame for
/// want of that number. It is forgotten as the effect's law says, and then dropped.
class UnknownStarts {
 public:
  UnknownStarts(const arm::Arm& arm, std::vector<Present> effects);

  /// The arm is seen for the first time.
  void begin(const FineRod& fine);
  bool empty() const { return numbers_.empty(); }
  /// Inputs of the last instant of a series that no effect has changed yet. @param driven the same as the
  /// effects change it
  void drive(const Series& series, const Series& driven);
  /// With Memories::remember(). @param memories what it left
  void remember(const FineRod& fine, const Instant& instant, const Shape& shape,
                const std::vector<Memory>& memories);

  /// Of each segment's curvature towards x and y, 1/m^2, at an instant of this shape.
  /// @param given as InstantSolver::Context has it
  std::vector<Eigen::Vector2d> curvature_variance(InstantSolver& solver, const std::vector<Memory>& memories,
                                                  const Instant& instant, const Shape& shape,
                                                  const std::vector<arm::SegmentPrediction>& given) const;

 private:
  struct Number {
    std::size_t effect = 0;
    Eigen::VectorXd start;
    Memory memory;                 ///< empty: it is in the inputs
    double first_difference = -1;  ///< from the memory at rest, when both were first told something
    std::vector<Eigen::Vector2d> by_inputs = {};  ///< by segment, what it changes of the laws' curvature
  };

  const arm::Arm arm_;
  const std::vector<Present> effects_;
  std::vector<Number> numbers_;
};

}  // namespace softarm::model
