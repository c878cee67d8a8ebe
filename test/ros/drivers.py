#!/usr/bin/python3
"""A node for each snippet of doc/drivers.md, and a publisher that behaves as that driver does, faults included."""
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings

import rospy
import rostest

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
import foreign_messages as foreign  # noqa: E402
import softarm_estimator.msg as mirrors  # noqa: E402
from diagnostic_msgs.msg import DiagnosticArray  # noqa: E402
from geometry_msgs.msg import Point, Point32, PointStamped, PoseStamped, TransformStamped  # noqa: E402
from nav_msgs.msg import Odometry  # noqa: E402
from sensor_msgs.msg import PointCloud  # noqa: E402
from softarm_estimator.msg import ArmEstimate  # noqa: E402
from tf2_msgs.msg import TFMessage  # noqa: E402
from visualization_msgs.msg import Marker  # noqa: E402

FRAMES, RATE, LOST = 90, 30.0, range(40, 50)  # ring_2 is lost in LOST
NAN = float("nan")
PROGRAM = ["estimator_node"] if shutil.which("estimator_node") else ["rosrun", "softarm_estimator", "estimator_node"]
DOC = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "doc", "drivers.md")
ARM = """format: 1
name: any_driver
segments:
  - {name: segment_1, length_m: 0.2, mass_per_length_kg_m: 0, diameter_m: 0.04, bending_stiffness: {base_nm2: 0.03}}
payload: {default_kg: 0}
"""
BASE = "base: {body: base}\n"
BODIES = "bodies:\n  - {name: ring_1, arclength_m: 0.1}\n  - {name: ring_2, arclength_m: tip}\n"


def snippets():
    with open(DOC, encoding="utf-8") as file:
        return dict(re.findall(r"^```yaml ([^\n]+)\n(.*?)^```$", file.read(), re.M | re.S))


def arm_of(snippet):
    has = lambda key: re.search("^%s:" % key, snippet, re.M)
    return ARM + ("" if has("base") else BASE) + ("" if has("bodies") else BODIES) + snippet


def position(body, i):
    """Of base, ring_1, ring_2 at instant i: an arc that hangs from (0, 0, 1) and swings; no two are the same."""
    angle = 0.6 + 0.2 * math.sin(0.1 * i)
    along = {"base": 0.0, "ring_1": 0.5, "ring_2": 1.0}[body]
    radius = 0.2 / angle
    return (radius * (1.0 - math.cos(angle * along)), 1e-6 * (i % 7), 1.0 - radius * math.sin(angle * along))


def set_point(to, p):
    to.x, to.y, to.z = p


def y_up(p):
    return (p[0], p[2], -p[1])


class Driver:
    """One publisher of a topic or of several; publish(i, stamp) sends what belongs to instant i."""

    def __init__(self):
        self.publishers = {}
        self.rejections = []  # that the node must report

    def send(self, topic, message):
        self.publishers[topic].publish(message)

    def advertise(self, topic, kind):
        # Without a queue publish() sends: with one, a thread per connection does, and on a busy machine a body's thread may
        # get its turn only after another body's has sent half a second of messages.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SyntaxWarning)
            self.publishers[topic] = rospy.Publisher(topic, kind, queue_size=None, tcp_nodelay=True)

    def connected(self):
        return all(p.get_num_connections() > 0 for p in self.publishers.values())


class Poses(Driver):
    """kind: message type; fill(message, position, body) -> None. frozen: a lost body repeats its last pose."""

    def __init__(self, topic, kind, frame, points_up=False, times=1, frozen=False, bodies=("base", "ring_1", "ring_2")):
        super().__init__()
        self.topic, self.kind, self.frame, self.points_up, self.times = topic, kind, frame, points_up, times
        self.frozen, self.bodies = frozen, bodies
        for body in bodies:
            self.advertise(topic.replace("<body>", body), kind)
        if times > 1:
            self.rejections = ["duplicate ring_1"]

    def orientation(self, q):
        """Half a turn about x: z points down. In a frame whose y is up, that is half a turn and a quarter of one."""
        if self.points_up:
            q.x, q.y, q.z, q.w = math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)
        else:
            q.x, q.y, q.z, q.w = 1.0, 0.0, 0.0, 0.0

    def publish(self, i, stamp):
        for repeat in range(self.times):
            for body in self.bodies:
                if body == "ring_2" and i in LOST and not self.frozen:
                    continue
                message = self.kind()
                message.header.stamp = stamp + rospy.Duration.from_sec(1e-4 * repeat)
                message.header.frame_id = self.frame
                p = position(body, LOST[0] if body == "ring_2" and i in LOST else i)
                p = y_up(p) if self.points_up else p
                if self.kind is PointStamped:
                    set_point(message.point, p)
                elif self.kind is TransformStamped:
                    set_point(message.transform.translation, p)
                    self.orientation(message.transform.rotation)
                else:
                    pose = message.pose.pose if self.kind is Odometry else message.pose
                    set_point(pose.position, p)
                    self.orientation(pose.orientation)
                self.send(self.topic.replace("<body>", body), message)


