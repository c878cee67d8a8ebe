#!/usr/bin/python3
"""The scores of the proof on made-up reports: each rate, calibration, coverage of intervals, places, the story."""
import math
import os
import sys
import unittest

sys.path.insert(0, os.path.join(sys.argv[1] if len(sys.argv) > 1 else ".", "scripts"))
import prove_report  # noqa: E402
import prove_figures  # noqa: E402
import prove_score as score  # noqa: E402
import prove_sources  # noqa: E402


def effect(name, values=None, form="", catalogued=True, **more):
    return {"effect": name, "form": form, "values": values or {}, "catalogued": catalogued,
            "signal": {"leftover_snr": 20.0, "leftover_m": 2e-4}, **more}


def truth(*effects, distractors=(), constants=None):
    return {"effects": list(effects), "distractors": list(distractors), "constants": constants or {},
            "ideal": [{"effect": e["effect"], "explains": 0.7, "cosine": 1.0} for e in effects]}


def named(name, probability=0.95, confusable=(), parameters=None, where=None):
    return {"name": name, "probability": probability, "confusable_with": list(confusable),
            "parameters": parameters or {}, "where": where or {}}


def report(verdict, *effects, ranking=(), findings=None, before=1e-3, after=5e-4, shifts=()):
    names = [e["name"] for e in effects] + list(ranking)
    return {"verdict": verdict, "effects": list(effects), "shifts": list(shifts), "noise_floor_m": 4e-4,
            "ranking": [{"name": n, "finding": (findings or {}).get(n, "absent")} for n in names],
            "baseline": {"held_out_rms_m": before}, "extended": {"held_out_rms_m": after}}


def result(kind, hidden, said, baselines=None):
    return {"case": "case_001", "kind": kind, "number": 0, "truth": hidden, "report": said, "not_drawn": None,
            "cost": {"seconds": 10.0, "memory_bytes": 2**28}, "baselines": baselines}


