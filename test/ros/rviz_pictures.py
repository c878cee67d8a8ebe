#!/usr/bin/python3
"""What each launch file's rviz shows, photographed under a virtual display: the arm, its figures, the colour bar; and while
nothing comes, what is waited for. Where a launch file is new, it is photographed here or says that it has no rviz."""
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import rospkg
import rospy
import rostest

PACKAGE = rospkg.RosPack().get_path("softarm_estimator")
LAUNCH = os.path.join(PACKAGE, "launch")
WIDTH, HEIGHT = 640, 450  # of the photographs: half of the screen
PATIENCE_S = 60.0  # for rviz on a machine that is busy
LAUNCH_ENDS_S = 60.0  # roslaunch gives its programs 15 s after SIGINT, and 2 s after SIGTERM; without it they would live on


def near(colour, spread):
    return lambda r, g, b: all(abs(value - wanted) <= spread for value, wanted in zip((r, g, b), colour))


# Colours of src/ros/labels.h, tube.cpp and of the tube before the background.
LOOKS = {
    "measured": near((255, 166, 26), 40),
    "payload": lambda r, g, b: r > 90 and b > 140 and g < 0.65 * b and r < 0.95 * b,
    "tube": lambda r, g, b: 20 <= r <= 130 and 75 <= g <= 190 and 50 <= b <= 170 and max(g, b) > r + 35,
    "figures": lambda r, g, b: min(r, g, b) > 200,
    "red end": near((242, 64, 51), 45),
    "trouble": lambda r, g, b: r > 180 and 50 < g < 130 and 40 < b < 120,
}


