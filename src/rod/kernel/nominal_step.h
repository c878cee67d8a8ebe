#include <algorithm>
// The nominal sweep, included once per instruction set.
#pragma once

#include <cmath>

#include "kernel.h"

namespace softarm::rod::kernel {
namespace {

inline void cross(const double a[3], const double b[3], double c[3]) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

inline double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Columns of the rotation of a (nearly) unit quaternion.
inline void columns(const double q[4], double d1[3], double d2[3], double t[3]) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  d1[0] = w * w + x * x - y * y - z * z;
  d1[1] = 2 * (x * y + w * z);
  d1[2] = 2 * (x * z - w * y);
  d2[0] = 2 * (x * y - w * z);
  d2[1] = w * w - x * x + y * y - z * z;
  d2[2] = 2 * (y * z + w * x);
  t[0] = 2 * (x * z + w * y);
  t[1] = 2 * (y * z - w * x);
  t[2] = w * w - x * x - y * y + z * z;
}

/// Right-hand side d/ds of (q, m, p) and the stage's record.
inline __attribute__((always_inline)) void evaluate(const Section& c, double flex, const double q[4],
                                                    const double m[3], const double n[3], Stage& g,
                                                    double dq[4], double dm[3]) {
  columns(q, g.d1, g.d2, g.t);
  const double b1 = flex * (dot(g.d1, m) + c.moment[0]);
  const double b2 = flex * (dot(g.d2, m) + c.moment[1]);
  const double b3 = flex * (dot(g.t, m) + c.moment[2]);
  const double bent1 = b1 + c.anisotropy[0] * b1 + c.anisotropy[1] * b2;
  const double bent2 = b2 + c.anisotropy[1] * b1 - c.anisotropy[0] * b2;
  const double u1 = c.rest[0] + c.bend * bent1;
  const double u2 = c.rest[1] + c.bend * bent2;
  const double u3 = c.rest[2] + c.twist * b3;
  double stretch[3];
  if (c.shearable) {
    const double nt = dot(n, g.t);
    for (int i = 0; i < 3; ++i) stretch[i] = g.t[i] + c.shear * n[i] + (c.axial - c.shear) * nt * g.t[i];
  } else {
    for (int i = 0; i < 3; ++i) stretch[i] = g.t[i];
  }
  for (int i = 0; i < 3; ++i) {
    g.n[i] = n[i];
    g.m[i] = m[i];
    g.bent[i] = bent1 * g.d1[i] + bent2 * g.d2[i];
    g.twisted[i] = b3 * g.t[i];
    g.kappa[i] = c.stretch * (u1 * g.d1[i] + u2 * g.d2[i] + u3 * g.t[i]);
    g.dp[i] = c.stretch * stretch[i];
  }
  g.local[0] = b1;
  g.local[1] = b2;
  g.flex = flex;
  const double *k = g.kappa, w = q[0], x = q[1], y = q[2], z = q[3];
  dq[0] = 0.5 * (-k[0] * x - k[1] * y - k[2] * z);
  dq[1] = 0.5 * (k[0] * w + k[1] * z - k[2] * y);
  dq[2] = 0.5 * (k[1] * w + k[2] * x - k[0] * z);
  dq[3] = 0.5 * (k[2] * w + k[0] * y - k[1] * x);
  cross(n, g.dp, dm);  // -p' x n
}

template <typename Method>
inline __attribute__((always_inline)) void nominal_step_by(const Step& step, const double n_distal[3],
                                                           State& y, Stage* stages, StepError* error) {
  constexpr int kStages = Method::kStages;
  const Section& c = *step.section;
  Stage scratch;
  double rate[kStages][7];  // of q, m
  double dp[kStages][3];
  for (int i = 0; i < kStages; ++i) {
    double z[7] = {y.q[0], y.q[1], y.q[2], y.q[3], y.m[0], y.m[1], y.m[2]};
    for (int j = 0; j < i; ++j) {
      if (Method::kA[i][j] == 0.0) continue;
      const double a = step.h * Method::kA[i][j];
      for (int r = 0; r < 7; ++r) z[r] += a * rate[j][r];
    }
    Stage& g = stages != nullptr ? stages[i] : scratch;
    g.below = -Method::kC[i] * step.h;
    double n[3];
    for (int r = 0; r < 3; ++r) n[r] = n_distal[r] + g.below * c.weight[r];
    evaluate(c, step.flex[i], z, z + 4, n, g, rate[i], rate[i] + 4);
    for (int r = 0; r < 3; ++r) dp[i][r] = g.dp[r];
  }
  if (error != nullptr) {
    // For the rotation and for the position alone.
    double q5 = 0, q3 = 0, p5 = 0, p3 = 0;
    for (int r = 0; r < 4; ++r) {
      double e5 = 0, e3 = 0;
      for (int i = 0; i < kStages; ++i) e5 += Method::kE5[i] * rate[i][r], e3 += Method::kE3[i] * rate[i][r];
      q5 += e5 * e5, q3 += e3 * e3;
    }
    for (int r = 0; r < 3; ++r) {
      double e5 = 0, e3 = 0;
      for (int i = 0; i < kStages; ++i) e5 += Method::kE5[i] * dp[i][r], e3 += Method::kE3[i] * dp[i][r];
      p5 += e5 * e5, p3 += e3 * e3;
    }
    const double h = std::abs(step.h);
    error->q += 2 * h * Method::error(q5, q3);
    error->p += h * Method::error(p5, p3);
  }
  for (int i = 0; i < kStages; ++i) {
    if (Method::kB[i] == 0.0) continue;
    const double b = step.h * Method::kB[i];
    for (int r = 0; r < 4; ++r) y.q[r] += b * rate[i][r];
    for (int r = 0; r < 3; ++r) {
      y.m[r] += b * rate[i][4 + r];
      y.p[r] += b * dp[i][r];
    }
  }
  const double scale = 1.0 / std::sqrt(y.q[0] * y.q[0] + y.q[1] * y.q[1] + y.q[2] * y.q[2] + y.q[3] * y.q[3]);
  for (double& x : y.q) x *= scale;
}

inline void nominal_step(const Step& step, const double n_distal[3], State& y, Stage* stages,
                         StepError* error) {
  if (step.brief)
    nominal_step_by<CashKarp>(step, n_distal, y, stages, error);
  else
    nominal_step_by<Dop853>(step, n_distal, y, stages, error);
}

}  // namespace
}  // namespace softarm::rod::kernel