class Rates(unittest.TestCase):
    def marks(self, kind, hidden, said):
        return score.marks(kind, score.decision_of_report(said), hidden)

    def test_nothing_hidden(self):
        self.assertFalse(self.marks("none", truth(), report("consistent"))["false_alarm"])
        self.assertFalse(self.marks("none", truth(), report("cannot_tell"))["false_alarm"])
        self.assertTrue(self.marks("none", truth(), report("unknown"))["false_alarm"])
        wrong = self.marks("none", truth(), report("explained", named("creep", 0.99)))
        self.assertTrue(wrong["false_alarm"] and wrong["confident_wrong"])

    def test_untidy(self):
        hidden = truth(distractors=[effect("creep")])
        for said in (report("unknown"), report("explained", named("creep"))):
            self.assertFalse(self.marks("untidy_none", hidden, said)["false_alarm"])
        self.assertTrue(self.marks("untidy_none", hidden, report("explained", named("drift")))["false_alarm"])
        hardly = report("explained", named("creep"))
        hardly["stand_ins"] = [named("drift", 0.04)]
        self.assertFalse(self.marks("untidy_none", hidden, hardly)["false_alarm"])
        self.assertFalse(self.marks("none", truth(), {**hardly, "verdict": "cannot_tell", "effects": []})["false_alarm"])
        found = self.marks("untidy_single", truth(effect("drift")), {**hardly, "effects": []})
        self.assertFalse(found["top1"] or found["right_class"])
        single = self.marks("untidy_single", truth(effect("drift"), distractors=[effect("creep")]),
                            report("partly_explained", named("creep"), named("drift")))
        self.assertEqual(single, {"confident_wrong": False, "top1": False, "top3": True, "right_class": False})
        outside = truth(effect("valve_stiction", catalogued=False))
        self.assertTrue(self.marks("untidy_outside", outside, report("unknown"))["unknown"])

    def test_what_nobody_could_see_counts_for_confident_errors_alone(self):
        hidden = {**truth(effect("drift")), "clear": False}
        missed = self.marks("untidy_single", hidden, report("consistent"))
        self.assertEqual(missed, {"confident_wrong": False})
        self.assertEqual(self.marks("untidy_single", hidden, report("explained", named("creep", 0.99))), {"confident_wrong": True})
        self.assertFalse(self.marks("untidy_single", {**hidden, "clear": True}, report("consistent"))["top1"])
        pair = truth(effect("drift"), effect("creep"))
        self.assertTrue(self.marks("untidy_pair", pair, report("explained", named("creep"), named("drift")))["both_named"])
        self.assertEqual(self.marks("untidy_pair", {**pair, "clear": False}, report("consistent")), {"confident_wrong": False})
        outside = {**truth(effect("valve_stiction", catalogued=False)), "clear": False}
        self.assertNotIn("unknown", self.marks("untidy_outside", outside, report("consistent")))

    def test_one_effect(self):
        hidden = truth(effect("creep"))
        good = self.marks("single_strong", hidden, report("explained", named("creep")))
        self.assertEqual(good, {"confident_wrong": False, "top1": True, "top3": True, "right_class": True})
        rival = self.marks("single_strong", hidden, report("explained", named("drift", 0.99, ["creep"]), ranking=["creep"]))
        self.assertEqual(rival, {"confident_wrong": False, "top1": False, "top3": True, "right_class": True})
        wrong = self.marks("single_weak", hidden, report("explained", named("drift"), ranking=["shear", "mullins", "creep"]))
        self.assertEqual(wrong, {"confident_wrong": True, "top1": False, "top3": False, "right_class": False})
        unsure = self.marks("single_weak", hidden, report("explained", named("drift", 0.6)))
        self.assertFalse(unsure["confident_wrong"])
        missed = self.marks("single_strong", hidden, report("consistent", ranking=["creep"]))
        self.assertFalse(missed["top1"] or missed["top3"] or missed["right_class"])

    def test_two_effects(self):
        hidden = truth(effect("creep"), effect("shear"))
        self.assertTrue(self.marks("pair", hidden, report("explained", named("shear"), named("creep")))["both_named"])
        one = self.marks("pair", hidden, report("explained", named("shear", 0.99, ["creep"])))
        self.assertFalse(one["both_named"])
        self.assertTrue(one["right_class"])
        third = self.marks("pair", hidden, report("explained", named("shear"), named("creep"), named("drift", 0.99)))
        self.assertTrue(third["both_named"] and third["confident_wrong"])

    def test_outside_the_catalogue(self):
        hidden = truth(effect("valve_stiction", catalogued=False))
        self.assertTrue(self.marks("outside", hidden, report("unknown"))["unknown"])
        for verdict in ("explained", "consistent", "partly_explained"):
            self.assertFalse(self.marks("outside", hidden, report(verdict))["unknown"])
        self.assertTrue(self.marks("outside", hidden, report("explained", named("hysteresis")))["confident_wrong"])
        hidden["ideal"] = [{"effect": "hysteresis", "explains": 0.99, "cosine": 1.0}]  # 2 of 20 are left
        self.assertNotIn("unknown", self.marks("outside", hidden, report("explained", named("hysteresis"))))
        sticks = {**truth(effect("valve_stiction", catalogued=False)), "class": ["hysteresis"]}
        kind = self.marks("outside", sticks, report("partly_explained", named("hysteresis"), named("drift")))
        self.assertTrue(kind["unknown"])
        for said in (report("explained", named("hysteresis")), report("partly_explained", named("drift"), named("hysteresis"))):
            self.assertFalse(self.marks("outside", sticks, said)["unknown"])
        # What acts like it by its signature, sealed with the draw, may be named; the verdict is another matter.
        bumped = {**truth(effect("bumped_cameras", catalogued=False)), "kind": "outside",
                  "ideal": [{"effect": name, "explains": share, "cosine": 1.0}
                            for name, share in (("gravity_direction", 0.8), ("base_tilt", 0.73), ("payload_offset", 0.7), ("drift", 0.1))]}
        for name, wrong in (("gravity_direction", False), ("base_tilt", False), ("payload_offset", True), ("drift", True)):
            marks = self.marks("outside", bumped, report("explained", named(name)))
            self.assertEqual(marks["confident_wrong"], wrong, name)
            self.assertFalse(marks["unknown"])
        bumped["ideal"] = [{"effect": "gravity_direction", "explains": 0.49, "cosine": 1.0}]  # less than half acts like nothing
        self.assertTrue(self.marks("outside", bumped, report("explained", named("gravity_direction")))["confident_wrong"])
        like = truth(effect("line_delay", catalogued=False, like="clock_offset"))
        self.assertFalse(self.marks("outside", like, report("explained", named("clock_offset")))["confident_wrong"])

    def test_compensated(self):
        hidden = truth(effect("base_compliance"))
        for said in (report("explained", named("shear", 0.7, ["base_compliance"])), report("cannot_tell"),
                     report("consistent", ranking=["base_compliance"], findings={"base_compliance": "cannot_tell"})):
            self.assertTrue(self.marks("compensated", hidden, said)["found_or_cannot_tell"])
        sealed = {**hidden, "class": ["shear"]}  # what nobody can tell from it
        self.assertTrue(self.marks("compensated", sealed, report("explained", named("shear")))["found_or_cannot_tell"])
        self.assertFalse(self.marks("compensated", hidden, report("explained", named("shear")))["found_or_cannot_tell"])
        self.assertFalse(self.marks("compensated", hidden, report("consistent", ranking=["base_compliance"]))
                         ["found_or_cannot_tell"])

    def test_a_distractor_is_there(self):
        hidden = truth(distractors=[effect("tip_mass")])
        self.assertFalse(self.marks("none", hidden, report("explained", named("tip_mass", 0.99)))["confident_wrong"])

    def test_shares(self):
        results = [result("none", truth(), report("consistent"))] * 3 + [result("none", truth(), report("unknown"))]
        results.append(result("single_strong", truth(effect("creep")), None))
        figures = prove_figures.figures(results)
        self.assertEqual(figures["none"]["trials"], 4)
        self.assertAlmostEqual(figures["none"]["false_alarm"], 0.25)
        self.assertIsNone(figures["none"]["top1"])
        self.assertIsNone(figures["pair"]["both_named"])
        self.assertEqual((figures["single_strong"]["top1"], figures["failed"]), (0.0, 1))


