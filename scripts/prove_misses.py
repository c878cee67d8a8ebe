"""Of the proof's story: each case that counts against the diagnosis, why, and a picture of it. Results are those of prove_score.py."""
import math

import prove_real_score
import prove_score
from prove_figures import WORLDS, extent
from prove_files import markdown

ACTS_LIKE = 0.5  # share of what is hidden, from which on an effect that explains it is said to act like it
AS_MUCH = 0.9  # of the best effect's share: more is as much
PANELS_ACROSS, PANEL_INCHES, MOST_PANELS, MOST_TOLD = 4, (3.1, 2.0), 48, 2  # of a picture; curves of what was told, of a panel
WORDS = {"top1": "not first", "top3": "not among three", "right_class": "not by its class", "both_named": "not both",
         "unknown": "not said to be unknown", "found_or_cannot_tell": "neither found nor undecided",
         "false_alarm": "**accused**", "confident_wrong": "**sure and wrong**"}


def counts_against(result):
    """Names of the rates that a case counts against; empty where there are none. A diagnosis that failed says nothing."""
    if not result["truth"]:
        return []
    if result["report"] is None:
        return ["no report"]
    decision = prove_score.decision_of(result)
    return [rate for rate, value in prove_score.marks(result["kind"], decision, result["truth"]).items()
            if value == (rate in ("false_alarm", "confident_wrong"))]


def world_of(kind):
    return next(world for world, kinds in WORLDS.items() if kind in kinds.values())


def missed(results):
    """Those results by world, in the order of their cases."""
    by_world = {world: [] for world in WORLDS}
    for result in results:
        if counts_against(result):
            by_world[world_of(result["kind"])].append(result)
    return {world: some for world, some in by_world.items() if some}


def explained_by(truth):
    """Share of what is hidden that each effect of the catalogue explains, to an ideal detector; to first order."""
    return {item["effect"]: item["explains"] for item in truth.get("ideal", [])}


def percent(share):
    return "under 1 %" if share < 0.005 else "over 99 %" if 0.995 <= share < 1.0 else f"{100 * share:.0f} %"


def joined(effects):
    """Names of named effects, in words."""
    names = [f"`{named['name']}`" for named in effects]
    return ", ".join(names[:-1]) + " and " + names[-1] if len(names) > 1 else "".join(names)


def of_wrong_statement(named, result):
    """What is told and is not so."""
    truth = result["truth"]
    said = f"`{named['name']}` ({percent(named.get('probability') or 0.0)})"
    if result["kind"] == "control":
        return f"{said} is what its interventions have, and is told of the untouched recordings"
    share = explained_by(truth).get(named["name"])
    if not truth["effects"] or share is None:
        return f"{said} is not there"
    if share >= ACTS_LIKE:
        return f"{said} acts like what is hidden: it explains {percent(share)} of it"
    return f"{said} is not there: it explains {percent(share)} of what is hidden"


def of_form(effect, truth):
    """What the catalogue can say of a hidden effect at all; empty where its own law is the best that can be said."""
    shares = explained_by(truth)
    best = max(shares, key=shares.get, default=None)
    own = shares.get(effect)
    if best is None or best == effect:
        return ""
    if shares[best] < ACTS_LIKE:
        return f"to first order no effect of the catalogue explains half of it (best: `{best}`, {percent(shares[best])})"
    if own is not None and own >= AS_MUCH * shares[best]:
        return f"`{best}` explains as much of it ({percent(shares[best])}; its own law {percent(own)})"
    return f"`{best}` explains {percent(shares[best])} of it" + ("" if own is None else f", the catalogue's law of its own {percent(own)}")


def of_silence(effect, result):
    """What became of an effect that should be the first one named."""
    report, decision = result["report"], prove_score.decision_of(result)
    for place, named in enumerate(decision["named"], 1):
        if named["name"] == effect:
            before = decision["named"][:place - 1]
            whose = f" after {joined(before)}" if before else ""
            there = {one["effect"] for one in prove_score.everything(result["truth"])} | set(prove_score.hidden(result["truth"]))
            if before and all(one["name"] in there for one in before):
                whose += ", which is there, too" if len(before) == 1 else ", which are there, too"
            return f"told{whose}, at {percent(named.get('probability') or 0.0)}"
    for named in decision["named"]:
        if effect in named.get("confusable_with", []):
            return f"told as what `{named['name']}` may be mistaken for"
    for place, candidate in enumerate(report["ranking"], 1):
        if candidate["name"] == effect:
            finding = str(candidate.get("finding", "absent")).replace("_", " ")
            return f"not told; it has place {place} of the ranking, at {percent(candidate.get('probability') or 0.0)} ({finding})"
    return "not told"


