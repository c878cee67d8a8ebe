"""Of the proof's story: what a newcomer wants to know of it, before the table. Pure functions, no files."""
import statistics

import prove_figures
import prove_rig
import prove_score
import prove_solid
from prove_files import markdown

# What was hidden and what is counted, of which kinds of case, and the rate that answers it.
QUESTIONS = [
    ("nothing hidden: the report gives a false alarm", ("none", "untidy_none", "solid_none"), "false_alarm"),
    ("one effect, the arm file otherwise right: it is named first", ("single_strong",), "top1"),
    ("one effect barely above the noise, the arm file otherwise right: it is named first", ("single_weak",), "top1"),
    ("two effects, the arm file otherwise right: both are named", ("pair",), "both_named"),
    ("one effect, and small departures of everything: it is named first", ("untidy_single",), "top1"),
    ("the same: it is found", ("untidy_single",), "right_class"),
    ("an effect outside the catalogue: the report says so", ("outside", "untidy_outside"), "unknown"),
    ("finite-element arm, one effect: it is named first", ("solid_single",), "top1"),
    ("recordings of a real arm, one clear intervention: it is found", ("intervention",), "right_class"),
    ("the same recordings untouched: the report gives a false alarm", ("control",), "false_alarm"),
]
SURE = prove_score.CONFIDENT
FEWEST_CASES = 2  # of an effect that has a row of its own
FEWEST_STATEMENTS = 10  # of fewer no share is told in percent
WHOLE_PAGE = "proof.md"
GROUPS = {"simulated arms": ("tidy", "untidy"), "the finite-element arm": ("solid",), "real arms": ("real",)}
DEFINITIONS = """- *False alarm*: with nothing hidden, the report names an effect that is not there, whatever its probability. In
  the kind `none`, which has no departures above the noise, any name counts, and so does any verdict but *consistent* and *cannot
  tell*. For untouched recordings of a real arm only names of their interventions count, from 50 %.
- *Named first*: the effect is the first name in the report, whatever its probability. For an intervention only names from 50 %
  count that the untouched recordings do not get.
- *Found*: the effect is named first, or listed as confusable with the first name. An intervention is found where any name that
  counts, or one listed as confusable with it, is in the class that was sealed with the case: the effects that describe the
  intervention, or act like it.
- *Says so*, of an effect outside the catalogue: the verdict is *unknown*, or *partly explained* with an effect named first that
  acts like it.
- What a report lists as *stand-ins* (hardly there, below 10 %) is no name here.
- Cases in which what is hidden is too small to be seen (not *clear*, see [the worlds](#the-worlds)) count for false alarms and
  confident statements only.
"""
ONE_HIDDEN = {"simulated arms": ("single_strong", "single_weak", "compensated", "untidy_single"),
              "the finite-element arm": ("solid_single", "solid_compensated"), "real arms": ("intervention",)}


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
    lines = [["what was hidden: what is counted", "how often, of the cases that count (90 % interval)"]]
    for question, kinds, rate in QUESTIONS:
        hits, count = counted(results, kinds, rate)
        if count:
            lines.append([question, share_of(hits, count)])
    return markdown(lines)


def sure(results):
    """By world: (confident statements that are right, all of them, cases with one that is wrong, all cases with a report)."""
    found = {}
    for world, kinds in prove_figures.WORLDS.items():
        pairs = [(result, prove_score.decision_of(result)) for result in results
                 if result["truth"] and result["report"] and result["kind"] in kinds.values()]
        if pairs:
            hits = [bool(hit) for probability, hit in prove_figures.stated(pairs) if probability > SURE]
            wrong = sum(prove_score.is_confident_and_wrong(decision, result["truth"]) for result, decision in pairs)
            found[world] = (sum(hits), len(hits), wrong, len(pairs))
    return found


def sure_statements(results):
    lines = [["world", "confident statements that are right", "cases with a confident statement that is wrong"]]
    lines += [[world, share_of(right, said), share_of(wrong, cases)] for world, (right, said, wrong, cases) in sure(results).items()]
    return markdown(lines)


def joined(parts, space=" "):
    return f",{space}".join(parts[:-1]) + f"{space}and " + parts[-1] if len(parts) > 1 else "".join(parts)


def whole(figures):
    return figures["full"] and set(figures.get("worlds", prove_figures.WORLDS)) == set(prove_figures.WORLDS)


