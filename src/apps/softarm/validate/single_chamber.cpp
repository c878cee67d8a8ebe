// "Toward Semi-autonomous Stiffness Adaptation of Pneumatic Soft Robots: Modeling and Validation" (slides):
// the comparison of model and experiment, and the stiffness surface.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "papers.h"
#include "published/published_single_chamber.h"

namespace softarm::app::validate {
namespace {

using published::ChamberLaw;
using published::ChamberSolution;
using published::SingleChamberArm;

constexpr double kDisplacementM = 0.015;
const Eigen::Vector3d kAcross = Eigen::Vector3d::UnitX();

/// A row of the slides' table.
struct Published {
  double pressure_pa, force_n;
  const char *model_mm, *stiffness;
};
constexpr std::array<Published, 4> kPublished{{{0.0, 0.051, "14.4", "3.4"},
                                               {4e3, 0.064, "14.3", "4.3"},
                                               {12e3, 0.073, "13.9", "4.9"},
                                               {20e3, 0.089, "13.7", "5.9"}}};

/// How far the force moves the tip along itself, m.
double displacement(const SingleChamberArm& arm, const Published& row, ChamberLaw law,
                    ChamberSolution solution) {
  const auto stiffness = published::tip_stiffness(arm, kAcross, row.force_n, row.pressure_pa, law, solution);
  return stiffness ? stiffness->displacement_m.dot(kAcross) : kNoValue;
}

/// E_o with which the published force moves the tip by the published 15 mm; by bisection of ln E.
double modulus_for(SingleChamberArm arm, const Published& row) {
  double low = std::log(1e5), high = std::log(1e7);
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    arm.modulus_pa = std::exp(middle);
    const double x = displacement(arm, row, ChamberLaw::kStatics, ChamberSolution::kBoundaryValue);
    // Too soft an arm has no solution within reach or moves too far.
    (std::isfinite(x) && x < kDisplacementM ? high : low) = middle;
  }
  return std::exp(0.5 * (low + high));
}

SingleChamberArm with_weight(SingleChamberArm arm) {
  arm.gravity_m_s2 = -kGravity * kAcross;  // level, the force against the weight
  return arm;
}

Table comparison() {
  const SingleChamberArm arm = published::slides_arm();
  Table table{"single_chamber.comparison",
              "Comparison of the model with experiments: constants as printed",
              {"boundary values", "initial values", "printed law, initial"},
              {},
              {}};
  for (const Published& row : kPublished) {
    const std::array<double, 3> x{
        displacement(arm, row, ChamberLaw::kStatics, ChamberSolution::kBoundaryValue),
        displacement(arm, row, ChamberLaw::kStatics, ChamberSolution::kInitialValue),
        displacement(arm, row, ChamberLaw::kPrinted, ChamberSolution::kInitialValue)};
    Row mm{fmt::format("{:.0f} kPa, {:.0f} mN: tip moves (mm)", row.pressure_pa / 1e3, 1e3 * row.force_n),
           fmt::format("{} (15 measured)", row.model_mm),
           {},
           ""};
    Row k{fmt::format("{:.0f} kPa: k (mN/mm)", row.pressure_pa / 1e3), row.stiffness, {}, ""};
    for (double value : x) {
      mm.ours.push_back(cell("{:.1f}", 1e3 * value));
      k.ours.push_back(cell("{:.2f}", row.force_n / value));
    }
    table.rows.push_back(mm);
    table.rows.push_back(k);
  }
  Row growth{"k at 20 kPa over k at 0 kPa", "1.74", {}, "same force, 51 mN"};
  const auto ratio = [&](ChamberLaw law, ChamberSolution solution) {
    Published at_20 = kPublished[3];
    at_20.force_n = kPublished[0].force_n;
    return displacement(arm, kPublished[0], law, solution) / displacement(arm, at_20, law, solution);
  };
  growth.ours = {cell("{:.3f}", ratio(ChamberLaw::kStatics, ChamberSolution::kBoundaryValue)),
                 cell("{:.3f}", ratio(ChamberLaw::kStatics, ChamberSolution::kInitialValue)),
                 cell("{:.3f}", ratio(ChamberLaw::kPrinted, ChamberSolution::kInitialValue))};
  table.rows.push_back(growth);
  table.notes = {
      "Boundary values: clamp at the base, force at the tip. Initial values: the slides' formulation, with "
      "n(0) "
      "and m(0) of the undeformed arm, without which the force would stand nowhere. Printed law: the term "
      "n' = - rho A g - P A e_3 taken at its word. k is force over displacement, as in the slides (51 / 15 = "
      "3.4). Without weight: the slides do not say which way the arm points."};
  return table;
}

Table chamber_arithmetic() {
  const SingleChamberArm arm = published::slides_arm();
  Table table{
      "single_chamber.arithmetic", "Why the printed constants cannot give these curves", {"ours"}, {}, {}};
  const double modulus = arm.material.initial_modulus_pa(), inertia = arm.section.second_moment_m4(),
               length3 = std::pow(arm.length_m, 3);
  const auto add = [&](const std::string& what, const char* published, Cell ours, const std::string& remark) {
    table.rows.push_back({what, published, {std::move(ours)}, remark});
  };
  add("E = 6 (c01 + c10) (kPa)", "", cell("{:.0f}", modulus / 1e3), "6 (277 - 209); Mooney-Rivlin at rest");
  add("EI (N m2)", "", cell("{:.3e}", modulus * inertia),
      fmt::format("I = pi/64 (12^4 - 3.5^4) = {:.1f} mm4", 1e12 * inertia));
  add("3 EI / L^3 (mN/mm)", "3.4", cell("{:.2f}", 3.0 * modulus * inertia / length3), "at 0 kPa");
  for (const Published& row : kPublished) {
    const double e = modulus_for(arm, row), weighted = modulus_for(with_weight(arm), row);
    add(fmt::format("E for {} mN/mm at {:.0f} kPa (kPa)", row.stiffness, row.pressure_pa / 1e3), "",
        cell("{:.0f}", e / 1e3),
        fmt::format("{:.2f} times the printed; EI {:.3e} N m2; level, lifted against its weight: {:.0f} kPa",
                    e / modulus, e * inertia, weighted / 1e3));
  }
  const auto at_20 = published::pressurise(arm, 20e3);
  if (at_20) {
    add("pull of 20 kPa on the wall, P A_ch (N)", "", cell("{:.3f}", 20e3 * arm.section.chamber_area_m2()),
        fmt::format("{:.2f} % of EA = {:.1f} N",
                    100.0 * 20e3 * arm.section.chamber_area_m2() / (modulus * arm.section.wall_area_m2()),
                    modulus * arm.section.wall_area_m2()));
    add("stretch at 20 kPa", "", cell("{:.4f}", at_20->stretch), "");
    add("tangent modulus at 20 kPa / at rest", "1.74", cell("{:.3f}", at_20->modulus_pa / modulus),
        "what the chamber's pull makes of Mooney-Rivlin rubber");
  }
  // What stretch would stiffen this rubber by 74 %.
  double stretch = 1.0, best = 1.0, best_stretch = 1.0;
  std::optional<double> wanted;
  for (; stretch < 4.0; stretch += 1e-4) {
    const double ratio = arm.material.tangent_modulus_pa(stretch) / modulus;
    if (ratio > best) {
      best = ratio;
      best_stretch = stretch;
    }
    if (ratio >= 1.74) {
      wanted = stretch;
      break;
    }
  }
  if (wanted) {
    add("stretch that stiffens it by 74 %", "", cell("{:.3f}", *wanted),
        fmt::format("a pressure of {:.0f} kPa would stretch the wall so far",
                    arm.material.nominal_stress_pa(*wanted) * arm.section.wall_area_m2() /
                        arm.section.chamber_area_m2() / 1e3));
  } else {
    add("largest stiffening of this rubber", "1.74", cell("{:.3f}", best),
        fmt::format("at a stretch of {:.3f}; no pressure stiffens it by 74 %", best_stretch));
  }
  return table;
}

/// The modulus that the slides' own stiffness asks for, between their pressures.
double fitted_modulus(const SingleChamberArm& arm, double pressure_pa) {
  for (std::size_t i = 1; i < kPublished.size(); ++i) {
    const Published &a = kPublished[i - 1], &b = kPublished[i];
    if (pressure_pa > b.pressure_pa) continue;
    const double share = (pressure_pa - a.pressure_pa) / (b.pressure_pa - a.pressure_pa);
    return (1.0 - share) * modulus_for(arm, a) + share * modulus_for(arm, b);
  }
  return modulus_for(arm, kPublished.back());
}

void surface(bool quick, Table& table, Series& series) {
  const SingleChamberArm arm = published::slides_arm();
  table = {"single_chamber.surface",
           "Stiffness surface: tangent k (mN/mm) over force and pressure",
           {"0 kPa", "4 kPa", "12 kPa", "20 kPa"},
           {},
           {}};
  series = {"single_chamber_surface",
            {"force_n", "pressure_pa", "printed_boundary", "printed_initial", "fitted_boundary"},
            {}};
  const int count = quick ? 4 : 10;
  std::vector<double> forces;
  for (int i = 0; i <= count; ++i) forces.push_back(0.09 * i / count);
  std::vector<double> pressures{0.0, 4e3, 8e3, 12e3, 16e3, 20e3};
  struct Kind {
    const char* name;
    bool fitted;
    ChamberSolution solution;
  };
  constexpr std::array<Kind, 3> kKinds{{{"printed, boundary", false, ChamberSolution::kBoundaryValue},
                                        {"printed, initial", false, ChamberSolution::kInitialValue},
                                        {"E of the table, boundary", true, ChamberSolution::kBoundaryValue}}};
  std::vector<std::vector<std::vector<double>>> k(kKinds.size());  // by kind, pressure, force
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
    for (double pressure : pressures) {
      SingleChamberArm one = arm;
      if (kKinds[kind].fitted) one.modulus_pa = fitted_modulus(arm, pressure);
      std::vector<double> row;
      for (double force : forces) {
        const auto s = published::tip_stiffness(one, kAcross, force, pressure, ChamberLaw::kStatics,
                                                kKinds[kind].solution);
        row.push_back(s ? s->tangent_n_m : kNoValue);
      }
      k[kind].push_back(row);
    }
  }
  for (std::size_t p = 0; p < pressures.size(); ++p)
    for (std::size_t f = 0; f < forces.size(); ++f)
      series.rows.push_back({forces[f], pressures[p], k[0][p][f], k[1][p][f], k[2][p][f]});
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
    for (const std::size_t f : {std::size_t{0}, forces.size() / 2, forces.size() - 1}) {
      Row row{fmt::format("{}: {:.0f} mN", kKinds[kind].name, 1e3 * forces[f]), "", {}, ""};
      for (const std::size_t p : {0, 1, 3, 5}) row.ours.push_back(cell("{:.2f}", k[kind][p][f]));
      table.rows.push_back(row);
    }
  }
  table.notes = {
      "The slides show the surface without numbers. k is d|F| / d|displacement of the tip|, the displacement "
      "from "
      "the tip at no force (their d|p(L)| hardly changes with a small force across the arm)."};
}

}  // namespace

Result single_chamber(const Settings& settings, Progress& progress) {
  progress.line("single_chamber: boundary-value and initial-value problems");
  Result result{"single_chamber",
                "Toward Semi-autonomous Stiffness Adaptation of Pneumatic Soft Robots (slides)",
                {comparison(), chamber_arithmetic()},
                {}};
  Table table;
  Series series;
  surface(settings.quick, table, series);
  result.tables.push_back(table);
  result.series.push_back(series);
  progress.advance(kSingleChamber_s, 0);
  return result;
}

}  // namespace softarm::app::validate
