#!/usr/bin/python3
"""How many cases the proof has: enough of them in a sample, and in the whole so many that a diagnosis without an error meets
every target."""
import argparse
import copy
import os
import re
import sys
import unittest

ROOT = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else ".")
sys.path.insert(0, os.path.join(ROOT, "scripts"))
import prove_figures  # noqa: E402
import prove_real  # noqa: E402
import prove_report  # noqa: E402
import prove_rig  # noqa: E402
import prove_score  # noqa: E402
import prove_solid  # noqa: E402


def campaign(name):
    """As `prove kinds` lists them."""
    with open(os.path.join(ROOT, "config", "campaigns", name + ".yaml"), encoding="utf-8") as text:
        kinds = text.read().split("\nkinds:\n")[1]
    found = re.findall(r"- (?:\{|\n? *)kind: (\w+),?\s+sample: (\d+),?\s+full: (\d+)", kinds)
    assert len(found) == kinds.count("kind: "), name
    return [{"kind": kind, "sample": int(sample), "full": int(full)} for kind, sample, full in found]


class OfCampaign(prove_rig.Source):
    def __init__(self, options, name):
        self.options = options
        self.listed = campaign(name)


def plan(**more):
    """(kind, number) of every case of all worlds."""
    options = argparse.Namespace(**{"root": ROOT, "programs": "/nowhere", "seed": 5, "full": False, "cases": None, "jobs": 1, **more})
    sources = [OfCampaign(options, name) for name in prove_rig.CAMPAIGNS.values()]
    sources += [prove_solid.Source(options), prove_real.Source(options)]
    return [case for source in sources for case in source.plan(source.kinds())]


class Sample(unittest.TestCase):
    def test_it_has_sixty_cases_and_more(self):
        for seed in (5, 1228):  # of the latter all interventions are on two sets of recordings: the fewest controls
            self.assertGreaterEqual(len(plan(seed=seed)), 60)


def hidden_of(kind, number):
    """What is hidden in a case, in numbers that can be compared: a contact, beside it a soft spot in a pair."""
    contact = {"effect": "contact", "form": "spring_wall", "catalogued": True, "names": ["contact"],
               "values": {"fraction": 0.5, "stiffness_n_per_m": 100.0}, "parameters": {"stiffness_n_per_m": 100.0},
               "signal": {"leftover_snr": 20.0, "leftover_m": 1e-3}}
    if kind in ("none", "untidy_none", "solid_none", "control"):
        return []
    if kind in ("outside", "untidy_outside"):
        return [{**contact, "effect": "valve_stiction", "catalogued": False, "names": [], "parameters": {}, "values": {}}]
    spot = {**contact, "effect": "soft_spot", "names": ["soft_spot"], "parameters": {"share": 100.0},
            "values": {"centre_fraction": 0.5}}
    return [contact, spot] if kind in ("pair", "untidy_pair") else [contact]


def truth_of(kind, number):
    effects = hidden_of(kind, number)
    of_real = {"set": "trunk", "split": 0, "clear": True, "unexplained_m": 1e-3} if kind in ("intervention", "control") else {}
    if kind.startswith("untidy"):  # as config/campaigns/untidy_final.yaml expects at least
        of_real["clear"] = number % 3 == 0
    return {"kind": kind, "effects": effects, "distractors": [], "ideal": [], "constants": {"bending_stiffness": 0.03},
            "class": [e["effect"] for e in effects if e["catalogued"]], "rejected": [], **of_real}


def perfect(kind, number, truth):
    """The report of a diagnosis without an error, of whose 90 % intervals nine in ten cover."""
    def said(effect):
        (symbol, value), = effect["parameters"].items()
        high = value + 1.0 if number % 10 != 5 else value - 1e-9
        return {"name": effect["effect"], "probability": 1.0, "confusable_with": [], "where": {"s_from": 0.09, "s_to": 0.11},
                "parameters": {symbol: {"value": value, "low": value - 1.0, "high": high}}}

    named = [said(effect) for effect in truth["effects"] if effect["catalogued"]]
    verdict = "explained" if named else "unknown" if truth["effects"] else "consistent"
    errors = {"held_out_rms_m": 1e-4}
    law = {"share": 0.8, "share_of_flexible": 0.9} if verdict == "unknown" else None
    return {"verdict": verdict, "discovered_law": law, "effects": named, "ranking": [{"name": one["name"]} for one in named], "noise_floor_m": 1e-4,
            "baseline": errors, "extended": errors, "shifts": [{"name": "bending_stiffness", "before": 0.04, "after": 0.03}]}


MOVES = [[[0, 1, 1000, 0, 0], [1, 1, 0, 1000, 0]]]  # of one trial: [second, body, x, y, z], um


# Targets of every world that the finite-element arm and the recordings have too few cases to meet.
FEW = ["solid: confident (p > 0.9) and wrong", "real: confident (p > 0.9) and wrong", "solid: 90 % intervals that hold the true value",
       "real: 90 % intervals that hold the true value"]


