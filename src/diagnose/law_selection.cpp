#include "law_selection.h"

#include <algorithm>
#include <random>
#include <utility>

#include "math/parallel.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;

constexpr std::uint64_t kSeed = 1;
constexpr double kSingular = 1e-9;  // of a term one size of which does nothing

Matrix2d own_block(const Reduced& reduced, Index term) {
  return reduced.products.block<2, 2>(2 * term, 2 * term);
}

/// Whether constants, effects and the terms before it leave little of a term.
bool is_absorbed(const Reduced& reduced, Index term) {
  const double whole = reduced.whole.segment<2>(2 * term).sum();
  return !(own_block(reduced, term).trace() > kPolicy.law.least_left * whole);
}

/// By which chi^2 falls with a term.
double gain_of(const Reduced& reduced, double precision, Index term) {
  const Vector2d score = reduced.score.segment<2>(2 * term);
  return score.dot((own_block(reduced, term) + precision * Matrix2d::Identity()).inverse() * score);
}

/// What is left when a term has taken its own.
void take(Reduced& reduced, double precision, Index term) {
  const MatrixXd across = reduced.products.middleCols<2>(2 * term);
  const MatrixXd by = across * (own_block(reduced, term) + precision * Matrix2d::Identity()).inverse();
  const Vector2d score = reduced.score.segment<2>(2 * term);
  reduced.score -= by * score;
  reduced.products -= by * across.transpose();
}

/// The terms that explain most, one upon the other.
std::vector<Index> forward(Reduced reduced, double precision, std::size_t most) {
  std::vector<Index> chosen;
  const Index terms = reduced.score.size() / 2;
  while (chosen.size() < most) {
    Index best = -1;
    double gain = 0.0;
    for (Index term = 0; term < terms; ++term) {
      if (is_absorbed(reduced, term)) continue;
      const double of_term = gain_of(reduced, precision, term);
      if (of_term > gain) {
        best = term;
        gain = of_term;
      }
    }
    if (best < 0) break;
    take(reduced, precision, best);
    chosen.push_back(best);
  }
  return chosen;
}

/// Mean squared canonical correlation of what two terms can do.
double alike(const Reduced& reduced, Index one, Index other) {
  if (one == other) return 1.0;
  const Matrix2d mixed = reduced.products.block<2, 2>(2 * one, 2 * other);
  const auto inverse = [&](Index term) -> Matrix2d {
    const Matrix2d own = own_block(reduced, term);
    return (own + kSingular * own.trace() * Matrix2d::Identity()).inverse();
  };
  return 0.5 * (inverse(one) * mixed * inverse(other) * mixed.transpose()).trace();
}

/// What halves of the units choose.
std::vector<std::vector<Index>> chosen_by_halves(const LawSums& sums, const std::vector<bool>& use,
                                                 unsigned jobs) {
  std::vector<std::vector<bool>> halves;
  std::mt19937_64 random(kSeed);
  std::vector<std::size_t> order;
  for (std::size_t u = 0; u < use.size(); ++u)
    if (use[u]) order.push_back(u);
  for (std::size_t n = 0; n < kPolicy.law.halvings; ++n) {
    // Fisher and Yates: what the library's own shuffle does is not the same everywhere.
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
    for (const bool first : {true, false}) {
      std::vector<bool> half(use.size(), false);
      for (std::size_t i = 0; i < order.size(); ++i) half[order[i]] = (i < order.size() / 2) == first;
      halves.push_back(std::move(half));
    }
  }
  std::vector<std::vector<Index>> list(halves.size());
  math::in_parallel(halves.size(), jobs, [&](std::size_t i) {
    list[i] = forward(reduce(sums, halves[i]), sums.size_precision, kPolicy.law.most_terms);
  });
  return list;
}

/// By term: the share of the halves that chose it or one like it.
std::vector<double> stability_of(const Reduced& all, const std::vector<std::vector<Index>>& halves) {
  std::vector<double> shares;
  for (Index term = 0; 2 * term < all.score.size(); ++term) {
    if (is_absorbed(all, term)) {
      shares.push_back(0.0);
      continue;
    }
    const auto votes = std::count_if(halves.begin(), halves.end(), [&](const std::vector<Index>& chosen) {
      return std::any_of(chosen.begin(), chosen.end(), [&](Index other) {
        return !is_absorbed(all, other) && alike(all, other, term) >= kPolicy.law.alike;
      });
    });
    shares.push_back(static_cast<double>(votes) / static_cast<double>(halves.size()));
  }
  return shares;
}

}  // namespace

std::vector<StableTerm> stable_terms(const LawSums& sums, const Folds& folds, unsigned jobs) {
  std::vector<StableTerm> list;
  const std::vector<bool> use = units_of(sums, folds);
  if (std::count(use.begin(), use.end(), true) < 2 || sums.terms == 0) return list;
  const Reduced all = reduce(sums, use);
  const std::vector<double> stability = stability_of(all, chosen_by_halves(sums, use, jobs));
  Reduced left = all;
  std::vector<Index> chosen;
  double gain = 0.0;
  while (chosen.size() < kPolicy.law.most_terms) {
    Index best = -1;
    double most = 0.0;
    for (Index term = 0; term < sums.terms; ++term) {
      const bool stands_for_one = std::any_of(chosen.begin(), chosen.end(), [&](Index other) {
        return alike(all, other, term) >= kPolicy.law.alike;
      });
      if (stability[static_cast<std::size_t>(term)] < kPolicy.law.stable || stands_for_one ||
          is_absorbed(left, term))
        continue;
      const double of_term = gain_of(left, sums.size_precision, term);
      if (of_term > most) {
        best = term;
        most = of_term;
      }
    }
    if (best < 0) break;
    chosen.push_back(best);
    const double held_out = held_out_gain(sums, chosen, folds);
    if (!(held_out > (1.0 + kPolicy.law.least_more) * gain)) break;
    gain = held_out;
    take(left, sums.size_precision, best);
    list.push_back({best, stability[static_cast<std::size_t>(best)]});
  }
  return list;
}

}  // namespace softarm::diagnose
