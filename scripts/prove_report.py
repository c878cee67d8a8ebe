"""The table of the proof and doc/proof.md, from prove_figures.figures()."""
import prove_misses
import prove_real_report
import prove_figures
import prove_score
import prove_short
from prove_files import markdown

KIND_DESCRIPTION = {
    "none": "nothing hidden but distractors below the noise",
    "single_strong": "one effect of the catalogue",
    "single_weak": "one, barely above the noise",
    "pair": "two effects",
    "outside": "an effect outside the catalogue",
    "compensated": "one that fits frame by frame hide",
    "class_only": "one mounting, one speed: only a class can be right",
    "untidy_none": "nothing but small departures of everything, together what the campaign says",
    "untidy_single": "one effect of the catalogue among such departures, as large as it comes",
    "untidy_pair": "two effects among such departures",
    "untidy_outside": "an effect outside the catalogue among such departures",
    "solid_none": "a finite-element arm with nothing hidden",
    "solid_single": "a finite-element arm with one thing hidden",
    "solid_compensated": "a finite-element arm with a smaller chamber, which a gain takes up",
    "intervention": "recordings of a real arm with one thing wrong that is known, from invisible to gross",
    "control": "the same recordings untouched",
}
# Rows of several kinds together: a name and the kinds. Each of them alone has too few cases to meet such a target.
POOLED = {"none, untidy_none, solid_none": ("none", "untidy_none", "solid_none"),
          "compensated, solid_compensated": ("compensated", "solid_compensated")}
# (kind or name of several, rate, target, whether more is better)
TARGETS = [
    ("none, untidy_none, solid_none", "false_alarm", 0.01, False),
    ("none", "false_alarm", None, False),
    ("single_strong", "top1", 0.85, True), ("single_strong", "top3", 0.95, True),
    ("single_strong", "right_class", 0.97, True),
    ("single_weak", "top1", 0.65, True), ("single_weak", "top3", 0.85, True),
    ("pair", "both_named", 0.70, True),
    ("outside", "unknown", 0.80, True),
    ("compensated", "found_or_cannot_tell", 0.95, True),
    ("class_only", "right_class", None, True),
    ("untidy_none", "false_alarm", None, False),
    ("untidy_single", "top1", 0.75, True), ("untidy_single", "right_class", 0.90, True),
    ("untidy_pair", "both_named", None, True),
    ("untidy_outside", "unknown", 0.80, True),
    ("solid_none", "false_alarm", None, False),
    ("solid_single", "top1", 0.75, True), ("solid_single", "right_class", 0.90, True),
    ("solid_compensated", "found_or_cannot_tell", None, True),
    ("compensated, solid_compensated", "found_or_cannot_tell", 0.95, True),
    ("intervention", "top1", 0.70, True), ("intervention", "right_class", 0.85, True),
    ("intervention", "unknown", None, True), ("control", "false_alarm", 0.0, False),
]
# (figure, description, least, most)
FIGURES = [
    ("confident_wrong", "confident (p > 0.9) and wrong, all trials", None, 0.02),
    ("calibration_error", "calibration error of stated probabilities", None, 0.05),
    ("parameter_median_error", "size of the effect, median relative error", None, 0.15),
    ("interval_coverage", "90 % intervals that cover", 0.85, 0.95),
    # No target: an error of 15 % of the displacement is asked of other forms than the catalogue's, beside the arm's constants.
    # These displacements are beside one set of them each, and hold what a refit of the constants would absorb.
    ("displacement_explained", "share of the displacement of what is hidden that the named effect makes, median of those rightly named",
     None, None),
    ("displacement_coverage", "90 % intervals of the displacement that cover (effects of one size)", None, None),
    ("held_out_over_floor", "held-out error over noise floor, median (but untidy)", None, 1.05),
    ("worse_than_baseline", "held-out worse than before, nothing hidden", None, 0.0),
    ("bias_removed", "bias of EI removed where compensated and named, median", 0.8, None),
    ("place_error_m", "place of contact and soft spot, median error, m", None, 0.02),
    ("law_share", "outside the catalogue and unknown: share of what a flexible model learns that a discovered law takes, median", 0.5, None),
]
# Of each of these worlds by itself: (worlds, figure, description, least, most)
IN_WORLDS = [
    (("tidy", "untidy", "solid", "real"), "confident_wrong", "confident (p > 0.9) and wrong", None, 0.02),
    (("tidy", "untidy", "solid", "real"), "interval_coverage", "90 % intervals that cover", 0.85, 0.95),
    (("real",), "parameter_median_error", "size of what was done, median relative error", None, 0.25),
]
# What two cores have in 10 s and in 30 s: a diagnosis that takes more of them cannot be that fast. (figure, description, most)
TIMES = [("core_seconds_median", "tidy, untidy: processor time of a diagnosis, median, s", 20.0),
         ("core_seconds_most", "tidy, untidy: processor time of a diagnosis, longest, s", 60.0)]
