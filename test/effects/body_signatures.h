// An arm and what effects do to it, for the tests of what they look like.
#pragma once

#include <gtest/gtest.h>

#include "body_table.h"

namespace softarm::effects::body_testing {

class Signatures : public ::testing::Test {
 protected:
  model::Present with(const char* id, std::initializer_list<double> values) const {
    return present(id, values_of(values));
  }
  /// Bodies moved, one column each, instant by instant.
  Eigen::Matrix3Xd moved(const model::Present& by, const std::vector<Condition>& conditions) {
    return body_testing::moved(model, arm, by, trial_of(arm, conditions));
  }
  Eigen::VectorXd inputs(double level, std::size_t first = 0) const { return inputs_of(arm, level, first); }
  double tip(const model::Present& by, const Condition& condition) {
    return moved(by, {condition}).rightCols<1>().norm();
  }
  static constexpr Eigen::Index kRings = 4;
  const arm::Arm arm = shipped("online_200mm");
  model::ExtendedModel model{arm};
};

}  // namespace softarm::effects::body_testing
