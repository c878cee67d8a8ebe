// The truth beside a simulated recording, as CSV.
#pragma once

#include <ostream>

#include "simulator.h"

namespace softarm::rig {

/// Writes the column names: stamp, M0, phi, EI, L, payload, payload_steadied, theta_tip, tip_x, tip_y, tip_z
/// (base frame), Mx, My, vacuum, P_1 ... P_n (Pa, gauge), ring_1_x, ring_1_y, ring_1_z ... (base frame), T_1
/// ... T_n (N), angle_1 ... (rad). M0, phi, EI, L, Mx, My are the first segment's; those of segment i follow
/// as M0_i ... My_i. SI units, rad.
void write_truth_header(std::ostream& out, const Scenario& scenario);

/// Writes one row; numbers are the shortest that read back to the same value.
/// @param epoch_s added to the stamp: the recording's time of t = 0
void write_truth_row(std::ostream& out, const Truth& truth, double epoch_s = 0.0);

}  // namespace softarm::rig
