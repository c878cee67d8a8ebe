#!/usr/bin/python3
"""scripts/lib.sh looks for younger files only among the inputs that it names: all that the build reads is there."""
import os
import re
import subprocess
import sys

import tree

source, build = tree.directories()
with open(os.path.join(source, "scripts/lib.sh"), encoding="utf-8") as text:
    lists = dict(re.findall(r"^(PROGRAMS_INPUTS|ALL_INPUTS)=\((.*)\)$", text.read(), re.M))
programs = set(lists["PROGRAMS_INPUTS"].split())
everything = programs | set(lists["ALL_INPUTS"].split()[1:])
findings = [f"{name}: named in scripts/lib.sh, not there" for name in sorted(everything)
            if not os.path.exists(os.path.join(source, name))]

if not os.path.exists(os.path.join(build, "build.ninja")):
    tree.skip("this build is not ninja's")
graph = subprocess.run(["ninja", "-C", build, "-t", "graph", "programs"], stdout=subprocess.PIPE, check=True,
                       encoding="utf-8").stdout
reached = set(re.findall(r'label="(.+?)"', graph))


def top(path):
    """The first folder of a path inside the checkout, outside of the build folder; None elsewhere."""
    path = os.path.realpath(os.path.join(build, path))
    if not path.startswith(source + os.sep) or path.startswith(build + os.sep):
        return None
    return os.path.relpath(path, source).split(os.sep)[0]


depfiles = tree.dependencies(build)
used = {path: top(path) for name, paths in depfiles.items() for path in paths}
used.update({path: top(path) for path in reached})
findings += [f"{path} is compiled, but {folder} is not among ALL_INPUTS of scripts/lib.sh"
             for path, folder in sorted(used.items()) if folder and folder not in everything]
of_programs = {path for name, paths in depfiles.items() if name in reached for path in paths} | reached
findings += [f"{path} is compiled into a program, but {used[path]} is not among PROGRAMS_INPUTS of scripts/lib.sh"
             for path in sorted(of_programs) if used[path] and used[path] not in programs]
if not any(used[path] == "src" for path in of_programs):
    sys.exit("no source of a program found: this check sees nothing")
tree.finish(findings, "inputs of the build that the scripts overlook")
