#!/usr/bin/python3
"""show_arm fits the shipped configurations to an arm (what rviz makes of them: rviz_pictures.py)."""
import os
import resource
import signal
import subprocess
import sys
import tempfile
import unittest

import rospkg
import rostest
import yaml

PACKAGE = rospkg.RosPack().get_path("softarm_estimator")
ARMS = os.path.join(PACKAGE, "config", "arms")


class RvizConfigs(unittest.TestCase):
    def fitted(self, arm, *arguments):
        """The view and the displays that rviz would be started with."""
        with tempfile.NamedTemporaryFile(suffix=".rviz") as out:
            subprocess.run(["show_arm", "--arm", arm, "--arms-dir", ARMS, "--config", os.path.join(PACKAGE, "rviz/demo.rviz"),
                            "--wait", "0", "--out", out.name, *arguments], check=True)
            with open(out.name) as text:
                manager = yaml.safe_load(text)["Visualization Manager"]
        return manager["Views"]["Current"], manager["Displays"]

    def test_the_view_is_fitted_to_the_arm(self):
        view, displays = self.fitted("online_200mm")  # that of the file
        with open(os.path.join(PACKAGE, "rviz/demo.rviz")) as text:
            shipped = yaml.safe_load(text)["Visualization Manager"]
        self.assertAlmostEqual(view["Distance"], shipped["Views"]["Current"]["Distance"])
        self.assertEqual([d["Class"] for d in shipped["Displays"]], [d["Class"] for d in displays])
        small, small_displays = self.fitted("hybrid_85mm")
        of = lambda kind, shown: next(display for display in shown if display["Class"] == kind)
        self.assertAlmostEqual(small["Distance"], view["Distance"] * 0.085 / 0.2)
        self.assertAlmostEqual(small["Focal Point"]["Z"], view["Focal Point"]["Z"] * 0.085 / 0.2)
        self.assertAlmostEqual(of("rviz/Grid", small_displays)["Cell Size"], 0.02)
        self.assertEqual(of("rviz/MarkerArray", small_displays), of("rviz/MarkerArray", displays))

    def test_a_wrong_arm_is_one_line(self):
        done = subprocess.run(["show_arm", "--arm", "no_arm", "--arms-dir", ARMS, "--config",
                               os.path.join(PACKAGE, "rviz/demo.rviz")], stderr=subprocess.PIPE, text=True)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("no_arm", done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)

    def test_a_full_disk_is_one_line_and_leaves_what_was_there(self):
        def full_disk():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (1024, 1024))
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "arm.rviz")
            with open(out, "w") as before:
                before.write("another's")
            done = subprocess.run(["show_arm", "--arm", "online_200mm", "--arms-dir", ARMS, "--config",
                                   os.path.join(PACKAGE, "rviz/demo.rviz"), "--wait", "0", "--out", out],
                                  stderr=subprocess.PIPE, text=True, preexec_fn=full_disk)
            self.assertEqual(done.returncode, 1)
            self.assertEqual(done.stderr, "show_arm: %s: cannot be written: File too large\n" % out)
            self.assertEqual(os.listdir(folder), ["arm.rviz"])
            with open(out) as after:
                self.assertEqual(after.read(), "another's")

    def test_other_arms_are_shown_beside_this_one(self):
        _, own = self.fitted("online_200mm")
        _, all_of_them = self.fitted("online_200mm", "--also", "left", "right")
        topic = lambda display: display.get("Marker Topic", display.get("Topic"))
        topics = {topic(display) for display in all_of_them} - {None}
        self.assertEqual(topics, {prefix + "softarm_estimator/" + what for prefix in ("", "/left/", "/right/")
                                  for what in ("markers", "backbone")})
        self.assertEqual(len(all_of_them), len(own) + 4)


if __name__ == "__main__":
    rostest.unitrun("softarm_estimator", "rviz_configs", RvizConfigs, sys.argv)