def campaign_of_its_own(figures):
    """Name of the campaign where it is none of the proof's; otherwise None."""
    named = figures.get("campaign")
    known = {*prove_rig.CAMPAIGNS.values(), *prove_figures.WORLDS}
    return named if named and not set(named.split(", ")) <= known else None


def what(figures):
    """What the pages are of, in words."""
    if campaign_of_its_own(figures):
        return f"the campaign `{campaign_of_its_own(figures)}`"
    if figures.get("so_far"):
        return "the proof so far"
    return "the proof" if whole(figures) else "a part of the proof" if figures["full"] else "a sample of the proof"


def arms(figures):
    """" of real and finite-element arms", where not all arms are there."""
    found = set(figures["worlds"])
    if not found or found == set(prove_figures.WORLDS) or campaign_of_its_own(figures):
        return ""
    simulated = [world for world in GROUPS["simulated arms"] if world in found]
    words = ["simulated" if len(simulated) == 2 else f"{simulated[0]} simulated"] if simulated else []
    words += [word for world, word in (("real", "real"), ("solid", "finite-element")) if world in found]
    return f" of {joined(words)} arms"


def cases_of(figures):
    return f"{figures['draws']} {'case' if figures['draws'] == 1 else 'cases'}"


def title(figures):
    if what(figures) == "the proof":
        return "The proof of `softarm diagnose`"
    of = what(figures)
    count = f"{figures['draws']} of {figures['so_far']} cases" if figures.get("so_far") else cases_of(figures)
    return f"{of[0].upper()}{of[1:]}: {count}{arms(figures)}"


def about(figures, names):
    """What the page is of, and of a part of the proof where the whole of it is; a sentence or two."""
    found = figures["worlds"]
    simulated = "simulated trials" if "tidy" in found or "untidy" in found else "trials of a finite-element arm" if "solid" in found else None
    done = [f"effects were hidden in {simulated}"] if simulated else []
    done += ["known faults were put into recordings of real arms"] if "real" in found else []
    text = (f"This page reports a blind test of `softarm diagnose` by {cases_of(figures)}:\n{', '.join(done)},\n"
            "and the diagnosis had to name them before the sealed truth was opened.\n")
    if what(figures) == "the proof":
        return text
    page = "the whole proof" if names["story"] == WHOLE_PAGE else f"[the whole proof]({WHOLE_PAGE})"
    if campaign_of_its_own(figures):
        return text + f"They are other cases than those of {page}, and few cases say little.\n"
    if figures["full"] or figures.get("so_far"):
        return text + f"It is no more than a part of {page}, and few cases say little.\n"
    return text + f"It is a sample: so few cases say little, and {page} has many more.\n"


def groups(results):
    """By group of worlds, and by world, what sure() has of it; of the groups that have any."""
    of = sure(results)
    found = {group: {world: of[world] for world in worlds if world in of} for group, worlds in GROUPS.items()}
    return {group: worlds for group, worlds in found.items() if worlds}


def total(worlds):
    """(confident statements that are right, all of them) of some worlds."""
    return tuple(sum(one[i] for one in worlds.values()) for i in (0, 1))


def right_statements(results):
    """How many of the confident statements are right, by group of worlds: a sentence."""
    parts = []
    for group, worlds in groups(results).items():
        right, said = total(worlds)
        later = "; see the note below" if "solid" in worlds and found_by_nature(results) else ""
        if said >= FEWEST_STATEMENTS:
            told = f"it is right in {right} of {said} statements ({100 * right / said:.0f} %)"
        else:
            told = f"there are too few statements to say ({right} of {said} right)" if said else "there is no such statement"
        parts.append(f"on {group} ({joined([f'*{world}*' for world in worlds])}{later}) {told}")
    return f"Where the diagnosis is more than {100 * SURE:.0f} % sure,\n" + ";\n".join(parts) + ".\n"


def trust(worlds):
    """"all", "none" or "some": how much of the 90 % interval of the share that is right is as right as it says. Where one of several
    worlds is not to be believed, its group is not; empty: too few statements leave it open."""
    def ends(right, said):
        return prove_figures.interval(right, said) or (0.0, 1.0)

    right, said = total(worlds)
    low, high = ends(right, said)
    if high < SURE or any(ends(*one[:2])[1] < SURE for one in worlds.values() if one[1] >= FEWEST_STATEMENTS):
        return "none"
    return "" if said < FEWEST_STATEMENTS else "all" if low >= SURE else "some"


