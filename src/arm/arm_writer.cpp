#include "arm_writer.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

#include "actuators/actuator.h"
#include "effect_correlations.h"
#include "softarm/arm/arm_file.h"
#include "yaml_editor.h"

namespace softarm::arm {
namespace {

using yaml::Editor;
using yaml::Path;

constexpr const char* kHeader = "# softarm ";
constexpr const char* kPrograms[] = {"identify", "diagnose"};
constexpr double kSame = 1e-9;  // relative: what nine digits hold

bool same(double a, double b) {
  return std::abs(a - b) <= kSame * std::max(std::abs(a), std::abs(b));
}

std::string number(double value) {
  return fmt::format("{:.10g}", value);
}

void visit_elements(const std::vector<WallElement>& read, const std::vector<WallElement>& wanted,
                    const Path& at, const VisitNumber& visit) {
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    visit({at / k / "time_s", read[k].time_s, wanted[k].time_s});
    visit({at / k / "share", read[k].share, wanted[k].share});
  }
}

void visit_segment(const Segment& read, const Segment& wanted, const Path& at, const VisitNumber& visit) {
  visit({at / "length_m", read.length_m, wanted.length_m});
  visit({at / "mass_per_length_kg_m", read.mass_per_length_kg_m, wanted.mass_per_length_kg_m});
  visit({at / "bending_stiffness" / "base_nm2", read.bending_stiffness.base_nm2,
         wanted.bending_stiffness.base_nm2});
  if (read.axial_stiffness_n && wanted.axial_stiffness_n)
    visit({at / "axial_stiffness_n", *read.axial_stiffness_n, *wanted.axial_stiffness_n});
  visit({at / "joint_compliance_rad_per_nm", read.joint_compliance_rad_per_nm.value_or(0.0),
         wanted.joint_compliance_rad_per_nm.value_or(0.0)});
  visit_elements(read.wall.bending, wanted.wall.bending, at / "wall" / "bending", visit);
  visit_elements(read.wall.axial, wanted.wall.axial, at / "wall" / "axial", visit);
  visit({at / "wall" / "slows_per_pa", read.wall.slows_per_pa.value_or(0.0),
         wanted.wall.slows_per_pa.value_or(0.0)});
  visit({at / "wall" / "shares_grow_per_pa", read.wall.shares_grow_per_pa.value_or(0.0),
         wanted.wall.shares_grow_per_pa.value_or(0.0)});
  if (wanted.wall.lag_s)
    visit({at / "wall" / "lag_s", read.wall.lag_s.value_or(Wall::kUsualLag_s), *wanted.wall.lag_s});
  for (const ActuatorKind* kind : actuator_kinds()) kind->visit_numbers(read, wanted, at, visit);
}

/// Visits every constant that may be written: its path, its value as read, its value as wanted.
void visit_constants(const Arm& read, const Arm& wanted, const VisitNumber& visit) {
  for (std::size_t i = 0; i < wanted.segments.size(); ++i)
    visit_segment(read.segments[i], wanted.segments[i], Path{"segments", i}, visit);
  for (std::size_t k = 0; k < wanted.bodies.size(); ++k)
    visit({Path{"bodies", k, "arclength_m"}, read.bodies[k].arclength_m, wanted.bodies[k].arclength_m});
  visit({Path{"payload", "arclength_m"}, read.payload.arclength_m, wanted.payload.arclength_m});
  const LawPrior &p = read.estimator.prior, &q = wanted.estimator.prior;
  const auto prior = [&](const char* key, double a, double b) {
    visit({Path{"estimator", "prior", key}, a, b});
  };
  prior("moment_sd_nm", p.moment_sd_nm, q.moment_sd_nm);
  prior("moment_sd_rel", p.moment_sd_rel, q.moment_sd_rel);
  prior("bending_stiffness_sd_rel", p.bending_stiffness_sd_rel, q.bending_stiffness_sd_rel);
  prior("length_sd_m", p.length_sd_m, q.length_sd_m);
  prior("axial_stiffness_sd_rel", p.axial_stiffness_sd_rel, q.axial_stiffness_sd_rel);
  prior("moment_jitter_sd_nm", p.moment_jitter_sd_nm, q.moment_jitter_sd_nm);
  prior("length_jitter_sd_m", p.length_jitter_sd_m, q.length_jitter_sd_m);
}

void write_number(Editor& editor, const WrittenNumber& constant) {
  if (!constant.or_path.empty() && editor.has(constant.or_path)) {
    if (!same(constant.or_factor, 1.0)) editor.scale(constant.or_path, constant.or_factor);
  } else if (!same(constant.before, constant.after)) {
    editor.set(constant.path, number(constant.after));
  }
}

void set_rest_curvature(Editor& editor, std::size_t segment, const Eigen::Vector3d& before,
                        const Eigen::Vector3d& after) {
  const Path path{"segments", segment, "rest_curvature_per_m"};
  if (!editor.has(path)) {
    if (!(before - after).isZero(0.0))
      editor.set(path, fmt::format("[{}, {}, {}]", number(after[0]), number(after[1]), number(after[2])));
    return;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    if (same(before[axis], after[axis])) continue;
    Path element = path;
    element.emplace_back(k);
    editor.set(element, number(after[axis]));
  }
}

bool same_structure(const Arm& a, const Arm& b) {
  if (a.segments.size() != b.segments.size() || a.bodies.size() != b.bodies.size()) return false;
  for (std::size_t i = 0; i < a.segments.size(); ++i) {
    const Segment &x = a.segments[i], &y = b.segments[i];
    if (x.bending_stiffness.by_pressure.size() != y.bending_stiffness.by_pressure.size()) return false;
    if (x.wall.bending.size() != y.wall.bending.size() || x.wall.axial.size() != y.wall.axial.size())
      return false;
    for (const ActuatorKind* kind : actuator_kinds()) {
      if (kind->count(x) != kind->count(y)) return false;
    }
  }
  return true;
}

/// Without the header of an earlier identification or diagnosis.
std::string without_header(std::string text) {
  const auto begins = [&text](const char* program) {
    return text.rfind(kHeader + std::string(program) + ": ", 0) == 0;
  };
  while (begins(kPrograms[0]) || begins(kPrograms[1])) {
    const std::size_t end = text.find('\n');
    if (end == std::string::npos) return "";
    text.erase(0, end + 1);
  }
  return text;
}

bool same_effects(const std::vector<EffectEntry>& a, const std::vector<EffectEntry>& b) {
  const auto same_correlation = [](const EffectCorrelation& x, const EffectCorrelation& y) {
    return x.entry == y.entry && x.number == y.number && same(x.value, y.value);
  };
  const auto same_number = [&](const EffectNumber& x, const EffectNumber& y) {
    return x.name == y.name && same(x.value, y.value) && x.sd.has_value() == y.sd.has_value() &&
           (!x.sd || same(*x.sd, *y.sd)) &&
           std::equal(x.correlations.begin(), x.correlations.end(), y.correlations.begin(),
                      y.correlations.end(), same_correlation);
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](const EffectEntry& x, const EffectEntry& y) {
    return x.id == y.id &&
           std::equal(x.numbers.begin(), x.numbers.end(), y.numbers.begin(), y.numbers.end(), same_number);
  });
}