class Tf(Driver):
    def __init__(self):
        super().__init__()
        self.advertise("/tf", TFMessage)
        self.rejections = ["other_frame ring_1"]

    def publish(self, i, stamp):
        message = TFMessage()
        for body in ("base", "ring_1", "ring_2"):
            if body == "ring_2" and i in LOST:
                continue
            for parent in ("/world", "camera"):
                transform = TransformStamped()
                transform.header.stamp = stamp
                transform.header.frame_id = parent
                transform.child_frame_id = "/vicon/%s/%s" % (body, body)
                set_point(transform.transform.translation, position(body, i))
                transform.transform.rotation.x = 1.0
                message.transforms.append(transform)
        self.send("/tf", message)


class Vicon(Driver):
    def __init__(self):
        super().__init__()
        self.advertise("/vicon/markers", foreign.VICON["vicon_bridge/Markers"])
        self.rejections = ["occluded ring_2"]

    def publish(self, i, stamp):
        message = foreign.VICON["vicon_bridge/Markers"]()
        message.header.stamp = stamp

        def add(name, p, occluded=False):
            marker = foreign.VICON["vicon_bridge/Marker"]()
            marker.marker_name, marker.subject_name = name, "arm" if name else ""
            marker.occluded = occluded
            set_point(marker.translation, [1e3 * c for c in p])
            message.markers.append(marker)

        # Half a turn about x: the mount's y and z are the world's -y and -z.
        x, y, z = position("base", i)
        for name, (dx, dy, dz) in (("mount1", (0.05, 0, 0)), ("mount2", (-0.05, 0, 0)), ("mount3", (0, 0.04, 0)),
                                   ("mount4", (0, 0, 0.03))):
            add(name, (x + dx, y - dy, z - dz))
        x, y, z = position("ring_1", i)
        add("r1a", (x, y + 0.02, z))
        add("r1b", (x, y - 0.02, z))
        add("ring_2", (9, 9, 9) if i in LOST else position("ring_2", i), i in LOST)
        add("", (0.3, 0.3, 0.3))
        self.send("/vicon/markers", message)


class Qualisys(Driver):
    def __init__(self):
        super().__init__()
        self.advertise("/qualisys/markers", foreign.MOCAP["mocap_base/MarkerList"])
        self.rejections = ["not_tracked ring_2"]

    def publish(self, i, stamp):
        message = foreign.MOCAP["mocap_base/MarkerList"]()
        message.header.stamp, message.header.frame_id = stamp, "/mocap"
        for body in ("ring_2", "ring_1"):
            marker = foreign.MOCAP["mocap_base/Marker"]()
            marker.id, marker.labeled, marker.tracked = body, True, not (body == "ring_2" and i in LOST)
            set_point(marker.position, position(body, i) if marker.tracked else (NAN, NAN, NAN))
            message.markers.append(marker)
        self.send("/qualisys/markers", message)


class Phasespace(Driver):
    def __init__(self):
        super().__init__()
        self.advertise("/phasespace/markers", foreign.PHASESPACE_SERVER["phasespace_msgs/Markers"])
        self.rejections = ["bad_condition ring_2"]

    def publish(self, i, stamp):
        message = foreign.PHASESPACE_SERVER["phasespace_msgs/Markers"]()  # never stamped
        for led, body in ((7, "ring_1"), (8, "ring_2")):
            marker = foreign.PHASESPACE_SERVER["phasespace_msgs/Marker"]()
            marker.id, marker.time = led, 5000000 + int(1e6 * i / RATE)
            marker.x, marker.z, marker.y = position(body, i)
            marker.cond = -1.0 if body == "ring_2" and i in LOST else 3.0
            message.markers.append(marker)
        self.send("/phasespace/markers", message)


