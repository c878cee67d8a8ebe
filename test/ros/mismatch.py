#!/usr/bin/python3
"""A ring slips in a stream on a real roscore: topic, diagnostics and markers say which, within half a second of the stream."""
import os
import sys
import time
import unittest

import rospy
import rostest

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus  # noqa: E402
from feeder import NODE, first_nan  # noqa: E402
from geometry_msgs.msg import PoseStamped  # noqa: E402
from softarm_estimator.msg import Mismatch  # noqa: E402
from visualization_msgs.msg import MarkerArray  # noqa: E402

SLIP_S = 9.0  # after the first frame, by slipped_ring.yaml


class MismatchOfASlip(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("mismatch")
        cls.first = cls.alarm = cls.warning = cls.newest = cls.nan = None
        cls.before = []
        cls.namespaces = {}
        cls.subscribers = [
            rospy.Subscriber("/mocap/ring_1/pose", PoseStamped, cls.on_pose, queue_size=1000),
            rospy.Subscriber(NODE + "/mismatch", Mismatch, cls.on_mismatch, queue_size=1000),
            rospy.Subscriber(NODE + "/markers", MarkerArray, cls.on_markers, queue_size=10),
            rospy.Subscriber("/diagnostics", DiagnosticArray, cls.on_diagnostics, queue_size=10)]
        # The rig's clock starts with its first frame, which may be before we listen: its scenario time is index / rate.
        end = time.time() + 40.0
        while time.time() < end and not (cls.alarm and cls.warning and "alarm" in cls.namespaces):
            time.sleep(0.02)

    @classmethod
    def on_pose(cls, message):
        if cls.first is None:  # header.seq counts frames from the first
            cls.first = message.header.stamp.to_sec() - message.header.seq / 120.0

    @classmethod
    def on_mismatch(cls, message):
        cls.nan = cls.nan or first_nan(message)
        cls.newest = message.header.stamp.to_sec()
        if message.alarm:
            cls.alarm = cls.alarm or message
        elif cls.alarm is None:
            cls.before.append(message)

    @classmethod
    def on_markers(cls, message):
        for marker in message.markers:
            cls.namespaces[marker.ns] = marker

    @classmethod
    def on_diagnostics(cls, message):
        for status in message.status:
            if status.name.endswith("mismatch") and status.level == DiagnosticStatus.WARN and cls.warning is None:
                cls.warning = (cls.newest, status)

    def test_topic(self):
        self.assertIsNotNone(self.alarm)
        self.assertIsNone(self.nan)
        seen = self.alarm.header.stamp.to_sec() - self.first
        self.assertGreater(seen, SLIP_S)
        self.assertLess(seen, SLIP_S + 0.5)
        self.assertAlmostEqual(self.alarm.onset.to_sec() - self.first, SLIP_S, delta=0.15)
        self.assertEqual((self.alarm.kind, self.alarm.body), ("ring", "ring_2"), self.alarm.description)
        self.assertAlmostEqual(self.alarm.s, 0.1)
        self.assertAlmostEqual(self.alarm.size, 0.003, delta=0.001)
        self.assertGreater(self.alarm.change, self.alarm.threshold)

    def test_before_it_nothing(self):
        self.assertGreater(len(self.before), 200)
        quiet = [m for m in self.before if m.valid and m.threshold > 0.0]
        self.assertGreater(len(quiet), 100)
        self.assertTrue(all(m.laws for m in quiet))
        self.assertEqual({m.kind for m in quiet}, {"none"})

    def test_diagnostics(self):
        self.assertIsNotNone(self.warning)
        newest, status = self.warning
        # What the stream had come to when the warning was here.
        self.assertLess(newest - self.first, SLIP_S + 0.6)
        self.assertIn("ring_2", status.message)
        self.assertIn("since", status.message)
        values = {v.key: v.value for v in status.values}
        self.assertEqual(values["alarms"], "1")
        self.assertEqual(values["last alarm, kind"], "ring")

    def test_markers(self):
        self.assertIn("alarm", self.namespaces)
        self.assertIn("ring_2", self.namespaces["alarm"].text.replace("\n", " "))
        self.assertGreater(len(self.namespaces["mismatch"].points), 10)


if __name__ == "__main__":
    rostest.rosrun("softarm_estimator", "mismatch", MismatchOfASlip, sys.argv)
