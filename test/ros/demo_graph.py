#!/usr/bin/python3
"""The demo's graph (rig, estimator, report) as users start it, without rviz."""
import re
import subprocess
import sys
import unittest

import rostest


class DemoGraph(unittest.TestCase):
    def report(self, *arguments):
        return subprocess.run(["demo_report", *arguments], text=True, timeout=60,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def test_estimates_come_and_agree_with_the_truth(self):
        done = self.report("--seconds", "8", "--truth")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        received, estimated = map(int, re.search(r"(\d+) received, (\d+) estimated", done.stdout).groups())
        self.assertGreater(received, 8 * 120 * 0.8)
        self.assertGreater(estimated, 0.95 * received)
        self.assertLess(float(re.search(r"shape error +rms ([\d.]+) mm", done.stdout).group(1)), 2.0, done.stdout)
        error = re.search(r"EI, where identifiable .*error: median [\d.e-]+ \(([\d.]+) %\)", done.stdout)
        self.assertLess(float(error.group(1)), 15.0, done.stdout)

    def test_no_estimates_is_a_failure(self):
        done = self.report("--seconds", "1", "--wait", "1", "--estimate-topic", "/nobody")
        self.assertEqual(done.returncode, 1)
        self.assertIn("no estimate was received", done.stderr)


if __name__ == "__main__":
    rostest.unitrun("softarm_estimator", "demo_graph", DemoGraph, sys.argv)
