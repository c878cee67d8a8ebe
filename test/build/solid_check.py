#!/usr/bin/python3
"""The finite-element arm: its results as they are kept, and trials made of them; with CalculiX and gmsh also a cylinder against
closed forms, and one trial computed anew against what is kept."""
import csv
import json
import os
import shutil
import sys
import tempfile
import types
import unittest

import tree

source, build = tree.directories()
sys.path.insert(0, os.path.join(source, "scripts"))
try:
    import numpy as np
    import prove_figures
    import prove_report
    import prove_score
    import prove_solid
    import solid_trials
except ImportError:
    sys.exit(tree.SKIPPED)

KEPT = os.path.join(source, "test", "data", "solid")
PROGRAM = os.path.join(build, "devel", "lib", "softarm_estimator", "softarm")
HAS_SOLVER = all(shutil.which(name) for name in ("ccx", "gmsh"))
with open(os.path.join(KEPT, "cases.json"), encoding="utf-8") as text:
    PLAN = json.load(text)


def states_of(case):
    return solid_trials.read_states(os.path.join(KEPT, case + ".csv"), PLAN["bodies"], len(PLAN["marker_deg"]))


def gain_of_nature():
    return next(told["parameters"]["share"] for told in prove_solid.OF_NATURE if told["effect"] == "gain_nonlinearity")


def poses(marks):
    return [solid_trials.rigid_fit(solid_trials.reference_of(PLAN), seen) for seen in marks]


class Kept(unittest.TestCase):
    def test_every_case_has_all_its_states(self):
        for case in PLAN["cases"]:
            trials = states_of(case)
            self.assertEqual(len(trials), len(PLAN["attitudes"]) * len(PLAN["payloads_kg"])
                             - len(PLAN["cases"][case].get("without", [])), case)
            for name, states in trials.items():
                self.assertEqual(len(states), PLAN["states"], name)
                self.assertEqual(states[0][2], [0, 0, 0], name)
                self.assertTrue(all(0 <= p <= PLAN["highest_pa"] for state in states for p in state[2]), name)

    def test_an_arm_that_hangs_without_pressure_is_straight_and_a_little_longer(self):
        for body, height, (turn, place) in zip(PLAN["bodies"], PLAN["bodies"].values(),
                                               poses(states_of("nothing")["hanging_empty"][0][3])):
            self.assertLess(np.linalg.norm(place[:2]), 1e-5, body)
            self.assertLess(abs(turn[0, 2]) + abs(turn[1, 2]), 1e-4, body)
            self.assertTrue(0 < place[2] - height < 1e-3, body)

    def test_a_chamber_bends_the_arm_away_from_itself(self):
        for name, states in states_of("identify").items():
            if not name.startswith("hanging"):
                continue
            for _, _, pressures, marks in states[1:]:
                push = sum(-p * np.exp(1j * np.radians(azimuth))
                           for p, azimuth in zip(pressures, PLAN["arm"]["chamber_azimuth_deg"]))
                x, y, _ = poses(marks)[-1][1]
                self.assertLess(abs(np.angle((x + 1j * y) / push)), 0.15, (name, pressures))

    def test_sections_lose_their_roundness_by_less_than_a_millimetre(self):
        worst = 0.0
        for states in states_of("nothing").values():
            for _, _, _, marks in states:
                for seen, (turn, place) in zip(marks, poses(marks)):
                    off = seen - (solid_trials.reference_of(PLAN) @ turn.T + place)
                    worst = max(worst, np.sqrt((off ** 2).sum(axis=1).mean()))
        self.assertTrue(1e-4 < worst < 1e-3, worst)  # a rod's sections keep theirs

    def test_what_is_hidden_moves_the_arm(self):
        plain = states_of("nothing")
        for case in PLAN["cases"]:
            if case in ("identify", "nothing"):
                continue
            moved = [np.linalg.norm(there[1] - here[1]) for name, states in states_of(case).items()
                     for (*_, before), (*_, after) in zip(plain[name], states) for there, here in zip(poses(after), poses(before))]
            self.assertGreater(max(moved), 5e-4, case)  # five times the noise of a mean


    def test_hanging_the_moment_grows_as_without_weight(self):
        azimuths = np.exp(1j * np.radians(PLAN["arm"]["chamber_azimuth_deg"]))
        curvatures, pushes = [], []
        for case in ("identify", "nothing"):
            for _, _, pressures, marks in states_of(case)["hanging_empty"][1:]:
                (near, low), (far, high) = (poses(marks)[i] for i in (0, 2))
                turn = far @ near.T
                angle = np.arccos((np.trace(turn) - 1) / 2)
                axis = np.array([turn[0, 2] - turn[2, 0], turn[1, 2] - turn[2, 1]]) / (2 * np.sin(angle))
                arc = np.linalg.norm(high - low) * (angle / 2) / np.sin(angle / 2)
                curvatures.append(angle * complex(*axis) / arc)
                p = np.array(pressures) / 5e4
                pushes.append([-(p * azimuths).sum(), -(p ** 2 * azimuths).sum()])
        both = [np.concatenate([part(np.array(x)) for part in (np.real, np.imag)]) for x in (pushes, curvatures)]
        gain, square = np.linalg.lstsq(*both, rcond=None)[0]
        self.assertAlmostEqual(square / gain, gain_of_nature(), delta=0.15 * gain_of_nature())


