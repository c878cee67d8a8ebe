#include "advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace softarm::identify {
namespace {

constexpr double kPartThatCounts = 0.2;  // of a direction of unit norm
constexpr double kStrongCorrelation = 0.9;

// As on the command line; with every EI and its growth held, gains and saturation are those of the ratio.
constexpr const char* kHoldStiffness =
    "; or hold EI and fit moment over stiffness: --hold '*.bending_stiffness.*'";

bool is_gain(ConstantKind kind) {
  return role_of(kind) == ConstantRole::kMoment;
}

/// Of the moment: its gain, and how it falls behind its input.
bool is_actuation(ConstantKind kind) {
  return is_gain(kind) || role_of(kind) == ConstantRole::kSaturation;
}

bool is_stiffness(ConstantKind kind) {
  const ConstantRole role = role_of(kind);
  return role == ConstantRole::kBendingStiffness || role == ConstantRole::kBendingStiffnessSlope;
}

/// At a limit that the truth is unlikely to lie at.
bool refused(const Constant& c) {
  return c.at_bound && !c.kept && !is_none(c);
}

std::string list_of(const Combination& combination) {
  std::string names;
  for (const auto& part : combination.parts) names += (names.empty() ? "" : ", ") + part.first;
  return names;
}

/// Of each member of a combination: what it and another member, whose inputs always go together with its own,
/// both lack; empty where there is no such member.
std::vector<std::string> lacks_of_pairs(const Conditions& conditions, const Result& result,
                                        const std::vector<int>& members) {
  const auto ref = [&](std::size_t m) -> const ConstantRef& {
    return result.constants[static_cast<std::size_t>(members[m])].ref;
  };
  std::vector<std::string> lacks(members.size());
  for (std::size_t a = 0; a < members.size(); ++a) {
    for (std::size_t b = 0; b < members.size() && lacks[a].empty(); ++b) {
      if (a != b && conditions.driven_alike(ref(a), ref(b)))
        lacks[a] = conditions.advice_of_pair(ref(a), ref(b));
    }
  }
  return lacks;
}

/// @param lack of its largest part; @param of_pair whether another part lacks the same
std::string sentence_of(const Combination& combination, const Constant& largest, bool gains_and_stiffness,
                        const std::string& lack, bool of_pair) {
  if (combination.parts.size() == 1) return largest.name + " is not determined: " + lack;
  if (of_pair) return list_of(combination) + " cannot be separated: " + lack;
  return fmt::format("{} can change together and no trial would show it{}: {}", list_of(combination),
                     gains_and_stiffness ? " (only moment over stiffness shows)" : "", lack);
}

/// Tells the members of a combination what they lack, and whom they are mistaken for.
/// @param ratio whether moments and stiffness are among them
void advise_members(const Conditions& conditions, const std::vector<int>& members,
                    const std::vector<std::string>& lacks, bool ratio, Result& result) {
  const auto constant = [&](int j) -> Constant& { return result.constants[static_cast<std::size_t>(j)]; };
  for (std::size_t m = 0; m < members.size(); ++m) {
    const int j = members[m];
    Constant& c = constant(j);
    if (c.determined) continue;
    // Each by its own conditions: those of the combination's largest part are of another input, or law.
    if (c.advice.empty() && lacks[m].empty() && ratio &&
        (is_actuation(c.ref.kind) || is_stiffness(c.ref.kind)))
      c.advice = conditions.load_advice() + kHoldStiffness;
    if (c.advice.empty()) c.advice = lacks[m].empty() ? conditions.advice(c.ref) : lacks[m];
    for (const int k : members) {
      const auto known = std::find_if(c.confused_with.begin(), c.confused_with.end(),
                                      [&](const auto& other) { return other.first == constant(k).name; });
      if (k != j && known == c.confused_with.end())
        c.confused_with.emplace_back(constant(k).name, result.correlation(j, k));
    }
  }
}

/// A direction in which the constants, in units of their own final scales, may be off by more than is
/// allowed.
/// @param v of length 1
void add_combination(const Conditions& conditions, const Eigen::VectorXd& v, double relative_sd,
                     Result& result) {
  const auto constant = [&](int j) -> Constant& { return result.constants[static_cast<std::size_t>(j)]; };
  std::vector<int> members;
  for (int j = 0; j < static_cast<int>(v.size()); ++j) {
    if (std::abs(v[j]) >= kPartThatCounts) members.push_back(j);
  }
  std::sort(members.begin(), members.end(), [&](int a, int b) { return std::abs(v[a]) > std::abs(v[b]); });
  Combination combination;
  combination.relative_sd = relative_sd;
  bool gains = false, stiffness = false;
  const double sign = v[members.front()] < 0.0 ? -1.0 : 1.0;
  for (const int j : members) {
    combination.parts.emplace_back(constant(j).name, sign * v[j]);
    gains = gains || is_actuation(constant(j).ref.kind);
    stiffness = stiffness || is_stiffness(constant(j).ref.kind);
  }
  const std::vector<std::string> lacks = lacks_of_pairs(conditions, result, members);
  const Constant& largest = constant(members.front());
  const bool of_pair = !lacks.front().empty();
  const bool ratio = gains && stiffness;
  const std::string own = ratio ? conditions.load_advice() + kHoldStiffness : conditions.advice(largest.ref);
  combination.sentence = sentence_of(combination, largest, ratio, of_pair ? lacks.front() : own, of_pair);
  advise_members(conditions, members, lacks, ratio, result);
  result.undetermined.push_back(std::move(combination));
}

/// What is still to be said of a constant.
void advise(const Conditions& conditions, Constant& c) {
  if (c.kept && !c.at_bound) {
    const bool of_bending = role_of(c.ref.kind) == ConstantRole::kBendingStiffness;
    c.advice = fmt::format(
        "the trials do not determine it: kept at {:g} as in the arm file, and the rest fitted to that; {}",
        c.value, of_bending ? conditions.load_advice() + kHoldStiffness : conditions.advice(c.ref));
  } else if (c.kept) {
    c.advice = fmt::format("ran to {:g} {}; kept at {:g} as in the arm file; {}", c.ran_to, c.unit, c.value,
                           conditions.advice(c.ref));
  } else if (refused(c)) {
    c.advice =
        fmt::format("the fit ran into the limit of what an arm may have, {:g} {}; check {}", c.value, c.unit,
                    is_gain(c.ref.kind) ? "the bending direction and which input feeds it"
                                        : "the arm's other values and the trials");
  } else if (!c.determined && c.advice.empty()) {
    c.advice = conditions.advice(c.ref);
  }
}

}  // namespace

