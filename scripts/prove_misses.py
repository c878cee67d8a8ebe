"""Of the proof's story: each case that counts against the diagnosis, why, and a picture of it. Results are those of prove_score.py."""
import math

import prove_real_score
import prove_score
from prove_figures import WORLDS

ACTS_LIKE = 0.5  # share of what is hidden, from which on an effect that explains it is said to act like it
NOTHING_OF_IT = 0.1  # below which it has nothing to do with it
NEAR_BEST = 0.9  # of the best effect's share: less, and the hidden one has another form than the catalogue's
PANELS_ACROSS, PANEL_INCHES, MOST_PANELS = 4, (3.1, 2.0), 48  # of a picture


def counts_against(result):
    """What of a case does: names of rates, and of an intervention its outcome; empty where nothing does."""
    if not result["truth"]:
        return []
    decision = prove_score.decision_of(result)
    wrong = [rate for rate, value in prove_score.marks(result["kind"], decision, result["truth"]).items()
             if value == (rate in ("false_alarm", "confident_wrong"))]
    return wrong if result["report"] else wrong or ["no report"]


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
    """Share of what is hidden that each effect of the catalogue explains, to an ideal detector."""
    return {item["effect"]: item["explains"] for item in truth.get("ideal", [])}


def percent(share):
    return "under 1 %" if 0.0 <= share < 0.005 else f"{100 * share:.0f} %"


def joined(words):
    return ", ".join(words[:-1]) + " and " + words[-1] if len(words) > 1 else "".join(words)


def of_wrong_statement(named, truth):
    """What a statement that is wrong takes for what it says."""
    share = explained_by(truth).get(named["name"])
    said = f"`{named['name']}` ({percent(named.get('probability') or 0.0)})"
    if not truth["effects"]:
        return f"{said} is not there: small departures together, or the noise, look like it"
    if share is None:
        return f"{said} is not there"
    if share >= ACTS_LIKE:
        return f"{said} acts like what is hidden: it explains {percent(share)} of it"
    if share < NOTHING_OF_IT:
        return f"{said} has nothing of what is hidden ({percent(share)} of it): it takes what another form or small departures leave"
    return f"{said} explains {percent(share)} of what is hidden"


def of_form(effect, truth):
    """What the catalogue can say of a hidden effect at all; empty where it is the best that can be said."""
    shares = explained_by(truth)
    best = max(shares, key=shares.get, default=None)
    own = shares.get(effect)
    if best is None or best == effect:
        return ""
    if own is None:
        return f"to an ideal detector `{best}` explains most of it ({percent(shares[best])})"
    if own < NEAR_BEST * shares[best]:
        return (f"its form is not the catalogue's: that explains {percent(own)} of it, `{best}` {percent(shares[best])}")
    return f"`{best}` explains as much of it ({percent(shares[best])}; the catalogue's own form {percent(own)})"


def of_silence(effect, result):
    """What became of a hidden effect that is not the first one named."""
    report, decision = result["report"], prove_score.decision_of(result)
    for place, named in enumerate(decision["named"], 1):
        if named["name"] == effect:
            before = [f"`{one['name']}`" for one in decision["named"][:place - 1]]
            there = [prove_score.right(one, result["truth"]) for one in decision["named"][:place - 1]]
            whose = "" if not before else f" after {joined(before)}" + (", which is there, too" if all(there) and len(there) == 1 else
                                                                        ", which are there, too" if all(there) else "")
            return f"told{whose}, at {percent(named.get('probability') or 0.0)}"
        if effect in named.get("confusable_with", []):
            return f"told as what `{named['name']}` may be mistaken for"
    for place, candidate in enumerate(report["ranking"], 1):
        if candidate["name"] == effect:
            finding = str(candidate.get("finding", "absent")).replace("_", " ")
            return f"not told; in the ranking it is no. {place}, at {percent(candidate.get('probability') or 0.0)} ({finding})"
    return "not told"


