"""Figures of the proof: rates, calibration, intervals and power of many results. Pure functions, no files.

Results and decisions are those of prove_score.py; pairs are (result, decision).
"""
import collections
import math
import random
import re
import statistics

import prove_displacement
import prove_real_score
from prove_score import (BASELINES, KINDS, LEAST_BEYOND, all_marks, baseline_decision, beyond_catalogue, bias_removed, decision_of,
                         is_confident_and_wrong, is_right, judged, marks, right, sizes, unseen_rms_m)

RATES = ["top1", "top3", "right_class", "both_named", "false_alarm", "confident_wrong", "unknown", "found_or_cannot_tell"]
FIGURES = ["parameter_median_error", "interval_coverage", "held_out_over_floor", "place_error_m", "calibration_error",
           "confident_wrong", "bias_removed", "worse_than_baseline", "displacement_explained", "displacement_coverage",
           "untidy_held_out_over_floor", "law_share"]
CALIBRATION_BINS = 5


def stated(pairs):
    """(probability, was right) of everything that is named."""
    return [(named["probability"], right(named, result["truth"])) for result, decision in pairs
            for named in judged(decision, result["truth"]) if named.get("probability") is not None]


def calibration_bins(statements):
    """(probability, was right) in bins of equal width."""
    bins = [[] for _ in range(CALIBRATION_BINS)]
    for probability, hit in statements:
        bins[min(CALIBRATION_BINS - 1, int(probability * CALIBRATION_BINS))].append((probability, hit))
    return bins


def calibration_error(statements):
    """Expected calibration error of (probability, was right)."""
    if not statements:
        return None
    return sum(abs(sum(p for p, _ in b) - sum(bool(hit) for _, hit in b)) for b in calibration_bins(statements)) / len(statements)


def interval(hits, count):
    """Wilson's 90 % interval of a rate."""
    if count == 0:
        return None
    z, p = 1.6449, hits / count
    middle = (p + z * z / (2 * count)) / (1 + z * z / count)
    half = z / (1 + z * z / count) * math.sqrt(p * (1 - p) / count + z * z / (4 * count * count))
    return max(0.0, middle - half), min(1.0, middle + half)


BOOTSTRAPS = 400  # of cases: an interval's ends to a few percent of its width
BOOTSTRAP_SEED = 1
FEWEST_CASES = 5  # of a bootstrap: fewer are no picture of others like them


def figure_intervals(pairs):
    """90 % intervals of FIGURES by a bootstrap of the cases; absent where a figure is."""
    if len(pairs) < FEWEST_CASES:
        return {}
    draw = random.Random(BOOTSTRAP_SEED)
    found = {key: [] for key in FIGURES}
    for _ in range(BOOTSTRAPS):
        figures_of_draw = general([pairs[draw.randrange(len(pairs))] for _ in pairs], True)
        for key, value in figures_of_draw.items():
            if value is not None:
                found[key].append(value)
    table = {}
    for key, values in found.items():
        if values:
            values.sort()
            table[key] = (values[int(0.05 * (len(values) - 1))], values[math.ceil(0.95 * (len(values) - 1))])
    return table


def mcnemar(cases):
    """Of (ours is right, theirs is right): how often each alone is, and the exact two-sided p of that being chance."""
    ours = sum(1 for a, b in cases if a and not b)
    theirs = sum(1 for a, b in cases if b and not a)
    n = ours + theirs
    tail = sum(math.comb(n, k) for k in range(min(ours, theirs) + 1)) / 2 ** n
    return {"cases": len(cases), "ours_alone": ours, "theirs_alone": theirs, "p": min(1.0, 2.0 * tail)}


def mean(values):
    return sum(values) / len(values) if values else None


def rates(pairs):
    """pairs: (result, decision). Rates by kind."""
    table = {}
    for kind in KINDS:
        found = [marks(kind, decision, result["truth"]) for result, decision in pairs if result["kind"] == kind]
        table[kind] = {"trials": len(found), "counted": {}}
        for rate in RATES:
            counted = [m[rate] for m in found if rate in m]
            table[kind][rate] = mean(counted)
            table[kind]["counted"][rate] = len(counted)
    return table


