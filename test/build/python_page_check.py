#!/usr/bin/python3
"""doc/python.md and the notebook are what python/examples/tour.py executes to: the same cells, which print the same but for numbers.
The other examples run, and say in one line what is wrong."""
import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import tree

source, build = tree.directories()
PROGRAM = os.path.join(build, "devel", "lib", "softarm_estimator", "softarm")
PACKAGES = os.path.join(build, "devel", "lib", "python3", "dist-packages")
EXAMPLES = os.path.join(source, "python", "examples")


def without_numbers(text):
    return re.sub(r"[\s-]+", " ", re.sub(r"[+-]?\d[\d.]*(e[+-]\d+)?", "#", text))


def read(*path):
    with open(os.path.join(*path), encoding="utf-8") as file:
        return file.read()


def run(*command):
    environment = {**os.environ, "PYTHONPATH": PACKAGES, "SOFTARM_BUILD_DIR": build}
    return subprocess.run([sys.executable, *command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment,
                          check=False)


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(dir=build, prefix="python_page_check_")
        cls.addClassCleanup(shutil.rmtree, cls.folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def test_page_and_notebook_are_the_tour(self):
        done = run(os.path.join(source, "scripts", "python_page.py"), "--program", PROGRAM, "--out", self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        told = "run scripts/python scripts/python_page.py again"
        self.assertEqual(without_numbers(read(self.folder, "python.md")), without_numbers(read(source, "doc", "python.md")), told)
        ours, theirs = json.loads(read(self.folder, "tour.ipynb")), json.loads(read(EXAMPLES, "tour.ipynb"))
        self.assertEqual([cell["source"] for cell in ours["cells"]], [cell["source"] for cell in theirs["cells"]], told)
        for cell in theirs["cells"]:
            for link in re.findall(r"\]\((\.\./[^)#]+)", "".join(cell["source"])):
                self.assertTrue(os.path.exists(os.path.join(EXAMPLES, link)), link)
        for picture in os.listdir(self.path("images")):
            self.assertTrue(os.path.exists(os.path.join(source, "doc", "images", picture)), picture)

    def test_examples(self):
        bags = []
        for k in range(3):
            bags.append(self.path(f"trial_{k}.bag"))
            subprocess.run([PROGRAM, "simulate", "trial_10s", "--seconds", "8", "--seed", str(k + 3), "--out", bags[-1]], check=True,
                           stdout=subprocess.DEVNULL)
        for name, arguments, word in (
                ("estimate_trial.py", [*bags, "--out", self.path("a.png"), "--csv", self.path("a.csv")], "frames estimated"),
                ("reach.py", ["--places", "6", "--out", self.path("b.png")], "6 places"),
                ("identify_and_diagnose.py", [*bags, "--out", self.path("results")], "rms error on unseen trials")):
            done = run(os.path.join(EXAMPLES, name), *arguments)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(word, done.stdout)
        for made in ("a.png", "a.csv", "b.png", "results/online_200mm_identified.yaml", "results/report/report.html"):
            self.assertTrue(os.path.getsize(self.path(made)), made)
        done = run(os.path.join(EXAMPLES, "estimate_trial.py"), self.path("nowhere.bag"))
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn("nowhere.bag: no such bag\n", done.stderr)


if __name__ == "__main__":
    if not os.path.exists(PROGRAM) or not os.path.exists(os.path.join(PACKAGES, "softarm")) or any(
            importlib.util.find_spec(name) is None for name in ("matplotlib", "pandas")):
        tree.lacks("no module, no program, no matplotlib or no pandas (Debian packages python3-matplotlib, python3-pandas)")
    unittest.main(argv=sys.argv[:1])
