#!/usr/bin/python3
"""The core and the rig are built without ROS: no header of a ROS package, no generated message, no include path of either.

A header belongs to a ROS package where its folder under /usr/include has a namesake with a package.xml in /usr/share;
roscpp and its base packages share the folder ros.
"""
import json
import os
import re
import sys

import tree

TARGETS = ("softarm_live", "softarm_study", "softarm_rig")

source, build = tree.directories()
generated = os.path.join(build, "devel", "include") + os.sep


def is_ros(path):
    found = re.match(r"/usr/include/([^/]+)/", path) or re.match(r"/opt/ros/[^/]+/include/([^/]+)/", path)
    if not found:
        return path.startswith(generated)
    package = found.group(1)
    return path.startswith("/opt/ros/") or package == "ros" or os.path.exists(f"/usr/share/{package}/package.xml")


if os.path.exists("/usr/include/ros/ros.h") and not is_ros("/usr/include/ros/ros.h"):
    sys.exit("this check does not recognise /usr/include/ros/ros.h as a header of ROS")

findings = []
for target in TARGETS:
    for name, paths in tree.objects_of(build, target).items():
        findings += [f"{name} was compiled from {path}" for path in paths if is_ros(path)]

with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as text:
    for entry in json.load(text):
        command = entry["command"]
        if not any(f"/{target}.dir/" in f"/{command}" for target in TARGETS):
            continue
        for path in re.findall(r"(?:-I|-isystem)\s*(\S+)", command):
            if is_ros(path + "/"):
                findings.append(f"{entry['file']} is compiled with the include path {path}")

tree.finish(findings, "ROS in the core or the rig")