bool is_none(const Constant& c) {
  const ConstantRole role = role_of(c.ref.kind);
  const bool may_be_none = role == ConstantRole::kBendingStiffnessSlope ||
                           role == ConstantRole::kSaturation || role == ConstantRole::kJoint ||
                           role == ConstantRole::kWall;
  return may_be_none && c.value <= 1e-6 * c.scale;
}

void judge(const arm::Arm& arm, const std::vector<trial::StaticFrame>& frames, const Uncertainty& uncertainty,
           const Eigen::VectorXd& scale, double determined_sd, bool near_buckling, Result& result) {
  const Conditions conditions(arm, frames);
  const int count = static_cast<int>(result.constants.size());
  const auto constant = [&](int j) -> Constant& { return result.constants[static_cast<std::size_t>(j)]; };
  for (int j = 0; j < count; ++j) {
    Constant& c = constant(j);
    c.determined = c.sd <= determined_sd * c.scale && !refused(c) && !c.kept;
    if (c.determined && near_buckling && !conditions.load_varies() &&
        role_of(c.ref.kind) == ConstantRole::kBendingStiffness) {
      c.determined = false;
      c.advice = std::string(
                     "the arm is near its buckling load, and no other load determines EI: the fit finds the "
                     "EI that goes with that load, whatever the arm's is; ") +
                 conditions.load_advice() + kHoldStiffness;
    }
    for (int k = 0; k < count; ++k) {
      if (k != j && std::abs(result.correlation(j, k)) >= kStrongCorrelation)
        c.confused_with.emplace_back(constant(k).name, result.correlation(j, k));
    }
  }
  for (int i = 0; i < count; ++i) {
    Eigen::VectorXd v = uncertainty.directions.col(i) * uncertainty.direction_sd[i];
    for (int j = 0; j < count; ++j) v[j] *= scale[j] / constant(j).scale;
    const double sd = v.norm();
    if (sd > determined_sd) add_combination(conditions, v / sd, sd, result);
  }
  for (Constant& c : result.constants) advise(conditions, c);
  const auto told = [](const Constant& c) {
    return c.determined && role_of(c.ref.kind) == ConstantRole::kBendingStiffness;
  };
  const auto loaded = [](const trial::StaticFrame& frame) { return frame.payload_kg > 0.0; };
  if (std::any_of(result.constants.begin(), result.constants.end(), told) &&
      std::none_of(frames.begin(), frames.end(), loaded))
    result.warnings.emplace_back(
        "no payload is attached to the arm: its own weight alone determines EI, which goes with the mass "
        "that the arm file states (10 % more mass makes EI and all gains 10 % higher)");
}

}  // namespace softarm::identify
