#!/usr/bin/python3
"""What the plotting scripts draw of trials of the rig: of estimates every value, the residual, a legend, the truth where it is; of
findings those of the bags; of an identification its three parts. What cannot be drawn is one line."""
import csv
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import tree

source, build = tree.directories()
SCRIPT = os.path.join(source, "scripts", "plot_estimates.py")
PROGRAM = os.path.join(build, "devel", "lib", "softarm_estimator", "softarm")
MODULE = os.path.join(build, "devel", "lib", "python3", "dist-packages", "softarm")


def softarm(*arguments):
    subprocess.run([PROGRAM, *arguments], check=True, stdout=subprocess.DEVNULL)


class PlotEstimates(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(dir=build, prefix="plots_check_")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        softarm("simulate", "trial_10s", "--seconds", "6", "--out", cls.path("trial.bag"))
        softarm("estimate", "--arm", "online_200mm", cls.path("trial.bag"), "--out", cls.path("estimates"))
        cls.csv = cls.path("estimates/trial/estimates.csv")

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    def plot(self, *arguments, out="trial.svg"):
        return subprocess.run([sys.executable, SCRIPT, *arguments, "--out", self.path(out)], stderr=subprocess.PIPE, text=True,
                              env={**os.environ, "SOFTARM_BUILD_DIR": build})

    def said(self, *arguments):
        """The texts of the picture, which matplotlib leaves beside their outlines."""
        done = self.plot(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.path("trial.svg"), encoding="utf-8") as picture:
            return picture.read()

    def test_every_value_with_legend_and_truth(self):
        picture = self.said(self.csv)
        for text in ("tip angle (°)", "φ (°)", "EI (N m²)", "L (mm)", "payload (g)", "residual (mm)", "estimated, identifiable",
                     "± 1 standard deviation", "the payload changes, or has just changed", "truth"):
            self.assertIn("<!-- %s -->" % text, picture)

    def test_without_a_truth_there_is_none(self):
        away = self.path("away/estimates/trial")
        os.makedirs(away)
        shutil.copy(self.csv, away)
        self.assertNotIn("<!-- truth -->", self.said(os.path.join(away, "estimates.csv")))
        named = self.said(os.path.join(away, "estimates.csv"), "--truth", self.path("trial.truth.csv"))
        self.assertIn("<!-- truth -->", named)

    def test_what_is_no_table_is_one_line(self):
        for wrong in (self.path("trial.bag"), self.path("trial.truth.csv"), self.path("nowhere.csv")):
            done = self.plot(wrong)
            self.assertEqual(done.returncode, 1)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertIn(wrong, done.stderr)

    def changed(self, name, change):
        """A copy of the table whose cells of the last row, by column, are changed."""
        with open(self.csv, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        change(rows)
        with open(self.path(name), "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, rows[0].keys())
            writer.writeheader()
            writer.writerows(rows)
        return self.path(name)

    def test_a_table_that_lacks_something_is_one_line(self):
        open(self.path("empty.csv"), "w").close()
        wrong = [(self.path("empty.csv"), "no column stamp"), (self.folder, "Is a directory"),
                 (self.changed("no_sd.csv", lambda rows: [row.pop("sd_phi") for row in rows]), "no column sd_phi"),
                 (self.changed("text.csv", lambda rows: rows[-1].update(EI="soft")), "column EI has a cell that is no number")]
        for path, why in wrong:
            done = self.plot(path)
            self.assertEqual((done.returncode, done.stderr), (1, f"plot_estimates: {path}: {why}\n"))
        for truth in ("text.csv", "nowhere.csv"):
            done = self.plot(self.csv, "--truth", self.path(truth))
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
            self.assertIn(truth, done.stderr)

    def test_a_picture_that_cannot_be_written_is_one_line(self):
        for name, why in (("no_folder/a.svg", "No such file or directory"), ("a.none", "Format 'none' is not supported")):
            done = self.plot(self.csv, out=name)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
            self.assertIn(f"{self.path(name)}: cannot be written: {why}", done.stderr)


class Others(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(dir=build, prefix="plots_check_")
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.bags = [cls.path(f"trial_{k}.bag") for k in range(3)]
        for k, bag in enumerate(cls.bags):
            softarm("simulate", "trial_10s", "--seconds", "8", "--seed", str(k + 1), "--out", bag)

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    @classmethod
    def write(cls, name, text):
        with open(cls.path(name), "w", encoding="utf-8") as file:
            file.write(text)
        return cls.path(name)

    def draw(self, script, *arguments):
        return subprocess.run([sys.executable, os.path.join(source, "scripts", script), *arguments, "--out", self.path("a.svg")],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False,
                              env={**os.environ, "SOFTARM_BUILD_DIR": build})

    def said(self, script, *arguments):
        done = self.draw(script, *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.path("a.svg"), encoding="utf-8") as picture:
            return picture.read()

    def expect_line(self, script, word, *arguments):
        done = self.draw(script, *arguments)
        self.assertEqual((done.returncode, done.stderr.count("\n")), (1, 1), done.stderr)
        self.assertIn(word, done.stderr)

    def test_findings_of_bags_are_those_that_were_written(self):
        findings = self.path("findings.json")
        softarm("check", "--arm", "online_200mm", *self.bags[:2], "--json", findings)
        drawn = self.said("plot_check.py", "--arm", "online_200mm", *self.bags[:2])
        for text in ("trial_0.bag", "trial_1.bag", "ring_4", "inputs at rest"):
            self.assertIn(f"<!-- {text} -->", drawn)
        of_file = self.said("plot_check.py", findings)
        texts = re.compile("<!-- (.*?) -->")
        self.assertEqual(texts.findall(of_file), texts.findall(drawn))
        self.expect_line("plot_check.py", "nowhere.bag: no such bag", "--arm", "online_200mm", self.path("nowhere.bag"))
        self.expect_line("plot_check.py", "--arm", self.bags[0])
        for text, word in (("{\"recordings\": []}", "findings of no recording"), ("{\"recordings\": [{\"name\": \"a\"}]}", "not the findings"),
                           ("{\"recordings\": [1]}", "not the findings"), ("", "not the findings")):
            self.expect_line("plot_check.py", word, self.write("wrong.json", text))
        self.expect_line("plot_check.py", "No such file", self.path("nowhere.json"))

    def test_an_identification(self):
        softarm("identify", "--arm", "online_200mm", *self.bags, "--out", self.path("fitted.yaml"), "--plot", self.path("picture"))
        drawn = self.said("plot_identify.py", self.path("picture"))
        for text in ("measured z of ring_4 (mm)", "after, fitted", "after, unseen", "unseen, before", "segment_1.chamber_1.moment_gain"):
            self.assertIn(f"<!-- {text} -->", drawn)
        for option, text in (("--joints", "sag of the tip"), ("--laws", "one chamber alone: c p / (1 + a p)"), ("--wall", "inflated for 15 s")):
            self.assertIn(f"<!-- {text} -->", self.said("plot_identify.py", option))
        self.expect_line("plot_identify.py", "shapes.csv", self.folder)
        self.write("shapes.csv", "trial,stamp\na,1\n")
        self.expect_line("plot_identify.py", "no column held_out", self.folder)

    def test_what_was_not_written_by_the_program_is_one_line(self):
        self.expect_line("plot_rig.py", "no column value", self.write("rig.csv", "kind,scenario\na,b\n"))
        self.expect_line("plot_rig.py", "no number", self.write("rig.csv", "kind,scenario,value,worst_mm\nstep,demo,a,1\n"))
        os.makedirs(self.path("validation"))
        self.expect_line("plot_validation.py", "no CSV files", self.path("validation"))
        for name in ("online_frames", "online_payload"):
            self.write(f"validation/{name}.csv", "a,b\n1,2\n")
        self.expect_line("plot_validation.py", "no column standing", self.path("validation"))
        self.write("validation/online_frames.csv", "standing,b\nyes,2\n")
        self.expect_line("plot_validation.py", "no number", self.path("validation"))


if __name__ == "__main__":
    if not os.path.exists(PROGRAM) or not os.path.exists(MODULE) or importlib.util.find_spec("matplotlib") is None:
        tree.lacks("no matplotlib (Debian package python3-matplotlib), no program, or no module softarm")
    unittest.main(argv=sys.argv[:1])
