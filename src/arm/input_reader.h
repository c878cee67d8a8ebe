// Values of inputs by their names.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "softarm/arm/laws.h"

namespace softarm::arm {

/// Refers to the arm and the values, which must outlive it.
class InputReader {
 public:
  InputReader(const Arm& arm, const InputValues& values) : inputs_(arm.inputs), values_(&values) {}
  /// @param known of all inputs, in their order
  InputReader(const Arm& arm, const Eigen::VectorXd& known) : inputs_(arm.inputs), known_(&known) {}

  /// @return nothing where the input is not declared, not known or not finite
  std::optional<double> operator()(const std::string& name) const;

 private:
  const Inputs& inputs_;
  const InputValues* values_ = nullptr;
  const Eigen::VectorXd* known_ = nullptr;
};

}  // namespace softarm::arm
