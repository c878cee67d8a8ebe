#!/usr/bin/python3
"""Pressures, tensions and servo angles on a real roscore: they arrive, are converted, serve as a prior, and are missed."""
import math
import os
import sys
import unittest

import rospy
import rostest

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
from diagnostic_msgs.msg import DiagnosticStatus  # noqa: E402
from feeder import NODE, Feeder, Listener  # noqa: E402
from softarm_estimator.msg import ArmEstimate  # noqa: E402
from softarm_estimator.srv import SetMode  # noqa: E402
from std_msgs.msg import Float64, Float64MultiArray  # noqa: E402

EI = 0.03  # N m^2, of mixed_arm.yaml
PRESSURE_KPA = 5.0  # 0.03 N m
ANGLE_DEG = 10.0  # 0.175 rad * 0.01 / (0.2 * 0.01) = 0.873 1/m


def tension_n(shape_rad):
    """The tension at which the three together bend the arm by so much; the load cell reads 2 N when it is slack."""
    moment = EI * (shape_rad / 0.2 - math.radians(ANGLE_DEG) * 5.0) - 6.0e-6 * 1e3 * PRESSURE_KPA
    return moment / 0.01 + 2.0


class LiveInputs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("live_inputs")
        cls.listener = Listener()
        cls.feeder = Feeder()
        publisher = lambda topic, kind: rospy.Publisher(topic, kind, queue_size=None, tcp_nodelay=True)
        cls.inputs = {"chamber_1": publisher("/pressures", Float64MultiArray),
                      "tendon_1": publisher("/tendon/1/tension", Float64),
                      "servo_1": publisher("/servo/1/angle", Float64)}
        assert cls.feeder.wait_for_subscribers(), "the node did not subscribe"
        # Each topic is connected by itself, on a loaded machine long after the bodies'.
        connected = lambda: all(one.get_num_connections() > 0 for one in cls.inputs.values())
        assert cls.listener.wait(connected, 20.0), "the node did not connect to its inputs"
        cls.set_mode = rospy.ServiceProxy(NODE + "/set_mode", SetMode)
        cls.set_mode.wait_for_service(10.0)

    def tearDown(self):
        self.assertEqual(self.listener.not_finite(), [])

    def press(self, silent=()):
        """One message of each input, for the shape that the feeder is about to publish."""
        shape = 0.8 + 0.4 * math.sin(0.01 * self.feeder.index)
        messages = {"chamber_1": Float64MultiArray(data=[99.0, PRESSURE_KPA]),
                    "tendon_1": Float64(data=tension_n(shape)), "servo_1": Float64(data=ANGLE_DEG)}
        for name, message in messages.items():
            if name not in silent:
                self.inputs[name].publish(message)

    def feed(self, frames, silent=None):
        """Feeds at 120 Hz with inputs before each frame (none where silent is None); returns the answers."""
        before = self.listener.count()

        def fault(body, k, message):
            if body == "base" and silent is not None:
                self.press(silent)
            return message

        self.feeder.feed(frames, rate=120.0, fault=fault)
        # The last may wait for an input that is due.
        self.listener.wait(lambda: self.listener.count() >= before + frames, 1.5)
        return self.listener.since(before)

    def test_a_without_inputs_all_are_named(self):
        estimates = self.feed(60)
        self.assertEqual({e.status for e in estimates}, {ArmEstimate.STATUS_MISSING_INPUTS})
        self.assertIn("the prior needs chamber_1, tendon_1, servo_1", estimates[-1].detail)
        self.listener.fresh()
        self.assertEqual(self.listener.value("inputs", "pressure chamber_1"), "absent")
        self.assertEqual(self.listener.value("inputs", "tension tendon_1"), "absent")
        self.assertEqual(self.listener.value("inputs", "angle servo_1"), "absent")
        self.assertEqual(self.listener.value("fit", "prior"), "on")
        self.assertEqual(self.listener.value("fit", "window (s)"), "0.25")

    def test_b_values_arrive_converted(self):
        # At rest: an input without a stamp counts from when it came, and the arm must not have moved on by then.
        self.feeder.swings = False
        self.feed(30, silent=())
        estimates = self.feed(120, silent=())
        self.feeder.swings = True
        self.assertEqual({e.status for e in estimates}, {ArmEstimate.STATUS_OK}, {e.detail for e in estimates})
        # The rings see M0 / EI alone: EI follows from what the laws make of all three inputs. A wrong unit, zero or
        # element of any of them moves it by 10 % or more.
        for e in estimates:
            segment = e.segments[0]
            self.assertTrue(e.prior)
            self.assertEqual(e.window, 0.25)
            self.assertTrue(segment.identifiable_bending_stiffness)
            self.assertLess(abs(segment.bending_stiffness - EI), 0.05 * EI)
            self.assertLess(abs(segment.moment - EI * segment.bending_angle / 0.2), 0.01)
        self.assertLess(sum(e.reduced_chi_square for e in estimates) / len(estimates), 2.0)

    def test_c_the_one_that_stops_is_named(self):
        self.feed(30, silent=())
        last = rospy.Time.now().to_sec()
        estimates = self.feed(150, silent=("tendon_1",))
        # The last value holds for input_max_age_s, 0.5 s.
        for e in estimates:
            if e.header.stamp.to_sec() < last + 0.45:
                self.assertEqual(e.status, ArmEstimate.STATUS_OK, e.detail)
        self.assertGreater(estimates[-1].header.stamp.to_sec(), last + 1.0)
        self.assertEqual(estimates[-1].status, ArmEstimate.STATUS_MISSING_INPUTS)
        self.assertIn("the prior needs tendon_1, absent or too old", estimates[-1].detail)
        seen = []

        def warned():
            self.feed(24, silent=("tendon_1",))
            seen.append(self.listener.task("inputs"))
            return seen[-1].message.startswith("inputs missing: tendon_1")

        # That very status, of a time when frames came: between two feeds no body is seen, which is said first.
        self.assertTrue(self.listener.wait(warned, 10.0), [status.message for status in seen])
        self.assertEqual(seen[-1].level, DiagnosticStatus.WARN)
        values = {v.key: v.value for v in seen[-1].values}
        self.assertTrue(values["tension tendon_1"].startswith("missing for"))
        self.assertTrue(values["angle servo_1"].startswith("seen"))
        self.assertEqual({e.status for e in self.feed(60, silent=())[12:]}, {ArmEstimate.STATUS_OK})

    def test_d_an_array_without_the_element(self):
        before = int(self.listener.value("inputs", "rejected: input_nan chamber_1"))
        self.inputs["chamber_1"].publish(Float64MultiArray(data=[99.0]))
        self.feed(24, silent=("chamber_1",))
        self.listener.fresh()
        self.assertEqual(int(self.listener.value("inputs", "rejected: input_nan chamber_1")) - before, 1)

    def test_e_both_at_once(self):
        answer = self.set_mode(unknown="both")
        self.assertTrue(answer.success)
        self.assertNotIn("prior", answer.message)  # it is on
        estimates = self.feed(60, silent=())
        self.assertEqual(estimates[-1].unknown, "both")
        self.assertEqual(estimates[-1].status, ArmEstimate.STATUS_OK, estimates[-1].detail)
        self.assertFalse(estimates[-1].payload_is_known)
        self.assertTrue(estimates[-1].determined_payload)
        self.assertLess(abs(estimates[-1].payload), 3.0 * estimates[-1].sd_payload)
        self.assertTrue(self.set_mode(unknown="stiffness").success)


if __name__ == "__main__":
    rostest.rosrun("softarm_estimator", "live_inputs", LiveInputs, sys.argv)