class Figures(unittest.TestCase):
    def test_calibration(self):
        self.assertIsNone(prove_figures.calibration_error([]))
        self.assertAlmostEqual(prove_figures.calibration_error([(0.9, True)] * 9 + [(0.9, False)]), 0.0)
        self.assertAlmostEqual(prove_figures.calibration_error([(1.0, False), (0.5, True), (0.5, False), (1.0, True)]), 0.25)

    def test_sizes_and_intervals(self):
        hidden = truth(effect("base_compliance", {"stiffness_nm_per_rad": 5.0}))
        for low, covers in ((0.19, True), (0.21, False)):
            parameters = {"compliance_rad_per_nm": {"value": 0.22, "low": low, "high": 0.25, "unit": "rad/(N m)"}}
            figures = prove_figures.figures([result("single_strong", hidden,
                                            report("explained", named("base_compliance", parameters=parameters)))])
            self.assertAlmostEqual(figures["parameter_median_error"], 0.1)
            self.assertEqual(figures["interval_coverage"], float(covers))
        tilt = score.true_parameters(effect("base_tilt", {"angle_deg": 2.0, "azimuth_deg": 90.0}), 0.2)
        self.assertAlmostEqual(tilt["towards_y_rad"], math.radians(2.0))
        self.assertAlmostEqual(tilt["towards_x_rad"], 0.0)
        offset = effect("pressure_offset", {"number": 3.0, "offset_pa": 500.0}, "pressure")
        self.assertEqual(score.true_parameters(offset, 0.2), {"offset_3_pa": 500.0})
        self.assertEqual(score.true_parameters(effect("creep", {"share": 0.1, "time_s": 9.0}, "prony"), 0.2), {})
        drift = score.true_parameters(effect("clock_drift", {"drift_ppm": -400.0}), 0.2)
        self.assertAlmostEqual(drift["rate"], -4.0016e-4, places=8)
        for form, numbers in (("linear", {"share": 0.1}), ("", {"share": 0.1}), ("step", {})):
            self.assertEqual(score.true_parameters(effect("stiffness_taper", {"share": 0.1}, form), 0.2), numbers)

    def test_one_of_a_wrong_chamber_is_not_right(self):
        def said_of(chamber, *confusable):
            numbers = {"chamber": {"value": chamber, "low": chamber, "high": chamber, "unit": "1"}}
            return report("explained", named("pressure_lag", parameters=numbers, confusable=confusable))

        def top1(said, hidden):
            return score.marks("single_strong", score.decision_of_report(said), hidden)["top1"]

        for theirs, chamber, right in ((2.0, 2.0, True), (2.0, 3.0, False), (0.0, 3.0, True), (2.0, 0.0, True)):
            hidden, said = truth(effect("pressure_lag", {"chamber": theirs}, "first_order")), said_of(chamber)
            self.assertEqual(score.right(said["effects"][0], hidden), right, (theirs, chamber))
            self.assertEqual(top1(said, hidden), right, (theirs, chamber))
        hidden = truth(effect("pressure_lag", {"chamber": 2.0}, "first_order"), effect("clock_offset", {"offset_s": 0.1}))
        self.assertTrue(score.right(said_of(3.0, "clock_offset")["effects"][0], hidden))
        # Of a record of before it could be one chamber's.
        self.assertTrue(score.right(said_of(3.0)["effects"][0], truth(effect("pressure_lag", {}, "first_order"))))
        sticks = named("hysteresis", parameters={"chamber": {"value": 3.0, "low": 3.0, "high": 3.0, "unit": "1"}})
        for values, form, right in (({"chamber": 3.0}, "play", True), ({"chamber": 1.0}, "play", False), ({}, "material", True)):
            self.assertEqual(score.right(sticks, truth(effect("hysteresis", values, form))), right, form)

    def test_ranks(self):
        hidden = truth(distractors=[effect("base_compliance", {"stiffness_nm_per_rad": 5.0})])
        for value, low, high, rank in ((0.2, 0.1, 0.3, 0.5), (0.3, 0.2, 0.5, 0.05), (0.1, 0.05, 0.2, 0.95)):
            parameters = {"compliance_rad_per_nm": {"value": value, "low": low, "high": high, "unit": "rad/(N m)"}}
            said = report("explained", named("base_compliance", parameters=parameters))
            self.assertAlmostEqual(score.ranks(result("untidy_none", hidden, said))[0], rank, places=3)
        self.assertEqual(score.ranks(result("untidy_none", hidden, report("consistent"))), [])

    def test_a_number_that_was_not_fitted_has_no_interval(self):
        hidden = truth(effect("contact", parameters={"stiffness_n_per_m": 100.0, "extent_m": 0.02}))
        held = {"value": 0.03, "unit": "m", "fitted": False}
        fitted = {"value": 110.0, "low": 90.0, "high": 130.0, "unit": "N/m"}
        for numbers, hits in (({"stiffness_n_per_m": fitted, "extent_m": held}, [True]), ({"extent_m": held}, [])):
            case = result("untidy_single", hidden, report("explained", named("contact", parameters=numbers)))
            errors, found, _ = score.sizes(case)
            self.assertAlmostEqual(errors[0], 0.1 if hits else 0.5, places=3)  # what it says of the size counts
            self.assertEqual(found, hits)
            self.assertEqual(len(score.ranks(case)), len(hits))
            self.assertEqual(prove_figures.figures([case])["interval_coverage"], 1.0 if hits else None)

    def test_an_arm_of_another_mass_is_payloads_told_wrong(self):
        said = report("explained", named("payload_scale", parameters={"share": {"value": -0.04, "low": -0.05, "high": -0.03}}))
        for ratio, right in ((0.96, True), (1.0, False)):
            hidden = {**truth(), "mass_ratio": ratio}
            self.assertEqual(score.right(said["effects"][0], hidden), right)
            self.assertEqual(len(score.ranks(result("untidy_none", hidden, said))), int(right))

    def test_a_payload_told_wrong_on_an_arm_of_another_mass_is_one_number(self):
        both = {**truth(distractors=[effect("payload_scale", {"share": -0.05})]), "mass_ratio": 1.1}
        found = [one for one in score.everything(both) if one["effect"] == "payload_scale"]
        self.assertEqual(len(found), 1)
        self.assertAlmostEqual(found[0]["values"]["share"], 1.1 * 0.95 - 1.0)

    def test_forces_are_those_of_an_arm_of_the_mass_that_the_file_states(self):
        def of(name, values, numbers, ratio):
            hidden = {**truth(effect(name, values)), "mass_ratio": ratio}
            parameters = {s: {"value": v, "low": 0.99 * v, "high": 1.01 * v, "unit": ""} for s, v in numbers.items()}
            said = report("explained", named(name, parameters=parameters))
            return score.sizes(result("untidy_single", hidden, said)), score.ranks(result("untidy_single", hidden, said))

        # Twice as heavy as its file says: stiffness and weight are half as large there, compliance is twice.
        for name, values, numbers in (("axial_compliance", {"axial_stiffness_n": 50.0}, {"compliance_per_n": 0.04}),
                                      ("base_compliance", {"stiffness_nm_per_rad": 5.0}, {"compliance_rad_per_nm": 0.4}),
                                      ("tip_mass", {"mass_kg": 0.02}, {"mass_kg": 0.01}),
                                      ("soft_spot", {"share": 0.3}, {"share": 0.3}),
                                      ("payload_scale", {"share": 0.1}, {"share": 1.2})):
            (errors, hits, _), ranks = of(name, values, numbers, 2.0)
            self.assertAlmostEqual(errors[0], 0.0, msg=name)
            self.assertEqual(hits, [True])
            self.assertAlmostEqual(ranks[0], 0.5)
        (errors, hits, _), _ = of("tip_mass", {"mass_kg": 0.02}, {"mass_kg": 0.02}, 2.0)
        self.assertAlmostEqual(errors[0], 1.0)
        self.assertEqual(hits, [False])
        hidden = {**truth(effect("creep"), constants={"bending_stiffness": 0.03}), "mass_ratio": 1.5}
        said = report("explained", shifts=[{"name": "bending_stiffness", "before": 0.03, "after": 0.021}])
        self.assertAlmostEqual(score.bias_removed(result("compensated", hidden, said)), 0.9)

    def test_place(self):
        hidden = truth(effect("soft_spot", {"share": 0.3, "centre_fraction": 0.5, "width_fraction": 0.2}))
        said = report("explained", named("soft_spot", where={"s_from": 0.08, "s_to": 0.14}))
        self.assertAlmostEqual(prove_figures.figures([result("single_strong", hidden, said)])["place_error_m"], 0.01)
        number = {"centre_m": {"value": 0.103, "low": 0.1, "high": 0.11}}  # its own number says it before that
        said = report("explained", named("soft_spot", parameters=number, where={"s_from": 0.08, "s_to": 0.14}))
        self.assertAlmostEqual(prove_figures.figures([result("single_strong", hidden, said)])["place_error_m"], 0.003)

    def test_bias(self):
        hidden = truth(effect("creep"), constants={"bending_stiffness": 0.03})
        shift = {"name": "bending_stiffness", "before": 0.04, "after": 0.031}
        said = report("explained", named("creep"), shifts=[shift])
        self.assertAlmostEqual(prove_figures.figures([result("compensated", hidden, said)])["bias_removed"], 0.9)
        small = dict(shift, before=0.0301)
        self.assertIsNone(score.bias_removed(result("compensated", hidden, report("explained", shifts=[small]))))

    def test_held_out(self):
        results = [result("single_strong", truth(effect("creep")), report("explained", named("creep"), after=4.4e-4)),
                   result("none", truth(), report("consistent", before=5e-4, after=6e-4)),
                   result("none", truth(), report("consistent", before=5e-4, after=5e-4))]
        results += [result(kind, truth(effect("creep")), report("explained", named("creep"), after=after))
                    for kind, after in (("untidy_single", 8e-4), ("untidy_outside", 9e-3), ("outside", 9e-3))]
        figures = prove_figures.figures(results)
        self.assertAlmostEqual(figures["untidy_held_out_over_floor"], 2.0)
        self.assertAlmostEqual(figures["held_out_over_floor"], 1.1)
        self.assertAlmostEqual(figures["worse_than_baseline"], 0.5)

    def test_interval_of_a_rate(self):
        low, high = prove_figures.interval(9, 10)
        self.assertTrue(0.6 < low < 0.9 < high < 1.0)
        self.assertEqual(prove_figures.interval(0, 10)[0], 0.0)
        self.assertIsNone(prove_figures.interval(0, 0))


