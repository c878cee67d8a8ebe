#!/usr/bin/python3
"""The pages of the proof on made-up reports: what was missed and why, and what stands first."""
import importlib.util
import math
import os
import sys
import tempfile
import unittest

from prove_score_check import effect, named, report, result, truth  # which puts the scripts on the path
import prove_figures
import prove_misses
import prove_short
import prove_solid
import tree


class Misses(unittest.TestCase):
    """What counts against the diagnosis, and why: each sentence from the numbers of the case."""
    def missed(self, kind, hidden, said):
        return result(kind, hidden, said)

    def test_what_is_right_is_no_miss(self):
        right = self.missed("single_strong", truth(effect("creep")), report("explained", named("creep", 0.99)))
        unclear = self.missed("untidy_single", {**truth(effect("creep")), "clear": False}, report("unknown"))
        none = self.missed("none", truth(), report("consistent"))
        self.assertEqual(prove_misses.missed([right, unclear, none, dict(result("pair", None, None), not_drawn="x")]), {})

    def test_one_that_is_told_instead(self):
        hidden = truth(effect("creep", form="wall"))
        hidden["ideal"] = [{"effect": "drift", "explains": 0.8}, {"effect": "creep", "explains": 0.6}, {"effect": "tether", "explains": 0.02}]
        said = report("explained", named("drift", 0.97), named("tether", 0.6), ranking=["shear", "creep"], findings={"creep": "cannot_tell"})
        said["ranking"][3]["probability"] = 0.2
        wrong = self.missed("single_strong", hidden, said)
        self.assertEqual(list(prove_misses.missed([wrong])), ["tidy"])
        why = prove_misses.why(wrong)
        for words in ("`creep` is not named (number 4 of the ranking, with 20 %: cannot tell)",
                      "`drift` explains 80 % of what is hidden, the catalogue's `creep` 60 %",
                      "`drift` (97 %) is not there, but acts like what is hidden (explains 80 % of that)",
                      "`tether` (60 %) is not there (explains 2 % of what is hidden)",
                      "what is hidden leaves 0.20 mm (error of the baseline on unseen trials: 1.00 mm)"):
            self.assertIn(words, why)

    def test_what_no_first_order_explains(self):
        hidden = truth(effect("creep"))
        hidden["ideal"] = [{"effect": "drift", "explains": 0.16}, {"effect": "creep", "explains": 0.02}]
        why = prove_misses.why(self.missed("single_strong", hidden, report("unknown")))
        self.assertIn("no effect of the catalogue explains half of what is hidden (best: `drift`, 16 %)", why)

    def test_interventions(self):
        known = {"set": "trunk", "split": 0, "words": "payloads withheld", "class": ["tip_mass", "payload_scale"], "clear": True,
                 "unexplained_m": 5e-3, "ideal": [{"effect": "tip_mass", "explains": 0.9}], "distractors": [], "constants": {},
                 "effects": [effect("payload_withheld", names=[])]}
        untouched = self.missed("control", {**known, "effects": []}, report("explained", named("payload_scale", 0.9)))
        missed = self.missed("intervention", known, report("explained", named("payload_scale", 0.9)))
        missed["control"] = untouched
        why = prove_misses.why(missed)
        for words in ("`tip_mass` is not named", "`payload_scale` is also named for the untouched recordings", "(the untouched recordings: 5.00 mm)"):
            self.assertIn(words, why)
        later = self.missed("intervention", known, report("explained", named("shear", 0.6), named("tip_mass", 0.8)))
        later["control"] = untouched
        self.assertEqual(prove_misses.counts_against(later), ["top1"])
        self.assertIn("found, but not by the first name: by `tip_mass`, or what is listed as confusable with that", prove_misses.why(later))

    def test_one_that_is_told_later_or_as_a_rival(self):
        there = {**truth(effect("creep"), distractors=[effect("drift")]), "distractors_leave_m": 1e-4}
        later = self.missed("untidy_single", there, report("explained", named("drift"), named("creep", 0.7)))
        self.assertIn("`creep` is named with 70 %, after `drift`, which is also there; what is hidden leaves 0.20 mm (the small departures: 0.10 mm)",
                      prove_misses.why(later))
        rival = self.missed("single_strong", truth(effect("creep")), report("explained", named("drift", 0.8, ["creep"])))
        self.assertEqual(prove_misses.counts_against(rival), ["top1", "top3"])
        self.assertIn("`creep` is only listed as confusable with `drift`", prove_misses.why(rival))
        both = self.missed("single_strong", truth(effect("creep")), report("explained", named("drift", 0.8, ["creep"]), named("creep", 0.6)))
        self.assertIn("`creep` is named with 60 %, after `drift`;", prove_misses.why(both))

    def test_an_accusation_and_a_failure(self):
        accused = self.missed("untidy_none", truth(), report("explained", named("drift", 0.95)))
        self.assertEqual(prove_misses.why(accused), "`drift` (95 %) is not there")
        hardly = self.missed("untidy_none", truth(), {**report("unknown", named("drift", 0.05)), "stand_ins": [named("creep", 0.05)]})
        self.assertEqual(prove_misses.why(hardly), "`drift` (5 %) is not there")
        unknown = self.missed("none", truth(), report("unknown"))
        self.assertEqual(prove_misses.why(unknown), "nothing wrong is named, but the verdict is unknown")
        there = self.missed("none", truth(distractors=[effect("drift")]), report("explained", named("drift", 0.95)))
        self.assertEqual(prove_misses.why(there), "what is named is there, but too small to count")
        failed = self.missed("single_strong", truth(effect("creep")), None)
        failed["cost"] = {"message": "no memory"}
        self.assertEqual(prove_misses.why(failed), "the diagnosis failed: no memory")
        self.assertEqual(prove_misses.counts_against(dict(failed, kind="none", truth=truth())), ["no report"])

    def test_page(self):
        accused = self.missed("untidy_none", truth(), report("explained", named("drift", 0.95)))
        figures = {"full": True, "seed": 1, "engine": "0123456789abcdef"}
        text = prove_misses.story([accused], figures, {"story": "p.md", "misses": {"untidy": "p_misses_untidy.png"}})
        for words in ("Of the 1 cases of [the proof](p.md), 1 count", "These pages are of all cases; seed 1", "## Untidy: 1 of 1 cases", "(p_misses_untidy.png)", "| case_001 | nothing | explained: drift 0.95 |",
                      "| **confident and wrong**, **false alarm** |"):
            self.assertIn(words, text)
        sample = prove_misses.story([accused], {**figures, "full": False}, {"story": "p.md", "misses": {}})
        self.assertTrue(sample.startswith("# What a sample of the proof missed, and why\n\nOf the 1 cases of [a sample of the proof](p.md)"))

    @tree.skip_unless_there(importlib.util.find_spec("matplotlib"), "no matplotlib (Debian package python3-matplotlib)")
    def test_picture(self):
        wrong = self.missed("single_strong", truth(effect("creep")), report("explained", named("drift", 0.95)))
        rows = [[[0, 0, 3000, 0, 0], [1, 0, 0, 0, 1000]]]
        wrong.update({"hidden_moves": [rows], "found_moves": [{"effect": "drift", "trials": rows}, {"effect": "shear", "trials": rows}]})
        self.assertEqual([(label, course) for label, _, course in prove_misses.curves(wrong)], [("creep", [3.0, 1.0]), ("drift", [3.0, 1.0])])
        with tempfile.TemporaryDirectory() as folder:
            drawn = prove_misses.draw_all([wrong], os.path.join(folder, "p"))
            self.assertEqual(drawn, {"tidy": os.path.join(folder, "p_misses_tidy.png")})
            with open(drawn["tidy"], "rb") as picture:
                self.assertEqual(picture.read(4), b"\x89PNG")
        self.assertEqual(prove_misses.draw_all([self.missed("single_strong", truth(effect("creep")), report("unknown"))], "p"), {})

    def test_courses_are_root_mean_squares_in_millimetres(self):
        trials = [[[0, 0, 3000, 0, 0], [0, 1, 0, 4000, 0], [1, 0, 0, 0, 1000]], [[0, 0, 2000, 0, 0]]]
        found = prove_misses.course(trials)
        for value, wanted in zip(found, [math.sqrt(12.5), 1.0, 2.0]):
            self.assertAlmostEqual(value, wanted)
        self.assertEqual(len(found), 3)


