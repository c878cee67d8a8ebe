"""Whatever an argument is, the answer is one line that names it, of softarm.Error or ValueError; nothing ends the interpreter."""
import inspect
import os
import unittest
import warnings

import support

import numpy as np
import softarm

# Nobody means these; a callback is called with two arguments whatever it is.
ODD = [3, -1, 2.5, "x", "", [], {}, [None], b"x", float("nan"), float("inf"), 1e300, -1e300, object(), np.zeros((2, 2)), np.array(["a"]),
       True, "\x00", "a\nb", ["a", "b"], 10**30]
EFFECTS = """
effects:
  - {id: hysteresis, parameters: {share: 0.3, width_pa: 2000, of: 0}}
  - {id: base_compliance, parameters: {compliance_rad_per_nm: 0.2}}
"""


class Arguments(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        # Some of what is odd is a path, and written to.
        os.makedirs(support.path("odd"))
        os.chdir(support.path("odd"))
        warnings.simplefilter("ignore", softarm.SoftarmWarning)
        cls.arm = softarm.load_arm("online_200mm")
        whole = softarm.read_bag(cls.arm, support.bag())
        arrays = {name: getattr(whole, name)[:20] for name in ("base_p_mocap_m", "base_q_mocap_xyzw", "inputs", "payload_kg")}
        cls.trial = softarm.Trial.from_arrays(cls.arm, whole.stamp_s[:20], whole.bodies_p_mocap_m[:20], **arrays)
        cls.extended = softarm.parse_arm(cls.arm.text + EFFECTS)

    def sweep(self, label, function, **usual):
        """Every argument in turn is something odd, the others are as usual."""
        usual = {**dict(arm=self.arm, trial=self.trial, trials=[self.trial], paths=[support.bag()], path=support.bag(), name="online_200mm",
                        text=self.arm.text, layout="template", scenario="trial_10s", out="/nowhere/x.bag"), **usual}
        given = inspect.signature(function).parameters
        needed = {name: usual[name] for name, one in given.items()
                  if one.default is inspect.Parameter.empty and one.kind is not inspect.Parameter.VAR_KEYWORD}
        refused = 0
        for name in (name for name, one in given.items() if one.kind is not inspect.Parameter.VAR_KEYWORD):
            for value in [*ODD, *([None] if name in needed else [])]:
                try:
                    function(**{**needed, name: value})
                except (softarm.Error, ValueError) as why:
                    refused += 1
                    self.assertTrue(str(why) and "\n" not in str(why) and "incompatible" not in str(why), f"{label}({name}={value!r}): {why}")
        self.assertGreater(refused, len(ODD) // 2, label)

    def test_files(self):
        for name in ("load_arm", "parse_arm", "read_bag", "read_bags", "read_csv", "read_table", "check", "simulate"):
            self.sweep(name, getattr(softarm, name))

    def test_nothing_is_written_beside_what_is_named(self):
        before = sorted(os.listdir("."))
        with self.assertRaisesRegex(ValueError, "^out: ''; must be a path$"):
            softarm.simulate("trial_10s", "", seconds=0.1)
        self.assertEqual(sorted(os.listdir(".")), before)

    def test_models(self):
        self.sweep("Model", softarm.Model)
        self.sweep("solve", softarm.Model(self.arm).solve)
        self.sweep("solve with effects", softarm.Model(self.extended).solve)
        self.sweep("with_constants", self.arm.with_constants, values={})

    def test_estimates(self):
        for name in ("estimate", "estimate_bags", "Estimator"):
            self.sweep(name, getattr(softarm, name))
        estimator = softarm.Estimator(self.arm)
        self.sweep("frame", estimator.frame, stamp_s=0.0, bodies_p_mocap_m=np.zeros((4, 3)))
        self.sweep("trial", estimator.trial)
        self.sweep("from_arrays", softarm.Trial.from_arrays, stamp_s=[0.0], bodies_p_mocap_m=np.zeros((1, 4, 3)))

    def test_fits(self):
        self.sweep("identify", softarm.identify)
        self.sweep("diagnose", softarm.diagnose)

    def test_loads_that_no_arm_bears(self):
        for model in (softarm.Model(self.arm, points=3), softarm.Model(self.extended, points=3)):
            for pressure_pa in (1e5, 1e7, 1e12, -1e12):
                for payload_kg in (0.0, 1e3, 1e9):
                    for gravity in ([0.0, 0.0, 0.0], [0.0, 0.0, 9.8], [1e6, 0.0, 0.0]):
                        shapes = model.solve({"chamber_1": pressure_pa}, payload_kg, gravity_base_m_s2=gravity, jacobians=True)
                        if shapes.status[0] == "ok":
                            self.assertTrue(np.isfinite(shapes.p_base_m).all())
                        else:
                            self.assertTrue(np.isnan(shapes.p_base_m).all() and np.isnan(shapes.jacobians.points_by_inputs).all())


if __name__ == "__main__":
    support.main()