class Whole(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.whole = cls.figures(plan(full=True))

    @staticmethod
    def figures(cases):
        """Of a perfect diagnosis, beside baselines that find nothing."""
        nothing = {method: {"alarm": False, "effects": [], "ranking": []} for method in prove_score.BASELINES}
        results = []
        for kind, number in cases:
            truth = truth_of(kind, number)
            results.append({"case": "case", "kind": kind, "number": number, "truth": truth, "report": perfect(kind, number, truth),
                            "not_drawn": None, "cost": {"seconds": 9.0, "core_seconds": 18.0, "memory_bytes": 2**28}, "baselines": nothing,
                            "hidden_moves": [MOVES for _ in truth["effects"]],
                            "found_moves": [{"effect": effect["effect"], "relative_sd": 0.1, "trials": MOVES}
                                            for effect in truth["effects"] if effect["catalogued"]]})
        return {**prove_figures.figures(results), "full": True}

    def test_a_perfect_diagnosis_meets_every_target(self):
        figures = self.whole
        rows = prove_report.rows(figures)
        self.assertEqual([row[:5] for row in rows if row[4] != (prove_report.MET if row[3] != "-" else "-") and row[0] not in FEW], [])
        self.assertEqual({row[4] for row in rows if row[0] in FEW}, {prove_report.NOT_CONTRADICTED})
        self.assertTrue(prove_report.passes(figures))
        for name, kinds in prove_report.POOLED.items():
            self.assertTrue(any(row[0].startswith(name) and row[3] != "-" for row in rows), name)
            self.assertEqual({kind for kind in kinds if not figures[kind]["trials"]}, set())

    def test_of_fewer_cases_it_does_not(self):
        fewer = [(kind, number) for kind, number in plan(full=True)
                 if number < {"none": 150, "untidy_none": 60, "single_strong": 80, "compensated": 40}.get(kind, 1000)]
        missed = [row[0] for row in prove_report.rows(self.figures(fewer)) if row[4] == prove_report.NOT_MET]
        self.assertEqual(missed, ["none, untidy_none, solid_none: false_alarm", "single_strong: right_class",
                                  "compensated: found_or_cannot_tell", "compensated, solid_compensated: found_or_cannot_tell"])

    def test_a_world_by_itself_contradicts(self):
        figures = copy.deepcopy(self.whole)
        figures["worlds"]["real"]["confident_wrong"] = 0.18
        figures["worlds"]["solid"].update({"interval_coverage": 0.67, "interval_numbers": 60})
        figures["worlds"]["solid"]["intervals"]["interval_coverage"] = (0.55, 0.80)
        figures["core_seconds_most"] = 61.0
        del figures["worlds"]["tidy"]["interval_coverage"], figures["worlds"]["tidy"]["intervals"]["interval_coverage"]
        rows = {row[0]: row[4] for row in prove_report.rows(figures) if row[4] not in (prove_report.MET, "-") and row[0] not in FEW[:1] + FEW[3:]}
        self.assertEqual(rows, {"real: confident (p > 0.9) and wrong": prove_report.CONTRADICTED,
                                "solid: 90 % intervals that hold the true value": prove_report.CONTRADICTED,
                                "tidy: 90 % intervals that hold the true value": prove_report.NOT_MET,
                                "tidy, untidy: processor time of a diagnosis, longest, s": prove_report.CONTRADICTED})

    def test_intervals_that_all_cover_contradict_nothing(self):
        figures = copy.deepcopy(self.whole)
        figures["worlds"]["solid"].update({"interval_coverage": 1.0, "interval_numbers": 10})
        figures["worlds"]["solid"]["intervals"]["interval_coverage"] = (1.0, 1.0)
        rows = {row[0]: row[4] for row in prove_report.rows(figures)}
        self.assertEqual(rows["solid: 90 % intervals that hold the true value"], prove_report.NOT_CONTRADICTED)

    def test_a_law_of_what_the_catalogue_does_not_have(self):
        def share(**more):
            truth = {**truth_of("outside", 0), "ideal": [{"effect": "creep", "explains": 0.5}]}
            report = {**perfect("outside", 0, truth_of("outside", 0)), **more}
            return prove_figures.law_share({"kind": "outside", "truth": truth, "report": report})

        self.assertEqual(share(discovered_law={"share": 0.3, "share_of_flexible": 0.6}), 0.6)
        self.assertEqual(share(discovered_law=None), 0.0)
        report = perfect("outside", 0, truth_of("outside", 0))
        del report["discovered_law"]
        older = {"kind": "outside", "truth": {**truth_of("outside", 0), "ideal": []}, "report": report}
        self.assertIsNone(prove_figures.law_share(older))
        self.assertEqual(prove_figures.law_share({**older, "report": {**report, "format": 1}}), 0.0)  # a report has no null
        self.assertIsNone(share(discovered_law={"share": 0.3}))  # nothing flexible learns anything
        self.assertIsNone(share(verdict="explained"))

    def test_why_draws_were_rejected(self):
        self.assertEqual(prove_figures.reasons([{"truth": {"rejected": ["0.2 mm are few", "1e-3 mm are few", "it flies away"]}},
                                                {"truth": None, "rejected": ["it flies away"]}, {"truth": None}]),
                         {"# mm are few": 2, "it flies away": 2})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
