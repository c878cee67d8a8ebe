#!/usr/bin/python3
"""demo.launch runs every shipped arm that has a scenario: estimates come, and agree with the truth."""
import os
import re
import subprocess
import sys
import tempfile
import unittest

import rospkg
import rostest

PACKAGE = rospkg.RosPack().get_path("softarm_estimator")
DEMO = os.path.join(PACKAGE, "launch", "demo.launch")
ARMS = ["semi_physical_200mm", "single_chamber_85mm", "hybrid_85mm", "cable_235mm", "two_segment"]
SEGMENTS = {"two_segment": 2}


class DemoArms(unittest.TestCase):
    def show(self, arm, seconds, *arguments):
        graph = subprocess.Popen(["roslaunch", "--wait", DEMO, "arm:=" + arm, "rviz:=false", *arguments],
                                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        try:
            return subprocess.run(["demo_report", "--seconds", str(seconds), "--wait", "20", "--truth"], text=True,
                                  timeout=60, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        finally:
            graph.terminate()
            graph.communicate(timeout=30)

    def check(self, arm):
        done = self.show(arm, 7)
        table = done.stdout
        self.assertEqual(done.returncode, 0, table)
        received, estimated = map(int, re.search(r"(\d+) received, (\d+) estimated", table).groups())
        self.assertGreater(received, 500, table)
        self.assertGreater(estimated, 0.95 * received, table)
        self.assertLess(float(re.search(r"shape error +rms ([\d.]+) mm", table).group(1)), 1.0, table)
        found = re.findall(r"EI, where identifiable .* (\d+) % within 1.96 sd; (\d+) % of frames", table)
        self.assertEqual(len(found), SEGMENTS.get(arm, 1), table)
        for within, of in found:
            self.assertGreater(int(of), 30, table)
            self.assertGreater(int(within), 60, table)
        self.assertEqual(len(re.findall(r"moment +[\d.e-]+ mN m, error", table)), SEGMENTS.get(arm, 1), table)

    def test_an_arm_without_a_scenario_is_refused_in_one_line(self):
        graph = subprocess.run(["roslaunch", "--wait", DEMO, "arm:=pouch_arm_one_segment", "rviz:=false"],
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=30)
        lines = [line for line in graph.stdout.splitlines() if "scenario is 'pouch_arm_one_segment'" in line]
        self.assertEqual(len(lines), 1, graph.stdout)
        for name in ["demo", "hybrid_85mm"]:  # those that there are
            self.assertIn(name, lines[0])

    def test_an_arm_of_ones_own_is_the_one_that_is_simulated(self):
        """Two kinds of segments, bodies of other names and places, a base that is not measured."""
        with tempfile.TemporaryDirectory() as folder:
            arm = os.path.join(folder, "mine.yaml")
            subprocess.run(["softarm", "new-arm", "--kind", "chambers,tendons", "--segments", "2", "--length", "0.15,0.1",
                            "--mass", "0.1,0.05", "--diameter", "0.04,0.03", "--actuators", "3,2", "--angles",
                            "0,120,240/0,90", "--bodies", "low:0.08,joint:0.15,high:0.2,end:tip", "--base", "hanging",
                            "--out", arm], check=True, stdout=subprocess.DEVNULL)
            done = self.show(arm, 6, "prior:=true", "window:=0.5")
        table = done.stdout
        self.assertEqual(done.returncode, 0, table)
        received, estimated = map(int, re.search(r"(\d+) received, (\d+) estimated", table).groups())
        self.assertGreater(estimated, 0.95 * received, table)
        self.assertLess(float(re.search(r"shape error +rms ([\d.]+) mm", table).group(1)), 2.0, table)
        lengths = re.findall(r"length +([\d.]+) mm", table)
        self.assertEqual(len(lengths), 2, table)
        for length, told in zip(lengths, (150, 100)):
            self.assertLess(abs(float(length) - told), 0.08 * told, table)

    def test_every_scenario_of_an_arm_is_shown(self):
        names = lambda folder: {f[:-5] for f in os.listdir(os.path.join(PACKAGE, "config", folder)) if f.endswith(".yaml")}
        self.assertEqual(names("arms") & names("scenarios"), set(ARMS))


for name in ARMS:
    setattr(DemoArms, "test_" + name, lambda self, arm=name: self.check(arm))

if __name__ == "__main__":
    rostest.rosrun("softarm_estimator", "demo_arms", DemoArms, sys.argv)