MET, NOT_MET, CONTRADICTED, NOT_CONTRADICTED = "met", "NOT MET", "CONTRADICTED", "not contradicted"


def number(value):
    return "-" if value is None else f"{value:.2f}" if value >= 0.095 or value == 0.0 else f"{value:.3f}"


def status(interval, least, most, full):
    """A target is met where all of the 90 % interval meets it, contradicted where none of it does. A sample is too small to
    meet anything: it contradicts, or it does not. In the whole a target without a figure is not met."""
    if least is None and most is None:
        return "-"
    if interval is None:
        return NOT_MET if full else "-"
    low, high = interval
    if (least is not None and high < least) or (most is not None and low > most):
        return CONTRADICTED
    if not full:
        return NOT_CONTRADICTED
    return MET if (least is None or low >= least) and (most is None or high <= most) else NOT_MET


BETTER_THAN_BASELINES = {"untidy": 0.05, "real": 0.05}  # world -> McNemar's p against the best of them


def beside_baselines(figures):
    """Rows of whether the diagnosis is right more often than the baseline that comes nearest to it, or is ahead."""
    table = []
    for world, most in BETTER_THAN_BASELINES.items():
        beside = {method: found for method, found in figures["worlds"].get(world, {}).get("mcnemar", {}).items() if found["cases"]}
        if not beside:
            if figures["full"]:
                table.append([f"{world}: right alone of the clear cases, diagnose to a baseline; McNemar's p", "0", "-", f"< {most:g}", NOT_MET]
                             + ["" for _ in prove_score.BASELINES])
            continue
        best, found = max(beside.items(), key=lambda one: one[1]["theirs_alone"] - one[1]["ours_alone"])
        ahead, clear = found["ours_alone"] > found["theirs_alone"], found["p"] < most
        judged = MET if ahead and clear else CONTRADICTED if clear else NOT_MET if figures["full"] else NOT_CONTRADICTED
        table.append([f"{world}: right alone of the clear cases, diagnose to {best}; McNemar's p", str(found["cases"]),
                      f"{found['ours_alone']} to {found['theirs_alone']}; {found['p']:.2g}", f"< {most:g}", judged]
                     + ["" for _ in prove_score.BASELINES])
    return table


def range_of(least, most):
    return (f"{least:g} ... {most:g}" if least is not None and most is not None else
            f">= {least:g}" if least is not None else f"<= {most:g}" if most is not None else "-")


def passes(figures):
    """Whether nothing contradicts a target and, in the whole proof, all are met."""
    return not any(row[4] in (CONTRADICTED, NOT_MET) for row in rows(figures))


def pooled(table, kinds, rate):
    """A rate of several kinds together (None: of no case), and how many cases count for it."""
    counts = {kind: table[kind]["counted"][rate] for kind in kinds}
    count = sum(counts.values())
    return (sum(round(table[kind][rate] * n) for kind, n in counts.items() if n) / count if count else None), count


