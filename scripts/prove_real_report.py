"""Of the proof's story: known interventions on real recordings, as text, table and picture."""
import prove_real_score
import prove_score

LOOKS = {"found": ("#1f6fb4", "o"), "in the control too": ("#8a8a8a", "s"), "named wrongly": ("#c0392b", "X"),
         "missed": ("#d9730d", "o"), "no name, unknown": ("#3a923a", "^"), "no name": ("#b8b8b8", "^")}

OUTCOMES = """- *Clear*: it leaves a quarter or more of what the arm's constants leave of the untouched recordings.
- *Found*: an effect of its class is named with 50 % or more, and is not the arm's own.
- *In the control too*: an effect of its class is named, but the untouched recordings get the same name.
- *Named wrongly*: it is not found, and the report has a confident statement that is wrong.
- *Missed*: it is not found, and nothing wrong is stated with confidence.
- *No name*: nothing in the catalogue acts like it, so that *unknown* is the right verdict; *no name, unknown* where that is the
  verdict.
"""


def description(truth):
    if not truth["effects"]:
        return f"{truth['set']}, {truth['split'] + 1}: untouched"
    effect = truth["effects"][0]
    clear = "" if truth["clear"] else ", not clear"
    return (f"{truth['set']}, {truth['split'] + 1}: {truth['words']}; leaves {1e3 * effect['signal']['leftover_m']:.2f} mm "
            f"(the untouched recordings {1e3 * truth['unexplained_m']:.2f} mm){clear}")


def outcome(decision, truth):
    found = prove_real_score.outcome(decision, truth, prove_score.is_confident_and_wrong(decision, truth))
    return f"**{found}**" if found == "named wrongly" or (truth["clear"] and found in ("missed", "in the control too")) else found


def interventions(results):
    """(change, leftover over the arm's own, clear, outcome) of each."""
    found = []
    for result in results:
        truth = result["truth"]
        if result["kind"] != "intervention" or not truth:
            continue
        decision, effect = prove_score.decision_of(result), truth["effects"][0]
        found.append((f"{truth['set']}: {effect['effect']}", effect["signal"]["leftover_m"] / truth["unexplained_m"], truth["clear"],
                      prove_real_score.outcome(decision, truth, prove_score.is_confident_and_wrong(decision, truth))))
    return found


def story(results, picture=None):
    """The table of outcomes by what was done, and a link to the picture; nothing where there are no real recordings."""
    listed = interventions(results)
    if not listed:
        return ""
    changes = sorted({change.split(": ")[1] for change, _, _, _ in listed})
    lines = ["| intervention | cases | clear | " + " | ".join(prove_real_score.BINS) + " |",
             "|" + "---|" * (3 + len(prove_real_score.BINS))]
    for change in changes:
        some = [one for one in listed if one[0].split(": ")[1] == change]
        counts = [sum(1 for one in some if one[3] == outcome) for outcome in prove_real_score.BINS]
        lines.append(f"| {change.replace('_', ' ')} | {len(some)} | {sum(1 for one in some if one[2])} | " +
                     " | ".join(str(n) if n else "" for n in counts) + " |")
    return ("## Known interventions on real recordings\n\nWhat became of each intervention, clear or not:\n\n" + "\n".join(lines) +
            "\n\n" + OUTCOMES + "\n" + (f"![Each intervention by its size]({picture})\n\n" if picture else ""))


def draw(results, path):
    """What became of each intervention, over its size; False where there are none."""
    listed = interventions(results)
    if not listed:
        return False
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    changes = sorted({change for change, _, _, _ in listed}, reverse=True)
    figure, axes = plt.subplots(figsize=(9.0, 1.6 + 0.23 * len(changes)), constrained_layout=True)
    for outcome in prove_real_score.BINS:
        some = [one for one in listed if one[3] == outcome]
        if some:
            colour, marker = LOOKS[outcome]
            axes.scatter([max(1e-3, one[1]) for one in some], [changes.index(one[0]) for one in some], color=colour, marker=marker,
                         s=42, label=f"{outcome} ({len(some)})", zorder=3)
    axes.set_xscale("log")
    axes.axvline(0.25, color="0.6", linewidth=1, linestyle=":")
    axes.text(0.26, -0.9, "clear", fontsize=8, color="0.4", va="bottom")
    axes.set_yticks(range(len(changes)))
    axes.set_yticklabels([change.replace("_", " ") for change in changes], fontsize=8)
    axes.set_ylim(-1, len(changes))
    axes.set_xlabel("what it leaves beside the arm's constants, over what these leave of the untouched recordings (rms)")
    axes.grid(alpha=0.25)
    axes.legend(fontsize=8, loc="lower center", bbox_to_anchor=(0.4, 1.0), ncol=3, frameon=False)
    figure.savefig(path, dpi=110)
    plt.close(figure)
    return True
