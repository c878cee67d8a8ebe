// What is assumed next where a shape depends on what it causes.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "effect.h"

namespace softarm::model {

/// Of the stations' positions, stacked.
Eigen::VectorXd difference_m(const Shape& a, const Shape& b);

/// Anderson's mixing: from shapes that were assumed and those that followed, the next to assume. A shape that
/// answers what is assumed many times over (a stiff spring) takes but a share of what followed.
class ShapeMixer {
 public:
  explicit ShapeMixer(double share) : share_(share) {}
  double share() const { return share_; }

  /// @param followed nullptr if nothing did: what was assumed has no equilibrium
  /// @return false after so many steps that made things worse that there is no hope
  bool next(const Shape& assumed, const Shape* followed, Shape& out);

 private:
  static constexpr std::size_t kHistory = 10;  ///< shapes that are mixed
  static constexpr double kWorse = 4.0, kMostWeight = 1e5, kAlike = 1e-5;
  static constexpr int kMostResets = 10;
  double share_, least_ = 0.0;
  int resets_ = 0;
  std::optional<std::pair<Shape, Shape>> best_;
  std::vector<Shape> assumed_, followed_;
  std::vector<Eigen::VectorXd> errors_;
};

}  // namespace softarm::model
