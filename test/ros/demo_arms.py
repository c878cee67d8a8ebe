#!/usr/bin/python3
"""demo.launch runs every shipped arm that has a scenario: estimates come, and agree with the truth."""
import os
import re
import subprocess
import sys
import unittest

import rospkg
import rostest

PACKAGE = rospkg.RosPack().get_path("softarm_estimator")
DEMO = os.path.join(PACKAGE, "launch", "demo.launch")
ARMS = ["semi_physical_200mm", "single_chamber_85mm", "hybrid_85mm", "cable_235mm", "two_segment"]
SEGMENTS = {"two_segment": 2}


class DemoArms(unittest.TestCase):
    def show(self, arm, seconds):
        graph = subprocess.Popen(["roslaunch", "--wait", DEMO, "arm:=" + arm, "rviz:=false"],
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

    def test_every_scenario_of_an_arm_is_shown(self):
        names = lambda folder: {f[:-5] for f in os.listdir(os.path.join(PACKAGE, "config", folder)) if f.endswith(".yaml")}
        self.assertEqual(names("arms") & names("scenarios"), set(ARMS))


for name in ARMS:
    setattr(DemoArms, "test_" + name, lambda self, arm=name: self.check(arm))

if __name__ == "__main__":
    rostest.rosrun("softarm_estimator", "demo_arms", DemoArms, sys.argv)