def rate_row(figures, name, rate, target, more):
    kinds = POOLED.get(name, (name,))
    ours, count = pooled(figures, kinds, rate)
    spread = prove_figures.interval(round(ours * count), count) if count else None
    # Of none at all every one is one too many: a count, not a rate.
    judged_by = (ours, ours) if target == 0.0 and count else spread
    if figures["full"] and not all(figures[kind]["counted"][rate] for kind in kinds):
        judged_by = None  # a whole that lacks a kind has no figure
    return ([f"{name}: {rate}", str(count), number(ours) + (f" ({spread[0]:.2f}-{spread[1]:.2f})" if spread else ""),
             "-" if target is None else (">= " if more else "<= ") + f"{target:g}",
             status(judged_by, target if more else None, None if more else target, figures["full"])]
            + [number(pooled(figures["baselines"][b], kinds, rate)[0]) for b in prove_score.BASELINES])


def rows(figures):
    """Cells of the table: what, trials, ours with its 90 % interval, target, met, then the baselines."""
    table = []
    for name, rate, target, more in TARGETS:
        drawn = any(figures[kind]["trials"] for kind in POOLED.get(name, (name,)))
        if drawn or (figures["full"] and target is not None):  # a sample says nothing of kinds that it has not
            table.append(rate_row(figures, name, rate, target, more))
    trials = str(sum(figures[kind]["trials"] for kind in prove_score.KINDS))
    for key, description, least, most in FIGURES:
        value, spread = figures[key], figures["intervals"].get(key)
        if key == "confident_wrong" and value is not None:  # a rate: no bootstrap of nothing is more than nothing
            spread = prove_figures.interval(round(value * int(trials)), int(trials))
        table.append([description, trials if key == "confident_wrong" else "",
                      number(value) + (f" ({number(spread[0])}-{number(spread[1])})" if spread else ""),
                      range_of(least, most), status(spread, least, most, figures["full"])]
                     + [number(figures["baselines"][b][key]) for b in prove_score.BASELINES])
    return table + in_worlds(figures) + times(figures) + beside_baselines(figures)


def in_world(figures, world, key, description, least, most):
    """A row of one world. Where it has so few cases that even none wrong would not meet a target, or that an interval is wider than what is
    allowed, it may contradict the target, no more."""
    found = figures["worlds"].get(world, {})
    value, spread, count = found.get(key), found.get("intervals", {}).get(key), found.get("reported", 0)
    if key == "interval_coverage" and spread is not None:  # a bootstrap of numbers that all cover knows of no others
        wilson = prove_figures.interval(round(value * found["interval_numbers"]), found["interval_numbers"])
        spread = (min(spread[0], wilson[0]), max(spread[1], wilson[1]))
    few = spread is not None and least is not None and most is not None and spread[1] - spread[0] > most - least
    if key == "confident_wrong" and value is not None:
        spread = prove_figures.interval(round(value * count), count)
        few = prove_figures.interval(0, count)[1] > most
    return ([f"{world}: {description}", str(count), number(value) + (f" ({number(spread[0])}-{number(spread[1])})" if spread else ""),
             range_of(least, most), status(spread, least, most, figures["full"] and not few)]
            + [number(figures["baselines"][b]["worlds"].get(world, {}).get(key)) for b in prove_score.BASELINES])


def in_worlds(figures):
    return [in_world(figures, world, key, description, least, most) for worlds, key, description, least, most in IN_WORLDS
            for world in worlds if world in figures["worlds"] or figures["full"]]


def times(figures):
    table = []
    for key, description, most in TIMES:
        value = figures[key]
        if value is not None or figures["full"]:
            judged_by = None if value is None else (value, value)
            table.append([description, "", "-" if value is None else f"{value:.1f}", range_of(None, most),
                          status(judged_by, None, most, figures["full"])] + ["" for _ in prove_score.BASELINES])
    return table


HEADINGS = ["", "trials", "diagnose (90 %)", "target", "", *prove_score.BASELINES]