class Story(unittest.TestCase):
    def test_every_trial_and_every_key(self):
        bic = {"bic": {"alarm": True, "effects": [{"name": "creep", "probability": 0.8}], "ranking": ["creep", "drift"]},
               "gp": {"alarm": True, "effects": [], "ranking": []}}
        results = [result("single_strong", truth(effect("creep")), report("explained", named("drift", 0.99)), bic),
                   dict(result("pair", None, None), not_drawn="the arm | flies")]
        figures = prove_figures.figures(results)
        self.assertEqual(figures["baselines"]["bic"]["single_strong"]["top1"], 1.0)
        self.assertEqual(figures["baselines"]["gp"]["single_strong"]["top1"], 0.0)
        self.assertIsNone(figures["baselines"]["lasso"]["single_strong"]["top1"])
        for kind in score.KINDS:
            self.assertEqual(set(figures[kind]), {"trials", "counted", *prove_figures.RATES})
        for key in prove_figures.FIGURES:
            self.assertIn(key, figures)
            self.assertIn(key, figures["baselines"]["bic"])
        figures.update({"campaign": "c", "seed": 1, "full": False, "truth_sha256": "abc", "engine": "def"})
        names = {"story": "p.md", "trials_page": "t.md", "misses_page": "m.md", "misses": {}}
        text = prove_report.story(results, figures, names) + prove_report.trials(results, figures, names)
        for words in ("drift 0.99", "confident_wrong", "not drawn: the arm / flies", "CONTRADICTED", "`bic` 0 to 1", "`abc`", "creep 0.70", "256 MiB"):
            self.assertIn(words, text)
        self.assertIn("such as `single_strong: top1` is a kind of case and a rate:\n[what was measured, and how](#what-was-measured-and-how)", text)
        self.assertIn("\n## What was measured, and how\n", text)
        self.assertIn("single_strong: top1", prove_report.table(figures))
        self.assertFalse(prove_report.passes(figures))
        self.assertEqual(figures["draws"], 2)

    def test_a_sample_contradicts_or_does_not(self):
        results = [result("single_strong", truth(effect("creep")), report("explained", named("creep", 0.95), after=4.1e-4))]
        results[0]["truth"]["rejected"] = ["creep is too small", "creep is too small"]
        figures = {**prove_figures.figures(results), "full": False}
        self.assertEqual(figures["rejected_draws"], 2)
        lost = dict(result("pair", None, None), not_drawn="the last", rejected=["the arm flies"] * 3)
        self.assertEqual(prove_figures.figures(results + [lost])["rejected_draws"], 5)
        self.assertTrue(prove_report.passes(figures))
        self.assertFalse(prove_report.passes({**figures, "full": True}))  # one case meets nothing

    def test_rejected_draws_are_told_without_the_numbers_that_differ(self):
        results = [result("single_strong", truth(effect("creep")), report("consistent"))]
        results[0]["truth"]["rejected"] = ["creep does not come to its size: 1.5", "it flies away", "creep does not come to its size: 2e-3",
                                           "creep does not come to its size", "no_load_2 is short"]
        figures = prove_figures.figures(results)
        self.assertEqual(figures["rejected_reasons"]["creep does not come to its size: #"], 2)
        self.assertIn("5 draws were rejected before the seal (creep does not come to its size, 3 times; it flies away, once; no_load_# is short, once).",
                      prove_report.rejected(figures))


