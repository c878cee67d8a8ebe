#!/usr/bin/python3
"""Known interventions on recordings: what each does to made-up tables, what they may be called, how they are scored beside
their controls."""
import argparse
import copy
import math
import os
import random
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(sys.argv[1] if len(sys.argv) > 1 else ".", "scripts"))
import prove_figures  # noqa: E402
import prove_files  # noqa: E402
import prove_real  # noqa: E402
import prove_real_report  # noqa: E402
import prove_real_score  # noqa: E402
import prove_report  # noqa: E402
import prove_score  # noqa: E402
import real_changes  # noqa: E402
import real_recordings  # noqa: E402

SETS = real_recordings.SETS
UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def table(name, seconds=12.0):
    """An arm that swings slowly in a plane, on straight chords from its base, as the files of a set have it."""
    kind, rows = SETS[name], []
    step = kind.period_s or 0.02
    for i in range(int(seconds / step)):
        t = i * step
        row = [float(i) if kind.period_s else t] + [0.0] * 53
        angle = 0.2 * math.sin(0.7 * t)
        tangent = real_changes.add(tuple(math.cos(angle) * x for x in kind.down), kind.across, math.sin(angle))
        at = kind.base_m or (0.0, 0.0, 0.5)
        if kind.base:
            row[kind.base[0]:kind.base[0] + 3] = at
            row[kind.base[1]:kind.base[1] + 4] = UPRIGHT
        for position, orientation in kind.bodies.values():
            at = real_changes.add(at, tangent, 0.1)
            row[position:position + 3] = at
            if orientation is not None:
                axis = real_changes.cross(kind.down, kind.across)
                row[orientation:orientation + 4] = real_changes.turn(axis, angle)
        for number, (column, zero) in enumerate(zip(kind.inputs, kind.zeros)):
            row[column] = zero + 5.0 + 5.0 * math.sin(0.7 * t + number)
        rows.append(row)
    return rows


def recordings(name):
    found = []
    for label, payload in (("a", [(0.0, 0.0)]), ("b", [(0.0, 0.0), (6.0, 0.2)]), ("c", [(0.0, 0.3)])):
        with tempfile.NamedTemporaryFile("w", suffix=".csv") as file:
            file.write("header\n")
            for row in table(name):
                file.write(",".join(f"{cell:.10g}" for cell in row) + "\n")
            file.flush()
            found.append(real_recordings.Recording(file.name, label, True, ",", payload, []))
    return found


def changed_columns(before, after):
    """Columns in which rows of the same time differ."""
    return {column for one, other in zip(before, after) for column in range(len(one.rows[0]))
            if any(abs(a[column] - b[column]) > 1e-9 for a, b in zip(one.rows, other.rows))}


def places(kind, recording, name):
    return [real_changes.place(row, kind.bodies[name][0]) for row in recording.rows]