class Trials(unittest.TestCase):
    def test_a_rigid_fit_finds_turn_and_place(self):
        turn, place = solid_trials.small_turn(np.array([0.3, -0.5, 0.8])), np.array([0.1, 0.2, -0.3])
        found, there = solid_trials.rigid_fit(solid_trials.reference_of(PLAN), solid_trials.reference_of(PLAN) @ turn.T + place)
        np.testing.assert_allclose(found, turn, atol=1e-12)
        np.testing.assert_allclose(there, place, atol=1e-12)

    def test_a_quaternion_is_its_turn(self):
        for vector in ([0.1, 0.2, 0.3], [3.1, 0, 0], [0, 3.1, 0.1], [0.1, 0, -3.0]):
            turn = solid_trials.small_turn(np.array(vector))
            x, y, z, w = solid_trials.quaternion(turn)
            np.testing.assert_allclose(turn @ [1, 0, 0], [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)], atol=1e-12)
            np.testing.assert_allclose(turn @ [0, 0, 1], [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], atol=1e-12)

    def test_gravity_points_down_in_every_attitude(self):
        for name, gravity in PLAN["attitudes"].items():
            turn = solid_trials.attitude(name, gravity)
            np.testing.assert_allclose(turn @ np.array(gravity), [0, 0, -1], atol=1e-8)
            self.assertAlmostEqual(np.linalg.det(turn), 1.0)

    def test_a_log_lies_about_one_chamber_only(self):
        self.assertEqual(solid_trials.logged([1e3, 2e3, 0], {"chamber": 2, "offset_pa": 500}), [1e3, 2500, 0])
        self.assertEqual(solid_trials.logged([1e3, 2e3, 0], {"chamber": 1, "lost_pa": 500}), [1500, 2e3, 0])
        self.assertEqual(solid_trials.logged([0, 2e3, 0], {"chamber": 1, "lost_pa": 500}), [0, 2e3, 0])

    @unittest.skipUnless(os.path.exists(PROGRAM), "softarm is not built")
    def test_bags_come_out_the_same_for_the_same_seed(self):
        kept = []
        for _ in range(2):
            folder = tempfile.mkdtemp(dir=build, prefix="solid_check_")
            self.addCleanup(shutil.rmtree, folder)
            bags = solid_trials.write_trials(PLAN, KEPT, "log_offset", folder, 3, PROGRAM)
            self.assertEqual(len(bags), 6)
            with open(bags[0], "rb") as bag:
                kept.append(bag.read())
        self.assertEqual(kept[0], kept[1])

    @unittest.skipUnless(os.path.exists(PROGRAM), "softarm is not built")
    def test_beside_a_wall_only_the_trials_that_it_has(self):
        folder = tempfile.mkdtemp(dir=build, prefix="solid_check_")
        self.addCleanup(shutil.rmtree, folder)
        of_wall = solid_trials.write_trials(PLAN, KEPT, "wall", os.path.join(folder, "wall"), 3, PROGRAM)
        plain = solid_trials.write_trials(PLAN, KEPT, "nothing", os.path.join(folder, "plain"), 3, PROGRAM, "wall")
        self.assertEqual([os.path.basename(bag) for bag in plain], [os.path.basename(bag) for bag in of_wall])
        self.assertEqual(len(plain), 5)


