// What effects need to know of what drives an arm.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "math/following.h"
#include "softarm/arm/arm.h"
#include "softarm/rod/rod.h"
#include "softarm/rod/solver.h"

namespace softarm::effects {

/// Where effects on pressures, and on the vacuum, have the share that is their size.
constexpr double kReferencePa = 50e3, kReferenceVacuumPa = 60e3;

using Rows = std::vector<Eigen::Index>;

/// Rows of Series::inputs that hold inputs of a kind, in order.
Rows rows_of(const arm::Arm& arm, arm::InputKind kind);
inline bool has(const arm::Arm& arm, arm::InputKind kind) {
  return !rows_of(arm, kind).empty();
}
/// Those that bend a segment as a chamber's pressure.
Rows chamber_rows(const arm::Arm& arm);
/// Those of pressures or vacuums, in order.
Rows gas_rows(const arm::Arm& arm);
/// The row of an input. @return -1 if there is none
Eigen::Index row_of(const arm::Arm& arm, const std::string& name);

/// Mean of all pressures that act in the segment, its chambers' and the central one's; 0 without any.
double mean_pressure_pa(const arm::Arm& arm, const arm::Segment& segment, const Eigen::VectorXd& inputs);
/// Vacuum of the segment's core, of the arm's only one where it has no core; 0 without any.
double vacuum_pa(const arm::Arm& arm, const arm::Segment& segment, const Eigen::VectorXd& inputs);
/// The share of the segment's EI, N m^2, that its jammed core bears.
double core_stiffness_nm2(const arm::Arm& arm, const arm::Segment& segment, const Eigen::VectorXd& inputs);
/// Whether some segment has a core that the vacuum stiffens.
bool has_core(const arm::Arm& arm);

using math::following;
using math::Following;

/// The curvature that a piece's linear law gives for the moment that acts on its middle in a shape, the axes
/// across only: u* + (m + M_act) / EI.
Eigen::Vector2d linear_curvature(const rod::Segment& piece, const rod::RodState& middle);
/// Makes the piece have another curvature at that moment, and another stiffness about it.
void bend_to(const Eigen::Vector2d& curvature, double stiffness_ratio, const rod::RodState& middle,
             rod::Segment& piece);

}  // namespace softarm::effects
