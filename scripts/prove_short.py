"""Of the proof's story: what a newcomer wants to know of it, before the table. Pure functions, no files."""
import statistics

import prove_figures
import prove_score
import prove_solid
from prove_files import markdown

# What was asked, of which kinds of case, and the rate that answers it.
QUESTIONS = [
    ("nothing is hidden: something is accused", ("none", "untidy_none", "solid_none"), "false_alarm"),
    ("one effect, all else as the arm file says: it is named first", ("single_strong",), "top1"),
    ("the same, barely above the noise", ("single_weak",), "top1"),
    ("two effects, all else as the arm file says: both are named", ("pair",), "both_named"),
    ("one effect among small departures of everything: it is named first", ("untidy_single",), "top1"),
    ("the same: it is named first, or as what that may be mistaken for", ("untidy_single",), "right_class"),
    ("something that the catalogue does not have: that is said", ("outside", "untidy_outside"), "unknown"),
    ("an arm by finite elements, one thing hidden: it is named first", ("solid_single",), "top1"),
    ("recordings of real arms, one thing wrong that is clear: it is found", ("intervention",), "right_class"),
    ("the same recordings untouched: they are accused of that", ("control",), "false_alarm"),
]
SURE = prove_score.CONFIDENT
FEWEST_CASES = 2  # of an effect that has a row of its own


def counted(results, kinds, rate):
    """(in how many cases it is so, of how many that count)."""
    marks = [prove_score.marks(result["kind"], prove_score.decision_of(result), result["truth"]) for result in results
             if result["truth"] and result["kind"] in kinds]
    hits = [found[rate] for found in marks if rate in found]
    return sum(hits), len(hits)


def share_of(hits, count):
    """"7 of 8 (88 %; 58 to 97 %)", with the 90 % interval."""
    if not count:
        return "none"
    low, high = prove_figures.interval(hits, count)
    return f"{hits} of {count} ({100 * hits / count:.0f} %; {100 * low:.0f} to {100 * high:.0f} %)"


def answers(results):
    lines = [["what is asked", "how often it is so, of the cases that count (90 % interval)"]]
    for question, kinds, rate in QUESTIONS:
        hits, count = counted(results, kinds, rate)
        if count:
            lines.append([question, share_of(hits, count)])
    return markdown(lines)


def sure_statements(results):
    """By world: what is said with confidence, how often it is there, and in how many cases one is not."""
    lines = [["world", f"said at more than {100 * SURE:.0f} %, and there", "cases with one that is not there"]]
    for world, kinds in prove_figures.WORLDS.items():
        pairs = [(result, prove_score.decision_of(result)) for result in results
                 if result["truth"] and result["report"] and result["kind"] in kinds.values()]
        if not pairs:
            continue
        sure = [bool(hit) for probability, hit in prove_figures.stated(pairs) if probability > SURE]
        wrong = sum(prove_score.is_confident_and_wrong(decision, result["truth"]) for result, decision in pairs)
        lines.append([world, share_of(sum(sure), len(sure)), share_of(wrong, len(pairs))])
    return markdown(lines)


def found_by_nature(results):
    """What the finite-element arm was found to have after the proof was sealed; empty where that is sealed, or was not said."""
    of_nature = {told["effect"] for told in prove_solid.OF_NATURE}
    pairs = [(prove_score.decision_of(result), result["truth"]) for result in results
             if result["truth"] and result["report"] and "solid" in result["truth"]]
    said, wrong_but_for_it = set(), 0
    for decision, truth in pairs:
        later = of_nature - {effect["effect"] for effect in truth["distractors"]}
        known = {**truth, "distractors": [*truth["distractors"], *({"effect": name, "values": {}} for name in later)]}
        said |= {named["name"] for named in decision["named"] if named["name"] in later}
        wrong_but_for_it += prove_score.is_confident_and_wrong(decision, known)
    if not said:
        return ""
    one = len(said) == 1
    return (f"In the finite-element arm {' and '.join(f'`{name}`' for name in sorted(said))} {'was' if one else 'were'} "
            f"[measured](solid_arm.md#what-is-hidden) after this was sealed, so these pages count {'it' if one else 'them'} as not there. "
            f"{'It is' if one else 'They are'}: counted so, {share_of(wrong_but_for_it, len(pairs))} of the cases of that world have "
            f"something at more than {100 * SURE:.0f} % that is not there.\n\n")


def by_effect(results):
    """Of clear cases with one thing hidden: how often it is named first, and by its class, the hardest first."""
    of = {}
    for result in results:
        truth = result["truth"]
        if not truth or len(truth["effects"]) != 1 or not truth.get("clear", True):
            continue
        found = prove_score.marks(result["kind"], prove_score.decision_of(result), truth)
        if result["kind"] == "class_only" or found.get("right_class") is None:
            continue
        effect = truth["effects"][0]
        where = "real: " if result["kind"] == "intervention" else "finite elements: " if result["kind"].startswith("solid") else ""
        of.setdefault(where + effect["effect"].replace("_", " "), []).append(
            (found["top1"], found["right_class"], effect["signal"]["leftover_m"]))
    lines = [["hidden", "cases", "named first", "by its class", "leaves, mm (median)"]]
    listed = [(name, cases) for name, cases in of.items() if len(cases) >= FEWEST_CASES]
    rows = [[name, len(cases), sum(case[0] for case in cases), sum(case[1] for case in cases),
             f"{1e3 * statistics.median(case[2] for case in cases):.2f}"] for name, cases in listed]
    lines += sorted(rows, key=lambda row: (row[3] / row[1], row[2] / row[1], row[0]))
    return markdown(lines) if len(lines) > 1 else ""


def story(results, names):
    """The first section of doc/proof.md. names: of files, see prove_pages.py."""
    picture = f"![What was said against what was there]({names['calibration']})\n\n" if "calibration" in names else ""
    hardest = by_effect(results)
    if hardest:
        hardest = f"By what was hidden, the hardest first (clear cases; what was hidden {FEWEST_CASES} times or more):\n\n{hardest}\n\n"
    return f"""## In short

Trials were made of arms with something hidden in them, by programs that share no code with the diagnosis, or recorded from real
arms and changed in a known way. What was hidden was sealed before the diagnosis saw the trials. Then it was asked:

{answers(results)}

Accused: something is named that is not there, however improbable it is called, but for what a report lists as hardly there; of an arm with nothing hidden and no small departures
also *unknown*. Named first: before all else, however improbable; on real arms with 50 % or more.

How far it is to be believed where it is sure:

{sure_statements(results)}

{found_by_nature(results)}{picture}{hardest}What was missed, why, and what it looked like: [case by case]({names['misses_page']}). Every case: [list]({names['trials_page']}).
"""