/// A row per number that has some.
std::string correlations_of(const std::vector<EffectEntry>& effects) {
  std::string rows;
  for (std::size_t e = 0; e < effects.size(); ++e) {
    for (const EffectNumber& n : effects[e].numbers) {
      std::string with;
      for (const EffectCorrelation& c : n.correlations)
        with +=
            (with.empty() ? "" : ", ") + name_in_file(effects, c.entry, c.number) + ": " + number(c.value);
      if (!with.empty())
        rows += fmt::format("  - {{of: {}, with: {{{}}}}}\n", name_in_file(effects, e, n.name), with);
    }
  }
  return rows.empty() ? "" : "effects_correlations:  # of the errors of parameters with an sd\n" + rows;
}

std::string section_of(const std::vector<EffectEntry>& effects, const std::optional<std::string>& verdict) {
  if (effects.empty()) return "";
  std::string text =
      verdict ? fmt::format("effects_verdict: {}  # of the diagnosis that found them\n", *verdict) : "";
  text += "effects:  # beside the laws; what they are: softarm diagnose --effects\n";
  for (const EffectEntry& effect : effects) {
    std::string values, sds, held;
    for (const EffectNumber& n : effect.numbers) {
      values += (values.empty() ? "" : ", ") + n.name + ": " + number(n.value);
      if (n.sd) sds += (sds.empty() ? "" : ", ") + n.name + ": " + number(*n.sd);
      if (!n.fitted) held += (held.empty() ? "  # not fitted: " : ", ") + n.name;
    }
    text += fmt::format("  - id: {}\n    parameters: {{{}}}{}\n", effect.id, values, held);
    if (!sds.empty()) text += fmt::format("    sd: {{{}}}\n", sds);
  }
  return text + correlations_of(effects);
}