def moved(pairs):
    return [score for result, _ in pairs for score in result.get("moved") or []]


def law_share(result):
    """Of something outside the catalogue that is said to be unknown: how much of what a flexible model learns the law takes that was
    discovered, on sequences that neither has seen; 0 where there is none. None: not asked, or of an older record, which lacks it (a
    report itself has its format and no null)."""
    report, truth = result["report"], result["truth"]
    if (result["kind"] not in ("outside", "untidy_outside") or beyond_catalogue(truth) < LEAST_BEYOND or report["verdict"] != "unknown"
            or not ("discovered_law" in report or "format" in report)):
        return None
    law = report.get("discovered_law")
    return (law or {"share_of_flexible": 0.0}).get("share_of_flexible")


def general(pairs, with_reports):
    figures = dict.fromkeys(FIGURES)
    figures["calibration_error"] = calibration_error(stated(pairs))
    figures["confident_wrong"] = mean([is_confident_and_wrong(decision, result["truth"]) for result, decision in pairs])
    if not with_reports:
        return figures
    errors, hits, places, removed, over, over_untidy, worse, laws = [], [], [], [], [], [], [], []
    for result, decision in pairs:
        report = result["report"]
        some_errors, some_hits, some_places = sizes(result)
        errors += some_errors
        hits += some_hits
        places += some_places
        laws += [share for share in [law_share(result)] if share is not None]
        if result["kind"] in ("none", "control"):
            worse.append(unseen_rms_m(report, "extended") > unseen_rms_m(report, "baseline"))
        elif result["kind"] not in ("outside", "untidy_outside", "intervention") and report["noise_floor_m"] > 0.0:
            # Of the untidy world no name explains the background: it has no target.
            of_world = over_untidy if result["kind"].startswith("untidy") else over
            of_world.append(unseen_rms_m(report, "extended") / report["noise_floor_m"])
        if result["kind"] == "compensated" and decision["named"]:
            share = bias_removed(result)
            if share is not None:
                removed.append(share)
    figures["parameter_median_error"] = statistics.median(errors) if errors else None
    figures["interval_coverage"] = mean(hits)
    figures["place_error_m"] = statistics.median(places) if places else None
    figures["held_out_over_floor"] = statistics.median(over) if over else None
    figures["untidy_held_out_over_floor"] = statistics.median(over_untidy) if over_untidy else None
    figures["bias_removed"] = statistics.median(removed) if removed else None
    figures["worse_than_baseline"] = mean(worse)
    figures["law_share"] = statistics.median(laws) if laws else None
    figures.update(prove_displacement.figures(moved(pairs)))
    return figures


# By the names that the contract has for them.
WORLDS = {"tidy": {kind: kind for kind in KINDS[:7]},
          "untidy": {"none": "untidy_none", "single_strong": "untidy_single", "pair": "untidy_pair", "outside": "untidy_outside"},
          "solid": {"none": "solid_none", "single_strong": "solid_single", "compensated": "solid_compensated"},
          "real": {"intervention": "intervention", "control": "control"}}
POWER_BINS = 4  # of equal numbers of cases