def of_size(result):
    """What is hidden beside what else is there."""
    truth = result["truth"]
    if not truth["effects"]:
        return ""
    leaves = 1e3 * math.sqrt(sum(effect["signal"]["leftover_m"] ** 2 for effect in truth["effects"]))
    beside = truth.get("distractors_leave_m", truth.get("unexplained_m"))
    if beside is None:
        return f"it leaves {leaves:.2f} mm of an error of {1e3 * result['report']['baseline']['held_out_rms_m']:.2f} mm"
    others = "of the arm's own" if "unexplained_m" in truth else "of small departures"
    return f"it leaves {leaves:.2f} mm beside {1e3 * beside:.2f} mm {others}"


def why(result):
    """One or more sentences, each from the numbers of the case."""
    truth, report = result["truth"], result["report"]
    if report is None:
        return "the diagnosis failed: " + ((result.get("cost") or {}).get("message") or "no report")
    decision, against = prove_score.decision_of(result), counts_against(result)
    said = []
    silent = [rate for rate in against if rate not in ("false_alarm", "confident_wrong", "unknown")]
    if silent and result["kind"] == "intervention":
        names = truth["effects"][0]["names"]
        known = set(decision.get("before", ())) & set(truth["class"])
        if known:
            said.append(f"{joined([f'`{name}`' for name in sorted(known)])} is what its untouched recordings are told, too")
        said += [f"`{name}` is {of_silence(name, result)}" for name in names if name not in known]
        if names:
            said.append(of_form(names[0], truth))
    elif silent:
        for effect in prove_score.hidden(truth):
            said.append(f"`{effect}` is {of_silence(effect, result)}")
            if len(truth["effects"]) == 1:  # of several an ideal detector sees all together
                said.append(of_form(effect, truth))
    if "unknown" in against:
        said.append(f"the best effect of the catalogue leaves {prove_score.beyond_catalogue(truth):.0f} sd of it, and that was not said")
    wrong = [named for named in prove_score.judged(decision, truth) if not prove_score.right(named, truth)
             and (named.get("probability") or 0.0) >= prove_real_score.NAMED_AT_LEAST]
    said += [of_wrong_statement(named, truth) for named in wrong]
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


def cell(text):
    return str(text).replace("|", "/").replace("\n", " ")


def story(results, figures, names):
    """doc/proof_misses.md. names: of files, see prove_pages.py."""
    drawn = [result for result in results if result["truth"]]
    by_world = missed(results)
    size = "the whole" if figures["full"] else "a sample"
    text = f"""# What the proof missed, and why

Written by `scripts/prove` about {size} of [the proof]({names['story']}), seed {figures['seed']}, engine `{figures['engine'][:12]}`: each case
that counts against the diagnosis, {sum(len(some) for some in by_world.values())} of {len(drawn)}. Reasons are worked out from what was hidden, what was said and what an ideal
detector would see. *Explains*: of what is hidden, beside the arm's constants, so much an effect of the catalogue explains at its best.
A case that is not clear counts only where something is told that is not there. What the rates mean: [the proof]({names['story']}).
"""
    for world, some in by_world.items():
        of_world = sum(1 for result in drawn if world_of(result["kind"]) == world)
        text += f"\n## {world.capitalize()}: {len(some)} of {of_world} cases\n\n"
        if world in names["misses"]:
            text += (f"![What was hidden and what was told, case by case]({names['misses'][world]})\n\n"
                     "Over all trials, one after the other: how far what is hidden moves the bodies (grey), and what was told does (red: "
                     "not there; blue: there).\n\n")
        text += "| case | hidden | said | counts as | why |\n|---|---|---|---|---|\n"
        for result in some:
            row = [result["case"], hidden(result["truth"]), told(result), ", ".join(
                rate if rate in ("false_alarm", "confident_wrong", "no report") else f"not {rate}" for rate in counts_against(result)), why(result)]
            text += "| " + " | ".join(cell(one) for one in row) + " |\n"
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
    return found + there[:2]


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
    figure.supylabel("mm", fontsize=8)
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