class Cloud(Driver):
    """A base of its own and points in changing order with a ghost."""

    def __init__(self, base_topic, topic, kind, frame, points_up=False):
        super().__init__()
        self.topic, self.kind, self.frame, self.points_up = topic, kind, frame, points_up
        self.advertise(topic, kind)
        self.base = Poses(base_topic, PoseStamped, frame, bodies=("base",))
        self.publishers.update(self.base.publishers)
        self.rejections = ["ghost markers", "no_point ring_2"]

    def publish(self, i, stamp):
        self.base.publish(i, stamp)
        points = [position("ring_1", i), (0.5, 0.4, 0.3)] + ([] if i in LOST else [position("ring_2", i)])
        message = self.kind()
        message.header.stamp, message.header.frame_id = stamp, self.frame
        if self.kind is Marker:
            message.type = Marker.SPHERE_LIST
        for p in points[i % len(points):] + points[:i % len(points)]:
            message.points.append((Point if self.kind is Marker else Point32)(*(y_up(p) if self.points_up else p)))
        self.send(self.topic, message)


DRIVERS = {
    "vrpn": lambda: Poses("/vrpn_client_node/<body>/pose", PoseStamped, "world", points_up=True, frozen=True),
    "vicon segments": lambda: Poses("/vicon/<body>/<body>", TransformStamped, "/vicon/world"),
    "odometry": lambda: Poses("/mocap/<body>/odom", Odometry, "world", times=2),
    "tf": Tf,
    "vicon markers": Vicon,
    "qualisys": Qualisys,
    "phasespace": Phasespace,
    "natnet markers": lambda: Poses("/natnet_ros/<body>/marker0/pose", PointStamped, "body/marker0",
                                    bodies=("ring_1", "ring_2")),
    "natnet cloud": lambda: Cloud("/natnet_ros/<body>/pose", "/natnet_ros/pointcloud", PointCloud, "world"),
    "natnet_ros cloud": lambda: Cloud("/mocap/rigid_bodies/<body>/pose", "/mocap/markers/vis", Marker, "mocap",
                                      points_up=True),
}


