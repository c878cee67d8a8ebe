"""Feeds the estimator node the way a mocap driver does, and listens to all it says."""
import math
import random
import sys
import threading
import time

import rospy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from softarm_estimator.msg import ArmEstimate
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

BODIES = ["base", "ring_1", "ring_2", "ring_3", "ring_4"]
NODE = "/softarm_estimator"
# A send gives the interpreter away, and what decodes estimates would keep it for 5 ms each time.
sys.setswitchinterval(2e-4)


def first_nan(message, path=""):
    """Path of the first float of a message that is not finite, or None."""
    if isinstance(message, float):
        return None if math.isfinite(message) else path
    if isinstance(message, (list, tuple)):
        for i, value in enumerate(message):
            found = first_nan(value, "%s[%d]" % (path, i))
            if found:
                return found
    elif hasattr(message, "__slots__") and hasattr(message, "_type"):
        for slot in message.__slots__:
            found = first_nan(getattr(message, slot), "%s.%s" % (path, slot))
            if found:
                return found
    return None


class Feeder:
    """Publishes an arc of a circle that swings, hanging from a base at 1 m, with noise."""

    def __init__(self, seed=1):
        # No queues: each would be sent by a thread of its own, and on a busy machine one body lags the others by frames.
        self.publishers = {b: rospy.Publisher("/mocap/%s/pose" % b, PoseStamped, queue_size=None, tcp_nodelay=True)
                           for b in BODIES}
        self.random = random.Random(seed)
        self.index = 0
        self.swings = True

    def wait_for_subscribers(self, timeout=15.0):
        end = time.time() + timeout
        while time.time() < end:
            if all(p.get_num_connections() > 0 for p in self.publishers.values()):
                return True
            time.sleep(0.05)
        return False

    def pose(self, body, stamp):
        """Pose of a body at the present index; z points down along the arm."""
        message = PoseStamped()
        message.header.stamp = stamp
        message.header.frame_id = "mocap"
        noise = lambda: self.random.gauss(0.0, 1e-4)
        angle = 0.8 + 0.4 * math.sin(0.01 * self.index)  # of the whole arm
        s = BODIES.index(body) / 4.0
        radius = 0.2 / angle
        x = radius * (1.0 - math.cos(angle * s))
        z = 1.0 - radius * math.sin(angle * s)
        message.pose.position.x = x + noise()
        message.pose.position.y = noise()
        message.pose.position.z = z + noise()
        # Half a turn about x points z down; then the tangent turns towards +x.
        half = -0.5 * angle * s + noise()
        message.pose.orientation.x = math.cos(half)
        message.pose.orientation.z = -math.sin(half)
        return message

    def feed(self, frames, rate=240.0, start=None, fault=None):
        """Publishes frames in real time. fault(body, k, message) returns the message to send, or None to lose it.

        Like a camera: stamps are of now, and where the machine was busy elsewhere frames are not made up for. start: stamp of the first frame, another time than now. Returns the stamps."""
        ahead = rospy.Duration(0) if start is None else start - rospy.Time.now()
        due = time.time()
        stamps = []
        for k in range(frames):
            time.sleep(max(0.0, due - time.time()))
            if time.time() > due + 1.0 / rate:
                due = time.time()
            stamp = rospy.Time.from_sec(due) + ahead
            due += 1.0 / rate
            stamps.append(stamp)
            for body in BODIES:
                message = self.pose(body, stamp)
                if fault:
                    message = fault(body, k, message)
                if message is not None:
                    self.publishers[body].publish(message)
            self.index += self.swings
        return stamps


class Listener:
    """Keeps estimates and diagnostics, and looks for NaN in everything the node publishes.

    What comes often is kept as it came and decoded when it is asked for: a feeder beside it needs the time."""

    KINDS = {"estimate": ArmEstimate, "backbone": Path, "markers": MarkerArray, "tf": TFMessage}

    def __init__(self):
        self.lock = threading.Lock()
        self.raw = {name: [] for name in self.KINDS}
        self.checked = dict.fromkeys(self.KINDS, 0)
        self.diagnostics = {}
        self.diagnostics_count = 0
        for name in self.KINDS:
            rospy.Subscriber("/tf" if name == "tf" else "%s/%s" % (NODE, name), rospy.AnyMsg, self.on_message, name,
                             queue_size=5000, tcp_nodelay=True)
        rospy.Subscriber("/diagnostics", DiagnosticArray, self.on_diagnostics)

    def on_message(self, message, name):
        with self.lock:
            self.raw[name].append(message._buff)

    def since(self, count, name="estimate"):
        """The messages of a kind from the count-th on."""
        with self.lock:
            raw = self.raw[name][count:]
        return [self.KINDS[name]().deserialize(r) for r in raw]

    def count(self, name="estimate"):
        with self.lock:
            return len(self.raw[name])

    def not_finite(self):
        """Paths of the NaN in what has come since the last call."""
        found = []
        for name in self.KINDS:
            messages = self.since(self.checked[name], name)
            self.checked[name] += len(messages)
            found += [path for path in map(first_nan, messages) if path]
        return found

    def frames(self):
        return {(t.header.frame_id, t.child_frame_id) for m in self.since(0, "tf") for t in m.transforms}

    def newest_markers(self):
        return self.since(-1, "markers")[0].markers

    def on_diagnostics(self, message):
        with self.lock:
            for status in message.status:
                if status.name.startswith("softarm_estimator: "):
                    self.diagnostics[status.name.split(": ")[1]] = status
                    self.diagnostics_count += 1

    def task(self, name):
        with self.lock:
            return self.diagnostics.get(name)

    def value(self, name, key, default="0"):
        status = self.task(name)
        values = {v.key: v.value for v in status.values} if status else {}
        return values.get(key, default)

    def fresh(self):
        """Waits for the next diagnostics: they count what has arrived by then."""
        with self.lock:
            before = self.diagnostics_count
        end = time.time() + 5.0
        while time.time() < end and self.diagnostics_count < before + 3:
            time.sleep(0.02)

    def wait(self, condition, timeout=5.0):
        end = time.time() + timeout
        while time.time() < end:
            if condition():
                return True
            time.sleep(0.02)
        return condition()