class World(unittest.TestCase):
    def options(self, **more):
        return types.SimpleNamespace(**{"root": source, "programs": os.path.dirname(PROGRAM), "full": False, "cases": None, "seed": 4,
                                        "jobs": 1, **more})

    def test_every_kind_is_scored_and_every_hidden_thing_is_in_the_catalogue(self):
        catalogue = {name[:-4] for name in os.listdir(os.path.join(source, "src", "effects"))}
        for kind, cases in prove_solid.CASES.items():
            self.assertIn(kind, prove_score.KINDS)
            self.assertIn(kind, prove_figures.WORLDS["solid"].values())
            self.assertTrue(any(target[0] == kind for target in prove_report.TARGETS), kind)
            for case in cases:
                self.assertIn(case, PLAN["trials"])
                self.assertEqual(case in prove_solid.HIDDEN, kind != "solid_none")
        for told in (*prove_solid.HIDDEN.values(), *prove_solid.OF_NATURE):
            self.assertTrue({told["effect"], *told.get("class", [])} <= catalogue, told)

    def test_the_plan_has_every_case_and_draws_of_the_noise_only(self):
        kinds = prove_solid.Source(self.options()).kinds()
        self.assertEqual(len(prove_solid.Source(self.options()).plan(kinds)), 8)
        full = prove_solid.Source(self.options(full=True)).plan(kinds)
        self.assertEqual(len(full), 40)
        self.assertEqual(len(set(full)), 40)

    @unittest.skipUnless(os.path.exists(PROGRAM), "softarm is not built")
    def test_a_case_tells_nothing_of_what_is_hidden_in_it(self):
        folder = tempfile.mkdtemp(dir=build, prefix="solid_check_")
        self.addCleanup(shutil.rmtree, folder)
        case, truth = os.path.join(folder, "case"), os.path.join(folder, "truth")
        prove_solid.Source(self.options()).draw("solid_none", 0, case, truth)
        self.assertEqual(sorted(os.listdir(case)), ["arm.yaml", "case.json"] + [f"trial_{i + 1}.bag" for i in range(6)])
        with open(os.path.join(truth, "case.json"), encoding="utf-8") as text:
            self.assertEqual(json.load(text)["solid"], "nothing")

    def test_what_the_body_has_by_nature_is_no_false_alarm(self):
        said = {"verdict": "unknown", "ranking": ["gain_nonlinearity"], "findings": {},
                "named": [{"name": "gain_nonlinearity", "probability": 0.95, "confusable_with": []}]}
        truth = {"effects": [], "distractors": prove_solid.OF_NATURE, "ideal": []}
        self.assertFalse(prove_score.marks("solid_none", said, truth)["confident_wrong"])
        said["named"][0]["name"] = "gravity_direction"
        self.assertTrue(prove_score.marks("solid_none", said, truth)["confident_wrong"])

    def test_a_class_decided_beforehand_is_right(self):
        said = {"verdict": "explained", "ranking": ["rest_curvature"], "findings": {},
                "named": [{"name": "rest_curvature", "probability": 0.95, "confusable_with": []}]}
        truth = {"effects": [{"effect": "pressure_offset", "catalogued": True, "values": {}}], "distractors": [], "ideal": []}
        self.assertFalse(prove_score.marks("solid_single", said, {**truth, "class": []})["right_class"])
        marks = prove_score.marks("solid_single", said, {**truth, "class": ["rest_curvature"]})
        self.assertTrue(marks["right_class"] and not marks["top1"] and not marks["confident_wrong"])


@unittest.skipUnless(HAS_SOLVER, "ccx or gmsh is not installed")
class Solved(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(dir=build, prefix="solid_check_")
        self.addCleanup(shutil.rmtree, self.folder)

    def test_a_cylinder_bends_as_a_cantilever_and_an_elastica(self):
        import solid_checks
        arm = solid_checks.full_cylinder(PLAN)
        small, large = 0.001, 0.2
        found = solid_checks.bent_cylinder(PLAN, [small, large], self.folder)
        for (across, along, turn), (wanted, wanted_turn) in zip(found[:1], [solid_checks.cantilever(arm, small * 9.80665)]):
            self.assertLess(abs(turn / wanted_turn - 1), 0.005)
            self.assertTrue(-0.05 < across / wanted - 1 < 0)  # the clamp keeps the section as wide as it was
        across, along, turn = found[1]
        wanted, wanted_along, wanted_turn = solid_checks.elastica(arm, large * 9.80665)
        self.assertLess(abs(turn / wanted_turn - 1), 0.005)
        self.assertTrue(-0.05 < across / wanted - 1 < 0)
        self.assertLess(abs(along - wanted_along), 0.05 * abs(wanted_along))

    def test_pressure_changes_the_gain_as_much_as_the_proof_says_and_not_the_stiffness(self):
        import solid_checks
        found = solid_checks.own_laws(PLAN, self.folder, alone_pa=(20e3, 40e3))
        self.assertAlmostEqual(found["gain_nonlinearity"], gain_of_nature(), delta=0.05 * gain_of_nature())
        self.assertLess(abs(found["pressure_stiffening"]), 0.01)

    def test_a_trial_computed_anew_is_the_one_that_is_kept(self):
        import solid_arm
        plan = {**PLAN, "states": 4}
        trial = "hanging_empty"
        path = solid_arm.compute_case(plan, "nothing", self.folder, self.folder, 1, [trial])
        with open(path, newline="", encoding="ascii") as new, open(os.path.join(KEPT, "nothing.csv"), newline="", encoding="ascii") as old:
            kept = {(row["trial"], row["state"]): row for row in csv.DictReader(old)}
            rows = list(csv.DictReader(new))
        self.assertEqual(len(rows), 4)
        for row in rows:
            for column, cell in row.items():
                if column.endswith("_mm"):
                    self.assertAlmostEqual(float(cell), float(kept[trial, row["state"]][column]), delta=0.005)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
