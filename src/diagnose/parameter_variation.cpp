#include "parameter_variation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <utility>

#include "covariates.h"
#include "math/statistics.h"
#include "policy.h"
#include "sentences.h"

namespace softarm::diagnose {
namespace {

constexpr std::size_t kMostPoints = 2000;  // of the statistics
constexpr std::size_t kMostDots = 300;     // of a picture
constexpr std::size_t kMostPictures = 8, kFewestPictures = 4;
constexpr int kShuffles = 499;

struct VariedParameter {
  std::string name, unit;
  bool ratio = false;                        ///< shown over its law; else less its law
  std::vector<std::optional<double>> shown;  ///< by point
  std::vector<double> rank;                  ///< by point, from -0.5 to 0.5; where shown
};

class Variation {
 public:
  Variation(const JointModel& model, const Linearised& at, const std::vector<InstantFit>& instants)
      : model_(model), at_(at), arm_(model.arm_with(at.at.constants)) {
    choose_points(instants);
    covariates_ = covariates_of(model, arm_, at, points_);
    for (std::size_t i = 0; i < arm_.segments.size(); ++i) add_parameters(i);
  }

  std::vector<ParameterVariation> pictures() {
    shuffle();
    std::vector<std::size_t> order(tests_.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      const bool varies = tests_[a].p < kPolicy.instants.p;
      if (varies != (tests_[b].p < kPolicy.instants.p)) return varies;
      // Of those that are no chance the largest first.
      return varies ? tests_[a].size > tests_[b].size : tests_[a].strength > tests_[b].strength;
    });
    std::vector<ParameterVariation> list;
    std::set<std::size_t> shown;
    for (const std::size_t i : order) {
      if (tests_[i].p >= kPolicy.instants.p || list.size() == kMostPictures) break;
      list.push_back(picture(tests_[i]));
      shown.insert(tests_[i].parameter);
    }
    for (const std::size_t i : order) {
      if (list.size() >= kFewestPictures) break;
      if (!shown.insert(tests_[i].parameter).second) continue;
      list.push_back(picture(tests_[i]));
    }
    return list;
  }

 private:
  struct Test {
    std::size_t parameter = 0, covariate = 0;
    double size = 0.0, strength = 0.0,
           p = 1.0;  ///< size: of the statistic; strength: over what chance makes of it
  };

  /// Evenly thinned blocks, in the order of their trials; also those without a fit, which keep the rhythm.
  void choose_points(const std::vector<InstantFit>& instants) {
    std::map<std::pair<std::size_t, std::size_t>, const InstantFit*> known;
    for (const InstantFit& fit : instants) known[{fit.trial, fit.block}] = &fit;
    std::size_t blocks = 0;
    for (const model::TrialData& trial : model_.trials()) blocks += trial.blocks.size();
    const std::size_t step = std::max<std::size_t>(1, (blocks + kMostPoints - 1) / kMostPoints);
    for (std::size_t t = 0; t < model_.trials().size(); ++t) {
      begins_.push_back(points_.size());
      for (std::size_t k = 0; k < model_.trials()[t].blocks.size(); k += step) {
        const auto fit = known.find({t, k});
        points_.push_back({t, k, fit != known.end() ? fit->second : nullptr});
      }
    }
    begins_.push_back(points_.size());
  }

  void add_parameters(std::size_t segment) {
    const std::string of = arm_.segments.size() > 1 ? " of " + arm_.segments[segment].name : "";
    const struct {
      const char* name;
      const char* unit;
      bool ratio;
      std::optional<Estimated> SegmentFit::*estimated;
    } all[] = {{"EI", "1", true, &SegmentFit::stiffness_nm2},
               {"M0", "1", true, &SegmentFit::moment_nm},
               {"φ", "rad", false, &SegmentFit::direction_rad},
               {"L", "m", false, &SegmentFit::length_m}};
    for (const auto& one : all) {
      VariedParameter parameter;
      parameter.name = one.name + of;
      parameter.unit = one.unit;
      parameter.ratio = one.ratio;
      parameter.shown.resize(points_.size());
      parameter.rank.resize(points_.size());
      std::vector<std::pair<double, std::size_t>> standing;
      for (std::size_t i = 0; i < points_.size(); ++i) {
        if (points_[i].fit == nullptr) continue;
        const std::optional<Estimated>& estimated = points_[i].fit->segments[segment].*one.estimated;
        if (!estimated || !(estimated->sd > 0.0)) continue;
        parameter.shown[i] =
            one.ratio ? estimated->value / estimated->law : estimated->value - estimated->law;
        standing.push_back({(estimated->value - estimated->law) / estimated->sd, i});
      }
      if (standing.size() < kPolicy.instants.fewest) continue;
      std::sort(standing.begin(), standing.end());
      for (std::size_t r = 0; r < standing.size(); ++r)
        parameter.rank[standing[r].second] =
            (static_cast<double>(r) + 0.5) / static_cast<double>(standing.size()) - 0.5;
      parameters_.push_back(std::move(parameter));
    }
  }

