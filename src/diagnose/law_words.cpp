#include "law_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "effects/catalogue.h"
#include "effects/learned_moment.h"
#include "policy.h"
#include "sentences.h"

namespace softarm::diagnose {
namespace {

using effects::LearnedMoment;
using effects::Regressor;

constexpr double kDegPerRad = 180.0 / M_PI;

std::string input_name(const arm::Arm& arm, double number) {
  const auto row = static_cast<std::size_t>(std::max<long>(0, std::lround(number) - 1));
  return row < arm.inputs.scalars.size() ? arm.inputs.scalars[row].name : "an input";
}

/// After the point, of a moment in mN m.
int digits_of(double mnm) {
  return std::abs(mnm) < 1.0 ? 3 : std::abs(mnm) < 10.0 ? 2 : std::abs(mnm) < 100.0 ? 1 : 0;
}

/// "1.2e-04 N m" would be right, too; people read mN m.
std::string moment(double moment_nm) {
  const double mnm = 1e3 * moment_nm;
  return fmt::format("{:.{}f} mN m", mnm, digits_of(mnm));
}

/// The end of the range that is farther from 0: there a term has its sizes.
double far_end(const LawTerm& term) {
  return std::abs(term.to) >= std::abs(term.from) ? term.to : term.from;
}

std::string sentence_of(const LawTerm& term, double azimuth_rad) {
  const double x_nm = term.x_nm.value, y_nm = term.y_nm.value;
  const double far = far_end(term);
  std::string text = "A moment that goes with " + term.goes_with + ": ";
  if (term.has_direction)
    text += fmt::format("{} along it and {} across it", moment(x_nm), moment(y_nm));
  else
    text += fmt::format("{} towards {:.0f} deg", moment(std::hypot(x_nm, y_nm)), kDegPerRad * azimuth_rad);
  text += fmt::format(" at {}, ", with_unit(far, term.unit));
  text += term.rises ? "at the tip, decreasing to the opposite at the base" : "the same all along the arm";
  return text + fmt::format("; learnt between {} and {}, beyond which it fades",
                            with_unit(term.from, term.unit), with_unit(term.to, term.unit));
}

// --- As an equation --------------------------------------------------------------------------------------

constexpr const char* kTendons =
    "tendons of a rod: D. C. Rucker, R. J. Webster, IEEE Trans. Robotics 27, 2011, "
    "doi:10.1109/TRO.2011.2160469";
constexpr const char* kProducts =
    "products as candidates of a law: S. L. Brunton, J. L. Proctor, J. N. Kutz, Proc. Natl. Acad. Sci. USA "
    "113, 2016, doi:10.1073/pnas.1517384113";

/// What a moment is in proportion to.
struct Form {
  std::string z, symbols;  ///< "u^2", "u: chamber_2"
  std::string source;      ///< of laws in which that stands
};

std::string cited_by(const char* effect) {
  const model::Effect* found = effects::find(effect);
  return found ? found->info().source : "";
}

std::optional<arm::InputKind> kind_of(const arm::Arm& arm, double number) {
  const auto row = static_cast<std::size_t>(std::max<long>(0, std::lround(number) - 1));
  if (row >= arm.inputs.scalars.size()) return std::nullopt;
  return arm.inputs.scalars[row].kind;
}

Form form_of_product(const arm::Arm& arm, const model::Values& values) {
  const std::string first = input_name(arm, values[LearnedMoment::kFirst]),
                    second = input_name(arm, values[LearnedMoment::kSecond]);
  const auto a = kind_of(arm, values[LearnedMoment::kFirst]),
             b = kind_of(arm, values[LearnedMoment::kSecond]);
  const bool pressures = a == arm::InputKind::kPressure && b == a;
  if (first == second) return {"u^2", "u: " + first, pressures ? cited_by("gain_nonlinearity") : kProducts};
  // How far a core is jammed changes what a chamber does.
  const bool jammed = (a == arm::InputKind::kPressure && b == arm::InputKind::kVacuum) ||
                      (a == arm::InputKind::kVacuum && b == arm::InputKind::kPressure);
  return {"u v", "u: " + first + "; v: " + second,
          pressures ? cited_by("chamber_bulge")
          : jammed  ? cited_by("vacuum_gain")
                    : kProducts};
}

Form form_of(const arm::Arm& arm, const model::Values& values) {
  const std::string input = "u: " + input_name(arm, values[LearnedMoment::kFirst]);
  const auto kind = kind_of(arm, values[LearnedMoment::kFirst]);
  const double scale = values[LearnedMoment::kScale];
  const auto follows = [&](const char* what) {
    return fmt::format("; w follows it: {} dw/dt = {} - w", with_unit(scale, "s"), what);
  };
  switch (LearnedMoment::of(values)) {
    case Regressor::kInput:
      return {"u", input,
              kind == arm::InputKind::kPressure ? cited_by("chamber_mismatch")
              : kind == arm::InputKind::kVacuum ? cited_by("vacuum_gain")
                                                : kTendons};
    case Regressor::kProduct:
      return form_of_product(arm, values);
    case Regressor::kPlay:
      return {"(u - P[u])", input + "; P: a play of " + with_unit(scale, LearnedMoment::unit_of(arm, values)),
              cited_by("hysteresis")};
    case Regressor::kLag:
      return {"(u - w)", input + follows("u"),
              cited_by(kind == arm::InputKind::kPressure ? "pressure_lag" : "creep")};
    case Regressor::kPayload:
      return {"m_p", "m_p: the payload", cited_by("tip_mass")};  // m and g alone are units
    case Regressor::kAttitude:
      return {"g_xy", "g_xy: gravity across the base", cited_by("gravity_direction")};
    case Regressor::kDriveLag:
      return {"(d - w)", "d: the actuation's moment" + follows("d"), cited_by("creep")};
    case Regressor::kCurvatureLag:
      return {"(k - w)", "k: the curvature" + follows("k"), cited_by("creep")};
    case Regressor::kCurvature:
      break;
  }
  return {"k", "k: the curvature", cited_by("stiffness_taper")};
}

/// Puts in the equation, its letters and its source; sizes and range are there.
void write_equation(const Form& form, LawTerm& term) {
  double x = 1e3 * term.x_nm.value, y = 1e3 * term.y_nm.value;
  const int digits = digits_of(std::hypot(x, y));
  for (double* size : {&x, &y})  // what rounds to nothing has no sign
    *size = std::round(*size * std::pow(10.0, digits)) / std::pow(10.0, digits) + 0.0;
  term.law = term.has_direction ? fmt::format("M = ({:.{}f} {} {} {:.{}f} R {}) mN m", x, digits, form.z,
                                              y < 0.0 ? "-" : "+", std::abs(y), digits, form.z)
                                : fmt::format("M = ({:.{}f}, {:.{}f}) mN m {}", x, digits, y, digits, form.z);
  term.law += fmt::format(" / ({})", with_unit(far_end(term), term.unit));
  if (term.rises) term.law += " (2 s / L - 1)";
  term.symbols = form.symbols + (term.has_direction ? "; R: a quarter turn about the arm's axis" : "");
  term.source = form.source;
}

}  // namespace

std::string goes_with(const arm::Arm& arm, const model::Values& values) {
  const std::string first = input_name(arm, values[LearnedMoment::kFirst]);
  const double scale = values[LearnedMoment::kScale];
  const std::string follows = " minus its first-order lag of " + with_unit(scale, "s");
  switch (LearnedMoment::of(values)) {
    case Regressor::kInput:
      return first;
    case Regressor::kProduct: {
      const std::string second = input_name(arm, values[LearnedMoment::kSecond]);
      return first == second ? "the square of " + first : first + " times " + second;
    }
    case Regressor::kPlay: {
      model::Values of_input = values;
      of_input[LearnedMoment::kOf] = static_cast<double>(Regressor::kInput);
      return fmt::format("how far a play of {} lags behind {}",
                         with_unit(scale, LearnedMoment::unit_of(arm, of_input)), first);
    }
    case Regressor::kLag:
      return first + follows;
    case Regressor::kPayload:
      return "the payload";
    case Regressor::kAttitude:
      return "gravity across the base";
    case Regressor::kDriveLag:
      return "the actuation's moment" + follows;
    case Regressor::kCurvatureLag:
      return "the curvature" + follows;
    case Regressor::kCurvature:
      break;
  }
  return "the curvature";
}

LawTerm law_term(const arm::Arm& arm, const model::Values& values, const Eigen::Vector2d& sd_nm,
                 double stability) {
  LawTerm term;
  term.goes_with = goes_with(arm, values);
  term.unit = LearnedMoment::unit_of(arm, values);
  term.from = values[LearnedMoment::kFrom];
  term.to = values[LearnedMoment::kTo];
  term.has_direction = LearnedMoment::is_vector(LearnedMoment::of(values));
  term.rises = std::lround(values[LearnedMoment::kRising]) == 1;
  term.stability = stability;
  // The law's sizes are those at +z_max; said are those at the far end.
  const double sign = std::abs(term.to) >= std::abs(term.from) || term.has_direction ? 1.0 : -1.0;
  const auto size = [&](LearnedMoment::Index which, EffectValue& to) {
    const model::Parameter& parameter = effects::learned_moment().info().parameters[which];
    const double value = sign * values[which], half = kPolicy.words.interval_sd * sd_nm[which];
    to = {parameter.symbol, parameter.unit, parameter.description, value, value - half, value + half};
  };
  size(LearnedMoment::kX, term.x_nm);
  size(LearnedMoment::kY, term.y_nm);
  write_equation(form_of(arm, values), term);
  term.sentence = sentence_of(term, std::atan2(term.y_nm.value, term.x_nm.value)) + ".";
  return term;
}

std::string sentence_of(const DiscoveredLaw& law) {
  std::vector<std::string> names;
  for (const LawTerm& term : law.terms) names.push_back(term.goes_with);
  std::string text = "What no effect of the catalogue explains ";
  if (law.terms.size() == 1) {
    text += "is a" + law.terms[0].sentence.substr(1);
  } else {
    text += "goes with " + one_of(names, "and") + ".";
    for (const LawTerm& term : law.terms) text += " " + term.sentence;
  }
  const double flexible = law.share_of_flexible.value_or(1.0);
  const std::string of_flexible = flexible < 1.0
                                      ? percent(flexible) + " of what a flexible model learns from it"
                                      : std::string("no less than a flexible model learns from it");
  text += fmt::format(
      " {} {} of what was left beyond the noise, {}: on input sequences that were not fitted, the mean error "
      "{}.",
      law.terms.size() > 1 ? "Together they account for" : "It accounts for", percent(law.share), of_flexible,
      change(law.held_out_mean_before_m, law.held_out_mean_after_m));
  if (!law.resembles.empty())
    text += fmt::format(" Its shape resembles that of {} ({:.0f} %).", law.resembles, 100.0 * law.cosine);
  return text;
}

}  // namespace softarm::diagnose
