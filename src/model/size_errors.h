// How well the numbers of effects are known: what an effect that is otherwise than its file says does.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "effect.h"
#include "memories.h"
#include "softarm/arm/arm.h"

namespace softarm::model {

/// One entry for each number with a standard deviation (Present::sd): the effects with that number a standard
/// deviation off, what they make of the inputs, and what they remember. One that would leave its possible
/// range is off to the other side, or by as much as there is room for, and what it does is scaled up.
class SizeErrors {
 public:
  SizeErrors(const arm::Arm& arm, std::vector<Present> effects);

  int count() const { return static_cast<int>(numbers_.size()); }
  /// After a pause, in which all came to rest.
  void rest();
  /// Of an instant: what is last in its series. @param undriven that no effect has changed yet
  void drive(const Series& undriven);
  /// With Memories::remember().
  void remember(const FineRod& fine, const Instant& instant, const Shape& shape);

  const std::vector<Present>& effects(int k) const { return at(k).effects; }
  const std::vector<Memory>& memories(int k) const { return at(k).memories.all(); }
  /// Sets inputs and payload of an instant.
  void drive(int k, Instant& instant) const;
  /// By what differences are multiplied for those of one standard deviation.
  double scale(int k) const { return at(k).scale; }
  /// The effects with each number off by so many standard deviations, within its possible range.
  std::vector<Present> leaning(const Eigen::VectorXd& by_sd) const;

 private:
  struct Number {
    std::size_t effect;
    Eigen::Index parameter;
    double sd;
    double scale;
    std::vector<Present> effects;
    Memories memories;
    Eigen::VectorXd inputs = {}, moment_inputs = {};
    double payload_kg = 0.0;
  };
  const Number& at(int k) const { return numbers_[static_cast<std::size_t>(k)]; }

  const arm::Arm arm_;
  const std::vector<Present> effects_;
  std::vector<Number> numbers_;
};

}  // namespace softarm::model