def table(figures):
    lines = [HEADINGS] + rows(figures)
    widths = [max(len(line[i]) for line in lines) for i in range(len(HEADINGS))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines)


def hidden_description(truth):
    if "set" in truth:
        return prove_real_report.description(truth)
    return "; ".join(effect_description(e) for e in truth["effects"]) or "nothing"


def effect_description(effect):
    form = f" ({effect['form']})" if effect.get("form") else ""
    signal = effect.get("signal")
    size = f", {signal['leftover_snr']:.0f} sd, {1e3 * signal['leftover_m']:.2f} mm" if signal else ""
    return effect["effect"] + form + size


def said(result):
    report = result["report"]
    if report is None:
        return "failed: " + ((result.get("cost") or {}).get("message") or "no report")
    named = [prove_misses.statement(one) for one in prove_score.decision_of_report(report)["named"]]
    return report["verdict"] + (": " + "; ".join(named) if named else "")


def judged(result):
    if not result["report"]:
        return "failed"
    decision = prove_score.decision_of(result)
    if result["kind"] == "intervention":
        return prove_real_report.outcome(decision, result["truth"])
    found = prove_score.marks(result["kind"], decision, result["truth"])
    bad = ("false_alarm", "confident_wrong")
    wrong = [rate for rate, value in found.items() if value == (rate in bad)]  # as prove_score.is_right
    if not wrong and not result["truth"].get("clear", True):
        return "not clear"
    return "right" if not wrong else ("" if set(wrong) <= {"top1", "top3"} else "**") + ", ".join(
        rate if rate in bad else f"not {rate}" for rate in wrong) + ("" if set(wrong) <= {"top1", "top3"} else "**")


def ideal_description(truth):
    if "class" in truth:
        return "class: " + (", ".join(truth["class"]) or "none")
    return ", ".join(f"{item['effect']} {item['explains']:.2f}" for item in truth["ideal"][:3])


def rejected(figures):
    most = list(figures["rejected_reasons"].items())[:5]
    return (f"{figures['rejected_draws']} draws were rejected on the way" +
            (" (" + "; ".join(f"{why}: {count}" for why, count in most) + ("; others" if len(figures["rejected_reasons"]) > len(most) else "") + ")"
             if most else ""))


def cost(figures):
    if figures["seconds_median"] is None:
        return "No diagnosis was made."
    return (f"A diagnosis took {figures['seconds_median']:.0f} s (median), {figures['seconds_most']:.0f} s and "
            f"{figures['memory_bytes_most'] / 2**20:.0f} MiB at most.")


def moved(figures):
    """How the displacements are spread, by world."""
    said = []
    for world, found in figures["worlds"].items():
        spread = found.get("displacement", {})
        if spread.get("effects"):
            lost = f", {spread['unmeasured']} not measured" if spread["unmeasured"] else ""
            said.append(f"{world} " + ", ".join(number(value) for value in spread["quantiles"].values()) +
                        f" ({spread['effects']} effects{lost})")
    return ("Of the displacement of what is hidden and clear the first effect named, rightly or not, makes this share (nothing "
            "named: 0), at the quantiles 10, 25, 50, 75 and 90 %: " + "; ".join(said) + "." if said else "")


def versus(figures):
    """Who is right where the other one is not."""
    said = []
    for method, found in figures["baselines"].items():
        if found.get("mcnemar"):
            m = found["mcnemar"]
            said.append(f"`{method}` {m['ours_alone']} to {m['theirs_alone']} (p = {m['p']:.2g})")
    return ("Clear cases that `diagnose` alone decides rightly, to those that a baseline alone does (McNemar): " + ", ".join(said) + "."
            if said else "")