def trusted(results):
    """Where what is said with confidence is to be believed, in three sentences at most."""
    of = {"all": [], "none": [], "some": [], "": []}
    for group, worlds in groups(results).items():
        of[trust(worlds)].append(f"on {group}")
    least, share = f"{100 * SURE:.0f} %", "the 90 % interval of the share that is right"
    text = f"Believe such statements {joined(of['all'])}:\nthere {share} is at {least} or above.\n" if of["all"] else ""
    text += f"Do not rely on them {joined(of['none'])}:\nthere {share} is below {least}.\n" if of["none"] else ""
    some = joined(of["some"])
    return text + (f"{some[0].upper()}{some[1:]} the figures leave this open:\n{share} includes {least}.\n" if some else "")


def found_single(results):
    """How often what is hidden alone is found, by group of worlds: a sentence; empty where nothing is."""
    counts = {group: counted(results, kinds, "right_class") for group, kinds in ONE_HIDDEN.items()}
    parts = [f"in {hits} of {count} cases{f' ({100 * hits / count:.0f} %)' if count >= FEWEST_STATEMENTS else ''} on {group}"
             for group, (hits, count) in counts.items() if count]
    if not parts:
        return ""
    lines = joined(parts, "\n")
    rest = ":\nwhat it does not name may be there all the same" if any(hits < count for hits, count in counts.values()) else ""
    return f"The diagnosis finds a single effect or fault that is large enough to be seen\n{lines}{rest}.\n"


def summary(results, figures, names):
    """What stands first on a page: what the page is, and what its figures come to; seven sentences at most."""
    if any(total(worlds)[1] for worlds in groups(results).values()):
        said = right_statements(results) + trusted(results)
    else:
        said = f"The diagnosis is nowhere more than {100 * SURE:.0f} % sure.\n"
    return about(figures, names) + said + found_single(results)


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
    was, it, them, are = ("was", "it", "it", "is") if one else ("were", "they", "them", "are")
    return (f"In the finite-element arm {joined([f'`{name}`' for name in sorted(said)])} {was} [measured](solid_arm.md#what-is-hidden) only after "
            f"this proof was sealed.\nThese pages therefore count {them} as not there, although {it} {are}. With {them} counted as there,\ncases of that world "
            f"with a confident statement that is wrong are {share_of(wrong_but_for_it, len(pairs))}.\n\n")


def by_effect(results):
    """Of clear cases with one thing hidden: how often it is named first, and found, the hardest first."""
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
    lines = [["hidden", "cases", "named first", "found", "leaves, mm (median)"]]
    listed = [(name, cases) for name, cases in of.items() if len(cases) >= FEWEST_CASES]
    rows = [[name, len(cases), sum(case[0] for case in cases), sum(case[1] for case in cases),
             f"{1e3 * statistics.median(case[2] for case in cases):.2f}"] for name, cases in listed]
    lines += sorted(rows, key=lambda row: (row[3] / row[1], row[2] / row[1], row[0]))
    return markdown(lines) if len(lines) > 1 else ""


def story(results, names):
    """The first section of doc/proof.md. names: of files, see prove_pages.py."""
    picture = f"![Stated probabilities against what was there]({names['calibration']})\n\n" if "calibration" in names else ""
    hardest = by_effect(results)
    if hardest:
        hardest = (f"By hidden effect, the hardest first (clear cases with one effect hidden; effects that were hidden {FEWEST_CASES} times or more).\n"
                   f"*Leaves*: by how much the effect still moves the bodies (rms) after the arm's constants are refitted:\n\n{hardest}\n\n")
    return f"""## In short

A case is a set of trials of one arm in which something is hidden, or nothing. Simulated trials come from programs that share no
code with the diagnosis; recordings of real arms are changed in a known way. The truth was sealed before the diagnosis saw the
trials.

{answers(results)}

{DEFINITIONS}
A *statement* is one effect in a report, with its probability. It is *confident* above {100 * SURE:.0f} %. It is *right* where that
effect, or one that the report lists as confusable with it, is there:

{sure_statements(results)}

On real arms an effect that is also named for the untouched recordings is the arm's own and not judged; for the untouched recordings
only names of their interventions are judged.

{found_by_nature(results)}{picture}{hardest}Every miss, with its reason and a picture: [misses]({names['misses_page']}).
Every case: [list]({names['trials_page']}).
"""
