#include "drives.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "arm/drive.h"

namespace softarm::effects {
namespace {

constexpr double kMostNumber = 64.0;  // of a chamber; an arm file may have more

}  // namespace

Rows rows_of(const arm::Arm& arm, arm::InputKind kind) {
  Rows rows;
  for (std::size_t i = 0; i < arm.inputs.scalars.size(); ++i) {
    if (arm.inputs.scalars[i].kind == kind) rows.push_back(static_cast<Eigen::Index>(i));
  }
  return rows;
}

Rows chamber_rows(const arm::Arm& arm) {
  Rows rows;
  for (const Eigen::Index row : rows_of(arm, arm::InputKind::kPressure)) {
    const std::string& name = arm.inputs.scalars[static_cast<std::size_t>(row)].name;
    const bool bends =
        std::any_of(arm.segments.begin(), arm.segments.end(), [&](const arm::Segment& segment) {
          return std::any_of(segment.chambers.begin(), segment.chambers.end(),
                             [&](const arm::Chamber& chamber) { return chamber.input == name; });
        });
    if (bends) rows.push_back(row);
  }
  return rows;
}

Rows gas_rows(const arm::Arm& arm) {
  Rows rows = rows_of(arm, arm::InputKind::kPressure);
  const Rows vacuums = rows_of(arm, arm::InputKind::kVacuum);
  rows.insert(rows.end(), vacuums.begin(), vacuums.end());
  std::sort(rows.begin(), rows.end());
  return rows;
}

model::Parameter chamber_parameter() {
  return {"chamber", "1",         "number of the chamber in the arm file's list of pressures (0: all)",
          0.0,       kMostNumber, 0.0,
          true};
}

std::vector<double> chamber_numbers(const arm::Arm& arm, const Rows& rows) {
  std::vector<double> numbers{0.0};
  const Rows pressures = rows_of(arm, arm::InputKind::kPressure);
  for (std::size_t k = 0; rows.size() > 1 && k < pressures.size(); ++k)
    if (const auto number = static_cast<double>(k + 1);
        number <= kMostNumber && std::find(rows.begin(), rows.end(), pressures[k]) != rows.end())
      numbers.push_back(number);
  return numbers;
}

Rows rows_of_chamber(const arm::Arm& arm, const Rows& rows, double number) {
  const long only = std::lround(number);
  if (only == 0) return rows;
  const Rows pressures = rows_of(arm, arm::InputKind::kPressure);
  if (only < 0 || only > static_cast<long>(pressures.size())) return {};
  const Eigen::Index row = pressures[static_cast<std::size_t>(only - 1)];
  return std::find(rows.begin(), rows.end(), row) == rows.end() ? Rows{} : Rows{row};
}

Eigen::Index row_of(const arm::Arm& arm, const std::string& name) {
  for (std::size_t i = 0; i < arm.inputs.scalars.size(); ++i) {
    if (arm.inputs.scalars[i].name == name) return static_cast<Eigen::Index>(i);
  }
  return -1;
}

double mean_pressure_pa(const arm::Arm& arm, const arm::Segment& segment, const Eigen::VectorXd& inputs) {
  double sum = 0.0;
  int count = 0;
  const auto add = [&](const std::string& name) {
    const Eigen::Index row = row_of(arm, name);
    if (row < 0) return;
    sum += inputs[row];
    ++count;
  };
  for (const arm::Chamber& chamber : segment.chambers) add(chamber.input);
  if (segment.central_chamber) add(segment.central_chamber->input);
  return count > 0 ? sum / count : 0.0;
}

double vacuum_pa(const arm::Arm& arm, const arm::Segment& segment, const Eigen::VectorXd& inputs) {
  if (segment.jamming_input) {
    const Eigen::Index row = row_of(arm, *segment.jamming_input);
    return row < 0 ? 0.0 : inputs[row];
  }
  const Rows rows = rows_of(arm, arm::InputKind::kVacuum);
  return rows.size() == 1 ? inputs[rows.front()] : 0.0;
}

double core_stiffness_nm2(const arm::Arm& arm, const arm::Segment& segment, const Eigen::VectorXd& inputs) {
  if (!segment.jamming_input) return 0.0;
  return segment.bending_stiffness.per_jamming_pressure_nm2_per_pa *
         std::max(0.0, vacuum_pa(arm, segment, inputs));
}

bool has_core(const arm::Arm& arm) {
  return std::any_of(arm.segments.begin(), arm.segments.end(), segment_has_core);
}

std::vector<model::StartNumber> curvature_starts(const arm::Arm& arm, const SegmentTest& which,
                                                 const std::function<double(const arm::Segment&)>& sd_per_m) {
  std::vector<model::StartNumber> numbers;
  for (const arm::Segment& segment : arm.segments) {
    if (!which(segment)) continue;
    for (const char* axis : {".x", ".y"}) numbers.push_back({segment.name + axis, "1/m", sd_per_m(segment)});
  }
  return numbers;
}

std::vector<Eigen::Vector2d> started_curvatures(const arm::Arm& arm, const SegmentTest& which,
                                                const std::vector<model::StartNumber>& numbers,
                                                const Eigen::VectorXd& start) {
  std::vector<Eigen::Vector2d> list(arm.segments.size(), Eigen::Vector2d::Zero());
  std::size_t at = 0;
  for (std::size_t i = 0; i < arm.segments.size(); ++i) {
    if (!which(arm.segments[i])) continue;
    for (int axis = 0; axis < 2; ++axis, ++at)
      list[i][axis] = numbers[at].sd * start[static_cast<Eigen::Index>(at)];
  }
  return list;
}

Eigen::Vector2d linear_curvature(const rod::Segment& piece, const rod::RodState& middle) {
  const Eigen::Vector3d moment = middle.q.conjugate() * middle.m + piece.moment_nm;
  return piece.rest_curvature_per_m.head<2>() + piece.curvature_of(moment.head<2>());
}

void stiffen(double factor, const arm::Arm& arm, const model::FineRod& fine, const model::Instant& instant,
             rod::Rod& rod) {
  const arm::InputReader inputs(arm, instant.moment_inputs);
  std::vector<Eigen::Vector3d> driven_per_m;  // turns about the section's axes, by segment
  for (const arm::Segment& segment : arm.segments) {
    const Eigen::Vector2d towards = arm::drive_of(segment, inputs).value_or(arm::Drive()).curvature_per_m;
    driven_per_m.emplace_back(-towards.y(), towards.x(), 0.0);
  }
  for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
    rod::Segment& piece = rod.segments[j];
    const auto segment = static_cast<std::size_t>(fine.pieces()[j].segment);
    piece.moment_nm += (factor - 1.0) / piece.bending_compliance * driven_per_m[segment];
    piece.bending_compliance /= factor;
    piece.torsional_compliance /= factor;
    piece.shear_compliance /= factor;
    piece.axial_compliance /= factor;
  }
}

