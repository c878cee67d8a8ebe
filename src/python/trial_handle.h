// A recorded trial as the module hands it around.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "arm_handle.h"
#include "ros/bag_trial.h"

namespace softarm::python {

/// Never changes.
struct TrialHandle {
  Arm arm;  ///< for which it was read: whose bodies and inputs are its columns
  BagTrial read;
};

using Trial = std::shared_ptr<const TrialHandle>;

/// The trials for a fit.
/// @param payload_kg counts in all of them, whatever they recorded; then it is set as the arm's, too
/// @throws std::invalid_argument where one has other bodies or inputs than the arm
std::vector<trial::Trial> trials_for(const ArmHandle& handle,
                                     const std::vector<std::shared_ptr<TrialHandle>>& trials,
                                     const std::optional<double>& payload_kg, arm::Arm& arm);
void expect_trial_of(const ArmHandle& arm, const TrialHandle& trial);

}  // namespace softarm::python