class Changes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.plain = {name: recordings(name) for name in SETS}

    def apply(self, name, change, seed=3):
        return real_changes.apply(name, SETS[name], self.plain[name], change, random.Random(seed))

    def test_every_change_touches_what_it_says_and_nothing_else(self):
        for name, changes in real_changes.CHANGES.items():
            kind = SETS[name]
            poses = set(real_changes.body_columns(kind))
            for change in changes:
                word = change.__name__
                with self.subTest(set=name, change=word):
                    after, done = self.apply(name, word)
                    self.assertGreater(done["size"], 0.0)
                    touched = set() if word.startswith("clock") and not kind.period_s else changed_columns(self.plain[name], after)
                    payloads = any(a.payload != b.payload for a, b in zip(self.plain[name], after))
                    self.assertEqual(payloads, word.startswith("payload"))
                    if word.startswith("log_"):
                        self.assertTrue(touched and touched <= set(kind.inputs))
                    elif word == "input_clock_shifted":
                        self.assertTrue(kind.period_s is None or len(touched) == 1)
                    elif word in ("gravity_tilted", "segment_of_another") or payloads:
                        self.assertEqual(touched, set())
                        self.assertTrue(payloads or done["gravity"] or done["segment"])
                    elif kind.period_s or not word.startswith("clock"):
                        self.assertTrue(touched and touched <= poses)
                    again, said = self.apply(name, word)
                    self.assertEqual(([one.rows for one in again], said), ([one.rows for one in after], done))

    def test_poses_of_a_clock_ahead_are_those_of_before(self):
        for seed in range(4):  # of both signs
            after, done = self.apply("trunk", "clock_shifted", seed)
            rows = round(done["parameters"]["offset_s"] / 0.01)
            middle = len(after[0].rows) // 2
            before = real_changes.place(self.plain["trunk"][0].rows[middle - rows], 7)
            self.assertEqual(real_changes.place(after[0].rows[middle], 7), before)
        after, _ = self.apply("pouch_one", "clock_shifted")
        self.assertLess(len(after[0].rows), len(self.plain["pouch_one"][0].rows))

    def test_poses_of_a_clock_that_drifts_are_those_of_ever_longer_before(self):
        for seed in range(4):  # of both signs
            after, done = self.apply("trunk", "clock_drifting", seed)
            self.assertEqual(done["effects"], ["clock_drift", "clock_offset"])
            for row in range(300, len(after[0].rows) - 100, 200):
                before = row - done["parameters"]["rate"] * row  # rows of 0.01 s
                at = min(range(len(self.plain["trunk"][0].rows)), key=lambda i: abs(i - before))
                self.assertEqual(real_changes.place(after[0].rows[row], 7), real_changes.place(self.plain["trunk"][0].rows[at], 7))

    def test_a_moved_body_is_as_far_off_as_is_said(self):
        for name in SETS:
            for change, symbol in (("body_moved_along", "z_m"), ("body_moved_across", "x_m")):
                after, done = self.apply(name, change)
                body = done["words"].split()[0]
                for a, b in zip(places(SETS[name], self.plain[name][1], body)[::200], places(SETS[name], after[1], body)[::200]):
                    off = real_changes.add(b, a, -1.0)
                    self.assertAlmostEqual(math.sqrt(real_changes.dot(off, off)), done["size"], places=8)
                    if symbol == "z_m":  # away from the base, which is above
                        self.assertGreater(real_changes.dot(off, SETS[name].down) * done["parameters"]["z_m"], 0.0)

    def test_tilts_keep_lengths_and_lead_where_they_say(self):
        for name in SETS:
            kind = SETS[name]
            after, done = self.apply(name, "frame_tilted")
            body = list(kind.bodies)[0]
            base = kind.base_m or (0.0, 0.0, 0.5)
            for a, b in zip(places(kind, self.plain[name][0], body)[::300], places(kind, after[0], body)[::300]):
                off_a, off_b = real_changes.add(a, base, -1.0), real_changes.add(b, base, -1.0)
                self.assertAlmostEqual(real_changes.dot(off_a, off_a), real_changes.dot(off_b, off_b), places=9)
            rest = real_changes.unit(real_changes.add(places(kind, after[0], body)[0], base, -1.0))  # it hangs at first
            self.assertAlmostEqual(math.acos(real_changes.dot(rest, kind.down)), done["size"], places=6)
            if kind.base:
                towards = done["parameters"]
                self.assertAlmostEqual(math.hypot(*towards.values()), done["size"], places=9)
                self.assertGreater(rest[0] * towards["towards_x_rad"] + rest[1] * towards["towards_y_rad"], 0.0)
        _, done = self.apply("trunk", "gravity_tilted")
        self.assertAlmostEqual(math.sqrt(sum(x * x for x in done["gravity"])), 9.80665, places=5)
        self.assertLess(done["gravity"][2], -9.6)
        self.assertGreater(-done["gravity"][0] * done["parameters"]["towards_x_rad"], 0.0)

    def test_laws_of_the_log(self):
        lag = real_changes.lag_law(0.5)
        self.assertEqual([lag(0.0, 0.0), lag(0.0, 4.0)], [0.0, 0.0])
        self.assertAlmostEqual(lag(0.5, 4.0), 4.0 * (1.0 - math.exp(-1.0)))
        play = real_changes.play_law(1.0)
        self.assertEqual([play(0.0, x) for x in (0.0, 0.5, 3.0, 2.5, 0.0)], [0.0, 0.0, 2.0, 2.0, 1.0])
        after, done = self.apply("pouch_one", "log_saturates")
        column = SETS["pouch_one"].inputs[1]
        pairs = [(a[column] + 0.75, b[column] + 0.75) for a, b in zip(self.plain["pouch_one"][0].rows, after[0].rows)]
        top = max(pairs)
        if "all inputs" in done["words"]:
            self.assertLess(top[1] / top[0], 1.0)

    def test_what_cannot_be_told_is_no_draw(self):
        two = [one for one in self.plain["trunk"] if one.name in "ab"]
        two[1].payload = list(two[0].payload)
        with self.assertRaises(real_changes.NothingChanged):
            real_changes.apply("trunk", SETS["trunk"], two, "payload_swapped", random.Random(1))
        two[1].payload = [(0.0, 0.0), (6.0, 0.2)]


