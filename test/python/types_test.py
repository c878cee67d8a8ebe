"""The package, the examples and what a laboratory writes pass a type checker; what is wrong does not. Skipped without mypy."""
import importlib.metadata
import os
import re
import subprocess
import sys
import unittest

import support

GOOD = """
import numpy as np
import softarm

arm: softarm.Arm = softarm.load_arm("online_200mm")
errors = arm.effects_correlations
covariances = errors.matrix * np.outer(errors.sd, errors.sd)
uncertain = [name.upper() for name in errors.names]
model = softarm.Model(arm, points=11, constants=list(arm.constants))
shapes = model.solve({"chamber_1": np.zeros(3)}, 0.1, stamp_s=[0.0, 0.1, 0.2])
tip_m: float = float(shapes.p_base_m[0, -1, 2])
jacobians = model.solve(jacobians=True).jacobians
if jacobians is not None:
    print(jacobians.bodies_by_inputs.shape)
trial: softarm.Trial = softarm.read_bag(arm, "trial.bag", progress=lambda share, what: print(f"{share:.2f} {what}"))
found = softarm.estimate(trial, unknown="both", prior=True, window_s=0.5)
EI_nm2: float = found.EI_nm2[found.identifiable_EI].max()
many = [one.summary for one in softarm.estimate_bags(arm, ["a.bag", "b.bag"], jobs=2)]
changes = [(alarm.onset_s, alarm.description.upper()) for alarm in found.alarms]
held_off = found.mismatch.stamp_s[~found.mismatch.valid]
fitted = softarm.identify(arm, [trial], held="*.length")
names = [one.name.upper() for one in fitted.constants if one.determined]
diagnosis = softarm.diagnose(fitted.arm, [trial])
if diagnosis.extended_arm is not None:
    diagnosis.extended_arm.save("arm_extended.yaml", force=True)
serious = [one.remedy for one in softarm.check(arm, "trial.bag").findings if one.severity == "serious"]
bag: str = softarm.simulate({"arm": "online_200mm"}, "trial.bag", seconds=2.0, seed=3).bag
"""

# Each line, and what the checker calls it.
WRONG = """
softarm.load_arm(3)  # arg-type
softarm.load_arm("a").effects_correlations.correlations  # attr-defined
softarm.Model("online_200mm")  # arg-type
softarm.Model(arm, poins=11)  # call-arg
softarm.estimate(trial, windows=1)  # arg-type
softarm.estimate(trial, window_s="long")  # arg-type
softarm.estimate(trial).EI_nm  # attr-defined
softarm.estimate_bags(arm, ["a.bag"])[0].alarms[0].onset  # attr-defined
softarm.estimate(trial).mismatch.score_sd.upper()  # attr-defined
softarm.read_bag("trial.bag")  # call-arg
softarm.identify(arm, trial)  # arg-type
softarm.diagnose(arm, [trial]).extended_arm.save("a.yaml")  # union-attr
softarm.check(arm, "a.bag").finding  # attr-defined
softarm.simulate("demo", "a.bag", seconds="ten")  # arg-type
softarm.read_bag(arm, "a.bag", progress=lambda share: None)  # arg-type misc
softarm.estimat(trial)  # attr-defined
"""


class Types(unittest.TestCase):
    def run_module(self, module, *arguments):
        environment = {**os.environ, "MYPYPATH": sys.path[0], "PYTHONPATH": sys.path[0], "MYPY_CACHE_DIR": support.path("cache")}
        done = subprocess.run([sys.executable, "-m", module, *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              env=environment, cwd=support.FOLDER, check=False)
        return done.returncode, done.stdout

    def check(self, *arguments):
        return self.run_module("mypy", "--config-file=", "--strict", *arguments)

    def write(self, name, text):
        with open(support.path(name), "w", encoding="utf-8") as file:
            file.write(text)
        return name

    def test_package(self):
        status, text = self.check("-p", "softarm")
        self.assertEqual(status, 0, text)

    def test_uses(self):
        status, text = self.check(self.write("good.py", GOOD))
        self.assertEqual(status, 0, text)

    def test_wrong_uses_are_found(self):
        before = "import softarm\narm = softarm.load_arm('a')\ntrial = softarm.read_bag(arm, 'a.bag')"
        status, text = self.check(self.write("wrong.py", before + WRONG))
        self.assertEqual(status, 1, text)
        first = before.count("\n") + 2
        for number, line in enumerate(WRONG.strip().splitlines(), first):
            codes = line.split("  # ")[1].split()
            found = re.findall(rf"^wrong\.py:{number}: error: .*\[([\w-]+)\]$", text, re.M)
            self.assertTrue(set(found) & set(codes), f"{line}\n{found}\n{text}")

    def test_examples(self):
        examples = os.path.join(support.SOURCE, "python", "examples")
        for name in sorted(os.listdir(examples)):
            if name.endswith(".py"):
                # Their own functions need no annotations, and matplotlib has none; what they asked for is there.
                status, text = self.run_module("mypy", "--config-file=", "--check-untyped-defs", "--ignore-missing-imports",
                                               "--disable-error-code=union-attr", os.path.join(examples, name))
                self.assertEqual(status, 0, text)

    def test_stub_is_the_extension(self):
        _, text = self.run_module("mypy.stubtest", "--concise", "softarm._softarm")
        self.assertIn("softarm._softarm", text)  # what pybind11 makes of every class
        others = [line for line in text.splitlines() if not re.search(
            r"metaclass differs|is inconsistent, stub does not have \*args argument", line)]
        self.assertEqual(others, [])


def at_least(package, *version):
    try:
        return tuple(int(part) for part in importlib.metadata.version(package).split(".")[:2]) >= version
    except (importlib.metadata.PackageNotFoundError, ValueError):
        return False


if __name__ == "__main__":
    if not at_least("mypy", 1, 0) or not at_least("numpy", 1, 22):
        support.skip("there is no mypy 1.0 (Debian package mypy), or NumPy is older than its annotations (1.22)")
    support.main()
