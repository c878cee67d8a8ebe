#!/usr/bin/python3
"""The wall: the virtual rig and the model under test share no code, or data made by the rig would prove nothing.

Reads the include directives of both sides, and what the compiler really read for each of their object files. It also
holds the dependencies within the core pointing one way: arm and rod know nothing of the rooms that use them.
"""
import os
import re

import tree

CORE_ROOMS = ("math", "arm", "rod", "fit", "trial", "identify", "effects", "diagnose")
FORBIDDEN = {"rig": CORE_ROOMS + ("ros", "apps")}
FORBIDDEN.update({room: ("rig", "ros", "apps") for room in CORE_ROOMS})
FORBIDDEN["arm"] += ("rod", "fit", "trial", "identify", "effects", "diagnose")
FORBIDDEN["rod"] += ("fit", "trial", "identify", "effects", "diagnose")


def room_of(path):
    found = re.search(r"(?:^|/)(?:include/softarm|src|test)/([a-z]+)/", path)
    return found.group(1) if found else None


source, build = tree.directories()
findings = []
for name in tree.files(source):
    room = room_of(name)
    if room not in FORBIDDEN or not name.endswith((".h", ".cpp")) or name.startswith("test/"):
        continue
    with open(os.path.join(source, name), encoding="utf-8") as text:
        for number, line in enumerate(text, 1):
            include = re.match(r'\s*#\s*include\s*[<"](.+?)[>"]', line)
            if not include:
                continue
            # Both "softarm/rod/rod.h" and a way round by relative path.
            path = os.path.normpath(os.path.join("/", os.path.dirname(name), include.group(1)))
            found = re.search(r"softarm/([a-z]+)/", include.group(1))
            other = found.group(1) if found else room_of(path)
            if other in FORBIDDEN[room]:
                findings.append(f"{name}:{number}: {room} includes {include.group(1)}")

for target, rooms in (("softarm_rig", ("rig",)), ("softarm_core", CORE_ROOMS)):
    for name, paths in tree.objects_of(build, target).items():
        for path in paths:
            inside = os.path.relpath(path, source)
            room = room_of(inside) if not inside.startswith("..") else None
            if room and room not in rooms:
                findings.append(f"{name} was compiled from {inside}")

tree.finish(findings, "includes through the wall between the rig and the model")
