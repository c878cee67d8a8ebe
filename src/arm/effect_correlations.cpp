#include "effect_correlations.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "math/linear_algebra.h"

namespace softarm::arm {
namespace {

constexpr double kNoNegativeVariance =
    1e-9;                           // of numbers with a standard deviation of 1: one below 0 by less
constexpr double kTakesPart = 0.2;  // in a mixture of numbers, of its length
constexpr std::size_t kMostCorrelated = 100;  // numbers: more than effects have that are found together

/// One correlation, as it is said.
struct SaidOfPair {
  EffectNumberAt first, second;  ///< in the order of the file
  const EffectCorrelation* said;
};

[[noreturn]] void refuse_correlation(const EffectCorrelation& said, const std::string& problem) {
  throw ArmError(
      fmt::format("{}key 'effects_correlations': {}", said.place.empty() ? "" : said.place + ": ", problem));
}

std::string name_of_number(const std::vector<EffectEntry>& entries, const EffectNumberAt& at) {
  return name_in_file(entries, at.entry, entries[at.entry].numbers[at.number].name);
}

bool is_uncertain(const EffectNumber& number) {
  return number.sd && *number.sd > 0.0;
}

/// The other number of a correlation.
EffectNumberAt other_of(const std::vector<EffectEntry>& entries, const EffectCorrelation& said) {
  if (said.entry >= entries.size())
    refuse_correlation(said, fmt::format("there are {} effects, and no number {} of a further one",
                                         entries.size(), said.number));
  const std::vector<EffectNumber>& numbers = entries[said.entry].numbers;
  const auto found = std::find_if(numbers.begin(), numbers.end(),
                                  [&](const EffectNumber& number) { return number.name == said.number; });
  if (found == numbers.end() || !is_uncertain(*found))
    refuse_correlation(said, fmt::format("{} is no parameter with a standard deviation (sd)",
                                         name_in_file(entries, said.entry, said.number)));
  return {said.entry, static_cast<std::size_t>(found - numbers.begin())};
}

SaidOfPair pair_of(const std::vector<EffectEntry>& entries, const EffectNumberAt& of,
                   const EffectCorrelation& said) {
  const EffectNumberAt with = other_of(entries, said);
  const auto refuse_for = [&](const std::string& problem) {
    refuse_correlation(said, name_of_number(entries, of) + problem);
  };
  if (!is_uncertain(entries[of.entry].numbers[of.number]))
    refuse_for(" is no parameter with a standard deviation (sd)");
  if (!(of < with) && !(with < of)) refuse_for(" is correlated with itself");
  if (!(std::abs(said.value) <= 1.0))
    refuse_for(fmt::format(" with {}: value {} is outside the allowed range [-1, 1]",
                           name_of_number(entries, with), said.value));
  return {std::min(of, with), std::max(of, with), &said};
}

/// All pairs, in the order of the file.
std::vector<SaidOfPair> all_pairs(const std::vector<EffectEntry>& entries) {
  std::vector<SaidOfPair> pairs;
  for (std::size_t e = 0; e < entries.size(); ++e) {
    for (std::size_t n = 0; n < entries[e].numbers.size(); ++n) {
      for (const EffectCorrelation& said : entries[e].numbers[n].correlations)
        pairs.push_back(pair_of(entries, {e, n}, said));
    }
  }
  const auto before = [](const SaidOfPair& a, const SaidOfPair& b) {
    return a.first < b.first || (!(b.first < a.first) && a.second < b.second);
  };
  std::stable_sort(pairs.begin(), pairs.end(), before);
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    if (!before(pairs[i - 1], pairs[i]))
      refuse_correlation(*pairs[i].said, fmt::format("{} with {} is given twice; each pair stands once",
                                                     name_of_number(entries, pairs[i].first),
                                                     name_of_number(entries, pairs[i].second)));
  }
  return pairs;
}

/// The numbers of pairs, in the order of the file.
std::vector<EffectNumberAt> numbers_of(const std::vector<SaidOfPair>& pairs) {
  std::vector<EffectNumberAt> numbers;
  for (const SaidOfPair& pair : pairs) {
    numbers.push_back(pair.first);
    numbers.push_back(pair.second);
  }
  std::sort(numbers.begin(), numbers.end());
  const auto same = [](const EffectNumberAt& a, const EffectNumberAt& b) { return !(a < b) && !(b < a); };
  numbers.erase(std::unique(numbers.begin(), numbers.end(), same), numbers.end());
  return numbers;
}

}  // namespace

std::string name_in_file(const std::vector<EffectEntry>& entries, std::size_t entry,
                         const std::string& number) {
  const std::string& id = entries[entry].id;
  std::size_t all = 0, which = 0;
  for (std::size_t e = 0; e < entries.size(); ++e) {
    if (entries[e].id != id) continue;
    ++all;
    if (e <= entry) ++which;
  }
  return all > 1 ? fmt::format("{}.{}.{}", id, which, number) : fmt::format("{}.{}", id, number);
}

std::vector<EffectNumberAt> uncertain_numbers(const std::vector<EffectEntry>& entries) {
  std::vector<EffectNumberAt> list;
  for (std::size_t e = 0; e < entries.size(); ++e) {
    for (std::size_t n = 0; n < entries[e].numbers.size(); ++n)
      if (is_uncertain(entries[e].numbers[n])) list.push_back({e, n});
  }
  return list;
}

CorrelatedNumbers correlated_numbers(const std::vector<EffectEntry>& entries) {
  const std::vector<SaidOfPair> pairs = all_pairs(entries);
  CorrelatedNumbers out;
  if (pairs.empty()) return out;
  out.numbers = numbers_of(pairs);
  const EffectCorrelation& first = *pairs.front().said;
  if (out.numbers.size() > kMostCorrelated)
    refuse_correlation(first,
                       fmt::format("{} parameters; allowed: up to {}", out.numbers.size(), kMostCorrelated));
  const auto n = static_cast<Eigen::Index>(out.numbers.size());
  const auto place = [&](const EffectNumberAt& number) {
    return std::lower_bound(out.numbers.begin(), out.numbers.end(), number) - out.numbers.begin();
  };
  Eigen::MatrixXd all = Eigen::MatrixXd::Identity(n, n);
  for (const SaidOfPair& pair : pairs) {
    const Eigen::Index i = place(pair.first), j = place(pair.second);
    all(i, j) = all(j, i) = pair.said->value;
  }
  const math::Eigensystem system = math::eigensystem_of(all);
  if (system.values[0] < -kNoNegativeVariance) {
    std::vector<std::string> names;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (std::abs(system.vectors(i, 0)) >= kTakesPart)
        names.push_back(name_of_number(entries, out.numbers[static_cast<std::size_t>(i)]));
    }
    refuse_correlation(first, fmt::format("{} cannot be correlated so all at once: a mixture of them would "
                                          "have a variance below 0; a pair that is not given has 0: give it, "
                                          "or bring the values nearer to 0",
                                          fmt::join(names, ", ")));
  }
  out.rows = system.vectors * system.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
  return out;
}

}  // namespace softarm::arm
