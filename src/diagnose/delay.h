// By how much bodies answer late to their inputs, where that is beyond what a line about no delay can see.
#pragma once

#include <vector>

#include "effects/clocks.h"
#include "model/prepared_trial.h"

namespace softarm::diagnose {

/// Clocks that are apart.
struct Delay {
  double offset_s =
      0.0;        ///< the bodies' clock is ahead by so much; where there is a rate, when the session begins
  int input = 0;  ///< of this input alone, its number in the arm file's list; 0: of all
  double rate = 0.0;  ///< and gets further ahead by so many seconds in each of the session's

  /// By how much it is ahead at an instant of a trial.
  double at(const model::Series& series, double t_s) const {
    return rate == 0.0 ? offset_s : effects::drifted_s(rate, offset_s, series.session_s, t_s);
  }
};

/// In each trial by itself the place of the outermost body is regressed on the inputs, their squares and
/// products, payload and gravity, with the inputs at other times: no model of the arm, so that a delay of
/// seconds, about which no model is linear, is found before anything is fitted or left out. Delays that grow
/// over the session are found in the same way.
/// @return the likeliest delay where that is too long for the screen (`kPolicy.delay`): a place to begin
/// from,
///         no finding. Before it one that grows, where that is likelier yet
std::vector<Delay> find_delays(const arm::Arm& arm, const std::vector<model::TrialData>& trials,
                               unsigned jobs = 1);

}  // namespace softarm::diagnose
