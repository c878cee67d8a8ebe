"""Identification and diagnosis of the module are those of the program; recordings in CSV are what an import of them is."""
import json
import os
import signal
import time
import unittest

import support

import numpy as np
import softarm


def trials(count=3, seconds="12"):
    """Of the rig, each with another seed."""
    return [support.bag("trial_10s", seconds, f"fit_{k}", str(k + 11)) for k in range(count)]


class Fits(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.bags = trials()
        cls.arm = softarm.load_arm("online_200mm")
        cls.trials = softarm.read_bags(cls.arm, cls.bags)

    def test_identification_is_the_programs(self):
        out = support.path("identified.yaml")
        printed = support.softarm("identify", "--arm", "online_200mm", *self.bags, "--out", out, "--json", out + ".json")
        shares = []
        found = softarm.identify(self.arm, self.trials, progress=lambda share, what: shares.append(share))
        with open(out, encoding="utf-8") as file:
            self.assertEqual(found.arm.text, file.read())
        with open(out + ".json", encoding="utf-8") as file:
            self.assertEqual(found.to_dict(), json.load(file))
        self.assertIn(found.verdict, printed)
        self.assertIn(found.text, printed)
        k = len(found.constants)
        self.assertEqual((found.correlation.shape, found.covariance.shape), ((k, k), (k, k)))
        np.testing.assert_allclose(np.diag(found.covariance), [one.sd**2 for one in found.constants], rtol=1e-6)
        self.assertEqual(list(found.to_pandas().index), [one.name for one in found.constants])
        self.assertEqual(shares, sorted(shares))

    def test_what_cannot_be_fitted_is_one_line(self):
        support.one_line(self, ValueError, lambda: softarm.identify(self.arm, self.trials, free="wings"), "wings")
        support.one_line(self, ValueError, lambda: softarm.identify(self.arm, self.trials, held_out="monday"), "monday")
        support.one_line(self, ValueError, lambda: softarm.identify(self.arm, self.trials, held_out_share=2), "held_out_share")
        support.one_line(self, ValueError, lambda: softarm.identify(self.arm, self.trials, seed=-1), "seed", "-1")
        support.one_line(self, ValueError, lambda: softarm.identify(self.arm, self.trials, payload_kg="all"), "payload_kg", "all")
        support.one_line(self, ValueError, lambda: softarm.diagnose(self.arm, self.trials, payload_kg=-2.0), "-2", "from 0 to")
        support.one_line(self, softarm.IdentifyError, lambda: softarm.identify(self.arm, []))
        support.one_line(self, softarm.Error, lambda: softarm.diagnose(self.arm, []))
        support.one_line(self, ValueError, lambda: softarm.diagnose(self.arm, self.trials, block_s=-1.0), "block_s")
        support.one_line(self, ValueError, lambda: softarm.diagnose(self.arm, self.trials, held="wings"), "wings")

    def test_diagnosis_is_the_programs(self):
        out = support.path("report")
        support.softarm("diagnose", "--arm", "online_200mm", *self.bags, "--out", out)
        told = []
        found = softarm.diagnose(self.arm, self.trials, progress=lambda share, what: told.append(what))
        with open(os.path.join(out, "report.json"), encoding="utf-8") as file:
            expected = json.load(file)
        ours = found.to_dict()
        # What was typed is the program's alone.
        for origin in (expected, ours):
            for key in [key for key in origin if key in ("origin", "command", "date", "sha256", "inputs")]:
                origin.pop(key)
        self.assertEqual(ours, expected)
        with open(os.path.join(out, "arm_extended.yaml"), encoding="utf-8") as file:
            self.assertEqual(found.extended_arm.text, file.read())
        self.assertTrue(told)
        mine = found.save(support.path("mine"))
        self.assertEqual({os.path.basename(path) for path in mine}, {"report.html", "report.json", "arm_extended.yaml"})
        self.assertGreater(os.path.getsize(mine[0]), 10000)
        with self.assertRaises(FileExistsError):
            found.save(support.path("mine"))
        self.assertEqual(len(found.to_pandas()), len(found.ranking))

    def test_ctrl_c_ends_a_diagnosis(self):
        at = []

        def interrupt(share, what):
            if not at:
                at.append(time.monotonic())
                signal.raise_signal(signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            softarm.diagnose(self.arm, self.trials, progress=interrupt)
        self.assertLess(time.monotonic() - at[0], 20.0)  # the longest of its pieces takes a second or two

    def test_catalogue(self):
        names = {one["id"] for one in softarm.catalogue()}
        self.assertTrue({"base_compliance", "hysteresis", "contact"} <= names)


class Csv(unittest.TestCase):
    def write(self):
        """A trial as a laboratory's table in mm and kPa, and its layout."""
        arm = softarm.load_arm("online_200mm")
        trial = softarm.read_bag(arm, support.bag())
        cells = [trial.stamp_s[:, None] - trial.stamp_s[0]]
        bodies = [("base", trial.base_p_mocap_m, trial.base_q_mocap_xyzw)]
        bodies += [(body.name, trial.bodies_p_mocap_m[:, k], trial.bodies_q_mocap_xyzw[:, k]) for k, body in enumerate(arm.bodies)]
        layout = ["time: {column: 1, unit: s}", "mocap:", "  unit: mm", "  up: z", "  bodies:"]
        at = 2
        for name, p, q in bodies:
            cells += [p * 1e3, q]
            layout += [f"    - name: {name}", f"      position: [{at}, {at + 1}, {at + 2}]",
                       f"      orientation: [{at + 3}, {at + 4}, {at + 5}, {at + 6}]", "      orientation_order: xyzw"]
            at += 7
        pressures = [(k, one) for k, one in enumerate(arm.inputs) if one.kind == "pressure"]
        layout += ["pressures:", "  unit: kPa", "  reference: gauge", "  inputs:"]
        for k, one in pressures:
            cells.append(trial.inputs[:, k:k + 1] * 1e-3)
            layout += [f"    - topic: {one.topic}", f"      column: {at}"]
            at += 1
        layout += ["payload:", "  - from_s: 0", "    kg: 0.05"]
        with open(support.path("table.csv"), "w", encoding="utf-8") as file:
            for row in np.concatenate(cells, axis=1):
                file.write(",".join("" if np.isnan(value) else repr(float(value)) for value in row) + "\n")
        with open(support.path("table.yaml"), "w", encoding="utf-8") as file:
            file.write("\n".join(layout) + "\n")
        return arm, trial

    def test_is_what_an_import_of_it_is(self):
        arm, trial = self.write()
        support.softarm("import", "table.yaml", "table.csv", "--out", "table.bag")
        imported = softarm.read_bag(arm, support.path("table.bag"))
        read, = softarm.read_csv(arm, support.path("table.yaml"), support.path("table.csv"))
        self.assertEqual(read.name, "table")
        self.assertGreater(len(read), 400)
        for name in ("stamp_s", "bodies_p_mocap_m", "bodies_q_mocap_xyzw", "base_p_mocap_m", "inputs", "payload_kg"):
            np.testing.assert_array_equal(getattr(read, name), getattr(imported, name), err_msg=name)
        # And what was written into it, in SI.
        np.testing.assert_allclose(read.bodies_p_mocap_m[:400], trial.bodies_p_mocap_m[:400], atol=1e-9)
        self.assertEqual(set(read.payload_kg[5:]), {0.05})
        self.assertEqual(len(read.to_pandas()), len(read))
        self.assertEqual(len(read.series[arm.inputs[0].name][0]), len(trial.stamp_s))

    def test_a_layout_that_is_none_is_one_line(self):
        arm = softarm.load_arm("online_200mm")
        nowhere = support.path("nowhere.yaml")
        support.one_line(self, softarm.CsvError, lambda: softarm.read_csv(arm, nowhere, "trial.csv"), nowhere)
        layout = os.path.join(support.SOURCE, "config", "layouts", "pouch_arm_one_segment.yaml")
        missing = support.path("nowhere.csv")
        support.one_line(self, softarm.CsvError, lambda: softarm.read_csv(arm, layout, missing), missing)


if __name__ == "__main__":
    support.main()
