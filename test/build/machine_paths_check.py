#!/usr/bin/python3
"""No path of somebody's machine stands in the tree: it works from any checkout, for any user. In a fresh checkout (SOFTARM_FRESH_CHECKOUT)
nor does anything stand at its top that was left there, by a test for one; in anybody else's that is theirs, and not looked at."""
import os
import re
import sys

import tree

PATHS = re.compile(rb"(?<![\w.$}])/(?:work|root|home|farm)/")

TOP = set(""".ci .clang-format .dockerignore .gitignore CHANGELOG.rst CITATION.cff CMakeLists.txt CONTRIBUTING.md Dockerfile LICENSE
README.md bench cmake config doc include launch msg package.xml python rviz scripts src srv test third_party""".split())

source, _ = tree.directories()
if not PATHS.search(b" /" + b"root/x"):
    sys.exit("the pattern finds nothing")
findings = []
for name in tree.files(source):
    if name.split("/")[0] not in TOP:
        if os.environ.get("SOFTARM_FRESH_CHECKOUT"):
            findings.append(f"{name!r}: does not belong at the top of the tree")
        continue
    with open(os.path.join(source, name), "rb") as content:
        text = content.read()
    if b"\0" in text or name == os.path.relpath(os.path.realpath(__file__), source):
        continue
    for number, line in enumerate(text.splitlines(), 1):
        if PATHS.search(line):
            findings.append(f"{name}:{number}: {line.decode(errors='replace').strip()[:150]}")
tree.finish(findings, "machine paths and strays")
