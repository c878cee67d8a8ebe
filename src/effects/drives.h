// What effects need to know of what drives an arm.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "math/following.h"
#include "model/effect.h"
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

/// The number of an effect that may be one chamber's alone, by the arm file's list of pressures; 0: all.
model::Parameter chamber_parameter();
/// What it may be among these rows: 0 and, where there are several, each one's.
std::vector<double> chamber_numbers(const arm::Arm& arm, const Rows& rows);
/// Those of these rows that it is about.
Rows rows_of_chamber(const arm::Arm& arm, const Rows& rows, double number);
/// The row of an input. @return -1 if there is none
Eigen::Index row_of(const arm::Arm& arm, const std::string& name);

/// Changes what drives the trial as each of its pressures: rows of inputs and of moment_inputs, one by one.
template <typename Change>
void for_pressures(const arm::Arm& arm, model::Series& series, const Change& change) {
  for (const Eigen::Index row : rows_of(arm, arm::InputKind::kPressure)) {
    change(series.inputs.row(row));
    change(series.moment_inputs.row(row));
  }
}

/// Mean of all pressures that act in the segment, its chambers' and the central one's; 0 without any.
double mean_pressure_pa(const arm::Arm& arm, const arm::Segment& segment, const Eigen::VectorXd& inputs);
/// Vacuum of the segment's core, of the arm's only one where it has no core; 0 without any.
double vacuum_pa(const arm::Arm& arm, const arm::Segment& segment, const Eigen::VectorXd& inputs);
/// The share of the segment's EI, N m^2, that its jammed core bears.
double core_stiffness_nm2(const arm::Arm& arm, const arm::Segment& segment, const Eigen::VectorXd& inputs);
/// Whether some segment has a core that the vacuum stiffens.
bool has_core(const arm::Arm& arm);

/// Of what a trial finds: an arm that was left bent by this, as a turn of one segment, rad.
constexpr double kLeftBent_rad = 0.5;
/// Standard deviation of what is anywhere between -1 and 1.
constexpr double kAnywhere = 0.577;

using SegmentTest = std::function<bool(const arm::Segment&)>;
/// Curvatures that a trial finds in the segments in question: two numbers each. @param sd_per_m of one
std::vector<model::StartNumber> curvature_starts(const arm::Arm& arm, const SegmentTest& which,
                                                 const std::function<double(const arm::Segment&)>& sd_per_m);
/// The same by segment of the arm, 1/m; 0 of the others.
std::vector<Eigen::Vector2d> started_curvatures(const arm::Arm& arm, const SegmentTest& which,
                                                const std::vector<model::StartNumber>& numbers,
                                                const Eigen::VectorXd& start);
/// Of an arm that was left bent.
inline double left_bent_per_m(const arm::Segment& segment) {
  return kLeftBent_rad / segment.length_m;
}
inline bool any_segment(const arm::Segment&) {
  return true;
}
inline bool segment_has_core(const arm::Segment& segment) {
  return segment.jamming_input && segment.bending_stiffness.per_jamming_pressure_nm2_per_pa > 0.0;
}

using math::following;
using math::Following;

/// The curvature that a piece's linear law gives for the moment that acts on its middle in a shape, the axes
/// across only: u* + (m + M_act) / EI. Where bend_to() made it a tangent, what it was bent to.
Eigen::Vector2d linear_curvature(const rod::Segment& piece, const rod::RodState& middle);
/// All stiffnesses of the material times a factor. What servos bend by winding cables up is a curvature and
/// stays: their moment goes with the stiffness.
void stiffen(double factor, const arm::Arm& arm, const model::FineRod& fine, const model::Instant& instant,
             rod::Rod& rod);
/// Of a law that leaves a curvature its direction: what it makes of a small change along it and across it.
Eigen::Matrix2d slope_about(const Eigen::Vector2d& direction, double along, double across);
/// Makes the piece have another curvature at the moment that acts in the shape, and about it the law's own
/// answer to a change of that moment, along and across: solutions settle at once, and derivatives by the rod
/// are those of the law. Only for Stage::kLaws, whose laws begin from Segment::unloaded_curvature_per_m. With
/// several of them the answer is the product of theirs. The curvature is exact; the answer is where a section
/// is round and the slopes have the same direction, as about the curvature without a load, else nearly so.
/// @param slope of the curvature by what linear_curvature() is; symmetric, positive definite
void bend_to(const Eigen::Vector2d& curvature, const Eigen::Matrix2d& slope, const rod::RodState& middle,
             rod::Segment& piece);

}  // namespace softarm::effects
