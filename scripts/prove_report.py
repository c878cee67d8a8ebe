"""The table of the proof and doc/proof.md, from prove_figures.figures()."""
import collections
import re

import prove_misses
import prove_real_report
import prove_figures
import prove_score
import prove_short
from prove_files import markdown

KIND_DESCRIPTION = {
    "none": "nothing; small departures stay below the noise",
    "single_strong": "one effect of the catalogue",
    "single_weak": "one effect of the catalogue, barely above the noise",
    "pair": "two effects of the catalogue",
    "outside": "one effect outside the catalogue",
    "compensated": "one effect that fits frame by frame absorb",
    "class_only": "one effect, recorded in one attitude at one speed: only its class can be right",
    "untidy_none": "nothing; small departures of everything, together as large as the campaign file says",
    "untidy_single": "one effect of the catalogue of any size, and such departures",
    "untidy_pair": "two effects of the catalogue of any size, and such departures",
    "untidy_outside": "one effect outside the catalogue of any size, and such departures",
    "solid_none": "nothing in a finite-element arm",
    "solid_single": "one effect in a finite-element arm",
    "solid_compensated": "a smaller chamber in a finite-element arm, which a gain absorbs",
    "intervention": "one known fault in recordings of a real arm, from invisible to gross",
    "control": "nothing in the same recordings",
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
    ("confident_wrong", "confident (p > 0.9) and wrong, all cases", None, 0.02),
    ("calibration_error", "calibration error of stated probabilities", None, 0.05),
    ("parameter_median_error", "size of a rightly named effect, median relative error", None, 0.15),
    ("interval_coverage", "90 % intervals that hold the true value", 0.85, 0.95),
    # No target: an error of 15 % of the displacement is asked of other forms than the catalogue's, beside the arm's constants.
    # These displacements are beside one set of them each, and hold what a refit of the constants would absorb.
    ("displacement_explained", "share of the hidden displacement that a rightly named effect makes, median",
     None, None),
    ("displacement_coverage", "90 % intervals that hold the true displacement (effects with one size)", None, None),
    ("held_out_over_floor", "error on unseen trials over noise floor, median (untidy left out)", None, 1.05),
    ("worse_than_baseline", "nothing hidden: extended arm with a larger error on unseen trials than the baseline", None, 0.0),
    ("bias_removed", "compensated, and something named: share of the error of EI that the extended arm removes, median", 0.8, None),
    ("place_error_m", "place of contact and soft spot, median error, m", None, 0.02),
    ("law_share", "outside the catalogue, verdict unknown: share of what a flexible model learns that the discovered law explains, median",
     0.5, None),
]
# Of each of these worlds by itself: (worlds, figure, description, least, most)
IN_WORLDS = [
    (("tidy", "untidy", "solid", "real"), "confident_wrong", "confident (p > 0.9) and wrong", None, 0.02),
    (("tidy", "untidy", "solid", "real"), "interval_coverage", "90 % intervals that hold the true value", 0.85, 0.95),
    (("real",), "parameter_median_error", "size of a rightly named intervention, median relative error", None, 0.25),
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
                table.append([f"{world}: clear cases that only one decides rightly, diagnose to a baseline; McNemar's p", "0", "-",
                              f"< {most:g}", NOT_MET] + ["" for _ in prove_score.BASELINES])
            continue
        best, found = max(beside.items(), key=lambda one: one[1]["theirs_alone"] - one[1]["ours_alone"])
        ahead, clear = found["ours_alone"] > found["theirs_alone"], found["p"] < most
        judged = MET if ahead and clear else CONTRADICTED if clear else NOT_MET if figures["full"] else NOT_CONTRADICTED
        table.append([f"{world}: clear cases that only one decides rightly, diagnose to {best}; McNemar's p", str(found["cases"]),
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


HEADINGS = ["", "cases", "diagnose (90 %)", "target", "", *prove_score.BASELINES]


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
    if truth.get("class") or "set" in truth:
        return "class: " + (", ".join(truth.get("class", [])) or "none")
    return ", ".join(f"{item['effect']} {item['explains']:.2f}" for item in truth["ideal"][:3])


def number_of(count, one, many):
    return f"{count} {one if count == 1 else many}"


def rejected(figures):
    """Draws that did not do, cases that could not be drawn, and diagnoses that failed."""
    reasons = collections.Counter()
    for reason, count in figures["rejected_reasons"].items():
        reasons[re.sub(r": #$", "", reason)] += count  # "#" stands for a number that differs
    most = reasons.most_common(5)
    more = "; others" if len(reasons) > len(most) else ""
    why = " (" + "; ".join(f"{why}, {count} times" if count > 1 else f"{why}, once" for why, count in most) + more + ")" if most else ""
    failed = figures["failed"]
    return (f"{number_of(figures['rejected_draws'], 'draw was', 'draws were')} rejected before the seal{why}. "
            f"{number_of(figures['not_drawn'], 'case', 'cases')} could not be drawn. {number_of(failed, 'diagnosis', 'diagnoses')} failed"
            + (f"; {'it counts' if failed == 1 else 'they count'} as having said nothing." if failed else "."))


def cost(figures):
    if figures["seconds_median"] is None:
        return "No diagnosis was made."
    return (f"A diagnosis took {figures['seconds_median']:.0f} s (median), {figures['seconds_most']:.0f} s and "
            f"{figures['memory_bytes_most'] / 2**20:.0f} MiB at most.")


def moved(figures):
    """How the displacements are spread, by world."""
    spreads = []
    for world, found in figures["worlds"].items():
        spread = found.get("displacement", {})
        if spread.get("effects"):
            lost = f", {spread['unmeasured']} not measured" if spread["unmeasured"] else ""
            spreads.append(f"{world} " + ", ".join(number(value) for value in spread["quantiles"].values()) +
                           f" ({spread['effects']} effects{lost})")
    if not spreads:
        return ""
    return ("**Displacement.** How much of the displacement of a clear hidden effect is made by the effect that is named for it (the first\n"
            "right name, else the first wrong one; nothing named counts as 0, all of it as 1), at the quantiles 10, 25, 50, 75 and 90 %:\n"
            + "; ".join(spreads) + ".\n")


def versus(figures):
    """Who is right where the other one is not."""
    pairs = []
    for method, found in figures["baselines"].items():
        if found.get("mcnemar"):
            m = found["mcnemar"]
            pairs.append(f"`{method}` {m['ours_alone']} to {m['theirs_alone']} (p = {m['p']:.2g})")
    return ("Clear cases that `diagnose` alone decides rightly, to those that only the baseline does (McNemar): " + ", ".join(pairs) + "."
            if pairs else "")


JUDGED = """In brackets: 90 % intervals, Wilson's for rates, by a bootstrap of the cases for other figures. A target is

- *met* where the whole interval meets it,
- *contradicted* where no part of the interval meets it,
- *not met* where a part of it does, or where the whole proof has no figure,
- *not contradicted* where a part of it does, and the cases are too few to meet the target: in a sample, and in a world where even a
  diagnosis without an error would not meet it, or where the interval is wider than the target.

A single case contradicts a target of 0. A row of several kinds has their cases and one target together. Each world has to meet by
itself the targets that name it.

**Baselines.** Four simpler methods decide the same cases. They have what one round of the diagnosis has: the same fit, signatures,
noise with a background, refits, prior odds, forms other than the catalogue's, and least sizes. They decide differently, and their
probabilities are BIC weights of the refitted models: `per_frame` goes by the residuals of fits frame by frame alone, `bic` goes
forward step by step, `lasso` follows the path of a group lasso, and `gp` is a Gaussian process alone. `gp` never names an effect;
its alarm is an alarm of the other three, too."""


# How the cases of each world are made.
WORLDS_TEXT = """## The worlds

- **tidy**: nine trials of an arm in the virtual rig, which shares no code with the model of the diagnosis. The arm file is right
  but for the constants that are fitted. Where [the rig has one](effects.md#the-virtual-rigs-forms), a hidden effect has another
  form than the catalogue's.
- **untidy**: the same, and six to ten small departures besides, 0.2 to 3 mm together, so that nothing is quite as the arm file
  says.
  - The wished size of what is hidden is drawn evenly in its logarithm, from a fifth of the position noise to 4 mm. A few scalings
    come near it, and what they come to stays: nothing is drawn again because it is hard to see.
  - A case is *clear* where each hidden effect leaves as much as all departures together or more, and half of the position noise or
    more. That is sealed with the case.
  - Rates of naming count clear cases; `power`, `confident_wrong` and the intervals count all.
  - The masses in the arm file are the only scale of forces in recordings. Where the arm is heavier than its file says, true
    compliances, stiffnesses, weights and payloads are compared as such a file would have them.
- **solid**: [a silicone arm by finite elements](solid_arm.md), which is no rod model. An independent solver computed it once.
  - Five or six trials of states at rest, with new noise in each draw, and nothing or one of seven things hidden: a soft ring, an
    elastic clamp, a payload off the axis, an edge in the way, an input log with an offset or a dead zone, or a smaller chamber,
    which a gain absorbs.
  - Which names are right was decided before the first diagnosis. The stiff caps of the arm are there, are not in its file, and may
    be named.
  - The arm file is identified from other states of the arm with nothing hidden.
- **real**: recordings of two real arms ([a tendon trunk and a pouch arm](real_arms.md)), imported as they are (the controls), and
  again with one known fault (the interventions).
  - Most faults are put into the recorded table before it is imported: payloads stated with a factor, withheld or exchanged between
    trials; the clock of the cameras or of one input shifted or drifting; a body moved along or across the arm, or two bodies
    exchanged; the frame of the cameras tilted together with gravity, or the base tilted without it; the log of the inputs passed
    through a saturating gain, a dead zone, a lag, an offset, a play or a leak. The arm did what it did, so it seems to have the
    inverse of such a fault in the log.
  - Two faults are written into the arm file: gravity tilted, and one segment with the constants of another session.
  - Sizes are drawn evenly in their logarithm, from invisible to gross.
  - The arm file is identified from pieces of the recordings that are not diagnosed; where there are no others, from those.

A real arm has effects of its own, and nobody knows which. So an intervention is judged beside its control:

- A name that both get is the arm's own and finds nothing, unless it is in the class of the intervention, a small departure in the
  control and none in the intervention. (The baselines list no small departures, so that they gain nothing by this.)
- An intervention is *found* where the report names, with 50 % or more, an effect of its class that is not the arm's own.
- The *class* is decided and sealed before the first diagnosis. It has the effects that describe the intervention outright, and
  those that act like it: their signatures explain half or more of what the intervention leaves after the constants are refitted,
  and at least 0.9 of what the best effect explains. Where the class is empty, nothing in the catalogue acts like the intervention,
  and *unknown* is right.
- An intervention is *clear* where it leaves a quarter or more of what the constants leave of the untouched recordings. Rates count
  clear interventions; `power` counts all.
- In a control only those names are judged that describe one of its interventions outright. None of them may be named.
"""


def trials(results, figures, names):
    """doc/proof_trials.md: every case. names: of files, see prove_pages.py."""
    lines = [["case", "kind", "hidden", "an ideal detector", "said", "error on unseen trials: baseline -> extended (noise floor), mm", "judged"]]
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
    return f"""# Every case of {prove_short.what(figures)}

These are the cases of [{prove_short.what(figures)}]({names['story']}), seed {figures['seed']}. That page defines the words.

- *Hidden*: the effect, its form, and what it leaves after the arm's constants are refitted, in standard deviations (sd) and in mm.
  Of a recording of a real arm: the arm and the part of the recordings, the fault, and what it leaves beside what the untouched
  recordings leave.
- *An ideal detector*: the class that was sealed, or else the effects of the catalogue that explain most of what is hidden, with the
  share that each explains.
- *Said*: the verdict, then each name with its probability and, in square brackets, what the report lists as confusable with it.
- *Judged*: the [rates]({names['story']}#what-was-measured-and-how) that count against the diagnosis (bold where any other than `top1`
  and `top3` does). Of an intervention what [became of it]({names['story']}#known-interventions-on-real-recordings).

{markdown(lines)}
"""


MEASURED = """**Size of a hidden effect.** The same trials are simulated (or, of real recordings, imported) with and without it,
with the same random numbers. The arm's constants are fitted to each, and the residuals are subtracted: means over 0.2 s as the
diagnosis uses them, at the same times, each over its standard deviation (white noise, and what the diagnosis allows for swinging).
What the derivatives of the constants explain is projected out. The length of the rest is the signal to noise after a refit (*sd* on
these pages); its rms distance of a body is what the effect *leaves*, in metres. A body that stands out in a mean counts as in the
diagnosis, by Huber's weight: beyond four times the typical residual of the recording with the effect, squares grow as distances
do. A set of trials has some 13000 such numbers, so that 12 sd are 0.02 mm, no more than the error of the rig itself. Each effect
therefore leaves at least the `least_leftover_m` of the campaign file, too. An effect is *compensated* where its length with the
constants held is 20 sd or more, and a chi^2 test of fits frame by frame stays below 3 standard deviations.

**Rates.** A report's first name is meant without its stand-ins, and the *class* of a name is that name with all that the report
lists as confusable with it.

- `top1`: the first name is what is hidden; of a pair, one of the two.
- `top3`: what is hidden is among the first three of the ranking, and the report says that something is there.
- `right_class`: what is hidden, or a name that was sealed as right, too, is in the class of the first name; of a pair, each effect
  is in the class of some name.
- `both_named`: both effects of a pair are named.
- `unknown`: the verdict is *unknown*, or *partly explained* with an effect named first that acts like what is hidden. Counts where
  the best effect of the catalogue leaves 8 standard deviations or more of what is hidden.
- `found_or_cannot_tell`: what is hidden, or a name that was sealed as right, too, is in the class of some name, or its finding or
  the verdict is *cannot tell*.
- `false_alarm`: see [above](#in-short). Of an intervention, `top1`, `top3` and `right_class` go by its sealed class, as [the
  worlds](#the-worlds) say.
- `confident_wrong`: a name has a probability above 0.9, and neither it nor anything in its class is there.

Of a simulated arm with one effect hidden, what nobody can tell from that effect in these trials is a right name, too. That is
decided by signature and sealed with the draw: its signature and the hidden effect's have a cosine above 0.95 and, with the length
of what the effect leaves, are less than 3 sd apart (the rule by which the diagnosis calls two effects one class), and it explains
no less of that by 3 sd or more. Of the finite-element arm it was decided by hand.

Small departures that were simulated are there, and may be named. Of an effect outside the catalogue each effect that acts like it
counts as there: its signature explains half or more of what the hidden one leaves, and at least 0.9 of what the best effect
explains (sealed with the draw, as for real recordings).

**Displacement.** By how much an effect moves the bodies, every three seconds, in all trials. *Hidden*: the prediction with the
effect less that without it, beside one set of the arm's constants. *Found*: the same of the model in `arm_extended.yaml`. The share
is 1 - |found - hidden|^2 / |hidden|^2.

**An ideal detector** compares the effects of the catalogue with the noise-free difference, and knows which share each explains.
Where the hidden effect is not first there, its form differs from the catalogue's, or no detector could find it."""


def provenance(figures):
    return f"""## How this was run

`scripts/prove` wrote this page from {prove_figures.extent(figures)} of `{figures['campaign']}`, seed {figures['seed']}. The engine that diagnosed is
commit `{figures['engine']}`.
SHA-256 of what was hidden, taken before the first diagnosis: `{figures['truth_sha256']}`.
{rejected(figures)}
{cost(figures)}
"""


def story(results, figures, names):
    """doc/proof.md. names: of files, see prove_pages.py."""
    kinds = [["kind", "cases", "what is hidden"]]
    kinds += [[k, figures[k]["trials"], KIND_DESCRIPTION[k]] for k in prove_score.KINDS if figures[k]["trials"]]
    table_rows = rows(figures)
    example = next((row[0] for row in table_rows if row[0].endswith(": top1")), "single_strong: top1")
    return f"""# {prove_short.title(figures)}

{prove_short.summary(results, figures, names)}
{prove_short.story(results, names)}
## All figures and their targets

A name such as `{example}` is a kind of case and a rate:
[what was measured, and how](#what-was-measured-and-how) explains both.
The last columns are of simpler methods, which are explained below the table.

{markdown([HEADINGS] + table_rows)}

{JUDGED}
{versus(figures)}

{moved(figures)}
{prove_real_report.story(results, names.get("real"))}{WORLDS_TEXT}
## What was measured, and how

{markdown(kinds)}

{MEASURED}

{provenance(figures)}"""