class Short(unittest.TestCase):
    def test_counts_and_the_hardest_first(self):
        names = {"trials_page": "t.md", "misses_page": "m.md"}
        right = result("single_strong", truth(effect("creep")), report("explained", named("creep", 0.95)))
        wrong = result("single_strong", truth(effect("drift")), report("explained", named("shear", 0.95)))
        text = prove_short.story([right, right, wrong, wrong, right], names)
        self.assertIn("| one effect, the arm file otherwise right: it is named first | 3 of 5 (60 %; 27 to 86 %) |", text)
        self.assertIn("| tidy | 3 of 5 (60 %; 27 to 86 %) | 2 of 5 (40 %; 14 to 73 %) |", text)
        self.assertLess(text.index("| drift | 2 | 0 | 0 | 0.20 |"), text.index("| creep | 3 | 3 | 3 | 0.20 |"))
        self.assertNotIn("![", text)
        self.assertIn("(c.png)", prove_short.story([right], {**names, "calibration": "c.png"}))

    def test_what_the_finite_elements_were_found_to_have_after_a_seal(self):
        names = {"trials_page": "t.md", "misses_page": "m.md"}
        said = [named("gain_nonlinearity", 0.95), named("gravity_direction", 0.5)], [named("gravity_direction", 0.95)]
        sealed = [result("solid_none", {**truth(), "solid": "nothing"}, report("unknown", *ones)) for ones in said]
        text = prove_short.story(sealed, names)
        self.assertIn("| solid | 0 of 2 (0 %; 0 to 57 %) | 2 of 2 (100 %; 43 to 100 %) |", text)
        self.assertIn("`gain_nonlinearity` was [measured](solid_arm.md#what-is-hidden) only after", text)
        self.assertIn("with a confident statement that is wrong are 1 of 2 (50 %; 12 to 88 %).", text)
        self.assertNotIn("measured", prove_short.story(sealed[1:], names))
        known = {**truth(distractors=prove_solid.OF_NATURE), "solid": "nothing"}
        self.assertNotIn("measured", prove_short.story([result("solid_none", known, report("unknown", *said[0]))], names))

    @staticmethod
    def cases(kind, right, wrong):
        of_solid = {"solid": "x"} if kind.startswith("solid") else {}
        of_real = ({"set": "trunk", "split": 0, "class": ["creep"], "clear": True, "unexplained_m": 5e-3, "words": "x"} if kind == "intervention"
                   else {})
        hidden = {**truth(effect("creep")), **of_solid, **of_real}
        return ([result(kind, hidden, report("explained", named("creep", 0.95))) for _ in range(right)]
                + [result(kind, hidden, report("explained", named("shear", 0.95))) for _ in range(wrong)])

    @staticmethod
    def summary(results, page="p.md", **more):
        worlds = {world: {} for world, kinds in prove_figures.WORLDS.items() if any(one["kind"] in kinds.values() for one in results)}
        figures = {"full": False, "draws": len(results), "worlds": worlds, **more}
        return prove_short.summary(results, figures, {"story": page})

    def test_what_stands_first_is_computed(self):
        text = self.summary(self.cases("single_strong", 40, 0) + self.cases("untidy_single", 2, 0) + self.cases("solid_single", 0, 10)
                            + self.cases("intervention", 9, 1))
        for words in ("\non simulated arms (*tidy* and *untidy*) it is right in 42 of 42 statements (100 %);\n",
                      "\non the finite-element arm (*solid*) it is right in 0 of 10 statements (0 %);\n",
                      "\non real arms (*real*) it is right in 9 of 10 statements (90 %).\n",
                      "Believe such statements on simulated arms:\n", "Do not rely on them on the finite-element arm:\n",
                      "On real arms the figures leave this open:\n",
                      "\nin 42 of 42 cases (100 %) on simulated arms,\nin 0 of 10 cases (0 %) on the finite-element arm\nand in 9 of 10 cases (90 %) on "
                      "real arms:\nwhat it does not name may be there"):
            self.assertIn(words, text)
        self.assertEqual(text.count(".\n"), 7)
        silent = self.summary([result("none", truth(), report("consistent"))])
        self.assertIn("nowhere more than 90 % sure", silent)
        self.assertNotIn("finds", silent)
        right = self.summary(self.cases("single_strong", 40, 0))
        self.assertNotIn("rely", right)
        self.assertNotIn("may be there", right)

    def test_of_few_statements_no_share_is_told(self):
        text = self.summary(self.cases("single_strong", 9, 0) + self.cases("solid_single", 1, 0) + self.cases("intervention", 1, 3))
        for words in ("on simulated arms (*tidy*) there are too few statements to say (9 of 9 right)",
                      "on the finite-element arm (*solid*) there are too few statements to say (1 of 1 right)",
                      "on real arms (*real*) there are too few statements to say (1 of 4 right).\n",
                      "in 9 of 9 cases on simulated arms,\nin 1 of 1 cases on", "Do not rely on them on real arms:\n"):
            self.assertIn(words, text)
        for words in ("Believe", "leave this open", "(100 %)", "(25 %)"):
            self.assertNotIn(words, text)
        self.assertIn("it is right in 10 of 10 statements (100 %)", self.summary(self.cases("single_strong", 10, 0)))
        none = self.summary(self.cases("single_strong", 10, 0) + [result("control", truth(), report("consistent"))])
        self.assertIn("on real arms (*real*) there is no such statement.\n", none)

    def test_no_world_hides_behind_its_group(self):
        text = self.summary(self.cases("single_strong", 400, 0) + self.cases("untidy_single", 5, 5))
        self.assertIn("405 of 410 statements (99 %)", text)
        self.assertIn("Do not rely on them on simulated arms", text)
        self.assertNotIn("Believe", text)

    def test_a_page_says_of_what_it_is(self):
        every = {world: {} for world in prove_figures.WORLDS}
        of_all = {"full": False, "draws": 64, "worlds": every, "campaign": "proof_final, untidy_final, solid, real"}
        some = {**of_all, "draws": 27, "worlds": {"solid": {}, "real": {}}, "campaign": "solid, real"}
        for figures, title in (({**of_all, "full": True}, "The proof of `softarm diagnose`"), (of_all, "A sample of the proof: 64 cases"),
                               (some, "A sample of the proof: 27 cases of real and finite-element arms"),
                               ({**some, "full": True}, "A part of the proof: 27 cases of real and finite-element arms"),
                               ({**of_all, "so_far": 733}, "The proof so far: 64 of 733 cases"),
                               ({**some, "worlds": {"untidy": {}}, "draws": 1, "campaign": "untidy_final"},
                                "A sample of the proof: 1 case of untidy simulated arms"),
                               ({**some, "worlds": {"tidy": {}, "untidy": {}, "real": {}}, "campaign": "proof_final, untidy_final, real"},
                                "A sample of the proof: 27 cases of simulated and real arms"),
                               ({**some, "worlds": {"tidy": {}}, "campaign": "proof_development"}, "The campaign `proof_development`: 27 cases")):
            self.assertEqual(prove_short.title(figures), title)
        links = {"story": "p.md"}
        second = prove_short.about(of_all, links).split(".\n")[1]
        self.assertEqual(second, "It is a sample: so few cases say little, and [the whole proof](proof.md) has many more")
        self.assertIn("and the whole proof has many more", prove_short.about(of_all, {"story": "proof.md"}))
        self.assertIn("no more than a part of [the whole proof](proof.md)", prove_short.about({**of_all, "so_far": 733}, links))
        self.assertIn("other cases than those of [the whole proof](proof.md)", prove_short.about({**of_all, "campaign": "x"}, links))
        self.assertNotIn("whole", prove_short.about({**of_all, "full": True}, {"story": "proof.md"}))
        self.assertIn("by 27 cases:\neffects were hidden in trials of a finite-element arm, known faults were put into recordings of real arms,\nand", prove_short.about(some, links))
        self.assertNotIn("real arms", prove_short.about({**some, "worlds": {"tidy": {}}}, links))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
