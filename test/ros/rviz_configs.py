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

PACKAGE = rospkg.RosPack().get_path("softarm_estimator")


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
            rviz = subprocess.Popen(["rviz", "-d", config, "__name:=shown"], env=self.environment, stdout=output,
                                    stderr=subprocess.STDOUT)
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

    def test_demo(self):
        self.check("demo.rviz")

    def test_estimate(self):
        self.check("estimate.rviz")

    def test_replay(self):
        self.check("replay.rviz")


if __name__ == "__main__":
    rostest.unitrun("softarm_estimator", "rviz_configs", RvizConfigs, sys.argv)
