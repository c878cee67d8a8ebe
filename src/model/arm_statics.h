// An arm's shape by its laws and its rod, at inputs and payload, and how it follows from them.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/arm/constants.h"
#include "softarm/arm/laws.h"
#include "softarm/rod/solver.h"

namespace softarm::model {

/// What a shape follows from.
struct StaticLoad {
  arm::InputValues inputs;
  double payload_kg = 0.0;
  Eigen::Vector3d gravity_base = Eigen::Vector3d::Zero();  ///< in the rod's base frame, m/s^2
};

/// What an input of a kind usually is: pressures in Pa, else 1.
double usual_size(arm::InputKind kind);

/// At rest, all of a wall's creep done, without effects. Everything is in the rod's base frame.
///
/// Derivatives: the rod's own, analytic, by all of its parameters that inputs and constants move, times those
/// of the parameters, by central differences of the laws, which cost no solution of the rod.
class ArmStatics {
 public:
  /// @param points_m places of the backbone, m from the base at zero input
  /// @throws std::invalid_argument for places off the arm
  ArmStatics(const arm::Arm& arm, const std::vector<double>& points_m);

  enum class Outcome {
    kSolved,
    kNoLaws,         ///< an input is missing, or lies where the laws have no value
    kNoEquilibrium,  ///< none was found
  };
  /// From nothing: the shape that the arm takes when it is loaded, whatever was solved before.
  Outcome solve(const StaticLoad& load);

  // Valid after kSolved, until the next.
  const std::vector<arm::SegmentPrediction>& laws() const { return laws_; }
  const rod::RodState& point(int i) const { return solver_.station(bodies() + i); }
  Eigen::Vector3d body_position(int i) const;
  Eigen::Vector3d body_tangent(int i) const;

  /// Derivatives of the places of all bodies and, below, of all points of the backbone, x y z of one after
  /// the other: 3 (bodies + points) rows.
  Eigen::MatrixXd by_inputs() const;  ///< one column per Arm::inputs.scalars; 0 where absent
  Eigen::VectorXd by_payload() const;
  Eigen::MatrixXd by_gravity() const;  ///< x, y, z
  Eigen::MatrixXd by_constants(const std::vector<arm::ConstantRef>& constants) const;

 private:
  int bodies() const { return static_cast<int>(arm_.bodies.size()); }
  /// The rod's parameters that the laws set, in the order of parameters_, as another arm or other inputs
  /// have them. @return false where the laws have no value
  bool rod_values(const arm::Arm& arm, const arm::InputValues& inputs, Eigen::VectorXd& out) const;
  /// Of rod_values(), by one number, central where both sides have a value.
  Eigen::VectorXd difference(double step,
                             const std::function<bool(double, Eigen::VectorXd&)>& values_at) const;
  Eigen::MatrixXd by_rod() const;  ///< places by parameters_

  arm::Arm arm_;
  std::vector<rod::Parameter> parameters_;
  rod::Rod rod_;
  rod::Solver solver_;
  arm::InputValues inputs_;
  std::vector<arm::SegmentPrediction> laws_;
};

}  // namespace softarm::model
