#!/usr/bin/python3
"""diagnose.launch on a real roscore: the last seconds as trials, the program's exit status and report, recording meanwhile."""
import os
import re
import sys
import threading
import time
import unittest

import rosbag
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import TransformStamped
from softarm_estimator.msg import Mismatch
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage

HOME = os.environ["ROS_HOME"]
POSES = ["/mocap/%s/pose" % body for body in ["base", "ring_1", "ring_2", "ring_3", "ring_4"]]
TOPICS = set(POSES + ["/pressure/chamber_%d" % i for i in (1, 2, 3)] + ["/payload"])


class DiagnoseNode(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("diagnose_node_test")
        cls.statuses = {"softarm_diagnose": [], "fails": [], "full_disk": []}
        cls.subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, cls.on_diagnostics, queue_size=100)
        cls.alarms = rospy.Publisher("/test/mismatch", Mismatch, queue_size=10)
        cls.alarms_of_fails = rospy.Publisher("/test/fails_mismatch", Mismatch, queue_size=10)
        cls.diagnose = rospy.ServiceProxy("/softarm_diagnose/diagnose", Trigger)
        cls.diagnose_failing = rospy.ServiceProxy("/fails/diagnose", Trigger)
        cls.diagnose_on_full_disk = rospy.ServiceProxy("/full_disk/diagnose", Trigger)
        cls.diagnose.wait_for_service(15.0)
        cls.diagnose_failing.wait_for_service(15.0)
        cls.diagnose_on_full_disk.wait_for_service(15.0)

    @classmethod
    def on_diagnostics(cls, message):
        for status in message.status:
            for name, seen in cls.statuses.items():
                if status.name.startswith(name + ":") or status.name.startswith("/" + name + ":"):
                    seen.append((status, {v.key: v.value for v in status.values}))

    def wait(self, condition, timeout=15.0):
        end = time.time() + timeout
        while time.time() < end and not condition():
            time.sleep(0.05)
        return condition()

    def kept(self, name="softarm_diagnose"):
        return float(self.statuses[name][-1][1]["kept (s)"]) if self.statuses[name] else 0.0

    def test_a_too_early(self):
        if self.kept() < 0.5:  # on a busy machine we may be late ourselves
            answer = self.diagnose()
            if not answer.success:
                self.assertIn("have been recorded", answer.message)

    def test_b_service(self):
        self.assertTrue(self.wait(lambda: self.kept() > 5.5, 30.0))
        seen = len(self.statuses["softarm_diagnose"])
        answer = self.diagnose()
        self.assertTrue(answer.success, answer.message)
        self.assertIn("exit status 0", answer.message)
        report = re.search(r"report: (\S+)", answer.message).group(1)
        self.assertTrue(os.path.isfile(report))
        self.assertTrue(report.startswith(os.path.join(HOME, "diagnoses")), report)
        # Diagnostics came and messages were kept while it ran.
        running = [v for _, v in self.statuses["softarm_diagnose"][seen:] if v["running"] == "yes"]
        self.assertGreaterEqual(len(running), 1)

        folder = os.path.dirname(os.path.dirname(report))
        trials = sorted(os.listdir(os.path.join(folder, "trials")))
        self.assertEqual(trials, ["trial_01.bag", "trial_02.bag", "trial_03.bag"])
        with open(os.path.join(folder, "diagnose.log")) as log:
            call = log.readline()
        paths = " ".join(os.path.join(folder, "trials", t) for t in trials)
        self.assertEqual(call.strip(), "called with: diagnose --arm online_200mm %s --out %s" %
                         (paths, os.path.join(folder, "report")))
        last_end = None
        for trial in trials:
            with rosbag.Bag(os.path.join(folder, "trials", trial)) as bag:
                topics = bag.get_type_and_topic_info().topics
                self.assertEqual(set(topics), TOPICS)  # the payload too, which was said once before all of it
                self.assertAlmostEqual(bag.get_end_time() - bag.get_start_time(), 2.0, delta=0.2)
                self.assertGreater(topics[POSES[0]].message_count, 150)
                self.assertEqual(next(bag.read_messages("/payload")).message.data, 0.1)
                if last_end is not None:
                    self.assertLess(abs(bag.get_start_time() - last_end), 0.1)
                last_end = bag.get_end_time()

    def test_c_failure(self):
        self.assertTrue(self.wait(lambda: self.kept("fails") > 3.0, 30.0))
        answer = self.diagnose_failing()
        self.assertFalse(answer.success)
        self.assertIn("exit status 3", answer.message)
        self.assertIn("what is wrong with it", answer.message)
        warned = lambda: self.statuses["fails"][-1][0].level == DiagnosticStatus.WARN
        self.assertTrue(self.wait(warned, 5.0))
        self.assertIn("exit status 3", self.statuses["fails"][-1][0].message)

    def test_d_alarm(self):
        count = lambda: int(self.statuses["softarm_diagnose"][-1][1]["diagnoses"])
        self.assertTrue(self.wait(lambda: self.alarms.get_num_connections() > 0))
        before = count()
        for alarm in [False, True, True, False, True]:
            self.alarms.publish(Mismatch(alarm=alarm, description="a test"))
        self.assertTrue(self.wait(lambda: count() == before + 1 and
                                  self.statuses["softarm_diagnose"][-1][1]["running"] == "no", 15.0))
        time.sleep(1.5)
        self.assertEqual(count(), before + 1)  # once, however often
        self.assertIn("exit status 0", self.statuses["softarm_diagnose"][-1][1]["last diagnosis"])

    def test_d_alarm_while_a_diagnosis_runs(self):
        value = lambda key: self.statuses["fails"][-1][1][key]
        self.assertTrue(self.wait(lambda: self.kept("fails") > 3.0 and self.alarms_of_fails.get_num_connections() > 0, 30.0))
        before = int(value("diagnoses"))
        calling = threading.Thread(target=self.diagnose_failing)
        calling.start()
        self.assertTrue(self.wait(lambda: value("running") == "yes", 5.0))
        for alarm in [True, False, True, False]:
            self.alarms_of_fails.publish(Mismatch(alarm=alarm, description="a test"))
        self.assertTrue(self.wait(lambda: value("an alarm waits") == "yes", 5.0))
        calling.join()
        self.assertTrue(self.wait(lambda: int(value("diagnoses")) == before + 2 and value("running") == "no", 15.0))
        time.sleep(1.5)
        self.assertEqual(int(value("diagnoses")), before + 2)  # one for both
        self.assertEqual(value("an alarm waits"), "no")

    def test_d_base_and_rings_on_one_topic(self):
        diagnose = rospy.ServiceProxy("/on_tf/diagnose", Trigger)
        diagnose.wait_for_service(15.0)
        publisher = rospy.Publisher("/test/remapped/tf", TFMessage, queue_size=100)
        self.assertTrue(self.wait(lambda: publisher.get_num_connections() > 0))
        for k in range(80):
            message = TransformStamped()
            message.header.stamp = rospy.Time.now()
            publisher.publish(TFMessage(transforms=[message]))
            time.sleep(0.03)
        time.sleep(0.3)
        answer = diagnose()
        self.assertTrue(answer.success, answer.message)
        trials = os.path.join(os.path.dirname(os.path.dirname(re.search(r"report: (\S+)", answer.message).group(1))), "trials")
        kept = 0
        for trial in os.listdir(trials):
            with rosbag.Bag(os.path.join(trials, trial)) as bag:
                kept += bag.get_message_count("/test/tf")  # as the arm file has it: the program knows of no remapping
        self.assertEqual(kept, 80)  # each once

    def test_e_full_disk(self):
        self.assertTrue(self.wait(lambda: self.kept("full_disk") > 3.0, 30.0))
        for _ in range(2):  # it lives on
            answer = self.diagnose_on_full_disk()
            self.assertFalse(answer.success)
            self.assertRegex(answer.message, r"trial_01\.bag: cannot be written: File too large$")
            warned = lambda: self.statuses["full_disk"][-1][0].level == DiagnosticStatus.WARN
            self.assertTrue(self.wait(warned, 5.0))
            self.assertIn("cannot be written", self.statuses["full_disk"][-1][0].message)
        seen = len(self.statuses["full_disk"])
        self.assertTrue(self.wait(lambda: len(self.statuses["full_disk"]) > seen + 1, 5.0))
        self.assertGreater(self.kept("full_disk"), 3.0)
        left = [name for _, _, names in os.walk(os.path.join(HOME, "full_disk")) for name in names]
        self.assertEqual(left, [])


if __name__ == "__main__":
    rostest.rosrun("softarm_estimator", "diagnose_node", DiagnoseNode, sys.argv)
