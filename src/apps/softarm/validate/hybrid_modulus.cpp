#include "hybrid_modulus.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "published/mooney_rivlin.h"

namespace softarm::app::validate {
namespace {

// Table 2 of the paper.
constexpr double kOuterM = 0.012, kInnerM = 0.003, kOffsetM = 0.004;
constexpr arm::MooneyRivlin kPrintedRubber{18800.0, -14000.0};

double chamber_area_m2() {
  return M_PI / 4.0 * kInnerM * kInnerM;
}

}  // namespace

double hybrid_wall_area_m2() {
  return M_PI / 4.0 * (kOuterM * kOuterM - kInnerM * kInnerM);
}
double hybrid_second_moment_m4() {
  return M_PI / 64.0 * (std::pow(kOuterM, 4) - std::pow(kInnerM, 4));
}

Table hybrid_moduli(Series& series) {
  Table table{"hybrid.modulus",
              "Figure 8: rigidity EI over pressure, constants as printed (N m2)",
              {"(26) set equal to", "(26) as it stands", "tangent modulus"},
              {},
              {}};
  series = {"hybrid_modulus", {"pressure_pa", "printed", "chain_rule", "tangent"}, {}};
  const double inertia = hybrid_second_moment_m4();
  std::array<double, 3> at_rest{};
  for (int kpa = 0; kpa <= 40; kpa += 2) {
    const double stress = 1e3 * kpa * chamber_area_m2() / hybrid_wall_area_m2();
    const auto stretch = kPrintedRubber.stretch_at(stress);
    if (!stretch) continue;
    const double strain = 0.5 * (*stretch * *stretch - 1.0);
    const std::array<double, 3> ei{
        published::published_modulus_pa(kPrintedRubber, strain).value_or(kNoValue) * inertia,
        published::published_chain_rule_modulus_pa(kPrintedRubber, strain).value_or(kNoValue) * inertia,
        kPrintedRubber.tangent_modulus_pa(*stretch) * inertia};
    series.rows.push_back({1e3 * kpa, ei[0], ei[1], ei[2]});
    if (kpa == 0) at_rest = ei;
    if (kpa % 10 != 0) continue;
    Row row{fmt::format("EI at {} kPa", kpa), kpa == 0 ? "no numbers; grows" : "", {}, ""};
    for (std::size_t i = 0; i < ei.size(); ++i)
      row.ours.push_back(
          {fmt::format("{:.3e} ({:+.1f} %)", ei[i], 100.0 * (ei[i] / at_rest[i] - 1.0)), ei[i]});
    row.remark = fmt::format("stretch {:.4f} by {:.0f} kPa in the wall", *stretch, stress / 1e3);
    if (kpa == 0) row.remark = "at rest 4 (C10 + C01), and Young's modulus 6 (C10 + C01) = 28.8 kPa";
    table.rows.push_back(row);
  }
  const double ei = kPrintedRubber.initial_modulus_pa() * inertia, moment = kHybridTensionN * kOffsetM;
  const auto add = [&](const std::string& what, const std::string& text, double value,
                       const std::string& remark) {
    table.rows.push_back({what, "", {{"", {}}, {"", {}}, {text, value}}, remark});
  };
  add("curvature by 3 N at 4 mm (1/m)", fmt::format("{:.0f}", moment / ei), moment / ei,
      fmt::format("0.012 N m / {:.2e} N m2", ei));
  add("turns of the arm", fmt::format("{:.1f}", moment / ei * kHybridLengthM / (2.0 * M_PI)),
      moment / ei * kHybridLengthM / (2.0 * M_PI), "no arm can");
  const double wanted = moment * kHybridLengthM / (0.5 * M_PI);
  add("EI for a quarter turn (N m2)", fmt::format("{:.2e}", wanted), wanted,
      fmt::format("if that is what 3 N is to make: E = {:.0f} kPa, {:.0f} times the printed",
                  wanted / inertia / 1e3, wanted / ei));
  table.notes = {
      "E(P) is taken at the stretch by the chamber's pull P A_ch on the wall; (19) has no bending, so E(P) "
      "cannot "
      "depend on it. Only the uniaxial law with its free sides gives Young's modulus at rest: the stress "
      "(24), (25) "
      "is free of trace, which makes E a third too low, and (26) leaves out a term of the derivative."};
  return table;
}

}  // namespace softarm::app::validate
