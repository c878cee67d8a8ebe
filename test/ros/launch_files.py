#!/usr/bin/python3
"""The launch files can be read with their defaults, and every argument says what it is."""
import os
import sys
import unittest
import xml.etree.ElementTree as ElementTree

import roslaunch.config
import roslaunch.core
import roslib.packages
import rospkg
import rostest

FOLDER = os.path.join(rospkg.RosPack().get_path("softarm_estimator"), "launch")
REQUIRED = {"estimate.launch": ["arm:=online_200mm"], "replay.launch": ["bag:=/a/recording.bag"],
            "diagnose.launch": ["arm:=online_200mm"]}
MAIN = {"diagnose.launch": "diagnose_node"}  # of the others: the estimator


class LaunchFiles(unittest.TestCase):
    def files(self):
        names = sorted(n for n in os.listdir(FOLDER) if n.endswith(".launch"))
        self.assertTrue({"demo.launch", "diagnose.launch", "estimate.launch", "replay.launch"} <= set(names))
        return names

    def load(self, name, arguments):
        return roslaunch.config.load_config_default([(os.path.join(FOLDER, name), arguments)], None)

    def test_every_file_loads(self):
        for name in self.files():
            config = self.load(name, REQUIRED.get(name, []))
            self.assertEqual(config.config_errors, [], name)
            self.assertIn(MAIN.get(name, "estimator_node"), {node.type for node in config.nodes}, name)
            for node in config.nodes:  # the programs exist
                self.assertTrue(roslib.packages.find_node(node.package, node.type), "%s: %s" % (name, node.type))

    def test_required_arguments_are_asked_for(self):
        for name in REQUIRED:
            with self.assertRaises(roslaunch.core.RLException) as caught:
                self.load(name, [])
            self.assertIn(REQUIRED[name][0].split(":=")[0], str(caught.exception))

    def test_every_argument_is_documented(self):
        for name in self.files():
            for arg in ElementTree.parse(os.path.join(FOLDER, name)).getroot().findall("arg"):
                if "value" not in arg.attrib:  # those with a value are not the user's
                    self.assertGreater(len(arg.get("doc", "")), 8, "%s: %s" % (name, arg.get("name")))


if __name__ == "__main__":
    rostest.unitrun("softarm_estimator", "launch_files", LaunchFiles, sys.argv)