class Targets(unittest.TestCase):
    def test_every_world_says_how_its_cases_are_made(self):
        for world in prove_sources.WORLDS:
            self.assertIn(f"- **{world}**: ", prove_report.WORLDS_TEXT)

    def test_met_means_all_of_the_interval(self):
        status = prove_report.status
        self.assertEqual(status((0.9, 0.99), 0.85, None, True), "met")
        self.assertEqual(status((0.8, 0.99), 0.85, None, True), "NOT MET")
        self.assertEqual(status((0.8, 0.99), 0.85, None, False), "not contradicted")
        for full in (True, False):
            self.assertEqual(status((0.2, 0.8), 0.85, None, full), "CONTRADICTED")
            self.assertEqual(status((0.03, 0.2), None, 0.02, full), "CONTRADICTED")
        self.assertEqual(status((0.86, 0.94), 0.85, 0.95, True), "met")
        self.assertEqual(status((0.96, 0.99), 0.85, 0.95, True), "CONTRADICTED")
        self.assertEqual(status((0.5, 0.6), None, None, True), "-")
        self.assertEqual(status(None, 0.85, None, True), "NOT MET")
        self.assertEqual(status(None, 0.85, None, False), "-")
        for full in (True, False):
            self.assertEqual(status(None, None, None, full), "-")

    def test_in_the_whole_a_target_without_cases_is_not_met(self):
        figures = prove_figures.figures([result("class_only", truth(effect("creep")), report("explained", named("creep", 1.0)))])
        whole, sample = ({row[0]: row[4] for row in prove_report.rows({**figures, "full": full})} for full in (True, False))
        for row in ("single_strong: top1", "solid_single: right_class", "control: false_alarm",
                    "none, untidy_none, solid_none: false_alarm", "real: clear cases that only one decides rightly, diagnose to a baseline; McNemar's p",
                    "place of contact and soft spot, median error, m"):
            self.assertEqual(whole[row], "NOT MET")
            self.assertIn(sample.get(row, "-"), "-")
        self.assertEqual((whole["class_only: right_class"], sample["class_only: right_class"]), ("-", "-"))
        self.assertNotIn("solid_none: false_alarm", whole)  # no target, no cases
        self.assertFalse(prove_report.passes({**figures, "full": True}))
        self.assertTrue(prove_report.passes({**figures, "full": False}))

    def test_rows_of_several_kinds_carry_their_target(self):
        def judged(kinds, alarms, full):
            results = [result(kind, truth(), report("explained", named("drift", 0.6)) if i < alarms else report("consistent"))
                       for kind in kinds for i in range(100)]
            return {row[0]: row for row in prove_report.rows({**prove_figures.figures(results), "full": full})}
        every = ("none", "untidy_none", "solid_none")
        found = judged(every, 0, True)
        self.assertEqual(found["none, untidy_none, solid_none: false_alarm"][1:5], ["300", "0.00 (0.00-0.01)", "<= 0.01", "met"])
        for kind in every:
            self.assertEqual(found[kind + ": false_alarm"][1:5], ["100", "0.00 (0.00-0.03)", "-", "-"])
        self.assertEqual(judged(every, 4, False)["none, untidy_none, solid_none: false_alarm"][1:5],
                         ["300", "0.040 (0.03-0.06)", "<= 0.01", "CONTRADICTED"])
        for full, expected in ((True, "NOT MET"), (False, "not contradicted")):  # the solid arm is absent
            self.assertEqual(judged(every[:2], 0, full)["none, untidy_none, solid_none: false_alarm"][4], expected)

    def test_baselines_are_compared_on_what_is_clear(self):
        def case(clear, said):
            nothing = {"bic": {"alarm": False, "effects": [], "ranking": []}}
            return result("untidy_single", {**truth(effect("creep")), **({} if clear is None else {"clear": clear})}, said, nothing)
        wrong, right = report("explained", named("drift", 0.99)), report("explained", named("creep", 0.99))
        results = [case(False, wrong) for _ in range(9)] + [case(True, right), case(None, right), case(True, report("consistent"))]
        figures = prove_figures.figures(results)
        for found in (figures["baselines"]["bic"]["mcnemar"], figures["worlds"]["untidy"]["mcnemar"]["bic"]):
            self.assertEqual((found["cases"], found["ours_alone"], found["theirs_alone"]), (3, 2, 0))
        self.assertEqual(figures["confident_wrong"], 9 / 12)  # these count whether anybody could see or not

    def test_the_best_baseline_is_to_be_beaten(self):
        def judged(ours, theirs, full):
            beside = {"bic": prove_figures.mcnemar([(True, False)] * ours + [(False, True)] * theirs), "gp": prove_figures.mcnemar([(True, False)] * 9)}
            rows = prove_report.beside_baselines({"worlds": {"real": {"mcnemar": beside}}, "full": full})
            return [row[4] for row in rows if row[0].startswith("real")]
        self.assertEqual(judged(12, 1, True), ["met"])
        self.assertEqual(judged(3, 1, True), ["NOT MET"])
        self.assertEqual(judged(3, 1, False), ["not contradicted"])
        self.assertEqual(judged(1, 12, False), ["CONTRADICTED"])
        for full, expected in ((True, ["NOT MET", "NOT MET"]), (False, [])):  # the untidy world is absent, the real one was not decided
            beside = {"worlds": {"real": {"mcnemar": {"bic": prove_figures.mcnemar([])}}}, "full": full}
            self.assertEqual([row[4] for row in prove_report.beside_baselines(beside)], expected)

    def test_places_of_rig_and_solid_arm(self):
        of_rig = effect("soft_spot", {"share": 0.5, "centre_fraction": 0.4})
        of_solid = effect("soft_spot", form="solid", parameters={"share": 0.5, "centre_m": 0.085, "width_m": 0.03})
        self.assertAlmostEqual(score.true_place_m(of_rig, 0.2), 0.08)
        self.assertAlmostEqual(score.true_place_m(of_solid, 0.2), 0.085)
        said = named("soft_spot", parameters={"share": {"value": 0.5, "low": 0.4, "high": 0.6}}, where={"s_from": 0.07, "s_to": 0.11})
        places = score.sizes(result("solid_single", truth(of_solid), report("explained", said)))[2]
        self.assertAlmostEqual(places[0], 0.005)

    def test_intervals_of_figures_hold_them_and_narrow_with_cases(self):
        def of(count):
            results = [result("single_strong", truth(effect("creep")),
                              report("explained", named("creep", 0.6 + 0.3 * (i % 2)), after=(4.2 + 0.3 * (i % 3)) * 1e-4))
                       for i in range(count)]
            return prove_figures.figures(results)
        few, many = of(6), of(60)
        for figures in (few, many):
            low, high = figures["intervals"]["held_out_over_floor"]
            self.assertLessEqual(low, figures["held_out_over_floor"])
            self.assertGreaterEqual(high, figures["held_out_over_floor"])
        self.assertLess(many["intervals"]["calibration_error"][1] - many["intervals"]["calibration_error"][0],
                        few["intervals"]["calibration_error"][1] - few["intervals"]["calibration_error"][0])
        self.assertEqual(of(4)["intervals"], {})

    def test_worlds_and_power(self):
        def case(kind, size_m, named_first):
            hidden = effect("creep")
            hidden["signal"] = {"leftover_snr": 20.0, "leftover_m": size_m}
            return result(kind, truth(hidden), report("explained", named(named_first)))
        results = [case("untidy_single", 1e-4 * (1 + i), "creep" if i >= 4 else "drift") for i in range(8)]
        results.append(case("single_strong", 1e-3, "creep"))
        found = prove_figures.figures(results)["worlds"]
        self.assertEqual(set(found), {"tidy", "untidy"})
        self.assertEqual(found["untidy"]["single_strong"]["top1"], 0.5)
        self.assertEqual(found["tidy"]["single_strong"]["top1"], 1.0)
        curve = found["untidy"]["power"]
        self.assertEqual([part["right_class"] for part in curve], [0.0, 0.0, 1.0, 1.0])
        self.assertEqual([part["trials"] for part in curve], [2, 2, 2, 2])
        self.assertAlmostEqual(curve[0]["leftover_m"], 1.5e-4)
        for result_of in results[:6]:  # power counts what nobody could see, too; rates do not
            result_of["truth"]["clear"] = False
        found = prove_figures.figures(results)["worlds"]["untidy"]
        self.assertEqual([part["right_class"] for part in found["power"]], [0.0, 0.0, 1.0, 1.0])
        self.assertEqual((found["single_strong"]["top1"], found["single_strong"]["counted"]["top1"]), (1.0, 2))
        self.assertEqual(prove_figures.power([]), [])

    def test_mcnemar(self):
        self.assertEqual(prove_figures.mcnemar([(True, True), (False, False)])["p"], 1.0)
        found = prove_figures.mcnemar([(True, False)] * 6 + [(True, True)] * 3)
        self.assertEqual((found["ours_alone"], found["theirs_alone"]), (6, 0))
        self.assertAlmostEqual(found["p"], 2.0 / 64.0)
        self.assertAlmostEqual(prove_figures.mcnemar([(True, False)] * 3 + [(False, True)] * 3)["p"], 1.0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