def power(pairs):
    """How often one hidden effect is in the class that is named first, by the size of what it leaves: smallest first."""
    def right_class(kind, decision, truth):  # of an intervention whether it is clear or not
        return prove_real_score.found(decision, truth) if kind == "intervention" else all_marks(kind, decision, truth).get("right_class")

    found = [(result["truth"]["effects"][0]["signal"]["leftover_m"], right_class(result["kind"], decision, result["truth"]))
             for result, decision in pairs if len(result["truth"]["effects"]) == 1]
    found = sorted((size, hit) for size, hit in found if hit is not None)
    bins = min(POWER_BINS, len(found))
    parts = [found[i * len(found) // bins:(i + 1) * len(found) // bins] for i in range(bins)]
    return [{"leftover_m": statistics.median(size for size, _ in part), "trials": len(part),
             "right_class": mean([hit for _, hit in part])} for part in parts]


def against(method, pairs):
    """McNemar of the diagnosis and a baseline, over the clear cases that both have decided (all where nothing says clear): of
    others nothing of naming counts, so that who says nothing would always be right."""
    both = [(is_right(r["kind"], d, r["truth"]), is_right(r["kind"], baseline_decision(r, method), r["truth"]))
            for r, d in pairs if r["truth"].get("clear", True) and baseline_decision(r, method)]
    return mcnemar(both)


def worlds(pairs):
    """One object per world and kind, with the figures of the world, its power curve and who is right alone."""
    table = {}
    for world, kinds in WORLDS.items():
        own = [(r, d) for r, d in pairs if r["kind"] in kinds.values()]
        if own:
            of_kinds = rates(own)
            reported = [(r, d) for r, d in own if r["report"]]
            table[world] = {**{name: of_kinds[kind] for name, kind in kinds.items()},
                            **general(reported, True), "reported": len(reported),
                            "interval_numbers": sum(len(sizes(r)[1]) for r, _ in reported), "intervals": figure_intervals(reported),
                            "power": power(own),
                            "displacement": prove_displacement.distribution(moved(own)),
                            "mcnemar": {method: against(method, own) for method in BASELINES}}
    return table


def extent(figures):
    """What part of the campaigns figures are of, in words: "from ... of"."""
    if figures.get("so_far"):
        return f"the {figures['draws']} cases that were decided so far, in random order, out of {figures['so_far']}"
    return "all cases" if figures["full"] else "a sample"


def reasons(results):
    """Why draws were rejected, numbers left out of the words: how often, the most frequent first."""
    words = collections.Counter(re.sub(r"-?\d+(\.\d+)?(e[+-]?\d+)?", "#", reason)
                                for r in results for reason in (r["truth"] or r).get("rejected", []))
    return dict(words.most_common())


# Of nine trials of 25 s.
TIMED_KINDS = (*WORLDS["tidy"].values(), *WORLDS["untidy"].values())


def times(drawn):
    """What diagnoses took, in seconds (a core for each), of all cores, and in bytes."""
    costs = [(r["kind"], r["cost"]) for r in drawn if r.get("cost")]
    seconds = [cost["seconds"] for _, cost in costs]
    of_cores = [cost["core_seconds"] for kind, cost in costs if kind in TIMED_KINDS and "core_seconds" in cost]
    return {"seconds_median": statistics.median(seconds) if seconds else None, "seconds_most": max(seconds, default=None),
            "core_seconds_median": statistics.median(of_cores) if of_cores else None, "core_seconds_most": max(of_cores, default=None),
            "memory_bytes_most": max((cost["memory_bytes"] for _, cost in costs), default=None)}


def figures(results):
    """All rates and figures; a case without a report counts as one that says nothing."""
    drawn = [result for result in results if result["truth"]]
    prove_real_score.link(drawn)
    for result in drawn:
        result["moved"] = prove_displacement.scores(result)
    pairs = [(r, decision_of(r)) for r in drawn]
    table = rates(pairs)
    reported = [(r, d) for r, d in pairs if r["report"]]
    table.update(general(reported, True))
    table["intervals"] = figure_intervals(reported)
    table["worlds"] = worlds(pairs)
    table["draws"] = len(results)
    table["rejected_reasons"] = reasons(results)
    table["rejected_draws"] = sum(table["rejected_reasons"].values())
    table["not_drawn"] = len(results) - len(drawn)
    table["failed"] = sum(1 for r in drawn if not r["report"])
    table.update(times(drawn))
    table["baselines"] = {}
    for method in BASELINES:
        of_method = [(r, baseline_decision(r, method)) for r in drawn if baseline_decision(r, method)]
        beside = against(method, pairs)
        of_worlds = {world: general([(r, d) for r, d in of_method if r["kind"] in kinds.values()], False) for world, kinds in WORLDS.items()}
        table["baselines"][method] = {**rates(of_method), **general(of_method, False), "mcnemar": beside,
                                      "mcnemar_p": beside["p"], "worlds": of_worlds}
    return table
