"""Of the proof's story: each case that counts against the diagnosis, why, and a picture of it. Results are those of prove_score.py."""
import math

import prove_real_score
import prove_score
import prove_short
from prove_figures import WORLDS, extent
from prove_files import markdown

ACTS_LIKE = 0.5  # share of what is hidden, from which on an effect that explains it is said to act like it
AS_MUCH = 0.9  # of the best effect's share: more is as much
PANELS_ACROSS, PANEL_INCHES, MOST_PANELS, MOST_TOLD = 4, (3.1, 2.0), 48, 2  # of a picture; curves of what was told, of a panel
WORDS = {"top1": "not named first", "top3": "not in the first three", "right_class": "class not named", "both_named": "not both named",
         "unknown": "not said to be unknown", "found_or_cannot_tell": "neither found nor said to be undecidable",
         "false_alarm": "**false alarm**", "confident_wrong": "**confident and wrong**"}


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
    """What is named and is not so."""
    truth = result["truth"]
    said = f"`{named['name']}` ({percent(named.get('probability') or 0.0)})"
    if result["kind"] == "control":
        return f"{said} is named for the untouched recordings, though it describes one of their interventions"
    share = explained_by(truth).get(named["name"])
    if not truth["effects"] or share is None:
        return f"{said} is not there"
    if share >= ACTS_LIKE:
        return f"{said} is not there, but acts like what is hidden (explains {percent(share)} of that)"
    return f"{said} is not there (explains {percent(share)} of what is hidden)"


def of_form(effect, truth):
    """What the catalogue can say of a hidden effect at all; empty where its own law is the best that can be said."""
    shares = explained_by(truth)
    best = max(shares, key=shares.get, default=None)
    own = shares.get(effect)
    if best is None or best == effect:
        return ""
    if shares[best] < ACTS_LIKE:
        return f"no effect of the catalogue explains half of what is hidden (best: `{best}`, {percent(shares[best])})"
    if own is not None and own >= AS_MUCH * shares[best]:
        return f"`{best}` explains {percent(shares[best])} of what is hidden, as much as the catalogue's `{effect}` ({percent(own)})"
    return f"`{best}` explains {percent(shares[best])} of what is hidden" + ("" if own is None else f", the catalogue's `{effect}` {percent(own)}")


def of_silence(effect, result):
    """What became of an effect that should be the first one named."""
    report, decision = result["report"], prove_score.decision_of(result)
    for place, named in enumerate(decision["named"], 1):
        if named["name"] == effect:
            before = decision["named"][:place - 1]
            whose = f", after {joined(before)}" if before else ""
            there = {one["effect"] for one in prove_score.everything(result["truth"])} | set(prove_score.hidden(result["truth"]))
            if before and all(one["name"] in there for one in before):
                whose += ", which is also there" if len(before) == 1 else ", which are also there"
            return f"named with {percent(named.get('probability') or 0.0)}{whose}"
    for named in decision["named"]:
        if effect in named.get("confusable_with", []):
            return f"only listed as confusable with `{named['name']}`"
    for place, candidate in enumerate(report["ranking"], 1):
        if candidate["name"] == effect:
            finding = str(candidate.get("finding", "absent")).replace("_", " ")
            return f"not named (number {place} of the ranking, with {percent(candidate.get('probability') or 0.0)}: {finding})"
    return "not named"


def of_intervention(result):
    """What became of the names that it may be called by."""
    truth, decision = result["truth"], prove_score.decision_of(result)
    said = []
    told = [named for named in prove_real_score.new(decision) if prove_real_score.meets(named, truth)]
    if told:
        said.append(f"found, but not by the first name: by {joined(told)}, or what is listed as confusable with that")
    names = truth["effects"][0]["names"] or truth["class"]
    known = [name for name in names if name in decision.get("before", ())]
    said += [f"`{name}` is also named for the untouched recordings" for name in known]
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
        baseline = 1e3 * prove_score.unseen_rms_m(result["report"], "baseline")
        return f"what is hidden leaves {leaves:.2f} mm (error of the baseline on unseen trials: {baseline:.2f} mm)"
    others = "untouched recordings" if "unexplained_m" in truth else "small departures"
    return f"what is hidden leaves {leaves:.2f} mm (the {others}: {1e3 * beside:.2f} mm)"


def wrong_statements(result):
    """Those that count: of a false alarm all but what is listed as hardly there, of a case with something hidden those that are
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
        beyond = prove_score.beyond_catalogue(truth)
        said.append(f"the best effect of the catalogue leaves {beyond:.0f} sd of what is hidden, so that the verdict should be unknown")
    wrong = wrong_statements(result)
    said += [of_wrong_statement(named, result) for named in wrong]
    if "false_alarm" in against and not wrong:
        named = prove_score.said(prove_score.decision_of(result))
        said.append("what is named is there, but too small to count" if named else
                    f"nothing wrong is named, but the verdict is {report['verdict']}")
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
The pictures have a panel for each case. Over all trials, one after the other, they show by how much the bodies are moved: by what
is hidden (grey), and by what was named (blue where it, or what is listed as confusable with it, is there; red where not). Of the
names with 50 % or more the {MOST_TOLD} that move the bodies most are drawn. A picture has the first {MOST_PANELS} cases with a
measurement.
"""


def story(results, figures, names):
    """doc/proof_misses.md. names: of files, see prove_pages.py."""
    drawn = [result for result in results if result["truth"]]
    by_world = missed(results)
    text = f"""# What {prove_short.what(figures)} missed, and why

Of the {len(drawn)} cases of [{prove_short.what(figures)}]({names['story']}), {sum(len(some) for some in by_world.values())} count against the
diagnosis. This page lists each of them, with the reasons.
`scripts/prove` worked these out from what was hidden, what the report said and what an ideal detector would see.
These pages are of {extent(figures)}; seed {figures['seed']}, engine `{figures['engine']}`.

- *Said*: the verdict, then each name with its probability and, in square brackets, what the report lists as confusable with it.
- *Counts as*: [the rates]({names['story']}#what-was-measured-and-how) that count against the diagnosis. A case that is not clear is
  here only for a false alarm, for a confident statement that is wrong, or because the diagnosis failed.
- *Explains*: the largest share of what is hidden, beside the arm's constants, that an effect of the catalogue can explain, to first
  order.
- *Leaves*: by how much what is hidden moves the bodies (rms) after the constants are refitted. In brackets what there is besides.
""" + (CAPTION if names["misses"] else "")
    for world, some in by_world.items():
        of_world = sum(1 for result in drawn if world_of(result["kind"]) == world)
        text += f"\n## {world.capitalize()}: {len(some)} of {of_world} cases\n\n"
        if world in names["misses"]:
            text += f"![What was hidden and what was named]({names['misses'][world]})\n\n"
        elif names["misses"]:
            text += "No picture: no displacement was measured in these cases.\n\n"
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