/// The text without one of its topmost keys.
std::string without_key(std::string text, const std::string& key) {
  const YAML::Node root = YAML::Load(text);
  std::size_t from = text.size(), to = text.size();
  for (const auto& entry : root) {
    const auto at = static_cast<std::size_t>(entry.first.Mark().pos);
    if (entry.first.Scalar() == key) from = at;
    if (at > from) to = std::min(to, at);
  }
  return text.erase(from, to - from);
}

/// The text with other sections of effects, at its end.
std::string with_effects(std::string text, const std::vector<EffectEntry>& effects,
                         const std::optional<std::string>& verdict) {
  for (const char* key : {"effects", "effects_verdict", "effects_correlations"})
    text = without_key(std::move(text), key);
  if (!text.empty() && text.back() != '\n') text += '\n';
  return text + section_of(effects, verdict);
}

}  // namespace

std::string update_arm_text(const std::string& text, const std::string& source, const Arm& arm,
                            const std::vector<std::string>& header) {
  return update_arm_text(text, source, arm, parse_effect_entries(text, source), header, "identify");
}

std::string update_arm_text(const std::string& text, const std::string& source, const Arm& arm,
                            const std::vector<EffectEntry>& effects, const std::vector<std::string>& header,
                            const std::string& program, const std::optional<std::string>& verdict) {
  const Arm read = parse_arm(text, source);
  correlated_numbers(effects);  // before they are written: they may be from anywhere
  if (!same_structure(read, arm))
    throw ArmError(source + ": describes another arm than the one to be written");
  Editor editor(without_header(text), source);
  visit_constants(read, arm, [&](const WrittenNumber& constant) {
    const auto* key = std::get_if<std::string>(&constant.path.back());
    // What sits at the tip is said to, and stays there.
    const bool at_tip = key != nullptr && *key == "arclength_m" &&
                        same(constant.after, arm.total_length_m()) &&
                        same(constant.before, read.total_length_m());
    if (!at_tip) write_number(editor, constant);
  });
  for (std::size_t i = 0; i < arm.segments.size(); ++i)
    set_rest_curvature(editor, i, read.segments[i].rest_curvature_per_m,
                       arm.segments[i].rest_curvature_per_m);
  if (read.estimator.prior.enabled != arm.estimator.prior.enabled)
    editor.set({"estimator", "prior", "enabled"}, arm.estimator.prior.enabled ? "true" : "false");

  std::string written;
  for (const std::string& line : header) written += kHeader + program + ": " + line + "\n";
  const std::optional<std::string> before = parse_effects_verdict(text, source);
  const bool same_verdict = !verdict || verdict == before;
  written += same_verdict && same_effects(parse_effect_entries(text, source), effects)
                 ? editor.text()
                 : with_effects(editor.text(), effects, verdict ? verdict : before);
  // An alias would have changed another value too.
  const Arm again = parse_arm(written, source);
  if (!same_effects(parse_effect_entries(written, source), effects))
    throw ArmError(source +
                   ": the section 'effects' cannot be replaced; write the file as a block, not in braces");
  visit_constants(again, arm, [&](const WrittenNumber& constant) {
    const double a = constant.before, b = constant.after;
    if (!(std::abs(a - b) <= 10.0 * kSame * std::max(std::abs(a), std::abs(b))))
      throw ArmError(fmt::format("{}: {} cannot be replaced by {} alone; write out aliases", source, a, b));
  });
  return written;
}

}  // namespace softarm::arm
