#!/usr/bin/python3
"""The estimator node on a real roscore: every fault is visible in /diagnostics, none makes it publish NaN or die."""
import os
import subprocess
import sys
import threading
import time
import unittest

import rospy
import rostest

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from diagnostic_msgs.msg import DiagnosticStatus  # noqa: E402
from feeder import NODE, Feeder, Listener  # noqa: E402
from softarm_estimator.msg import ArmEstimate  # noqa: E402
from softarm_estimator.srv import SetMode, SetPayload  # noqa: E402
from std_msgs.msg import Float32MultiArray, Float64  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402
from visualization_msgs.msg import Marker  # noqa: E402

NAN = float("nan")
# Another node, which publishes on a driver's topic.
SECOND = """
import rospy
from geometry_msgs.msg import PoseStamped
rospy.init_node("second_driver")
publisher = rospy.Publisher("/mocap/ring_1/pose", PoseStamped, queue_size=10)
rate = rospy.Rate(50)
while not rospy.is_shutdown():
    message = PoseStamped()
    message.header.stamp = rospy.Time.now()
    publisher.publish(message)
    rate.sleep()
"""


class Faults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("faults")
        cls.listener = Listener()
        cls.feeder = Feeder()
        cls.payload = rospy.Publisher("/payload", Float64, queue_size=10, latch=True)
        cls.payload.publish(0.0)
        cls.pressures = rospy.Publisher("/pressures", Float32MultiArray, queue_size=10)
        assert cls.feeder.wait_for_subscribers(), "the node did not subscribe"
        cls.reset = rospy.ServiceProxy(NODE + "/reset", Trigger)
        cls.set_payload = rospy.ServiceProxy(NODE + "/set_payload", SetPayload)
        cls.set_mode = rospy.ServiceProxy(NODE + "/set_mode", SetMode)
        cls.reset.wait_for_service(10.0)

    def tearDown(self):
        self.assertEqual(self.listener.not_finite(), [])

    def rejected(self, what):
        return int(self.listener.value("inputs", "rejected: " + what))

    def feed(self, frames, fault=None, start=None, timeout=10.0):
        """Feeds, waits for the answers, returns them."""
        before = self.listener.count()
        self.feeder.feed(frames, fault=fault, start=start)
        self.listener.wait(lambda: self.listener.count() >= before + frames, timeout)
        return self.listener.since(before)

    def assert_mostly_ok(self, estimates, at_least):
        ok = sum(e.status == ArmEstimate.STATUS_OK for e in estimates)
        details = {e.detail for e in estimates if e.detail}
        self.assertGreaterEqual(ok, at_least, details)

    def test_a_before_anything_arrives(self):
        self.listener.fresh()
        self.assertEqual(self.listener.task("frames").level, DiagnosticStatus.WARN)
        self.assertIn("no frames yet", self.listener.task("frames").message)
        self.assertEqual(self.listener.value("inputs", "body ring_2"), "never seen")
        self.assertEqual(self.listener.value("inputs", "topic /mocap/ring_2/pose"), "no message yet")
        self.assertTrue(self.listener.wait(lambda: self.listener.count("markers") > 0))
        self.assertIn("waiting for /mocap/", " ".join(m.text for m in self.listener.newest_markers()))

    def test_b_late_start_of_a_publisher(self):
        estimates = self.feed(240, lambda body, k, m: None if body == "ring_1" and k < 180 else m)
        self.assert_mostly_ok(estimates, 235)
        self.assertEqual(len(estimates[-1].body_names), 4)

    def test_c_every_frame_is_answered_at_240_hz(self):
        sent = 1200
        stamps = []
        before, shown_before = self.listener.count(), self.listener.count("markers")
        stamps = self.feeder.feed(sent)
        self.listener.wait(lambda: self.listener.count() >= before + sent, 10.0)
        estimates = self.listener.since(before)
        self.assertEqual([e.header.stamp for e in estimates], stamps)  # every one, to the nanosecond, in order
        self.assert_mostly_ok(estimates, sent)
        self.listener.fresh()
        number = lambda key: int(self.listener.value("frames", key))
        self.assertEqual(number("frames received"), number("frames estimated") + number("frames refused") +
                         number("frames dropped") + number("frames waiting for bodies"))
        self.assertEqual(number("messages lost on their way"), 0)
        frames = self.listener.frames()
        self.assertIn(("mocap", "light_arm/base"), frames)
        for child in ["ring_1", "ring_2", "ring_3", "ring_4", "tip"]:
            self.assertIn(("light_arm/base", "light_arm/" + child), frames)
        tip = estimates[-1].backbone[-1].position
        self.assertLess(abs((tip.x ** 2 + tip.y ** 2 + tip.z ** 2) ** 0.5 - 0.19), 0.01)
        # The newest ones may say already that frames have ceased.
        shown = [message.markers for message in self.listener.since(shown_before, "markers")
                 if any(m.ns == "backbone" and m.action == Marker.ADD for m in message.markers)]
        self.assertEqual({m.ns for m in shown[-1]},
                         {"backbone", "rings", "measured", "estimated", "residuals", "payload", "scale", "legend", "text"})

    def test_d_lost_and_returning_body(self):
        feeding = threading.Thread(
            target=self.feeder.feed, args=(600,), kwargs={"fault": lambda b, k, m: None if b == "ring_2" and k < 480 else m})
        before = self.listener.count()
        feeding.start()
        self.assertTrue(self.listener.wait(
            lambda: "ring_2 lost for" in self.listener.task("inputs").message, 4.0))
        self.assertEqual(self.listener.task("inputs").level, DiagnosticStatus.WARN)
        feeding.join()
        self.listener.wait(lambda: self.listener.count() >= before + 600, 10.0)
        estimates = self.listener.since(before)
        self.assertEqual(len(estimates), 600)
        self.assertNotIn("ring_2", estimates[300].body_names)
        self.assertIn("ring_2", estimates[-1].body_names)
        self.assert_mostly_ok(estimates, 595)

    def test_e_nan_zero_and_bad_quaternions(self):
        def fault(body, k, m):
            if body == "ring_3":
                m.pose.position.x = NAN
            elif body == "ring_1":
                m.pose.position.x = m.pose.position.y = m.pose.position.z = 0.0
            elif body == "ring_4":
                m.pose.orientation.x = m.pose.orientation.z = 0.0
            return m

        nan, zero, quaternion = map(self.rejected, ["nan ring_3", "all_zero ring_1", "zero_quaternion ring_4"])
        estimates = self.feed(60, lambda b, k, m: fault(b, k, m) if k >= 10 else m)
        self.assertEqual(len(estimates), 60)
        self.listener.fresh()
        self.assertEqual(self.rejected("nan ring_3") - nan, 50)
        self.assertEqual(self.rejected("all_zero ring_1") - zero, 50)
        self.assertEqual(self.rejected("zero_quaternion ring_4") - quaternion, 50)

    def test_f_frames_of_nothing_but_nan_are_counted(self):
        def fault(body, k, m):
            m.pose.position.z = NAN
            return m

        before = int(self.listener.value("frames", "frames dropped: no_valid_body"))
        self.assertEqual(self.feed(48, fault, timeout=0.3), [])
        self.listener.fresh()
        self.assertEqual(int(self.listener.value("frames", "frames dropped: no_valid_body")) - before, 48)

    def test_g_frozen_body(self):
        frozen = []

        def fault(body, k, m):
            if body != "ring_3" or k < 10:
                return m
            frozen.append(m.pose)
            m.pose = frozen[0]
            return m

        estimates = self.feed(240, fault)
        self.assertNotIn("ring_3", estimates[-1].body_names)
        self.listener.fresh()
        self.assertGreater(self.rejected("frozen ring_3"), 100)
        self.assertIn("ring_3", self.feed(24)[-1].body_names)

    def test_h_jumping_body(self):
        def fault(body, k, m):
            if body == "ring_4" and 100 <= k < 104:
                m.pose.position.y += 0.4
            return m

        estimates = self.feed(200, fault)
        self.assert_mostly_ok(estimates, 200)
        self.listener.fresh()
        self.assertEqual(self.rejected("jump ring_4"), 4)

    def test_i_stamps_of_zero(self):
        def fault(body, k, m):
            m.header.stamp = rospy.Time(0)
            return m

        self.assertEqual(self.feed(20, fault, timeout=0.3), [])
        self.listener.fresh()
        self.assertEqual(self.rejected("bad_stamp base"), 20)
        self.assert_mostly_ok(self.feed(20), 20)

    def test_j_time_jumps_back(self):
        estimates = self.feed(240, start=rospy.Time.now() - rospy.Duration(3600))
        self.assertGreaterEqual(len(estimates), 238)
        self.assert_mostly_ok(estimates, 236)
        self.listener.fresh()
        self.assertEqual(self.listener.value("frames", "time jumps"), "1")
        self.assert_mostly_ok(self.feed(100), 98)  # and forward again

    def test_k_pressures_come_and_go(self):
        self.listener.fresh()
        self.assertEqual(self.listener.value("inputs", "pressure chamber_1"), "absent")
        stop = threading.Event()

        def press():
            while not stop.wait(0.02):
                self.pressures.publish(data=[0.0, 20.0])

        thread = threading.Thread(target=press)
        thread.start()
        try:
            self.feed(300)
            seen = self.listener.value("inputs", "pressure chamber_1")
        finally:  # a thread that goes on would keep the failure from being told
            stop.set()
            thread.join()
        self.assertTrue(seen.startswith("seen"), seen)
        self.pressures.publish(data=[0.0])  # the element is not there
        feeding = threading.Thread(target=self.feeder.feed, args=(600,))
        feeding.start()
        gone = self.listener.wait(
            lambda: self.listener.value("inputs", "pressure chamber_1").startswith("missing for"), 4.0)
        feeding.join()
        self.assertTrue(gone)
        self.listener.fresh()
        self.assertEqual(self.rejected("input_nan chamber_1"), 1)

    def test_l_services(self):
        self.assertFalse(self.set_payload(unknown=False, payload=-1.0).success)
        self.assertFalse(self.set_payload(unknown=False, payload=NAN).success)
        self.assertIn("both", self.set_mode(unknown="everything").message)
        refused = self.set_mode(unknown="both")
        self.assertFalse(refused.success)
        self.assertIn("unknown stays stiffness: one frame cannot separate EI and payload: enable the prior", refused.message)
        self.assertNotIn("\n", refused.message)
        self.assertTrue(self.set_mode(unknown="stiffness").success)
        self.assertTrue(self.set_payload(unknown=True).success)
        estimates = self.feed(60)
        self.assertEqual(estimates[-1].status, ArmEstimate.STATUS_MISSING_PAYLOAD)
        self.assertEqual(len(estimates[-1].backbone), 0)
        gone = [m.ns for m in self.listener.newest_markers() if m.action == Marker.DELETE]
        self.assertIn("backbone", gone)
        self.assertTrue(self.listener.wait(lambda: "missing_payload" in self.listener.task("fit").message, 2.0))
        self.assertTrue(self.set_payload(unknown=False, payload=0.0).success)
        self.assert_mostly_ok(self.feed(60), 59)
        self.assertTrue(self.set_mode(unknown="payload").success)
        self.assertEqual(self.feed(24)[-1].unknown, "payload")
        self.assertTrue(self.set_mode(unknown="stiffness").success)
        self.assertTrue(self.reset().success)
        estimates = self.feed(24)
        self.assertFalse(estimates[0].warm_start)
        self.assertTrue(estimates[-1].warm_start)

    def test_m_slipped_ring(self):
        def fault(body, k, m):
            if body == "ring_2":
                m.pose.position.z -= 0.02  # for ever, so no jump
            return m

        feeding = threading.Thread(target=self.feeder.feed, args=(720,), kwargs={"fault": fault})
        feeding.start()
        warned = self.listener.wait(lambda: "ring_2 set aside in" in self.listener.task("fit").message, 4.0)
        fit = self.listener.task("fit")
        feeding.join()
        self.assertTrue(warned, fit.message)
        self.assertEqual(fit.level, DiagnosticStatus.WARN)
        self.assertIn("arclength_m", fit.message)
        self.assertNotIn("ring_3 set aside", fit.message)
        self.feed(480)
        self.listener.fresh()
        self.assertNotIn("set aside", self.listener.task("fit").message)

    def test_n_silence(self):
        self.feed(24)
        self.assertTrue(self.listener.wait(
            lambda: self.listener.task("frames").level == DiagnosticStatus.ERROR and
            "no frames for" in self.listener.task("frames").message, 4.0))
        shown = lambda: " ".join(m.text for m in self.listener.newest_markers() if m.ns == "text")
        self.assertTrue(self.listener.wait(lambda: "waiting for" in shown(), 4.0), shown())
        self.assertRegex(shown(), r"no frames for \d+ s, waiting for /mocap/base/pose, .* more")

    def test_o_stamps_of_another_epoch(self):
        def since_1900(body, k, m):
            m.header.stamp = rospy.Time(m.header.stamp.secs + 2208988800, m.header.stamp.nsecs)  # the bodies share it
            return m

        estimates = self.feed(480, since_1900)
        self.assertGreaterEqual(len(estimates), 478)
        self.assertGreater(estimates[-1].header.stamp.secs, 2208988800)
        self.assertIn("another clock", self.listener.task("frames").message)

    def test_p_two_publishers_are_no_losses(self):
        self.feed(24)
        self.listener.fresh()
        lost = self.listener.value("frames", "messages lost on their way")
        second = subprocess.Popen([sys.executable, "-c", SECOND])
        feeding = threading.Thread(target=self.feeder.feed, args=(3840,))
        feeding.start()
        try:
            said = self.listener.wait(lambda: "two publishers on" in self.listener.task("inputs").message, 16.0)
            task = self.listener.task("inputs")
        finally:
            second.terminate()
            second.wait()
            feeding.join()
        self.assertTrue(said, task.message)
        self.assertRegex(task.message, r"two publishers on /mocap/ring_1/pose: /\w+, /\w+")
        self.assertEqual(task.level, DiagnosticStatus.WARN)
        self.feed(720)
        self.listener.fresh()
        self.assertNotIn("two publishers", self.listener.task("inputs").message)
        self.assertEqual(self.listener.value("frames", "messages lost on their way"), lost)

    def test_q_a_body_too_far_to_be_this_arms(self):
        def fault(body, k, m):
            if body == "ring_3":
                m.pose.position.y += 12.0  # for ever, so no jump: another body has its name
            return m

        before = self.listener.count()
        feeding = threading.Thread(target=self.feeder.feed, args=(720,), kwargs={"fault": fault})
        feeding.start()
        said = self.listener.wait(lambda: "ring_3 12 m from the base, too far for an arm of 0.2 m" in
                                  self.listener.task("inputs").message, 4.0)
        task = self.listener.task("inputs")
        feeding.join()
        self.assertTrue(said, task.message)
        self.assertEqual(task.level, DiagnosticStatus.WARN)
        self.listener.wait(lambda: self.listener.count() >= before + 720, 10.0)
        estimates = self.listener.since(before)
        self.assert_mostly_ok(estimates, 710)
        self.assertNotIn("ring_3", estimates[-1].body_names)
        self.assertLess(estimates[-1].rms_residual, 1e-3)
        self.feed(480)
        self.listener.fresh()
        self.assertNotIn("too far", self.listener.task("inputs").message)
        self.assertEqual(self.listener.value("inputs", "body ring_3"), "seen")


if __name__ == "__main__":
    rostest.rosrun("softarm_estimator", "estimator_node_faults", Faults, sys.argv)