class Drivers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("drivers")
        cls.lock = threading.Lock()
        cls.folder = tempfile.TemporaryDirectory()
        cls.estimates = {name: [] for name in DRIVERS}
        cls.rejected = {name: set() for name in DRIVERS}
        cls.nodes = []
        text = snippets()
        cls.node_names = {name: "driver_" + re.sub(r"\W", "_", name) for name in DRIVERS}
        for name, node in cls.node_names.items():
            path = os.path.join(cls.folder.name, node + ".yaml")
            with open(path, "w", encoding="utf-8") as file:
                file.write(arm_of(text[name]))
            rospy.Subscriber("/%s/estimate" % node, ArmEstimate, cls.on_estimate, name, queue_size=500)
            cls.nodes.append(subprocess.Popen(PROGRAM + ["__name:=" + node, "_arm:=" + path, "_publish_tf:=false",
                                                         "_marker_rate:=0"]))
        rospy.Subscriber("/diagnostics", DiagnosticArray, cls.on_diagnostics, queue_size=500)
        cls.drivers = {name: make() for name, make in DRIVERS.items()}
        end = time.time() + 30.0
        while time.time() < end and not all(d.connected() for d in cls.drivers.values()):
            time.sleep(0.1)
        cls.silent = [name for name, driver in cls.drivers.items() if not driver.connected()]
        begin = time.time()
        first = rospy.Time.now()
        cls.first_s = first.to_sec()
        for i in range(FRAMES):
            for driver in cls.drivers.values():
                driver.publish(i, first + rospy.Duration.from_sec(i / RATE))
            time.sleep(max(0.0, begin + (i + 1) / RATE - time.time()))
        end = time.time() + 10.0
        while time.time() < end and not all(len(e) >= FRAMES - 5 for e in cls.estimates.values()):
            time.sleep(0.1)
        time.sleep(2.5)  # for the diagnostics

    @classmethod
    def tearDownClass(cls):
        for node in cls.nodes:
            node.terminate()
        for node in cls.nodes:
            node.wait()
        cls.folder.cleanup()

    @classmethod
    def on_estimate(cls, message, name):
        with cls.lock:
            cls.estimates[name].append(message)

    @classmethod
    def on_diagnostics(cls, message):
        with cls.lock:
            for status in message.status:
                for name, node in cls.node_names.items():
                    if status.name == node + ": inputs":
                        cls.rejected[name].update(v.key[len("rejected: "):] for v in status.values
                                                  if v.key.startswith("rejected: "))

    def test_every_snippet_has_a_driver(self):
        self.assertEqual(set(snippets()) - {"pressures"}, set(DRIVERS))

    def test_md5_sums_of_the_mirrors_are_those_of_the_originals(self):
        for mirror, original in ((mirrors.ViconMarkers, foreign.VICON["vicon_bridge/Markers"]),
                                 (mirrors.ViconMarker, foreign.VICON["vicon_bridge/Marker"]),
                                 (mirrors.MocapMarkerList, foreign.MOCAP["mocap_base/MarkerList"]),
                                 (mirrors.MocapMarker, foreign.MOCAP["mocap_base/Marker"]),
                                 (mirrors.PhasespaceMarkers, foreign.PHASESPACE["phasespace_msgs/Markers"]),
                                 (mirrors.PhasespaceMarker, foreign.PHASESPACE["phasespace_msgs/Marker"])):
            self.assertEqual(mirror._md5sum, original._md5sum)
        self.assertEqual(foreign.VICON["vicon_bridge/Markers"]._md5sum, "579f0637989aa8139ce6bf98cf7aabda")
        self.assertEqual(foreign.MOCAP["mocap_base/MarkerList"]._md5sum, "a2118b2995486d302a0c33e52d38f452")

    def check(self, name):
        """Every frame is estimated; rings are where they were put, in the base's frame (z down); faults are said."""
        self.assertNotIn(name, self.silent, "the node did not subscribe")
        with self.lock:
            estimates = list(self.estimates[name])
            rejected = set(self.rejected[name])
        self.assertGreaterEqual(len(estimates), FRAMES - 5, rejected)
        first_s = 5.0 if name == "phasespace" else self.first_s
        seen = {"ring_1": 0, "ring_2": 0}
        for estimate in estimates:
            i = int(round((estimate.header.stamp.to_sec() - first_s) * RATE))
            # One ring alone does not determine the shape: the frame is refused, and shows no bodies.
            # The first frame after the loss may be closed before a body that is no longer awaited comes.
            if i not in LOST and i != LOST.stop:
                self.assertEqual(estimate.status, ArmEstimate.STATUS_OK, (i, estimate.detail))
            for body, measured in zip(estimate.body_names, estimate.measured):
                seen[body] += 1
                x, y, z = position(body, i)
                base = position("base", i) if "base: {fixed" not in snippets()[name] else (0.0, 0.0, 1.0)
                expected = (x - base[0], -(y - base[1]), -(z - base[2]))
                error = math.dist((measured.x, measured.y, measured.z), expected)
                self.assertLess(error, 0.015 if i in LOST or i == LOST.stop else 1e-5, (name, i, body, measured, expected))
        self.assertGreaterEqual(seen["ring_1"], len(estimates) - len(LOST) - 4)
        self.assertGreaterEqual(seen["ring_2"], len(estimates) - len(LOST) - 4)
        if name != "vrpn":  # what is lost there looks like a body at rest, until it is frozen for long
            self.assertLessEqual(seen["ring_2"], len(estimates) - len(LOST) + 1)
        for reason in self.drivers[name].rejections:
            self.assertIn(reason, rejected)


def check_of(name):
    return lambda self: self.check(name)


for driver_name in DRIVERS:
    setattr(Drivers, "test_" + re.sub(r"\W", "_", driver_name), check_of(driver_name))

if __name__ == "__main__":
    rostest.rosrun("softarm_estimator", "drivers", Drivers, sys.argv)
