#include "first_fits.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "delay.h"
#include "effects/catalogue.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

JointModel::FitOptions rough_fit() {
  JointModel::FitOptions roughly;
  roughly.tolerance = kPolicy.fit.roughly_sd;
  return roughly;
}

/// Goes on from where a rough fit ended. The arm moves as it did there, so that what was predicted still
/// holds.
Linearised finished(JointModel& model, const Linearised& roughly) {
  JointModel::FitOptions how;
  how.known = true;
  how.begins = &roughly;
  return model.fit(roughly.at, how, &roughly.predicted);
}

bool is_of_clocks(const model::Info& info) {
  return info.of_clocks || info.of_clock_rates;
}

/// The effect of clocks that are apart by so much.
model::Present present_of(const Delay& delay) {
  for (const std::unique_ptr<model::Effect>& effect : effects::catalogue()) {
    if (delay.rate != 0.0 && effect->info().of_clock_rates)
      return {effect.get(), Eigen::Vector2d(delay.rate, delay.offset_s)};
    if (delay.rate == 0.0 && effect->info().of_clocks)
      return {effect.get(), Eigen::Vector2d(delay.offset_s, delay.input)};
  }
  throw std::logic_error("no effect of clocks in the catalogue");
}

/// By how much clocks are apart as an effect of them says.
Delay delay_of(const model::Present& present) {
  if (present.effect->info().of_clock_rates) return {present.values[1], 0, present.values[0]};
  return {present.values[0], static_cast<int>(std::lround(present.values[1])), 0.0};
}

/// @return nothing where a delay is not found, is in the arm file already, or explains nothing. Of two the
/// one that fits better, where a rate is worth more than chance
std::optional<Linearised> fit_with_delay(JointModel& model, const Linearised& without) {
  for (const model::Present& present : model.known())
    if (is_of_clocks(present.effect->info())) return std::nullopt;
  std::optional<Linearised> best;
  for (const Delay& delay : find_delays(model.arm(), model.trials(), model.jobs())) {
    JointParameters from = model.start();
    from.effects.push_back(present_of(delay));
    Linearised delayed = model.fit(from, rough_fit());
    if (!(delayed.square < without.square)) continue;
    const double chance = 2.0 * kPolicy.delay.least_gain * inflation(delayed);
    if (!best || delayed.square < best->square + chance) best = std::move(delayed);
  }
  return best;
}

}  // namespace

FirstFits first_fits(JointModel& model, const std::function<void()>& progress) {
  FirstFits first;
  Linearised& baseline = first.baseline;
  baseline = model.fit(model.start(), rough_fit());
  first.delayed = fit_with_delay(model, baseline);
  if (first.delayed) first.ends = model.leave_out_ends(delay_of(first.delayed->at.effects.back()));
  // What is late for another reason, clocks apart for one, makes the fit find a lag that the arm has not, and
  // that would be taken for motion.
  const Linearised& moving = first.delayed ? *first.delayed : baseline;
  JointParameters calm = moving.at;
  calm.viscoelastic_lag_s = std::min(calm.viscoelastic_lag_s, model.viscoelastic_lag_s());
  std::vector<std::vector<model::Predicted>> path;
  model.predict(calm, &moving.predicted, path);
  first.swinging = model.allow_for_motion(calm, path);
  progress();
  // What is known beforehand counts against the misfit as it is, and that changes with what counts.
  double misfit = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double now = std::max(1.0, baseline.square / std::max(1, baseline.rows));
    if (now * kPolicy.fit.same_misfit > misfit && now < kPolicy.fit.same_misfit * misfit) break;
    misfit = now;
    model.set_misfit(misfit);
    const bool anew = i == 0 && misfit > kPolicy.fit.refit_from_start_chi2;
    JointModel::FitOptions how = rough_fit();
    how.known = i > 0 && !anew;
    how.near = how.known ? &baseline : nullptr;
    baseline = model.fit(anew ? model.start() : baseline.at, how, &baseline.predicted);
  }
  baseline = finished(model, baseline);
  if (first.delayed) first.delayed = model.fit(first.delayed->at, {}, &first.delayed->predicted);
  return first;
}

void fit_again_from(const JointParameters& constants, JointModel& model, FirstFits& first) {
  JointParameters from = constants;
  from.effects.clear();
  Linearised& baseline = first.baseline;
  baseline = model.fit(from, rough_fit());
  model.set_misfit(std::max(1.0, baseline.square / std::max(1, baseline.rows)));
  baseline = finished(model, baseline);
  if (!first.delayed) return;
  from.effects = first.delayed->at.effects;
  first.delayed = model.fit(std::move(from), {});
}

}  // namespace softarm::diagnose
