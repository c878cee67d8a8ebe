"""Estimates of the module are those of the program; a frame, a window, and a batch of bags are the same estimator."""
import csv
import os
import signal
import threading
import time
import unittest

import support

import numpy as np
import softarm


def table_of(name, *options):
    support.softarm("estimate", "--arm", "online_200mm", support.bag(), "--out", name, *options)
    with open(support.path(os.path.join(name, "trial", "estimates.csv")), encoding="utf-8") as file:
        return list(csv.DictReader(file))


class Estimates(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.arm = softarm.load_arm("online_200mm")
        cls.trial = softarm.read_bag(cls.arm, support.bag())

    def expect_table(self, rows, found):
        """To printed precision: what the CSV prints with nine digits."""
        frame = found.to_pandas()
        self.assertEqual(list(frame.columns), list(rows[0]))
        self.assertEqual(len(frame), len(rows))
        for column in frame.columns:
            cells = [row[column] for row in rows]
            if column == "status":
                self.assertEqual(list(frame[column]), cells)
            elif column == "stamp":
                self.assertEqual(["%.7f" % value for value in frame[column]], cells)
            elif column == "segment" or column.startswith("identifiable"):
                self.assertEqual([str(int(value)) for value in frame[column]], cells)
            else:
                self.assertEqual(["" if np.isnan(value) else "%.9g" % value for value in frame[column]], cells, column)

    def test_is_the_programs_table(self):
        rows = table_of("stiffness")
        self.assertGreater(len(rows), 400)
        self.assertGreater(sum(row["status"] == "ok" for row in rows), 400)
        self.expect_table(rows, softarm.estimate_bags(self.arm, support.bag())[0])
        self.expect_table(rows, softarm.estimate(self.trial))

    def test_is_the_programs_with_options_and_a_window(self):
        rows = table_of("both", "--unknown", "both", "--prior", "on", "--window", "0.5")
        self.expect_table(rows, softarm.estimate(self.trial, unknown="both", prior=True, window_s=0.5))
        rows = table_of("known", "--payload", "0.1")
        self.expect_table(rows, softarm.estimate(self.trial, payload_kg=0.1))
        self.expect_table(rows, softarm.estimate_bags(self.arm, [support.bag()], payload_kg=0.1)[0])

    def test_summary_is_the_programs(self):
        text = support.softarm("estimate", "--arm", "online_200mm", support.bag(), "--out", "summary")
        for line in softarm.estimate(self.trial).summary.splitlines():
            self.assertIn(line, text)

    def test_alarms_are_the_programs(self):
        """A ring that slips at 8 s: the bag, the trial, and frame by frame."""
        support.slipping_bag()
        text = support.softarm("estimate", "--arm", "online_200mm", "slip.bag", "--out", "alarms")
        found, = softarm.estimate_bags(self.arm, support.path("slip.bag"))
        trial = softarm.read_bag(self.arm, support.path("slip.bag"))
        self.assertEqual(softarm.estimate(trial).alarms, found.alarms)
        for threshold in (3.0, 1e6):
            other = softarm.estimate(trial, alarm_threshold_sd=threshold)
            held = other.mismatch.threshold_sd
            self.assertEqual(set(held[np.isfinite(held)]) - {0.0}, {threshold})
            self.assertEqual(bool(other.alarms), threshold < 6.0)
        alarm = found.alarms[0]
        self.assertIn(f"{alarm.onset_s:.2f} ... {alarm.seen_s:.2f} s", text)
        self.assertIn(alarm.description, text)
        self.assertIn(found.summary, text)
        self.assertAlmostEqual(alarm.onset_s, 8.0, delta=0.15)
        mismatch = found.mismatch
        during = mismatch.alarm
        self.assertEqual((set(mismatch.kind[during]), set(mismatch.body[during])), ({"ring"}, {"ring_3"}))
        self.assertAlmostEqual(mismatch.onset_s[during][-1] - mismatch.stamp_s[0], alarm.onset_s, delta=1e-6)
        self.assertTrue(np.isnan(mismatch.onset_s[~during]).all())
        self.assertFalse(mismatch.valid[0])
        self.assertTrue(np.isnan(mismatch.score_sd[0]) and np.isfinite(mismatch.score_sd[mismatch.valid]).all())
        frame = mismatch.to_pandas()
        self.assertEqual((len(frame), len(mismatch)), (len(found), len(found)))
        as_dict = found.to_dict()
        self.assertIsNone(as_dict["mismatch"]["score_sd"][0])
        self.assertEqual(as_dict["alarms"][0]["description"], alarm.description)

        estimator = softarm.Estimator(self.arm)
        arrays = {name: getattr(trial, name) for name in (
            "bodies_q_mocap_xyzw", "base_p_mocap_m", "base_q_mocap_xyzw", "inputs", "payload_kg")}
        stamps, p = trial.stamp_s, trial.bodies_p_mocap_m
        first = int(np.flatnonzero(during)[0])
        live = [estimator.frame(stamps[i], p[i], **{name: array[i] for name, array in arrays.items()}) for i in range(first + 40)]
        alarmed = [i for i, one in enumerate(live) if one.alarms]
        self.assertLess(abs(alarmed[0] - first), 10)  # the inputs' own samples are not there, their values at the frames are
        self.assertIn("ring_3", live[-1].mismatch.description[0])

    def test_frame_by_frame_is_the_trial(self):
        whole = softarm.estimate(self.trial)
        estimator = softarm.Estimator(self.arm)
        arrays = {name: getattr(self.trial, name) for name in (
            "bodies_q_mocap_xyzw", "base_p_mocap_m", "base_q_mocap_xyzw", "inputs", "payload_kg")}
        stamps, p = self.trial.stamp_s, self.trial.bodies_p_mocap_m
        for i in range(50):
            one = estimator.frame(stamps[i], p[i], **{name: array[i] for name, array in arrays.items()})
            self.assertEqual(one.status[0], whole.status[i])
            np.testing.assert_allclose(one.EI_nm2[0], whole.EI_nm2[i], rtol=1e-6)
            np.testing.assert_allclose(one.backbone_p_base_m[0], whole.backbone_p_base_m[i], atol=1e-8)

    def test_effects_and_doubts_are_said(self):
        text = self.arm.text + "\neffects:\n  - {id: base_compliance, parameters: {compliance_rad_per_nm: 0.2}}\neffects_verdict: unknown\n"
        arm = softarm.parse_arm(text, "mine.yaml")
        self.assertEqual([one["id"] for one in arm.effects], ["base_compliance"])
        self.assertIn("mine.yaml", softarm.Estimator(arm).notes[-1])
        with self.assertWarnsRegex(softarm.SoftarmWarning, "base_compliance"):
            softarm.Model(arm)
        with self.assertWarnsRegex(softarm.SoftarmWarning, "unknown"):
            found = softarm.estimate(self.trial, arm=arm)
        plain = softarm.estimate(self.trial)
        good = plain.identifiable_EI[:, 0]
        self.assertGreater(np.abs(found.EI_nm2[good] / plain.EI_nm2[good] - 1.0).max(), 0.01)  # they are in the fit
        with self.assertWarnsRegex(softarm.SoftarmWarning, "prior"):
            softarm.estimate(self.trial, unknown="both")

    def test_shapes_and_what_is_lost(self):
        found = softarm.estimate(self.trial, backbone_points=11)
        n = len(self.trial)
        self.assertEqual(found.EI_nm2.shape, (n, 1))
        self.assertEqual(found.backbone_p_base_m.shape, (n, 11, 3))
        self.assertEqual(found.bodies_measured_base_m.shape, (n, 4, 3))
        stamps, p = self.trial.stamp_s[:2], self.trial.bodies_p_mocap_m[:2]
        p[1] = np.nan
        lost = softarm.estimate(softarm.Trial.from_arrays(
            self.arm, stamps, p, base_p_mocap_m=self.trial.base_p_mocap_m[:2],
            base_q_mocap_xyzw=self.trial.base_q_mocap_xyzw[:2], inputs=self.trial.inputs[:2], payload_kg=0.0))
        self.assertEqual(list(lost.status), ["ok", "not_enough_bodies"])
        self.assertTrue(np.isnan(lost.EI_nm2[1, 0]))
        self.assertIsNone(lost.to_dict()["EI_nm2"][1][0])

    def test_a_batch_in_order_with_progress(self):
        other = support.bag("trial_10s", "2", "shorter")
        told = []
        found = softarm.estimate_bags(self.arm, [other, support.bag()], jobs=2,
                                      progress=lambda share, what: told.append((share, threading.current_thread())))
        self.assertEqual([one.name for one in found], ["shorter", "trial"])
        self.assertLess(len(found[0]), len(found[1]))
        self.assertTrue(told)
        self.assertEqual([share for share, _ in told], sorted(share for share, _ in told))
        self.assertEqual({thread for _, thread in told}, {threading.main_thread()})

    def test_what_is_wrong_is_one_line(self):
        nowhere = support.path("nowhere.bag")
        support.one_line(self, softarm.BagError, lambda: softarm.read_bag(self.arm, nowhere), nowhere)
        support.one_line(self, softarm.BagError, lambda: softarm.estimate_bags(self.arm, [nowhere]), nowhere)
        broken = support.path("broken.bag")
        with open(support.bag(), "rb") as whole, open(broken, "wb") as part:
            part.write(whole.read()[:20000])
        support.one_line(self, softarm.BagError, lambda: softarm.read_bag(self.arm, broken), broken)
        support.one_line(self, softarm.Error, lambda: softarm.estimate_bags(self.arm, [support.bag()] * 2), "trial")
        support.one_line(self, ValueError, lambda: softarm.estimate(self.trial, unknown="mass"), "unknown", "mass", "stiffness")
        support.one_line(self, ValueError, lambda: softarm.estimate(self.trial, payload_kg=70.0), "70", "from 0 to")
        support.one_line(self, ValueError, lambda: softarm.estimate(self.trial, window_s=float("nan")), "window_s", "nan")
        support.one_line(self, ValueError, lambda: softarm.estimate(self.trial, window_s="long"), "window_s", "long")
        support.one_line(self, ValueError, lambda: softarm.estimate(self.trial, alarm_threshold_sd=2.9), "alarm_threshold_sd", "from 3")
        support.one_line(self, ValueError, lambda: softarm.estimate_bags(self.arm, [support.bag()], prior="on"), "prior", "on")
        support.one_line(self, ValueError, lambda: softarm.estimate_bags(self.arm, [support.bag()], jobs=-1), "jobs", "-1")
        support.one_line(self, TypeError, lambda: softarm.estimate_bags(self.arm, [support.bag()], windows=1), "windows", "window_s")
        p, stamps = self.trial.bodies_p_mocap_m, self.trial.stamp_s
        from_arrays = softarm.Trial.from_arrays
        support.one_line(self, ValueError, lambda: from_arrays(self.arm, stamps, p[:, :3], inputs=self.trial.inputs),
                         "bodies_p_mocap_m", f"({len(stamps)}, 3, 3)", f"({len(stamps)}, 4, 3)")
        support.one_line(self, ValueError, lambda: from_arrays(self.arm, stamps[::-1], p), "stamp_s", "increase")
        support.one_line(self, ValueError, lambda: from_arrays(self.arm, stamps * np.nan, p), "stamp_s", "nan")
        support.one_line(self, ValueError, lambda: from_arrays(self.arm, stamps, p * np.inf), "bodies_p_mocap_m", "inf")
        support.one_line(self, ValueError, lambda: from_arrays(self.arm, stamps, "pose"), "bodies_p_mocap_m", "str")
        support.one_line(self, ValueError, lambda: from_arrays(self.arm, stamps, p), "base_p_mocap_m")
        support.one_line(self, ValueError, lambda: from_arrays(self.arm, stamps, p, inputs={"chamber_9": 0.0}), "chamber_9")
        estimator = softarm.Estimator(self.arm)
        support.one_line(self, ValueError, lambda: estimator.frame(0.0, p[0, :2]), "bodies_p_mocap_m", "(1, 2, 3)")
        support.one_line(self, ValueError, lambda: estimator.frame("now", p[0]), "stamp_s", "str")
        other = softarm.load_arm("two_segment")
        support.one_line(self, ValueError, lambda: softarm.estimate(self.trial, arm=other), "trial", "two_segment")


class LongCalls(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.arm = softarm.load_arm("online_200mm")
        cls.trial = softarm.read_bag(cls.arm, support.bag())
        rows = len(cls.trial)
        # Repeated until it takes seconds: some ten thousand frames.
        times = max(1, 20000 // rows)
        span = cls.trial.stamp_s[-1] - cls.trial.stamp_s[0] + 1.0
        stamps = np.concatenate([cls.trial.stamp_s + span * k for k in range(times)])

        def repeated(name):
            return np.concatenate([getattr(cls.trial, name)] * times)

        cls.long = softarm.Trial.from_arrays(
            cls.arm, stamps, repeated("bodies_p_mocap_m"), base_p_mocap_m=repeated("base_p_mocap_m"),
            base_q_mocap_xyzw=repeated("base_q_mocap_xyzw"), inputs=repeated("inputs"), payload_kg=repeated("payload_kg"))

    def test_others_run_meanwhile(self):
        counted = []
        ended = threading.Event()

        def count():
            while not ended.is_set():
                counted.append(time.monotonic())
                time.sleep(0.001)

        other = threading.Thread(target=count)
        other.start()
        begun = time.monotonic()
        softarm.estimate(self.long)
        done = time.monotonic()
        ended.set()
        other.join()
        during = [at for at in counted if begun < at < done]
        # Were the lock held, none but the first and the last could be.
        self.assertGreater(len(during), 20)

    def test_ctrl_c_ends_it(self):
        shares = []

        def interrupt(share, what):
            shares.append(share)
            signal.raise_signal(signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            softarm.estimate(self.long, progress=interrupt)
        self.assertLess(shares[-1], 1.0)
        # And the estimator, and Python, are as before.
        self.assertTrue(softarm.estimate(self.trial).ok.any())

    def test_an_exception_of_the_callback_ends_it(self):
        def fail(share, what):
            raise LookupError("enough")

        with self.assertRaisesRegex(LookupError, "enough"):
            softarm.estimate(self.long, progress=fail)


if __name__ == "__main__":
    support.main()
