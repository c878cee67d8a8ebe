"""What counts for interventions on real recordings, beside their controls. Pure functions; prove_score.py uses them.

A decision on an intervention has "before": the names that the control, the same recordings untouched, was given. What both
have is the arm's own, and says nothing of the intervention; but for what is of its class, small in the control and here not.
"""
BINS = ("found", "in the control too", "named wrongly", "missed", "no name, unknown", "no name")


# No effects of the catalogue: rings that have one another's names, and payloads that are not what was told. A report says them
# before all, under these keys.
EXCHANGED_NAMES, TOLD_PAYLOADS = "exchanged_names", "told_payloads"
BEFORE_ALL = (EXCHANGED_NAMES, TOLD_PAYLOADS)
NAMED_AT_LEAST = 0.5  # a report also lists what is likeliest, however improbable: it names nothing by that


def is_named(named):
    """Methods without probabilities name what they list."""
    probability = named.get("probability")
    return probability is None or probability >= NAMED_AT_LEAST


def names(decision):
    return [named["name"] for named in decision["named"] if is_named(named)]


def outright(decision):
    """Names, but for those of small departures."""
    return [named["name"] for named in decision["named"] if is_named(named) and not named.get("small")]


def of_both(decision, of_control, truth):
    """Names that a control was given and that are the arm's own, therefore."""
    grown = [name for name in outright(decision) if name in truth.get("class", ()) and name not in outright(of_control)]
    return [name for name in names(of_control) if name not in grown]


def stated(decision):
    """What is said that was not named in the control, with whatever probability."""
    return [named for named in decision["named"] if named["name"] not in decision.get("before", ())]


def new(decision):
    """What is named and was not in the control."""
    return [named for named in stated(decision) if is_named(named)]


def meets(named, truth):
    """Whether what is named, or what it is said to be confusable with, is in the class that was decided beforehand."""
    return any(name in truth["class"] for name in (named["name"], *named.get("confusable_with", [])))


def found(decision, truth):
    """Whether an intervention is found by its class; None where nothing in the catalogue is like it."""
    return any(meets(named, truth) for named in new(decision)) if truth["class"] else None


def marks(decision, truth, alarm):
    """Rates of an intervention: those of naming count where it is clear and has a name, `unknown` where it has none."""
    if not truth["clear"]:
        return {}
    if not truth["class"]:
        return {"unknown": decision["verdict"] == "unknown"}
    first = [named["name"] for named in new(decision)][:1]
    ranked = [name for name in decision["ranking"] if name not in decision.get("before", ())][:3]
    return {"top1": bool(first) and first[0] in truth["class"],
            "top3": alarm and any(name in truth["class"] for name in ranked), "right_class": found(decision, truth)}


def outcome(decision, truth, confident_and_wrong):
    """One of BINS."""
    if found(decision, truth):
        return "found"
    if confident_and_wrong:
        return "named wrongly"
    if not truth["class"]:
        return "no name, unknown" if decision["verdict"] == "unknown" else "no name"
    return "in the control too" if any(meets(named, truth) for named in decision["named"] if is_named(named)) else "missed"


def link(results):
    """Gives every intervention its control, and every control the names that were asked of its set: those that its
    interventions have outright."""
    of_set = {(r["truth"]["set"], r["truth"]["split"]): r for r in results if r["kind"] == "control" and r["truth"]}
    asked = {key: set() for key in of_set}
    for result in results:
        if result["kind"] != "intervention" or not result["truth"]:
            continue
        key = (result["truth"]["set"], result["truth"]["split"])
        result["control"] = of_set.get(key)
        asked.setdefault(key, set()).update(name for effect in result["truth"]["effects"] for name in effect["names"])
    for key, control in of_set.items():
        control["truth"]["asked"] = sorted(asked[key])
