#!/usr/bin/python3
"""rviz loads the shipped configurations under a virtual display, shows the node's topics, and stays alive."""
import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

import rosgraph
import rospkg
import rostest
import yaml

PACKAGE = rospkg.RosPack().get_path("softarm_estimator")
ARMS = os.path.join(PACKAGE, "config", "arms")


@unittest.skipUnless(shutil.which("Xvfb") and shutil.which("rviz"), "Xvfb or rviz is not installed")
class RvizConfigs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        read, write = os.pipe()  # Xvfb picks a free display and writes its number
        cls.server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x900x24"], pass_fds=[write],
                                      stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as pipe:
            display = ":" + pipe.readline().strip()
        cls.environment = dict(os.environ, DISPLAY=display, LIBGL_ALWAYS_SOFTWARE="1", QT_QPA_PLATFORM="xcb")

    @classmethod
    def tearDownClass(cls):
        cls.server.terminate()
        cls.server.wait()

    def check(self, name):
        config = os.path.join(PACKAGE, "rviz", name)
        self.assertTrue(os.path.isfile(config))
        with tempfile.TemporaryFile(mode="w+") as output:
            rviz = subprocess.Popen(["show_arm", "--arm", "hybrid_85mm", "--arms-dir", ARMS, "--config", config, "--wait", "0",
                                     "__name:=shown"], env=self.environment, stdout=output, stderr=subprocess.STDOUT)
            try:
                wanted = {"/softarm_estimator/markers", "/softarm_estimator/backbone", "/tf"}
                end = time.time() + 25.0
                subscribed = set()
                while time.time() < end and rviz.poll() is None and not wanted <= subscribed:
                    subscribed = {topic for topic, nodes in rosgraph.Master("/test").getSystemState()[1] if "/shown" in nodes}
                    time.sleep(0.2)
                time.sleep(1.0)  # frames are drawn
                alive = rviz.poll() is None
            finally:
                rviz.terminate()
                try:
                    rviz.wait(10)
                except subprocess.TimeoutExpired:
                    rviz.kill()
                    rviz.wait()
            output.seek(0)
            text = output.read()
        self.assertTrue(alive, text)
        self.assertTrue(wanted <= subscribed, "subscribed: %s\n%s" % (sorted(subscribed), text))
        self.assertNotIn("could not be loaded", text)
        self.assertNotIn("Failed to", text)

    def fitted(self, arm):
        """The view and the displays that rviz would be started with."""
        with tempfile.NamedTemporaryFile(suffix=".rviz") as out:
            subprocess.run(["show_arm", "--arm", arm, "--arms-dir", ARMS, "--config", os.path.join(PACKAGE, "rviz/demo.rviz"),
                            "--wait", "0", "--out", out.name], check=True)
            with open(out.name) as text:
                manager = yaml.safe_load(text)["Visualization Manager"]
        return manager["Views"]["Current"], {d["Class"]: d for d in manager["Displays"]}

    def test_the_view_is_fitted_to_the_arm(self):
        view, displays = self.fitted("online_200mm")  # that of the file
        with open(os.path.join(PACKAGE, "rviz/demo.rviz")) as text:
            shipped = yaml.safe_load(text)["Visualization Manager"]
        self.assertAlmostEqual(view["Distance"], shipped["Views"]["Current"]["Distance"])
        self.assertEqual({d["Class"] for d in shipped["Displays"]}, set(displays))
        small, small_displays = self.fitted("hybrid_85mm")
        self.assertAlmostEqual(small["Distance"], view["Distance"] * 0.085 / 0.2)
        self.assertAlmostEqual(small["Focal Point"]["Z"], view["Focal Point"]["Z"] * 0.085 / 0.2)
        self.assertAlmostEqual(small_displays["rviz/Grid"]["Cell Size"], 0.02)
        self.assertEqual(small_displays["rviz/MarkerArray"], displays["rviz/MarkerArray"])

    def test_a_wrong_arm_is_one_line(self):
        done = subprocess.run(["show_arm", "--arm", "no_arm", "--arms-dir", ARMS, "--config",
                               os.path.join(PACKAGE, "rviz/demo.rviz")], stderr=subprocess.PIPE, text=True)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("no_arm", done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)

    def test_demo(self):
        self.check("demo.rviz")

    def test_estimate(self):
        self.check("estimate.rviz")

    def test_replay(self):
        self.check("replay.rviz")


if __name__ == "__main__":
    rostest.unitrun("softarm_estimator", "rviz_configs", RvizConfigs, sys.argv)
