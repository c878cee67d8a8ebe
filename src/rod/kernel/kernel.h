// The two inner loops of the rod solver: the nominal sweep and the sweep of derivatives, in plain arrays.
//
// Derivatives are carried for kLanes parameters at once, one per SIMD lane, so that the same few lines serve
// SSE2, AVX2 and AVX-512 (in pieces of 2, 4 or 8); the build compiles them once for each and the program
// picks at start.
#pragma once

#include "cash_karp.h"
#include "dop853.h"

namespace softarm::rod::kernel {

constexpr int kLanes = 8;
constexpr int kMostStages = Dop853::kStages;

/// One double per parameter.
struct alignas(kLanes * sizeof(double)) Lanes {
  double value[kLanes];
};

/// Values that are constant along a segment.
struct Section {
  double stretch;        // length / rest length
  double bend, twist;    // 1 / EI, 1 / GJ
  double anisotropy[2];  // compliance across the axis: bend (I + [[a, b], [b, -a]])
  bool is_anisotropic;   // these are not 0, or wanted
  double axial, shear;   // 1 / EA, 1 / GA
  double rest[3];        // u*
  double moment[3];      // M_act
  double weight[3];      // weight per unit of s, world
  bool shearable;        // axial or shear is not 0, or wanted
};

/// What the sweep of derivatives needs to know of the nominal one at a Runge-Kutta stage (world frame).
struct Stage {
  double d1[3], d2[3], t[3];  // columns of R
  double n[3], m[3];
  double kappa[3];    // R u, times stretch: R' = [kappa]x R
  double dp[3];       // p'
  double local[2];    // flex * (R^T m + M_act), about x and y
  double bent[3];     // what bend makes of them, world: d kappa / d bend / stretch
  double twisted[3];  // the same, torsional part
  double flex;        // 1 / stiffness factor of the profile
  double below;       // distance in s from the distal end of the step
};

/// One Runge-Kutta step from its distal end towards the base.
struct Step {
  const Section* section;
  double s_distal;
  double h;                  // negative
  bool brief;                // by Cash and Karp's method: half the stages; else by Dormand and Prince's
  double flex[kMostStages];  // 1 / stiffness factor at the stages
  double flex_proximal;      // the same at the proximal end

  int stages() const { return brief ? CashKarp::kStages : Dop853::kStages; }
  /// Where a stage is, as a share of h.
  double place(int stage) const { return brief ? CashKarp::kC[stage] : Dop853::kC[stage]; }
};

struct State {
  double q[4];  // w x y z
  double m[3];
  double p[3];
};

struct StepError {
  double q, p;  // estimated local errors: of the rotation (rad) and of the position (m)
};

/// Curvature (section frame) and strain at a state, with internal force n.
void strains(const Section& section, double flex, const State& y, const double n[3], double u[3],
             double v[3]);

/// Derivatives of state and internal force, one parameter a lane.
struct LaneState {
  Lanes psi[3];  // rotation, world frame
  Lanes mu[3];   // internal moment
  Lanes pi[3];   // position
  Lanes nu[3];   // internal force at the distal end of the step
};

/// Derivatives of a section's values, one parameter a lane.
struct LaneSource {
  Lanes rest[3];    // of u*
  Lanes moment[3];  // compliance times d M_act
  Lanes bend, twist, axial, shear;
  Lanes anisotropy[2];  // times bend
  Lanes stretch;        // relative: d stretch / stretch
  Lanes weight[3];
};

/// One step of the nominal sweep: y is advanced; n_distal is the internal force at the distal end.
/// @param stages where not null, filled for the sweep of derivatives
/// @param error where not null, the local error estimate is added
using NominalStep = void (*)(const Step& step, const double n_distal[3], State& y, Stage* stages,
                             StepError* error);

/// One step of the sweep of derivatives along the stages of a nominal step.
using TangentStep = void (*)(const Step& step, const Stage* stages, const LaneSource& source, LaneState& y);

/// Both, for one instruction set.
struct Kernel {
  NominalStep nominal_step;
  TangentStep tangent_step;
};

Kernel baseline_kernel();
Kernel avx2_kernel();
Kernel avx512_kernel();

/// The fastest one that this processor runs.
Kernel pick_kernel();

}  // namespace softarm::rod::kernel