class Draws(unittest.TestCase):
    def options(self, **more):
        return argparse.Namespace(**{"root": "/nowhere", "programs": "/nowhere", "seed": 5, "full": False, "cases": None, "jobs": 1,
                                     **more})

    def test_every_change_once_before_any_twice(self):
        count = sum(len(changes) for changes in real_changes.CHANGES.values())
        design = prove_real.design(5, count)
        self.assertEqual(len({(name, change) for name, _, change in design}), count)
        self.assertEqual(design, prove_real.design(5, count + 9)[:count])
        self.assertNotEqual(design, prove_real.design(6, count))

    def test_every_intervention_has_its_control_in_the_plan(self):
        for more, interventions in (({}, prove_real.SAMPLE), ({"full": True}, prove_real.FULL), ({"cases": 1}, 1)):
            source = prove_real.Source(self.options(**more))
            plan = source.plan(source.kinds())
            self.assertEqual(sum(kind == "intervention" for kind, _ in plan), interventions)
            controls = {prove_real.CONTROLS[number] for kind, number in plan if kind == "control"}
            self.assertEqual(controls, {(name, split) for name, split, _ in source.design})
        self.assertGreaterEqual(prove_real.FULL, 60)

    def test_an_intervention_that_cannot_be_drawn_keeps_all_reasons(self):
        source = prove_real.Source(self.options())
        def nothing(number, attempt, case, truth, rejected):
            raise real_changes.NothingChanged(f"attempt {attempt}")
        source.intervene = nothing
        with self.assertRaises(prove_files.NotDrawn) as caught:
            source.draw("intervention", 0, "case", "truth")
        self.assertEqual(caught.exception.rejected, [f"attempt {i}" for i in range(prove_real.ATTEMPTS)])
        self.assertIn("the last: attempt 11", str(caught.exception))

    def test_without_recordings_it_says_so(self):
        os.environ["SOFTARM_DATA"] = "/nowhere"
        try:
            self.assertIn("SOFTARM_DATA", prove_real.Source(self.options()).absent())
        finally:
            del os.environ["SOFTARM_DATA"]

    def test_class_by_signature(self):
        ideal = [{"effect": "creep", "explains": 0.8}, {"effect": "drift", "explains": 0.75}, {"effect": "shear", "explains": 0.6}]
        self.assertEqual(prove_real.class_of(["hysteresis"], ideal), ["hysteresis", "creep", "drift"])
        self.assertEqual(prove_real.class_of([], ideal, ["creep"]), ["drift"])
        self.assertEqual(prove_real.class_of([], [{"effect": "creep", "explains": 0.4}]), [])

    def test_a_segment_of_another_arm_file(self):
        def arm(gain):
            return (f"name: x\nsegments:\n  - name: segment_1\n    gain: {gain}\n  - name: segment_2\n    gain: {gain}\n\ntip: {gain}\n")
        both = real_recordings.segment_of_another(arm(1), arm(2), "segment_2")
        self.assertEqual([line.strip() for line in both.splitlines() if "gain" in line or "tip" in line], ["gain: 1", "gain: 2", "tip: 1"])
        self.assertIn("gravity_m_s2: [1.000000,", prove_real.with_gravity("gravity_m_s2: [0, 0, -9.8]  # down", [1, 0, -9]))