Eigen::Matrix2d slope_about(const Eigen::Vector2d& direction, double along, double across) {
  const Eigen::Vector2d unit = direction.normalized();
  return across * Eigen::Matrix2d::Identity() + (along - across) * unit * unit.transpose();
}

void bend_to(const Eigen::Vector2d& curvature, const Eigen::Matrix2d& slope, const rod::RodState& middle,
             rod::Segment& piece) {
  const Eigen::Vector3d moment = middle.q.conjugate() * middle.m + piece.moment_nm;
  Eigen::Matrix2d linear;
  linear.col(0) = piece.curvature_of(Eigen::Vector2d::UnitX());
  linear.col(1) = piece.curvature_of(Eigen::Vector2d::UnitY());
  // Compliances are symmetric: slope * linear where one of the two is a number, as of a round section.
  const double determinant = std::sqrt(slope.determinant());
  const Eigen::Matrix2d root =
      (slope + determinant * Eigen::Matrix2d::Identity()) / std::sqrt(slope.trace() + 2.0 * determinant);
  const Eigen::Matrix2d compliance = root * linear * root;
  const double mean = 0.5 * compliance.trace();
  piece.rest_curvature_per_m.head<2>() = curvature - compliance * moment.head<2>();
  if (!(mean > 0.0)) return;  // rigid
  // As Segment::curvature_of has it.
  piece.bending_compliance = compliance.determinant() / mean;
  piece.anisotropy = Eigen::Vector2d(0.5 * (compliance(1, 1) - compliance(0, 0)),
                                     -0.5 * (compliance(0, 1) + compliance(1, 0))) /
                     mean;
}

}  // namespace softarm::effects
