#!/usr/bin/python3
"""Scores of the proof by displacement, on cases of which the answer is known."""
import os
import sys
import unittest

ROOT = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else ".")
sys.path.insert(0, os.path.join(ROOT, "scripts"))
import prove_displacement  # noqa: E402
import prove_figures  # noqa: E402


def rows(size, seconds=4):
    """Two trials with one body that moves to and fro, um."""
    return [[[second, 1, size * (-1) ** second, 0, trial * size] for second in range(seconds)] for trial in range(2)]


def case(hidden_um, said, moves, clear=True, effects=("creep",)):
    """said: (name, what it is confusable with); moves: name -> (um, relative sd)."""
    hidden = [{"effect": name, "catalogued": True, "values": {}, "signal": {"leftover_snr": 20.0, "leftover_m": 1e-3}}
              for name in effects]
    named = [{"name": name, "probability": 0.95, "confusable_with": list(alike), "parameters": {}} for name, alike in said]
    errors = {"held_out_rms_m": 1e-3}
    return {"case": "case_001", "kind": "untidy_single", "not_drawn": None, "cost": None, "baselines": None,
            "truth": {"effects": hidden, "distractors": [], "ideal": [], "constants": {}, "clear": clear},
            "report": {"verdict": "explained", "effects": named, "ranking": [], "noise_floor_m": 1e-3, "baseline": errors,
                       "extended": errors},
            "hidden_moves": [rows(hidden_um) for _ in effects],
            "found_moves": [{"effect": name, "relative_sd": sd, "trials": rows(um)} for name, (um, sd) in moves.items()]}


class Displacement(unittest.TestCase):
    def score(self, *arguments, **more):
        (found,) = prove_displacement.scores(case(*arguments, **more))
        return found

    def test_the_share_is_of_the_squares_that_are_found(self):
        whole = self.score(1000, [("creep", [])], {"creep": (1000, 0.1)})
        self.assertEqual((whole["share"], whole["right"], whole["covers"]), (1.0, True, True))
        less = self.score(1000, [("creep", [])], {"creep": (900, 0.1)})
        self.assertAlmostEqual(less["share"], 1.0 - 0.1 ** 2)
        self.assertLess(self.score(1000, [("creep", [])], {"creep": (-500, 0.1)})["share"], 0.0)

    def test_nothing_named_finds_nothing(self):
        found = self.score(1000, [], {})
        self.assertEqual((found["share"], found["right"], found["covers"]), (0.0, False, None))

    def test_what_was_not_measured_is_counted_and_no_error(self):
        lost = case(1000, [("creep", [])], {})
        lost["found_moves"] = None
        self.assertEqual([one["share"] for one in prove_displacement.scores(lost)], [None])
        figures = prove_figures.figures([lost, case(1000, [("creep", [])], {"creep": (1000, 0.1)})])
        self.assertEqual(figures["displacement_explained"], 1.0)
        spread = figures["worlds"]["untidy"]["displacement"]
        self.assertEqual((spread["effects"], spread["unmeasured"], spread["quantiles"]["0.1"]), (1, 1, 1.0))
        silent = case(1000, [], {})
        silent["found_moves"] = None
        self.assertEqual([one["share"] for one in prove_displacement.scores(silent)], [0.0])

    def test_of_a_pair_each_has_its_own(self):
        pair = case(1000, [("creep", []), ("shear", [])], {"creep": (1000, 0.1), "shear": (500, 0.1)}, effects=("creep", "drift"))
        of_creep, of_drift = prove_displacement.scores(pair)
        self.assertEqual((of_creep["share"], of_creep["right"]), (1.0, True))
        self.assertEqual((of_drift["share"], of_drift["right"]), (0.75, False))  # shear, not what is right for the other one
        alone = case(1000, [("creep", [])], {"creep": (1000, 0.1)}, effects=("creep", "drift"))
        self.assertEqual([one["share"] for one in prove_displacement.scores(alone)], [1.0, 0.0])

    def test_intervals_cover_where_the_nearest_size_is_within(self):
        # 1000 / 900 is 11 % more: within 1.645 times 7 %, not 6 %.
        self.assertTrue(self.score(1000, [("creep", [])], {"creep": (900, 0.07)})["covers"])
        self.assertFalse(self.score(1000, [("creep", [])], {"creep": (900, 0.06)})["covers"])
        several = case(1000, [("creep", [])], {"creep": (900, 0.07)})
        del several["found_moves"][0]["relative_sd"]
        self.assertIsNone(prove_displacement.scores(several)[0]["covers"])

    def test_another_form_or_name_is_judged_by_what_it_does(self):
        alike = self.score(1000, [("drift", ["creep"])], {"drift": (950, 0.1)})
        self.assertTrue(alike["right"])
        wrong = self.score(1000, [("drift", []), ("shear", [])], {"drift": (950, 0.1), "shear": (1000, 0.1)})
        self.assertEqual((wrong["right"], wrong["covers"]), (False, None))
        self.assertAlmostEqual(wrong["share"], 1.0 - 0.05 ** 2)
        later = self.score(1000, [("drift", []), ("creep", [])], {"drift": (1, 0.1), "creep": (1000, 0.1)})
        self.assertEqual((later["share"], later["right"]), (1.0, True))

    def test_only_what_both_have_is_compared(self):
        one = case(1000, [("creep", [])], {"creep": (1000, 0.1)})
        one["hidden_moves"][0][0].append([99, 1, 5000, 0, 0])
        self.assertEqual(prove_displacement.scores(one)[0]["share"], 1.0)
        one["hidden_moves"] = [rows(0)]
        self.assertEqual(prove_displacement.scores(one), [])
        self.assertEqual(prove_displacement.scores({**one, "hidden_moves": None}), [])

    def test_figures_and_their_spread(self):
        results = [case(1000, [("creep", [])], {"creep": (1000 - 10 * i, 0.02)}) for i in range(9)]
        results.append(case(1000, [("drift", [])], {"drift": (0, 0.1)}))
        results.append(case(1000, [("creep", [])], {"creep": (1000, 0.02)}, clear=False))
        figures = prove_figures.figures(results)
        self.assertAlmostEqual(figures["displacement_explained"], (1.0 - 0.03 ** 2 + 1.0 - 0.04 ** 2) / 2.0)
        self.assertAlmostEqual(figures["displacement_coverage"], 0.5)
        spread = figures["worlds"]["untidy"]["displacement"]
        self.assertEqual(spread["effects"], 10)
        self.assertEqual(list(spread["quantiles"]), ["0.1", "0.25", "0.5", "0.75", "0.9"])
        self.assertAlmostEqual(spread["quantiles"]["0.9"], 1.0 - 0.01 ** 2)
        self.assertIn("displacement_explained", figures["intervals"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
