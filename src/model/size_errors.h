// How well the numbers of effects are known: what effects that are otherwise than their file says do.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "effect.h"
#include "memories.h"
#include "softarm/arm/arm.h"

namespace softarm::model {

/// What is not known of the numbers of effects, as errors that are independent of each other. A number with a
/// standard deviation (Present::sd) that is correlated with no other is one of them. Numbers that are
/// correlated (Present::correlated) err along the principal directions of their covariance, in standard
/// deviations: no more of them than numbers. Each error has the effects with their numbers off by a standard
/// deviation of it, what they make of the inputs, and what they remember. Where a number would leave its
/// possible range, all are off to the other side, or by as much as there is room for, and what they do is
/// scaled up.
class SizeErrors {
 public:
  SizeErrors(const arm::Arm& arm, std::vector<Present> effects);

  int count() const { return static_cast<int>(errors_.size()); }
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
  /// The effects with each error so many standard deviations large, numbers within their possible ranges.
  std::vector<Present> leaning(const Eigen::VectorXd& by_sd) const;

 private:
  /// That is known to a standard deviation only.
  struct Number {
    std::size_t effect;
    Eigen::Index parameter;
    double sd;         ///< as the file says
    double low, high;  ///< possible on the arm
    /// Of one that may be anywhere in its range: no number is known worse.
    double most_sd() const;
  };
  struct Error {
    Eigen::VectorXd by_number;  ///< by how much a standard deviation of it moves each
    double scale;
    std::vector<Present> effects;
    Memories memories;
    Eigen::VectorXd inputs = {}, moment_inputs = {};
    double payload_kg = 0.0;
  };
  const Error& at(int k) const { return errors_[static_cast<std::size_t>(k)]; }
  double value_of(const Number& number, const std::vector<Present>& effects) const {
    return effects[number.effect].values[number.parameter];
  }
  Eigen::MatrixXd correlations() const;
  /// @param group of numbers that are correlated, if only through others; @param all correlations()
  void add_errors(const std::vector<Eigen::Index>& group, const Eigen::MatrixXd& all);
  void add_error(const Eigen::VectorXd& by_number);
  /// Share of such a move up to which all numbers stay in their ranges, at most 1.
  double room_for(const Eigen::VectorXd& by_number) const;

  const arm::Arm arm_;
  const std::vector<Present> effects_;
  std::vector<Number> numbers_;
  std::vector<Error> errors_;
};

}  // namespace softarm::model