class Photograph:
    def __init__(self, environment):
        rgb = subprocess.run(["import", "-silent", "-window", "root", "-depth", "8", "rgb:-"], env=environment,
                             stdout=subprocess.PIPE, timeout=30, check=True).stdout
        rows = [rgb[y * 6 * WIDTH:(y + 1) * 6 * WIDTH] for y in range(0, 2 * HEIGHT, 2)]
        self.pixels = [pixel for row in rows for pixel in zip(row[0::6], row[1::6], row[2::6])]
        # Without the window's frame: rviz draws between its tool bar and its status line.
        self.inside = [i for i in range(len(self.pixels)) if 60 <= i // WIDTH < 410 and 40 <= i % WIDTH < 600]

    def places(self, look):
        return [(i % WIDTH, i // WIDTH) for i in self.inside if LOOKS[look](*self.pixels[i])]

    def dark_share(self):
        return sum(max(self.pixels[i]) < 70 for i in self.inside) / len(self.inside)


@unittest.skipUnless(all(map(shutil.which, ["Xvfb", "rviz", "import"])), "Xvfb, rviz or ImageMagick is not installed")
class RvizPictures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        read, write = os.pipe()  # Xvfb picks a free display and writes its number
        # -noreset: a server begins anew when its last client leaves, and drops whoever comes meanwhile. Each photograph
        # before rviz is there would be such a last client.
        cls.server = subprocess.Popen(["Xvfb", "-noreset", "-displayfd", str(write), "-screen", "0", "1280x900x24"],
                                      pass_fds=[write], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as pipe:
            display = ":" + pipe.readline().strip()
        cls.environment = dict(os.environ, DISPLAY=display, LIBGL_ALWAYS_SOFTWARE="1", QT_QPA_PLATFORM="xcb")
        cls.folder = tempfile.TemporaryDirectory()

    @classmethod
    def tearDownClass(cls):
        cls.server.terminate()
        cls.server.wait()
        cls.folder.cleanup()

    def setUp(self):
        self.running = []
        self.log = os.path.join(self.folder.name, self.id() + ".log")

    def tearDown(self):
        for process in reversed(self.running):
            process.send_signal(signal.SIGINT)
        for process in self.running:
            try:
                process.wait(LAUNCH_ENDS_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        if rospy.has_param("/use_sim_time"):
            rospy.delete_param("/use_sim_time")

    def start(self, *command):
        with open(self.log, "ab") as log:
            self.running.append(subprocess.Popen(command, env=self.environment, stdout=log, stderr=log))

    def launch(self, name, *arguments):
        self.start("roslaunch", "--wait", os.path.join(LAUNCH, name), *arguments)

    def launch_in(self, namespace, name, *arguments):
        self.start("env", "ROS_NAMESPACE=" + namespace, "roslaunch", "--wait", os.path.join(LAUNCH, name), *arguments)

    def wait_for(self, shows):
        """Photographs until `shows` has nothing to say against the picture."""
        end = time.time() + PATIENCE_S
        missing = "no picture"
        while time.time() < end:
            missing = shows(Photograph(self.environment))
            if not missing:
                return
            time.sleep(0.3)
        with open(self.log, encoding="utf-8", errors="replace") as log:
            self.fail("%s\nThe programs' last lines:\n%s" % (missing, "".join(log.readlines()[-20:])))

    def arm(self, picture):
        counts = {look: len(picture.places(look)) for look in LOOKS}
        for look, least in {"tube": 1500, "measured": 15, "figures": 150, "red end": 8}.items():
            if counts[look] < least:
                return "%s: %s" % (look, counts)
        if picture.dark_share() < 0.6:
            return "docks cover the picture: %.2f of it is dark" % picture.dark_share()
        xs, ys = zip(*picture.places("tube"))
        middle = sum(xs) / len(xs), sum(ys) / len(ys)
        if not (200 < middle[0] < 440 and 110 < middle[1] < 350):
            return "the arm is not in the middle: %s" % (middle,)
        return ""

    def recording(self):
        bag = os.path.join(self.folder.name, "trial.bag")
        subprocess.run(["softarm", "simulate", "trial_10s", "--seconds", "8", "--out", bag], check=True, stdout=subprocess.DEVNULL)
        return bag

    def arm_beside(self, name, x_m):
        """The file of an arm that hangs there and has topics of its own."""
        path = os.path.join(self.folder.name, name + ".yaml")
        subprocess.run(["softarm", "new-arm", "--kind", "chambers", "--segments", "1", "--length", "0.2", "--mass", "0.2", "--diameter", "0.04",
                        "--actuators", "3", "--bodies", "4", "--base", "hanging", "--out", path], check=True, stdout=subprocess.DEVNULL)
        with open(path, encoding="utf-8") as file:
            text = file.read().replace("topic: /", "topic: /%s/" % name).replace("position_m: [0, 0, 0]", "position_m: [%g, 0, 0.5]" % x_m)
        with open(path, "w", encoding="utf-8") as file:
            file.write(re.sub(r"^inputs:.*$", r"\g<0>\n  payload_topic: /%s/payload" % name, text, flags=re.M))
        self.start("env", "ROS_NAMESPACE=" + name, "simulator_node", "__name:=rig", "_scenario:=" + path, "_endless:=true")
        return path

    def two_arms(self, picture):
        """One in each half of the picture, each with its figures, and nothing of an arm between them."""
        halves = lambda look: [[x for x, _ in picture.places(look) if (x < WIDTH // 2) == left] for left in (True, False)]
        counts = {look: [len(xs) for xs in halves(look)] for look in LOOKS}
        for look, least in {"tube": 500, "measured": 8, "figures": 60}.items():
            if min(counts[look]) < least:
                return "%s: %s" % (look, counts)
        left, right = halves("tube")
        return "" if max(left) + 15 < min(right) else "the arms meet: %d, %d" % (max(left), min(right))

    def test_demo(self):
        self.launch("demo.launch")
        self.wait_for(self.arm)

    def test_estimate(self):
        self.launch("estimate.launch", "arm:=online_200mm")
        self.wait_for(lambda picture: "" if len(picture.places("trouble")) > 100 else "it does not say what it waits for")
        self.assertEqual(len(Photograph(self.environment).places("tube")), 0, "there is no arm yet")
        self.start("simulator_node", "_scenario:=demo", "_endless:=true",
                   "_scenarios_dir:=" + os.path.join(PACKAGE, "config", "scenarios"))
        # rviz was fitted to an arm that was not there yet.
        self.wait_for(lambda picture: "" if len(picture.places("tube")) > 800 else "no arm: %d" % len(picture.places("tube")))

    def test_replay(self):
        self.launch("replay.launch", "bag:=" + self.recording(), "loop:=true")
        self.wait_for(self.arm)

    def test_two_arms_side_by_side(self):
        """As doc/messages.md has it."""
        self.launch_in("right", "estimate.launch", "arm:=" + self.arm_beside("right", 0.4), "frame_prefix:=right", "rviz:=false")
        subprocess.run(["rostopic", "echo", "-n", "1", "/right/softarm_estimator/estimate/header"], check=True, timeout=PATIENCE_S,
                       stdout=subprocess.DEVNULL)
        self.launch("estimate.launch", "arm:=" + self.arm_beside("left", 0.0), "frame_prefix:=left", "also:=right")
        self.wait_for(self.two_arms)

    def test_every_launch_file_with_rviz_is_photographed(self):
        shown = set()
        for name in os.listdir(LAUNCH):
            with open(os.path.join(LAUNCH, name), encoding="utf-8") as text:
                if 'name="rviz"' in text.read():
                    shown.add(name)
        tests = {name[len("test_"):] + ".launch" for name in dir(self) if name.startswith("test_")}
        self.assertTrue(shown)
        self.assertTrue(shown <= tests, shown - tests)


if __name__ == "__main__":
    rostest.unitrun("softarm_estimator", "rviz_pictures", RvizPictures, sys.argv)