def of_intervention(result):
    """What became of the names that it may be called by."""
    truth, decision = result["truth"], prove_score.decision_of(result)
    said = []
    told = [named for named in prove_real_score.new(decision) if prove_real_score.meets(named, truth)]
    if told:
        said.append(f"found by what is told later, or by what that may be mistaken for: {joined(told)}")
    names = truth["effects"][0]["names"] or truth["class"]
    known = [name for name in names if name in decision.get("before", ())]
    said += [f"`{name}` is what its untouched recordings are told, too" for name in known]
    if not told:
        said += [f"`{name}` is {of_silence(name, result)}" for name in names if name not in known]
        said.append(of_form(names[0], truth) if names else "")
    return said


def of_size(result):
    """What is hidden beside what else is there."""
    truth = result["truth"]
    if not truth["effects"]:
        return ""
    leaves = 1e3 * math.sqrt(sum(effect["signal"]["leftover_m"] ** 2 for effect in truth["effects"]))
    beside = truth.get("distractors_leave_m", truth.get("unexplained_m"))
    if beside is None:
        return f"it leaves {leaves:.2f} mm, the arm file {1e3 * prove_score.unseen_rms_m(result['report'], 'baseline'):.2f} mm on trials left out"
    others = "of the arm's own" if "unexplained_m" in truth else "of small departures"
    return f"it leaves {leaves:.2f} mm beside {1e3 * beside:.2f} mm {others}"


def wrong_statements(result):
    """Those that count: of an accusation all but what is listed as hardly there, of a case with something hidden those that are
    more probable than not."""
    truth, decision = result["truth"], prove_score.decision_of(result)
    alarmed = "false_alarm" in counts_against(result) and result["kind"] != "control"
    return [named for named in prove_score.judged(decision, truth) if not prove_score.right(named, truth)
            and (not named.get("stand_in") if alarmed else prove_real_score.is_named(named))]


def why(result):
    """In words, each from the numbers of the case."""
    truth, report = result["truth"], result["report"]
    if report is None:
        return "the diagnosis failed: " + ((result.get("cost") or {}).get("message") or "no report")
    against = counts_against(result)
    said = []
    if any(rate not in ("false_alarm", "confident_wrong", "unknown") for rate in against):
        if result["kind"] == "intervention":
            said += of_intervention(result)
        else:
            for effect in prove_score.hidden(truth):
                said.append(f"`{effect}` is {of_silence(effect, result)}")
                if len(truth["effects"]) == 1:  # of several an ideal detector sees all together
                    said.append(of_form(effect, truth))
    if "unknown" in against and result["kind"] != "intervention":
        said.append(f"the best effect of the catalogue leaves {prove_score.beyond_catalogue(truth):.0f} sd of it, and that was not said")
    wrong = wrong_statements(result)
    said += [of_wrong_statement(named, result) for named in wrong]
    if "false_alarm" in against and not wrong:
        named = prove_score.said(prove_score.decision_of(result))
        said.append("what it names is there, and too small to be told" if named else
                    f"nothing is named that is not there; the verdict is {report['verdict']}")
    said.append(of_size(result))
    return "; ".join(text for text in said if text)


def statement(named):
    alike = named.get("confusable_with", [])
    return f"{named['name']} {named['probability']:.2f}" + (f" [{', '.join(alike)}]" if alike else "")


def told(result):
    if result["report"] is None:
        return "no report"
    named = prove_real_score.stated(prove_score.decision_of(result))
    return result["report"]["verdict"] + (": " + "; ".join(statement(one) for one in named) if named else "")


def hidden(truth):
    if "set" in truth:
        return f"{truth['set']}, {truth['split'] + 1}: " + (truth["words"] if truth["effects"] else "untouched")
    return "; ".join(effect["effect"] + (f" ({effect['form']})" if effect.get("form") else "") for effect in truth["effects"]) or "nothing"


CAPTION = f"""
Pictures: over all trials, one after the other: how far what is hidden moves the bodies (grey), and what was told does (blue where it is
right, by itself or by what it may be mistaken for; red where it is not). Of what was told the {MOST_TOLD} largest that are more
probable than not; the first {MOST_PANELS} cases in which anything was measured.
"""