# How the cases of each world are made.
WORLDS_TEXT = """## The worlds

- **tidy**: nine trials of an arm by the virtual rig, which shares no code with the model of the diagnosis; the arm file is
  right but for the constants that are fitted, and what is hidden has another form than the catalogue's where
  [the rig has one](effects.md#the-virtual-rigs-forms).
- **untidy**: the same, and six to ten small departures besides, 0.2 to 3 mm together, so that nothing is quite as the arm file
  says. What is hidden is as large as it comes: its size is wished for evenly in its logarithm, from a fifth of the position
  noise to 4 mm, and whatever a few scalings make of it stays; nothing is drawn again because it is hard to see. A case is
  *clear* where each hidden effect leaves no less than the background does, and no less than half of the position noise;
  that is sealed with the case. Rates of naming count the clear ones; `power`, `confident_wrong` and the intervals count all.
  Recordings hold no scale of forces but the masses that the arm file states: of an arm that is heavier than that, true compliances,
  stiffnesses, weights and payloads are compared as such a file would have them.
- **solid**: [a silicone arm by finite elements](solid_arm.md), nobody's rod, computed once by a solver that is not this package's.
  Five or six trials of states at rest, noise new in each draw, nothing hidden or one of seven things: a soft ring, an elastic clamp, a
  payload off its axis, an edge in the way, a log with an offset or a dead zone; and a smaller chamber, which a gain takes up. What is right to
  name was decided before the first diagnosis. The arm file is identified from other states of the arm with nothing hidden. The
  arm's stiff caps are there, not in its file, and may be named.
- **real**: recordings of two real arms ([a tendon trunk and a pouch arm](real_arms.md)), imported as they are (the
  controls), and again with one thing wrong that is known (the interventions). It is done to the recorded table before it is
  imported: payloads told at a factor, withheld or exchanged between trials; the cameras' clock, or one input's, shifted or
  running off; a body moved along or across the arm, two bodies exchanged; the cameras' frame tilted with gravity, the base
  without; the log of the inputs passed through a gain that saturates, a dead zone, a lag, an offset, a play or a leak (the
  arm did what it did: what it seems to have is the inverse). Gravity told tilted, and one segment with the constants of
  another session, are written into the arm file. Sizes are drawn evenly in their logarithm, from what nobody could see to
  what nobody could overlook. The arm file is identified from pieces of the recordings that are not diagnosed; where there
  are no others, from those.

  A real arm has effects of its own, and nobody knows which. So an intervention is judged beside its control: what both are
  said to have is the arm's, and finds nothing, but for what is of the intervention's class, a small departure there and none here (the baselines list no small departures, and gain nothing by it). It is found where something is named, more probable than not, that the
  control was not said to have and that belongs to its class. The class is decided before anything is diagnosed and sealed
  with the rest: the effects that say the intervention outright, and those whose signatures explain half or more of what it
  leaves beside the arm's constants, and nearly as much as the best. Where the class is empty nothing in the catalogue acts
  like it, and *unknown* is right. Rates count interventions that are *clear*: what they leave is a quarter or more of what
  the constants leave of the untouched recordings; `power` counts all. Of a control, only those names are judged that its
  interventions have outright: none of them may be named.
"""


def trials(results, figures, names):
    """doc/proof_trials.md: every case. names: of files, see prove_pages.py."""
    lines = [["case", "kind", "hidden", "an ideal detector", "said", "baseline -> extended (floor), mm", ""]]
    for result in results:
        truth, report = result["truth"], result["report"]
        if truth is None:
            lines.append([result["case"], result["kind"], "not drawn: " + (result["not_drawn"] or "?"), "", "", "", ""])
            continue
        errors = "" if report is None else (f"{1e3 * prove_score.unseen_rms_m(report, 'baseline'):.3f} -> "
                                            f"{1e3 * prove_score.unseen_rms_m(report, 'extended'):.3f} "
                                            f"({1e3 * report['noise_floor_m']:.3f})")
        lines.append([result["case"], result["kind"], hidden_description(truth),
                      ideal_description(truth), said(result), errors, judged(result)])
    return f"""# Every case of the proof

Of [the proof]({names['story']}), seed {figures['seed']}, which says what these words mean.

{markdown(lines)}
"""