def hidden(names=("clock_offset",), clear=True, leftover_m=2e-3, parameters=None):
    return {"kind": "intervention", "set": "trunk", "split": 0, "words": "the clock", "class": list(names), "clear": clear,
            "unexplained_m": 5e-3, "distractors": [], "ideal": [], "constants": {}, "rejected": [],
            "effects": [{"effect": "clock_shifted", "names": list(names), "catalogued": False, "values": {}, "form": "",
                         "parameters": parameters or {}, "signal": {"leftover_snr": 30.0, "leftover_m": leftover_m}}]}


def report(verdict, *named):
    errors = {"held_out_rms_m": 5e-3}
    return {"verdict": verdict, "ranking": [{"name": name} for name, _ in named], "noise_floor_m": 2e-4, "baseline": errors,
            "extended": errors, "effects": [{"name": name, "probability": p, "confusable_with": [], "where": {}, "parameters": {
                "offset_s": {"value": 0.22, "low": 0.18, "high": 0.25, "unit": "s"}}} for name, p in named]}


def result(kind, truth, said):
    return {"case": f"{kind}", "kind": kind, "number": 0, "truth": truth, "report": said, "not_drawn": None, "cost": None,
            "baselines": None}


def control(said):
    return result("control", {"kind": "control", "set": "trunk", "split": 0, "effects": [], "distractors": [], "ideal": [],
                              "constants": {}, "rejected": []}, said)