def story(results, figures, names):
    """doc/proof_misses.md. names: of files, see prove_pages.py."""
    drawn = [result for result in results if result["truth"]]
    by_world = missed(results)
    text = f"""# What the proof missed, and why

Written by `scripts/prove` about {extent(figures)} of [the proof]({names['story']}), seed {figures['seed']}, engine `{figures['engine']}`: each case
that counts against the diagnosis, {sum(len(some) for some in by_world.values())} of {len(drawn)}. Reasons are worked out from what was hidden, what was said and what an ideal
detector would see. *Explains*: so much of what is hidden, beside the arm's constants, an effect of the catalogue explains at its best,
to first order. A case that is not clear counts only where something is told that is not there, or the diagnosis failed.
[What the rates mean]({names['story']}).
""" + (CAPTION if names["misses"] else "")
    for world, some in by_world.items():
        of_world = sum(1 for result in drawn if world_of(result["kind"]) == world)
        text += f"\n## {world.capitalize()}: {len(some)} of {of_world} cases\n\n"
        if world in names["misses"]:
            text += f"![What was hidden and what was told]({names['misses'][world]})\n\n"
        elif names["misses"]:
            text += "No picture: how far bodies move was measured of none of these.\n\n"
        lines = [["case", "hidden", "said", "counts as", "why"]]
        for result in some:
            against = ", ".join(WORDS.get(rate, rate) for rate in counts_against(result))
            lines.append([result["case"], hidden(result["truth"]), told(result), against, why(result)])
        text += markdown(lines) + "\n"
    return text


def course(trials):
    """By instant, trial after trial: rms of how far the bodies are moved, in mm. Rows are in micrometres."""
    means = []
    for rows in trials:
        at = {}
        for second, _, *move in rows:
            at.setdefault(second, []).append(sum(x * x for x in move))
        means += [1e-3 * math.sqrt(sum(squares) / len(squares)) for _, squares in sorted(at.items())]
    return means


def curves(result):
    """(label, colour, course) of what was hidden, then of what was told of it; empty where nothing was measured."""
    found = []
    for effect, trials in zip(result["truth"]["effects"], result.get("hidden_moves") or []):
        found.append((effect["effect"], "0.55", course(trials)))
    named = {one["name"]: one for one in prove_real_score.stated(prove_score.decision_of(result))}
    there = []
    for moves in result.get("found_moves") or []:
        one = named.get(moves["effect"])
        if one is not None and prove_real_score.is_named(one):
            is_right = prove_score.right(one, result["truth"])
            there.append((moves["effect"], "#1f6fb4" if is_right else "#c0392b", course(moves["trials"])))
    there.sort(key=lambda one: -sum(x * x for x in one[2]))
    return found + there[:MOST_TOLD]


def draw(results, path):
    """One panel for each; those that have no curve are left out. False where none has one."""
    panels = [(result, curves(result)) for result in results if result["report"]]
    panels = [(result, some) for result, some in panels if any(one[2] for one in some)][:MOST_PANELS]
    if not panels:
        return False
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    down = math.ceil(len(panels) / PANELS_ACROSS)
    across = min(PANELS_ACROSS, len(panels))
    figure, axes = plt.subplots(down, across, squeeze=False, constrained_layout=True,
                                figsize=(PANEL_INCHES[0] * across, PANEL_INCHES[1] * down))
    for axis in axes.flat[len(panels):]:
        axis.set_axis_off()
    for axis, (result, some) in zip(axes.flat, panels):
        for number, (label, colour, values) in enumerate(some):
            grey, first = colour == "0.55", number <= len(result["truth"]["effects"])
            axis.plot(values, color=colour, linewidth=1.6 if grey else 0.9, linestyle="-" if first else "--",
                      label=("hidden: " if grey else "") + label)
        axis.set_title(result["case"].replace("case_", ""), fontsize=8, loc="left", pad=2)
        axis.set_ylim(0, 1.45 * max(1e-3, *(value for one in some for value in one[2])))  # the legend stands above the curves
        axis.margins(x=0)
        axis.tick_params(labelsize=6)
        axis.set_xticks([])
        axis.legend(fontsize=5.5, frameon=False, loc="upper right", handlelength=1.2, borderaxespad=0.1)
    for axis in axes[:, 0]:
        axis.set_ylabel("mm", fontsize=7)
    figure.savefig(path, dpi=90)
    plt.close(figure)
    return True


def draw_all(results, stem):
    """A picture of each world; their paths by world."""
    drawn = {}
    for world, some in missed(results).items():
        path = f"{stem}_misses_{world}.png"
        if draw(some, path):
            drawn[world] = path
    return drawn