  /// First points of stretches of trials that may be exchanged, and the end.
  std::vector<std::size_t> stretches() const {
    const std::size_t trials = begins_.size() - 1;
    double seconds = 0.0;
    for (const model::TrialData& trial : model_.trials())
      seconds += trial.series.t_s[trial.series.t_s.size() - 1] - trial.series.t_s[0];
    const double each_s = std::min(kPolicy.fit.stretch_s, seconds / kPolicy.instants.fewest_stretches);
    std::vector<std::size_t> begins;
    for (std::size_t t = 0; t < trials; ++t) {
      double from_s = -1e300;
      for (std::size_t i = begins_[t]; i < begins_[t + 1]; ++i) {
        const double now_s = at_.predicted[t][points_[i].block].instant.t_s;
        if (now_s < from_s + each_s) continue;
        begins.push_back(i);
        from_s = now_s;
      }
    }
    begins.push_back(points_.size());
    return begins;
  }

  /// From where each point takes its values: its own, or those of another stretch.
  std::vector<std::size_t> sources(std::mt19937_64* random) const {
    std::vector<std::size_t> of(stretches_.size() - 1), from(points_.size());
    std::iota(of.begin(), of.end(), 0);
    for (std::size_t i = of.size(); random != nullptr && i > 1; --i)
      std::swap(of[i - 1], of[static_cast<std::size_t>((*random)() % i)]);
    for (std::size_t s = 0; s < of.size(); ++s) {
      const std::size_t length = stretches_[s + 1] - stretches_[s];
      const std::size_t there = stretches_[of[s] + 1] - stretches_[of[s]];
      for (std::size_t i = 0; i < length; ++i)
        from[stretches_[s] + i] = stretches_[of[s]] + i * there / length;
    }
    return from;
  }

  /// Root of the mean square of the bins' mean ranks, by test.
  std::vector<double> statistics(const std::vector<std::size_t>& from) const {
    std::vector<double> all;
    for (const VariedParameter& parameter : parameters_) {
      for (const Covariate& covariate : covariates_) {
        double sum[Covariate::kBins + 1] = {}, count[Covariate::kBins + 1] = {}, total = 0.0;
        for (std::size_t i = 0; i < points_.size(); ++i) {
          if (!parameter.shown[from[i]]) continue;
          const auto bin = static_cast<std::size_t>(covariate.bin[i]);
          sum[bin] += parameter.rank[from[i]];
          count[bin] += 1.0;
          total += 1.0;
        }
        double square = 0.0;
        for (std::size_t b = 0; b <= Covariate::kBins; ++b)
          if (count[b] > 0.0) square += sum[b] * sum[b] / count[b];
        all.push_back(std::sqrt(square / std::max(1.0, total)));
      }
    }
    return all;
  }

