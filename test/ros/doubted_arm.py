#!/usr/bin/python3
"""The estimator node warns of an arm file whose effects their own diagnosis doubted, and estimates with them all the same."""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import rospy
import rostest
from std_srvs.srv import Trigger

PROGRAM = ["estimator_node"] if shutil.which("estimator_node") else ["rosrun", "softarm_estimator", "estimator_node"]
ARM = os.path.join(os.path.dirname(os.path.realpath(__file__)), "extended_arm.yaml")


class DoubtedArm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("doubted_arm")

    def said_with(self, verdict):
        """What a node with that arm file has written to standard error by the time it answers."""
        node = "arm_" + verdict
        with tempfile.TemporaryDirectory() as folder:
            arm = os.path.join(folder, "mine.yaml")
            with open(ARM, encoding="utf-8") as file:
                text = file.read()
            with open(arm, "w", encoding="utf-8") as file:
                file.write(text.rstrip("\n") + "\neffects_verdict: %s\n" % verdict)
            log = os.path.join(folder, "stderr")
            with open(log, "w", encoding="utf-8") as stderr:
                process = subprocess.Popen(PROGRAM + ["__name:=" + node, "_arm:=" + arm, "_publish_tf:=false"], stderr=stderr)
            try:
                rospy.wait_for_service("/%s/reset" % node, 15.0)
                self.assertTrue(rospy.ServiceProxy("/%s/reset" % node, Trigger)().success)
            finally:
                process.terminate()
                process.wait()
            with open(log, encoding="utf-8") as file:
                return file.read()

    def test_something_else_is_there(self):
        self.assertRegex(self.said_with("unknown"),
                         r'WARN.*mine\.yaml: .*ended with the verdict "unknown": .*something else is there')

    def test_probably_not_what_is_there(self):
        self.assertRegex(self.said_with("cannot_tell"),
                         r'WARN.*mine\.yaml: .*ended with the verdict "cannot_tell": .*probably not what is there')

    def test_no_doubt(self):
        self.assertNotIn("verdict", self.said_with("explained"))


if __name__ == "__main__":
    rostest.rosrun("softarm_estimator", "doubted_arm", DoubtedArm, sys.argv)
