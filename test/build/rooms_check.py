#!/usr/bin/python3
"""The rooms of the house: every include goes along an arrow that is allowed, and there is no way round in a circle.

ALLOWED is the plan (doc/architecture.md draws it): a room may use those that stand behind it here, and no others. Read are
the include directives of all rooms, and, for the wall between the virtual rig and the model under test, what the compiler
really read for each object file: data made by a rig that shares code with the model would prove nothing.

`rooms_check.py --picture` prints the plan as doc/architecture.md has it (docs_check.py holds the two equal).
"""
import collections
import os
import re
import sys

import tree

ALLOWED = {
    "math": "",
    "arm": "math",
    "trial": "math arm",
    "rod": "math arm",
    "model": "math arm trial rod",
    "effects": "math arm rod model",
    "estimate": "math arm trial rod model",
    "identify": "math arm trial rod model",
    "check": "math arm trial estimate",
    "monitor": "math arm trial rod estimate",
    "diagnose": "math arm model effects estimate identify",
    "report": "diagnose",
    "published": "arm rod identify",
    "rig": "math",
    "ros": "math arm trial model effects estimate monitor",
    "python": "math arm trial model effects estimate identify check monitor diagnose report ros",
    "apps": "math arm trial rod model effects estimate identify check monitor diagnose report published rig ros",
}
ALLOWED = {room: set(others.split()) for room, others in ALLOWED.items()}
CORE = [room for room in ALLOWED if room not in ("rig", "ros", "python", "apps")]
LIVE = [room for room in CORE if room not in ("identify", "check", "diagnose", "report", "published")]


def room_of(path):
    found = re.match(r"(?:include/softarm|src)/(\w+)/", path)
    return found.group(1) if found and found.group(1) in ALLOWED else None


def circle():
    """Rooms that may use each other in a circle by the plan itself; empty: none."""
    left = {room: set(others) for room, others in ALLOWED.items()}
    while left:
        free = [room for room, others in left.items() if not others]
        if not free:
            return sorted(left)
        for room in free:
            del left[room]
        for others in left.values():
            others.difference_update(free)
    return []


def reachable(room):
    return ALLOWED[room].union(*(reachable(other) for other in ALLOWED[room]))


def picture():
    """The plan in Markdown: a diagram without the arrows that follow from others, and the whole of it as a table."""
    lines = ["```mermaid", "graph BT"]
    for room, others in ALLOWED.items():
        direct = [other for other in ALLOWED if other in others and
                  not any(other in reachable(between) for between in others)]
        lines += [f"  {room} --> {other}" for other in direct] or [f"  {room}"]
    lines += ["```", "", "| room | may include |", "|---|---|"]
    for room, others in ALLOWED.items():
        names = ", ".join(f"`{other}`" for other in ALLOWED if other in others)
        lines.append(f"| `{room}` | {'all others but `python`' if room == 'apps' else names or 'none'} |")
    return "\n".join(lines) + "\n"


if circle():
    sys.exit("the plan has a circle: " + ", ".join(circle()))
if sys.argv[1:] == ["--picture"]:
    print(picture(), end="")
    sys.exit()
source, build = tree.directories()
names = set(tree.files(source))
findings, used = [], collections.Counter()
for name in sorted(names):
    room = room_of(name)
    if name.startswith(("src/", "include/")) and name.endswith((".h", ".cpp")) and not room and name.count("/") > 1 and name != "include/softarm/export.h":
        findings.append(f"{name}: its folder is no room")
    if not room or not name.endswith((".h", ".cpp")):
        continue
    with open(os.path.join(source, name), encoding="utf-8") as text:
        for number, line in enumerate(text, 1):
            include = re.match(r'\s*#\s*include\s*"(.+?)"', line)
            if not include:
                continue
            given = include.group(1)
            for path in (os.path.join(os.path.dirname(name), given), "include/" + given, "src/" + given,
                         "src/apps/" + given):
                path = os.path.normpath(path)
                if path in names:
                    break
            else:
                continue
            other = room_of(path)
            if other and other != room:
                used[room, other] += 1
                if other not in ALLOWED[room]:
                    findings.append(f"{name}:{number}: {room} includes {given} of {other}")

for room, others in ALLOWED.items():
    if room != "apps":
        findings += [f"{room} -> {other} is allowed and not used: take the arrow out of the plan"
                     for other in sorted(others) if not used[room, other] and (room, other) != ("rig", "math")]

for target, rooms in (("softarm_rig", ("rig", "math")), ("softarm_live", LIVE), ("softarm_study", CORE)):
    for name, paths in tree.objects_of(build, target).items():
        for path in paths:
            inside = os.path.relpath(path, source)
            room = room_of(inside)
            if room and room not in rooms:
                findings.append(f"{name} was compiled from {inside}")

if len(sys.argv) > 3 and sys.argv[3] == "--all":
    for (room, other), count in sorted(used.items()):
        print(f"{room} -> {other}: {count}")
tree.finish(findings, "includes against the plan of the rooms")