  void shuffle() {
    stretches_ = stretches();
    const std::vector<double> own = statistics(sources(nullptr));
    std::mt19937_64 random(1);
    std::vector<std::vector<double>> null;
    std::vector<double> mean(own.size(), 0.0), variance(own.size(), 0.0);
    for (int b = 0; b < kShuffles; ++b) {
      null.push_back(statistics(sources(&random)));
      for (std::size_t i = 0; i < own.size(); ++i) mean[i] += null.back()[i] / kShuffles;
    }
    for (const std::vector<double>& one : null) {
      for (std::size_t i = 0; i < own.size(); ++i)
        variance[i] += (one[i] - mean[i]) * (one[i] - mean[i]) / kShuffles;
    }
    const auto strength = [&](const std::vector<double>& statistic, std::size_t i) {
      return variance[i] > 0.0 ? (statistic[i] - mean[i]) / std::sqrt(variance[i]) : 0.0;
    };
    std::vector<double> largest;
    for (const std::vector<double>& one : null) {
      double most = 0.0;
      for (std::size_t i = 0; i < own.size(); ++i) most = std::max(most, strength(one, i));
      largest.push_back(most);
    }
    for (std::size_t p = 0; p < parameters_.size(); ++p) {
      for (std::size_t c = 0; c < covariates_.size(); ++c) {
        const std::size_t i = p * covariates_.size() + c;
        Test test{p, c, own[i], strength(own, i), 1.0};
        const auto above =
            std::count_if(largest.begin(), largest.end(), [&](double one) { return one >= test.strength; });
        test.p = (1.0 + static_cast<double>(above)) / (1.0 + kShuffles);
        tests_.push_back(test);
      }
    }
  }

  std::string sentence(const VariedParameter& parameter, const Covariate& covariate) const {
    std::vector<std::vector<double>> bins(covariate.middle.size());
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (parameter.shown[i]) bins[static_cast<std::size_t>(covariate.bin[i])].push_back(*parameter.shown[i]);
    std::size_t high = 0, low = 0;
    std::vector<double> medians(bins.size());
    bool any = false;
    for (std::size_t b = 0; b < bins.size(); ++b) {
      if (bins[b].size() < 5) continue;
      medians[b] = math::median(std::move(bins[b]));
      if (!any) high = low = b;
      any = true;
      if (medians[b] > medians[high]) high = b;
      if (medians[b] < medians[low]) low = b;
    }
    if (!any || high == low) return "";
    const double ratio = medians[high] / medians[low];
    const bool times = parameter.ratio && ratio >= kPolicy.instants.times;
    const std::string by = times ? fmt::format("{:.1f} times as large", ratio)
                           : parameter.ratio
                               ? fmt::format("{:.1f} % larger", 100.0 * (ratio - 1.0))
                               : with_unit(medians[high] - medians[low], parameter.unit) + " larger";
    const double span = std::abs(covariate.middle.back() - covariate.middle.front());
    const auto at = [&](std::size_t bin) {
      const double x = covariate.middle[bin];
      if (covariate.unit == "1") return fmt::format("{:.0f}", x);
      return with_unit(std::abs(x) < 1e-3 * span ? 0.0 : x, covariate.unit);
    };
    return fmt::format("Relative to its law, {} is {} where the {} is {} {} where it is {}.", parameter.name,
                       by, covariate.name, at(high), times ? "as" : "than", at(low));
  }

  ParameterVariation picture(const Test& test) const {
    const VariedParameter& parameter = parameters_[test.parameter];
    const Covariate& covariate = covariates_[test.covariate];
    ParameterVariation variation;
    variation.parameter = parameter.name + (parameter.ratio ? " over its law" : " less its law");
    variation.unit = parameter.unit;
    variation.against = covariate.name;
    variation.against_unit = covariate.unit;
    variation.p = test.p;
    std::vector<std::size_t> there;
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (parameter.shown[i]) there.push_back(i);
    const std::size_t step = std::max<std::size_t>(1, (there.size() + kMostDots - 1) / kMostDots);
    for (std::size_t i = 0; i < there.size(); i += step) {
      variation.x.push_back(covariate.x[there[i]]);
      variation.value.push_back(*parameter.shown[there[i]]);
      variation.law.push_back(parameter.ratio ? 1.0 : 0.0);
    }
    if (test.p < kPolicy.instants.p) variation.sentence = sentence(parameter, covariate);
    return variation;
  }

  const JointModel& model_;
  const Linearised& at_;
  const arm::Arm arm_;
  std::vector<GridPoint> points_;
  std::vector<std::size_t> begins_;     ///< first point of each trial, and the end
  std::vector<std::size_t> stretches_;  ///< first point of each stretch, and the end
  std::vector<Covariate> covariates_;
  std::vector<VariedParameter> parameters_;
  std::vector<Test> tests_;
};

}  // namespace

std::vector<ParameterVariation> parameter_variation_of(const JointModel& model, const Linearised& at,
                                                       const std::vector<InstantFit>& instants) {
  if (instants.empty()) return {};
  return Variation(model, at, instants).pictures();
}

}  // namespace softarm::diagnose
