// The sweep of derivatives, included once per instruction set by the files that name the function.
//
//   psi' = k R du + dk/k kappa,   R du = C (mu - psi x m) + sources      (left perturbations: dR = [psi]x R)
//   pi'  = k dV + dk/k p',        dV = psi x V + C_se (nu - psi x n) + sources
//   mu'  = -(pi' x n + p' x nu)
#pragma once

#include "kernel.h"

namespace softarm::rod::kernel {
namespace {

/// As many lanes as one register holds.
template <int kWidth>
struct Register {
  using Type [[gnu::vector_size(kWidth * sizeof(double)), gnu::may_alias]] = double;
};

template <int kWidth>
inline __attribute__((always_inline)) const typename Register<kWidth>::Type& piece(const Lanes& lanes,
                                                                                   int i) {
  return reinterpret_cast<const typename Register<kWidth>::Type*>(lanes.value)[i];
}

template <int kWidth>
inline __attribute__((always_inline)) typename Register<kWidth>::Type& piece(Lanes& lanes, int i) {
  return reinterpret_cast<typename Register<kWidth>::Type*>(lanes.value)[i];
}

/// A section's sources, with what does not change from stage to stage done once.
template <typename V>
struct Source {
  V rest[3], moment[3], bend, twist, axial, shear, anisotropy[2], stretch, weight[3];
};

template <typename V>
inline __attribute__((always_inline)) void rates(const Section& c, const Stage& g, const Source<V>& f,
                                                 const V psi[3], const V mu[3], const V nu_distal[3],
                                                 V dpsi[3], V dmu[3], V dpi[3]) {
  const V w[3] = {mu[0] - (psi[1] * g.m[2] - psi[2] * g.m[1]), mu[1] - (psi[2] * g.m[0] - psi[0] * g.m[2]),
                  mu[2] - (psi[0] * g.m[1] - psi[1] * g.m[0])};
  const double bend = c.stretch * g.flex * c.bend;
  const double twist = c.stretch * g.flex * (c.twist - c.bend);
  V first = f.rest[0] + g.flex * f.moment[0];
  V second = f.rest[1] + g.flex * f.moment[1];
  if (c.is_anisotropic) {
    const V about1 = bend * (g.d1[0] * w[0] + g.d1[1] * w[1] + g.d1[2] * w[2]);
    const V about2 = bend * (g.d2[0] * w[0] + g.d2[1] * w[1] + g.d2[2] * w[2]);
    first += c.anisotropy[0] * about1 + c.anisotropy[1] * about2 + g.local[0] * f.anisotropy[0] +
             g.local[1] * f.anisotropy[1];
    second += c.anisotropy[1] * about1 - c.anisotropy[0] * about2 - g.local[1] * f.anisotropy[0] +
              g.local[0] * f.anisotropy[1];
  }
  const V along = twist * (g.t[0] * w[0] + g.t[1] * w[1] + g.t[2] * w[2]) + f.rest[2] + g.flex * f.moment[2];
  for (int r = 0; r < 3; ++r) {
    dpsi[r] = bend * w[r] + g.t[r] * along + g.d1[r] * first + g.d2[r] * second + g.bent[r] * f.bend +
              g.twisted[r] * f.twist + g.kappa[r] * f.stretch;
  }
  dpi[0] = psi[1] * g.dp[2] - psi[2] * g.dp[1] + g.dp[0] * f.stretch;
  dpi[1] = psi[2] * g.dp[0] - psi[0] * g.dp[2] + g.dp[1] * f.stretch;
  dpi[2] = psi[0] * g.dp[1] - psi[1] * g.dp[0] + g.dp[2] * f.stretch;
  V nu[3];
  for (int r = 0; r < 3; ++r) nu[r] = nu_distal[r] + g.below * f.weight[r];
  if (c.shearable) {
    const V x[3] = {nu[0] - (psi[1] * g.n[2] - psi[2] * g.n[1]), nu[1] - (psi[2] * g.n[0] - psi[0] * g.n[2]),
                    nu[2] - (psi[0] * g.n[1] - psi[1] * g.n[0])};
    const double nt = g.n[0] * g.t[0] + g.n[1] * g.t[1] + g.n[2] * g.t[2];
    const double shear = c.stretch * c.shear;
    const V axial = c.stretch * (c.axial - c.shear) * (g.t[0] * x[0] + g.t[1] * x[1] + g.t[2] * x[2]) +
                    nt * (f.axial - f.shear);
    for (int r = 0; r < 3; ++r) dpi[r] += shear * x[r] + g.t[r] * axial + g.n[r] * f.shear;
  }
  dmu[0] = -(dpi[1] * g.n[2] - dpi[2] * g.n[1] + g.dp[1] * nu[2] - g.dp[2] * nu[1]);
  dmu[1] = -(dpi[2] * g.n[0] - dpi[0] * g.n[2] + g.dp[2] * nu[0] - g.dp[0] * nu[2]);
  dmu[2] = -(dpi[0] * g.n[1] - dpi[1] * g.n[0] + g.dp[0] * nu[1] - g.dp[1] * nu[0]);
}

template <int kWidth, typename Method>
inline __attribute__((always_inline)) void tangent_piece(const Step& step, const Stage* stages,
                                                         const LaneSource& source, LaneState& y, int k) {
  using V = typename Register<kWidth>::Type;
  constexpr int kStages = Method::kStages;
  const Section& c = *step.section;
  Source<V> f;
  V psi0[3], mu0[3], pi0[3], nu0[3];
  for (int r = 0; r < 3; ++r) {
    f.rest[r] = c.stretch * piece<kWidth>(source.rest[r], k);
    f.moment[r] = c.stretch * piece<kWidth>(source.moment[r], k);
    f.weight[r] = piece<kWidth>(source.weight[r], k);
    psi0[r] = piece<kWidth>(y.psi[r], k);
    mu0[r] = piece<kWidth>(y.mu[r], k);
    pi0[r] = piece<kWidth>(y.pi[r], k);
    nu0[r] = piece<kWidth>(y.nu[r], k);
  }
  f.bend = c.stretch * piece<kWidth>(source.bend, k);
  f.twist = c.stretch * piece<kWidth>(source.twist, k);
  f.axial = c.stretch * piece<kWidth>(source.axial, k);
  f.shear = c.stretch * piece<kWidth>(source.shear, k);
  for (int r = 0; r < 2; ++r) f.anisotropy[r] = c.stretch * piece<kWidth>(source.anisotropy[r], k);
  f.stretch = piece<kWidth>(source.stretch, k);
  V dpsi[kStages][3], dmu[kStages][3], dpi[3];
#pragma GCC unroll 12
  for (int i = 0; i < kStages; ++i) {
    V psi[3] = {psi0[0], psi0[1], psi0[2]};
    V mu[3] = {mu0[0], mu0[1], mu0[2]};
#pragma GCC unroll 12
    for (int j = 0; j < i; ++j) {
      if (Method::kA[i][j] == 0.0) continue;
      const double a = step.h * Method::kA[i][j];
      for (int r = 0; r < 3; ++r) {
        psi[r] += a * dpsi[j][r];
        mu[r] += a * dmu[j][r];
      }
    }
    rates<V>(c, stages[i], f, psi, mu, nu0, dpsi[i], dmu[i], dpi);
    if (Method::kB[i] != 0.0) {
      const double b = step.h * Method::kB[i];
      for (int r = 0; r < 3; ++r) pi0[r] += b * dpi[r];
    }
  }
#pragma GCC unroll 12
  for (int i = 0; i < kStages; ++i) {
    if (Method::kB[i] == 0.0) continue;
    const double b = step.h * Method::kB[i];
    for (int r = 0; r < 3; ++r) {
      psi0[r] += b * dpsi[i][r];
      mu0[r] += b * dmu[i][r];
    }
  }
  for (int r = 0; r < 3; ++r) {
    piece<kWidth>(y.psi[r], k) = psi0[r];
    piece<kWidth>(y.mu[r], k) = mu0[r];
    piece<kWidth>(y.pi[r], k) = pi0[r];
    piece<kWidth>(y.nu[r], k) = nu0[r] - step.h * f.weight[r];
  }
}

template <int kWidth>
inline __attribute__((always_inline)) void tangent_step(const Step& step, const Stage* stages,
                                                        const LaneSource& source, LaneState& y) {
  for (int k = 0; k < kLanes / kWidth; ++k) {
    if (step.brief)
      tangent_piece<kWidth, CashKarp>(step, stages, source, y, k);
    else
      tangent_piece<kWidth, Dop853>(step, stages, source, y, k);
  }
}

}  // namespace
}  // namespace softarm::rod::kernel