class Scores(unittest.TestCase):
    def figures(self, truth, said, untouched):
        results = [result("intervention", truth, said), control(untouched)]
        return prove_figures.figures(results), results

    def test_found_and_not_in_the_control(self):
        figures, _ = self.figures(hidden(parameters={"offset_s": 0.2}), report("explained", ("clock_offset", 0.99)), report("unknown"))
        kind = figures["worlds"]["real"]["intervention"]
        self.assertEqual((kind["top1"], kind["top3"], kind["right_class"]), (1.0, 1.0, 1.0))
        self.assertEqual(figures["worlds"]["real"]["control"]["false_alarm"], 0.0)
        self.assertAlmostEqual(figures["parameter_median_error"], 0.1)
        self.assertEqual(figures["interval_coverage"], 1.0)

    def test_bodies_exchanged_are_found_where_the_report_says_so(self):
        exchanged = hidden(names=real_changes.bodies_exchanged(SETS["trunk"], recordings("trunk"), random.Random(1))["effects"])
        for said, rate in (({"exchanged_names": {"said": [], "seen": [], "trials": []}}, 1.0), ({}, 0.0)):
            figures, _ = self.figures(exchanged, {**report("unknown"), **said}, report("unknown"))
            kind = figures["worlds"]["real"]["intervention"]
            self.assertEqual((kind["top1"], kind["right_class"], kind["confident_wrong"]), (rate, rate, 0.0))

    def test_payloads_are_found_where_the_report_says_so(self):
        told = {"told_payloads": {"trials": [], "as_told_held_out_mean_m": 0.01, "held_out_mean_m": 0.001}}
        for change in (real_changes.payload_withheld, real_changes.payload_swapped, real_changes.payload_scaled):
            listed = recordings("trunk")
            for one in listed:
                one.before = copy.deepcopy(one)
            names = change(SETS["trunk"], listed, random.Random(2))["effects"]
            for said, rate in ((told, 1.0), ({}, 0.0)):
                figures, _ = self.figures(hidden(names=names), {**report("unknown"), **said}, report("unknown"))
                kind = figures["worlds"]["real"]["intervention"]
                self.assertEqual((kind["top1"], kind["right_class"], kind["confident_wrong"]), (rate, rate, 0.0))
            unsure = {"told_payloads": {**told["told_payloads"], "probability": 0.6}}
            decision = prove_score.decision_of_report({**report("unknown"), **unsure})
            self.assertEqual([named["probability"] for named in decision["named"]], [0.6])
            _, results = self.figures(hidden(names=names), report("unknown"), {**report("unknown"), **told})
            self.assertIn(prove_real_score.TOLD_PAYLOADS, results[1]["truth"]["asked"])

    def test_what_the_control_has_too_finds_nothing(self):
        both = report("explained", ("clock_offset", 0.99))
        figures, results = self.figures(hidden(parameters={"offset_s": 0.2}), both, both)
        kind = figures["worlds"]["real"]["intervention"]
        self.assertEqual((kind["top1"], kind["right_class"], kind["confident_wrong"]), (0.0, 0.0, 0.0))
        self.assertEqual(figures["control"]["false_alarm"], 1.0)
        self.assertEqual(figures["control"]["confident_wrong"], 1.0)
        self.assertIsNone(figures["parameter_median_error"])
        self.assertEqual(prove_report.judged(results[0]), "**in the control too**")
        self.assertFalse(prove_report.passes({**figures, "full": False}))

    def test_a_small_departure_of_the_control_that_is_none_here_is_found(self):
        outright = report("explained", ("clock_offset", 0.99))
        small = {**outright, "effects": [], "small_departures": outright["effects"]}
        for said, untouched, rate in ((outright, small, 1.0), (small, small, 0.0), (small, outright, 0.0), (small, report("unknown"), 1.0)):
            figures, _ = self.figures(hidden(), said, untouched)
            self.assertEqual([figures["intervention"][mark] for mark in ("top1", "top3", "right_class")], [rate] * 3)

    def test_what_the_arm_has_by_itself_is_no_error(self):
        own, other = ("hysteresis", 0.99), ("shear", 0.95)
        figures, _ = self.figures(hidden(), report("explained", own), report("unknown", own))
        self.assertEqual((figures["confident_wrong"], figures["control"]["false_alarm"]), (0.0, 0.0))
        figures, results = self.figures(hidden(), report("explained", own, other), report("unknown", own))
        self.assertEqual(figures["intervention"]["confident_wrong"], 1.0)
        self.assertEqual(prove_report.judged(results[0]), "**named wrongly**")

    def test_what_is_listed_as_improbable_is_not_named(self):
        said = report("unknown", ("clock_offset", 0.3))
        figures, results = self.figures(hidden(), said, said)
        self.assertEqual((figures["intervention"]["right_class"], figures["control"]["false_alarm"]), (0.0, 0.0))
        self.assertEqual(prove_report.judged(results[0]), "**missed**")

    def test_small_ones_count_for_power_alone(self):
        figures, _ = self.figures(hidden(clear=False), report("consistent"), report("consistent"))
        self.assertIsNone(figures["intervention"]["right_class"])
        self.assertEqual(figures["intervention"]["counted"]["right_class"], 0)
        self.assertEqual(figures["worlds"]["real"]["power"], [{"leftover_m": 2e-3, "trials": 1, "right_class": 0.0}])

    def test_what_has_no_name_is_unknown(self):
        for verdict, right in (("unknown", 1.0), ("explained", 0.0)):
            figures, _ = self.figures(hidden(names=()), report(verdict), report("consistent"))
            self.assertEqual((figures["intervention"]["unknown"], figures["intervention"]["right_class"]), (right, None))

    def test_baselines_have_controls_of_their_own(self):
        results = [result("intervention", hidden(), report("explained", ("clock_offset", 0.99))), control(report("unknown"))]
        found = {"bic": {"alarm": True, "effects": [{"name": "clock_offset"}], "ranking": ["clock_offset"]}}
        for one in results:
            one["baselines"] = found
        figures = prove_figures.figures(results)
        self.assertEqual(figures["baselines"]["bic"]["intervention"]["right_class"], 0.0)
        self.assertEqual(figures["worlds"]["real"]["mcnemar"]["bic"]["ours_alone"], 2)

    def test_story_and_picture(self):
        figures, results = self.figures(hidden(), report("explained", ("clock_offset", 0.99)), report("unknown"))
        figures.update({"campaign": "real", "seed": 1, "full": False, "truth_sha256": "a", "engine": "b"})
        names = {"story": "p.md", "trials_page": "t.md", "misses_page": "m.md", "misses": {}}
        text = prove_report.story(results, figures, names) + prove_report.trials(results, figures, names)
        for words in ("| clock shifted | 1 | 1 | 1 |", "class: clock_offset", "leaves 2.00 mm (the untouched recordings 5.00 mm)", "trunk, 1: untouched", "intervention: right_class", "A name such as `intervention: top1` is a kind"):
            self.assertIn(words, text)
        self.assertEqual(prove_real_report.story([results[1]]), "")
        self.assertEqual([outcome for *_, outcome in prove_real_report.interventions(results)], ["found"])
        self.assertTrue(set(prove_real_report.LOOKS) == set(prove_real_score.BINS))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
