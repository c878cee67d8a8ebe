// The cable paper's arm: its own model on the marks of ours, and the size of its figures.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "published/published_cable.h"
#include "softarm/arm/arm.h"
#include "table.h"

namespace softarm::app::validate {

constexpr double kCableLengthM = 0.235;
constexpr double kCableFittingLoadKg = 0.0392;

/// The arm under the servo's PWM and a load.
published::CableArm cable_paper_arm(double stiffness_nm2, double pwm, double load_kg,
                                    double load_arclength_m);

/// Their model at the bodies of an arm, in its base frame (z along the arm, x upwards); empty where it has no
/// shape.
std::vector<Eigen::Vector3d> cable_paper_shape(const published::CableArm& arm, published::CableLaw law,
                                               const arm::Arm& marks);

/// Does the printed EI go with the printed loads?
Table cable_arithmetic();

}  // namespace softarm::app::validate