def story(results, figures, names):
    """doc/proof.md. names: of files, see prove_pages.py."""
    kinds = [["kind", "trials", "what is hidden"]]
    kinds += [[k, figures[k]["trials"], KIND_DESCRIPTION[k]] for k in prove_score.KINDS if figures[k]["trials"]]
    return f"""# The proof of `softarm diagnose`

Written by `scripts/prove`: {prove_figures.extent(figures)} of the campaign `{figures['campaign']}`, seed {figures['seed']}. Engine: commit
`{figures['engine']}`. SHA-256 of what was hidden, taken before the first diagnosis: `{figures['truth_sha256']}`.
{rejected(figures)}, {figures['not_drawn']} cases could not be drawn, {figures['failed']} diagnoses failed (they count as having said nothing).
{cost(figures)}

{prove_short.story(results, names)}
## All that is asked of it

{markdown([HEADINGS] + rows(figures))}

In brackets: 90 % intervals, of rates Wilson's, of other figures by a bootstrap of the cases. *Met*: all of the interval meets
the target; *contradicted*: none of it does; a sample is too small to meet one and says *not contradicted*. In the whole a target
without a figure is not met. A row of several kinds has their cases together, and their target. Targets of every world are judged in each by itself; where a world has so few cases
that even none wrong would not meet one, or that the interval is wider than what is allowed, it says *not contradicted*. {versus(figures)} The baselines have what a round of the diagnosis has: the same fit, signatures, noise with a background of small departures,
refits, odds beforehand, forms other than the laws', and gates of size. They differ in how they decide, and are sure by BIC weights of the refitted models:
`per_frame` by the residuals of fits frame by frame alone, `bic` by forward steps, `lasso` by the path of a group lasso, `gp` by
a Gaussian process alone, which never names anything, and whose alarm the others share.
{moved(figures)}

{prove_real_report.story(results, names.get("real"))}{WORLDS_TEXT}
## What was measured, and how

{markdown(kinds)}

How large an effect is: the same trials are simulated (or, of real recordings, imported) with and without it, with the same random numbers. The difference of what
one set of the arm's constants leaves in both, in means over 0.2 s as the diagnosis uses them, at the times of those of the trials
without it, each over its standard deviation (white noise, and what the diagnosis allows for swinging), is projected orthogonally to the derivatives of all of
the arm's free constants. Its length is the signal to noise after a refit ("sd" below), its rms distance per body what is
left in metres. A trial set has some 13000 such numbers, so that 12 sd are 0.02 mm, no more than the error of the rig
itself; therefore sizes are also at least the `least_leftover_m` of the campaign file, which is the larger. Compensated: the length with the
constants held is 20 or more, and a chi^2 test of fits frame by frame stays below 3 standard deviations.

`top1`: the first effect named is the hidden one. `top3`: it is among the first three of the ranking, and something was said
to be there. `right_class`: it is the first one named, or among those that this is said to be confusable with. `unknown`: that
verdict, where the best effect of the catalogue leaves 8 standard deviations or more. `found_or_cannot_tell`: named, or in the class of a named one, or said to be undecidable. Confident and wrong: an
effect named with a probability above 0.9 that is not there, nor any that it is said to be confusable with. A named distractor
is there; so, of something outside the catalogue, is an effect that acts like it: one whose signature explains half or more of
what it leaves beside the arm's constants, and nearly as much as the best (sealed with the draw; the rule of the real
recordings, too). Displacement: by how much an effect moves the bodies, every three seconds, in all trials; hidden: with it less without it,
beside one set of the arm's constants; found: the model of `arm_extended.yaml` with it less without it; the share is
1 - |found - hidden|^2 / |hidden|^2. An ideal detector: the effects of the catalogue against the noise-free difference, with the share of it that each
explains; where the hidden one is not first there, its form differs from the catalogue's or no detector could do it.
"""
