// What is named, how sure, what every arm has, and the verdict.
#pragma once

#include <vector>

#include "selection.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// Fills ranking, effects, small departures and verdict.
/// @param adequate nothing of a size that matters is left, nor explained better without effects
/// @param d has the shares of what could be explained
void add_findings(JointModel& model, const Selection& selection, bool adequate, Diagnosis& d);

/// What may be mistaken for another may be mistaken the other way round, too.
void mistake_mutually(std::vector<NamedEffect>& effects);

/// Adds to what a short delay may be mistaken for the catalogue's others: a clock that is apart by a few
/// hundredths of a second is a lag of that length. Only their sum is told: its interval allows for the other.
/// @param values of the effects' parameters, as model::Present has them
void mistake_short_delays(const arm::Arm& arm, const std::vector<model::Present>& values,
                          std::vector<NamedEffect>& effects);

/// Where nothing among what the verdict stands on is more probable than not, and a small departure is, though
/// it is only small beside the rest: the largest such is no departure but what is known.
/// @param usual by small departure: that every arm has such, however surely it is there
void lead_with_what_is_known(const std::vector<bool>& usual, std::vector<NamedEffect>& effects,
                             std::vector<NamedEffect>& small);

/// Whether it is what every arm has: placement within what the arm file allows, weights known to a few
/// percent, or no more inertia than is not known of an arm that swings.
/// @param at the fit that it is of
bool is_usual(const JointModel& model, const Linearised& at, const model::Present& present);

/// A delay so short that clocks that are apart and pressures that lag are one.
bool is_short_delay(const model::Present& present);

/// Whether an effect is one body that sits elsewhere or another clock: hardly any physics that is missing
/// looks like that. A short delay of clocks is not of that kind: valves that stick and walls that creep look
/// like it; nor are clocks that drift apart: of little offset they look like what creeps over the session;
/// nor cameras that bow, or pressures that are off.
/// @param short_delay whether what was found is one, see is_short_delay()
bool is_of_sensors_alone(const model::Info& info, bool short_delay);

/// Whether an effect is little of what all explain, and of a size that departures of every arm have.
/// @param share of the squared error that all explain
/// @param explained_m rms distance of a body that all explain
bool is_small_share(double share, double explained_m, double length_m);

/// Root of the difference of two squares, and 0 where the second is larger.
double beyond_m(double whole_m, double part_m);

/// Probability that what was found is no stand-in for what nothing explains: something that no effect of the
/// catalogue makes looks like several that do.
/// @param part_m, left_m rms distances of a body on unseen trials: what it explains, and what is left beyond
/// the noise
/// @param of_sensors whether it is_of_sensors_alone()
double is_no_stand_in(double part_m, double left_m, double length_m, bool of_sensors);
/// What is in no model may stand in for something, too: the probabilities of such candidates times that they
/// do not.
/// @param screened upon the model, with what each would explain of what is left
void weigh_left_aside(const std::vector<Screened>& screened, double left_m, double length_m,
                      std::vector<Candidate>& ranking);

/// Explained is what is explained whole, by something that, with what it may be mistaken for, is more
/// probable than not: else these trials cannot tell. Partly explained is what such effects take half of.
/// @param d with its effects, their rivals among the ranking, and the share that they explain
Verdict verdict_of(const Diagnosis& d, bool adequate);

/// Candidates in the order in which they are said: what the verdict stands on, what that may be mistaken for,
/// the small departures and the stand-ins, all others, the most probable first.
void rank_as_said(Diagnosis& d);

/// Moves what is hardly there to the stand-ins. What nobody believes is not mistaken for others: each of
/// those stands in the ranking by itself.
void set_stand_ins_apart(Diagnosis& d);

}  // namespace softarm::diagnose
