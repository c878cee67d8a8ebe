"""Scores by displacement: by how much what was found moves the bodies, against what was hidden, whatever the form of its law.
Pure functions, no files; prove_figures.py uses them.

A result has "hidden_moves", by hidden effect the rows of `prove draw`, and "found_moves", those of `prove displacement`; None
where there are none. Rows are by trial [second, body, x, y, z], in micrometres.
"""
import statistics

import prove_real_score
from prove_score import INTERVAL_SD, class_of, decision_of, names_of

QUANTILES = (0.1, 0.25, 0.5, 0.75, 0.9)


def vectors(trials):
    return {(number, row[0], row[1]): row[2:5] for number, rows in enumerate(trials) for row in rows}


def product(a, b):
    return sum(x * y for key in a for x, y in zip(a[key], b[key]))


def compared(hidden, found):
    """(share of the squares of what is hidden that is found: 1 - |found - hidden|^2 / |hidden|^2, and the factor on what is
    found that comes nearest), over what both have; None where nothing is."""
    keys = hidden.keys() & found.keys()
    hidden, found = {key: hidden[key] for key in keys}, {key: found[key] for key in keys}
    whole, own, both = product(hidden, hidden), product(found, found), product(hidden, found)
    if whole == 0.0:
        return None
    return 1.0 - (own - 2.0 * both + whole) / whole, both / own if own > 0.0 else None


def is_of(effect, named):
    return any(name in names_of(effect) for name in class_of(named))


def chosen(effect, named, moves, effects):
    """What is said of a hidden effect: the first that is named rightly, else the first that is named, but for what is right for
    another one that is hidden; and whether it is right."""
    known = [one for one in named if one["name"] in moves]
    right = [one for one in known if is_of(effect, one)]
    wrong = [one for one in known if not any(is_of(hidden, one) for hidden in effects)]
    return (right or wrong or [None])[0], bool(right)


def scores(result):
    """Of each hidden effect that moves bodies: its share that is found (0: nothing is named; None: what is named was not
    measured), whether it is named rightly, and whether the 90 % interval of the size of what is found covers it (None where it
    has several sizes)."""
    hidden = result.get("hidden_moves")
    if not hidden or not result["report"]:
        return []
    moves = {one["effect"]: one for one in result.get("found_moves") or []}
    named = prove_real_score.stated(decision_of(result))
    effects, clear = result["truth"]["effects"], result["truth"].get("clear", True)
    list_of = []
    for effect, rows in zip(effects, hidden):
        first, is_right = chosen(effect, named, moves, effects)
        there = vectors(rows)
        found = compared(there, vectors(moves[first["name"]]["trials"]) if first else {key: (0.0, 0.0, 0.0) for key in there})
        if found is None:
            continue
        if named and result.get("found_moves") is None:  # `prove displacement` failed
            list_of.append({"share": None, "right": False, "covers": None, "clear": clear})
            continue
        share, factor = found
        sd = moves[first["name"]].get("relative_sd") if first else None
        covers = abs(factor - 1.0) <= INTERVAL_SD * sd if is_right and factor is not None and sd is not None else None
        list_of.append({"share": share, "right": is_right, "covers": covers, "clear": clear})
    return list_of


def figures(all_scores):
    """Median share of what is named rightly, coverage, and quantiles of all clear effects, named or not."""
    shares = [one["share"] for one in all_scores if one["right"]]
    covers = [one["covers"] for one in all_scores if one["covers"] is not None]
    return {"displacement_explained": statistics.median(shares) if shares else None,
            "displacement_coverage": sum(covers) / len(covers) if covers else None}


def distribution(all_scores):
    """Of the share that is found, over all clear effects; those that were not measured are counted."""
    clear = [one["share"] for one in all_scores if one["clear"]]
    shares = sorted(share for share in clear if share is not None)
    return {"effects": len(shares), "unmeasured": len(clear) - len(shares),
            "quantiles": {f"{q:g}": shares[round(q * (len(shares) - 1))] for q in QUANTILES} if shares else {}}
