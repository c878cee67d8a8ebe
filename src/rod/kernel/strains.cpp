#include "nominal_step.h"

namespace softarm::rod::kernel {

void strains(const Section& c, double flex, const State& y, const double n[3], double u[3], double v[3]) {
  double d1[3], d2[3], t[3];
  columns(y.q, d1, d2, t);
  const double b1 = flex * (dot(d1, y.m) + c.moment[0]), b2 = flex * (dot(d2, y.m) + c.moment[1]);
  u[0] = c.rest[0] + c.bend * (b1 + c.anisotropy[0] * b1 + c.anisotropy[1] * b2);
  u[1] = c.rest[1] + c.bend * (b2 + c.anisotropy[1] * b1 - c.anisotropy[0] * b2);
  u[2] = c.rest[2] + c.twist * flex * (dot(t, y.m) + c.moment[2]);
  v[0] = c.shear * dot(d1, n);
  v[1] = c.shear * dot(d2, n);
  v[2] = 1.0 + c.axial * dot(t, n);
}

}  // namespace softarm::rod::kernel
