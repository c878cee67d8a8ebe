"""Findings of the module are those of the program; trials of the virtual rig made from Python are those that it makes."""
import hashlib
import json
import os
import signal
import unittest

import support

import numpy as np
import softarm


class Checks(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.arm = softarm.load_arm("online_200mm")

    def program(self, *bags):
        """What it prints, and its JSON."""
        target = support.path("findings.json")
        text = support.softarm("check", "--arm", "online_200mm", *bags, "--json", target, "--force", status=None)
        with open(target, encoding="utf-8") as file:
            return text, json.load(file)

    def test_is_the_programs(self):
        bags = [support.bag(), support.bag("trial_10s", "6", "second", "8")]
        broken = support.path("broken.bag")
        with open(bags[0], "rb") as whole, open(broken, "wb") as part:
            part.write(whole.read()[:20000])
        for some, serious in ((bags[:1], False), (bags, False), ([*bags, broken], True)):
            told = []
            found = softarm.check(self.arm, some, progress=lambda share, what: told.append(share))
            text, document = self.program(*some)
            self.assertEqual(found.text, text)
            self.assertEqual(found.to_dict(), document)
            self.assertEqual(found.serious, serious)
            self.assertEqual(list(found.worst), some)
            self.assertEqual(len(found.to_pandas()), len(found.findings) + len(found.together))
            self.assertTrue(told)
        self.assertEqual([one.id for one in found.findings if one.severity == "serious"], ["unreadable"])

    def test_a_finding_has_its_figure(self):
        found = softarm.check(self.arm, support.bag())
        lost = next(one for one in found.findings if one.id == "lost_body")
        self.assertEqual((lost.recording, lost.unit, lost.severity), (support.bag(), "1", "information"))
        self.assertTrue(0.0 < lost.figure < 0.1)
        self.assertIn(f"{100.0 * lost.figure:.1f} %", lost.what)

    def test_what_is_wrong_is_one_line(self):
        nowhere = support.path("nowhere.bag")
        support.one_line(self, softarm.BagError, lambda: softarm.check(self.arm, [support.bag(), nowhere]), nowhere, "no such bag")
        support.one_line(self, ValueError, lambda: softarm.check(self.arm, support.bag(), jobs=-1), "jobs", "-1")


class Simulations(unittest.TestCase):
    def test_is_the_programs(self):
        """The bag, the truth and their digests, byte for byte; what is returned is what they hold."""
        support.softarm("simulate", "trial_10s", "--seconds", "3", "--seed", "9", "--out", "theirs.bag")
        made = softarm.simulate("trial_10s", support.path("ours.bag"), seconds=3, seed=9)
        for suffix in (".bag", ".truth.csv", ".truth.yaml"):
            with open(support.path("ours" + suffix), "rb") as ours, open(support.path("theirs" + suffix), "rb") as theirs:
                self.assertEqual(ours.read(), theirs.read(), suffix)
        with open(made.truth_path, "rb") as file:
            self.assertIn(hashlib.sha256(file.read()).hexdigest(), made.text)
        arm = softarm.load_arm("online_200mm")
        trial = softarm.read_bag(arm, made.bag)
        self.assertLess(abs(len(trial) - len(made.truth["stamp"])), 5)
        self.assertEqual((made.hidden["seed"], made.hidden["scenario"]), (9, "trial_10s"))
        self.assertEqual(made.to_dict(), made.hidden)
        self.assertEqual(len(made.to_pandas()), len(made.truth["stamp"]))
        found = softarm.estimate(trial)
        np.testing.assert_allclose(found.payload_kg[found.ok], made.truth["payload"][0], atol=1e-9)

    def test_an_arm_is_a_scenario(self):
        arm = softarm.load_arm("two_segment")
        made = softarm.simulate(arm, support.path("moving.bag"), seconds=2, seed=1)
        support.softarm("simulate", os.path.join(support.SOURCE, "config", "arms", "two_segment.yaml"), "--seconds", "2", "--seed",
                        "1", "--out", "moving_too.bag")
        with open(made.bag, "rb") as ours, open(support.path("moving_too.bag"), "rb") as theirs:
            self.assertEqual(ours.read(), theirs.read())
        self.assertGreater(len(softarm.read_bag(arm, made.bag)), 100)

    def test_what_is_wrong_is_one_line(self):
        out = support.path("wrong.bag")
        for wrong, kind, words in (
                (lambda: softarm.simulate("nowhere", out), softarm.Error, ["nowhere", "trial_10s"]),
                (lambda: softarm.simulate({"arm": "nobody"}, out, seconds=1), softarm.Error, ["nobody", "online_200mm"]),
                (lambda: softarm.simulate({"arms": 1}, out, seconds=1), softarm.Error, ["scenario.yaml", "format"]),
                (lambda: softarm.simulate("--help", out), softarm.Error, ["--help"]),
                (lambda: softarm.simulate({"arm": object()}, out), ValueError, ["scenario", "object"]),
                (lambda: softarm.simulate(3, out), ValueError, ["scenario", "3", "Arm"]),
                (lambda: softarm.simulate("demo", out), softarm.Error, ["endless"]),
                (lambda: softarm.simulate("demo", support.path("no/such.bag"), seconds=1), softarm.Error, ["folder"]),
                (lambda: softarm.simulate("demo", out, seconds=0), ValueError, ["seconds", "0.01"]),
                (lambda: softarm.simulate("demo", out, seconds="long"), ValueError, ["seconds", "long"]),
                (lambda: softarm.simulate("demo", out, seconds=1, seed=-1), ValueError, ["seed", "-1"]),
                (lambda: softarm.simulate("demo", out, seconds=1, seed="x"), ValueError, ["seed", "x"])):
            support.one_line(self, kind, wrong, *words)
        self.assertFalse([name for name in os.listdir(support.FOLDER) if name.startswith("wrong")])
        path = support.path("kept.bag")
        softarm.simulate("trial_10s", path, seconds=1)
        support.one_line(self, softarm.Error, lambda: softarm.simulate("trial_10s", path, seconds=2), "kept.bag")
        softarm.simulate("trial_10s", path, seconds=2, force=True)

    def test_ctrl_c_ends_it(self):
        signal.signal(signal.SIGALRM, lambda *_: signal.raise_signal(signal.SIGINT))
        signal.alarm(1)
        with self.assertRaises(KeyboardInterrupt):
            softarm.simulate("demo", support.path("long.bag"), seconds=100000)
        self.assertFalse(os.path.exists(support.path("long.bag")))


class Tables(unittest.TestCase):
    def test_cells_are_what_they_are(self):
        path = support.path("table.csv")
        with open(path, "w", encoding="utf-8") as file:
            file.write("stamp,trial,piece,error\n1.5,7,12_1,\n2.5,8,12_2,-3e-4\n")
        table = softarm.read_table(path, ["stamp"], texts=["trial"])
        self.assertEqual(list(table), ["stamp", "trial", "piece", "error"])
        np.testing.assert_array_equal(table["stamp"], [1.5, 2.5])
        np.testing.assert_array_equal(table["error"], [np.nan, -3e-4])
        self.assertEqual([list(table["trial"]), list(table["piece"])], [["7", "8"], ["12_1", "12_2"]])
        support.one_line(self, softarm.Error, lambda: softarm.read_table(path, ["sd"]), path, "no column sd")
        with open(path, "a", encoding="utf-8") as file:
            file.write("3.5\n")
        support.one_line(self, softarm.Error, lambda: softarm.read_table(path), path, "different numbers of cells")


if __name__ == "__main__":
    support.main()
