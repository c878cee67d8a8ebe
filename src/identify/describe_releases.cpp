#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "releases.h"

namespace softarm::identify {

std::string describe(const ReleaseFit& fit) {
  std::string text;
  const auto law = [&](const char* name, const SwingLaw& l) {
    text +=
        fmt::format("{}: {:.2f} Hz (by the arm file {:.2f} Hz), damping ratio {:.3f}", name,
                    fit.mode_hz.back() * std::sqrt(l.stiffness_scale), fit.mode_hz.back(), l.damping_ratio);
    if (l.slip_share > 0.0)
      text += fmt::format("; {:.2f} Hz while nothing slips, slips at {:.1f} mm",
                          fit.mode_hz.back() * std::sqrt(l.stiffness_scale * (1.0 + l.slip_share)),
                          1e3 * l.slip_m);
    text += "\n";
  };
  law("modes", fit.linear);
  law("modes with slip", fit.slip);
  text += fmt::format("{:<16} {:<8} {:>12}  {:>20}  {:>20}\n", "release", "", "amplitude", "rms: modes",
                      "modes with slip");
  double sum[2][2] = {{0, 0}, {0, 0}};
  int count[2] = {0, 0};
  for (const ReleaseError& e : fit.errors) {
    text += fmt::format(
        "{:<16} {:<8} {:9.1f} mm  {:6.1f} mm {:5.1f} % ({:.0f} %)  {:6.1f} mm {:5.1f} % ({:.0f} %)\n",
        e.trial, e.fitted ? "fitted" : "unseen", 1e3 * e.amplitude_m, 1e3 * e.linear_m,
        100 * e.linear_m / e.amplitude_m, 100 * e.linear_m / e.largest_m, 1e3 * e.slip_m,
        100 * e.slip_m / e.amplitude_m, 100 * e.slip_m / e.largest_m);
    ++count[e.fitted];
    sum[e.fitted][0] += 100 * e.linear_m / e.amplitude_m;
    sum[e.fitted][1] += 100 * e.slip_m / e.amplitude_m;
  }
  for (const int i : {1, 0})
    text += fmt::format("{} ({}), mean: {:.1f} % of the amplitude; with slip {:.1f} %\n",
                        i == 1 ? "fitted" : "unseen", count[i], sum[i][0] / std::max(1, count[i]),
                        sum[i][1] / std::max(1, count[i]));
  text += "in brackets: of the largest distance from rest within the second that is predicted\n";
  for (const std::string& line : fit.left_out) text += "left out: " + line + "\n";
  return text;
}

}  // namespace softarm::identify
