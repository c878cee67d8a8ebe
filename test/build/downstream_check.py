#!/usr/bin/python3
"""Another catkin package, test/downstream, finds what is installed, builds with the public headers alone, and runs."""
import os
import re
import shutil
import subprocess
import sys

import tree

source, build = tree.directories()
with open(os.path.join(build, "CMakeCache.txt"), encoding="utf-8") as text:
    cache = dict(re.findall(r"^(\w+):\w+=(.*)$", text.read(), re.M))
if cache.get("SOFTARM_WITH_ROS") != "ON":
    tree.skip("built without ROS, so there is no catkin package")


def run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8", check=False,
                          env={**os.environ, "PATH": "/usr/sbin:/usr/bin:/sbin:/bin:" + os.environ["PATH"]})
    print(done.stdout, end="")
    if done.returncode:
        sys.exit(f"{' '.join(command)}: exit status {done.returncode}")
    return done.stdout


# The install space, where that belongs to this build; else the devel space.
prefix = os.path.realpath(cache["CMAKE_INSTALL_PREFIX"])
if prefix.startswith(build + os.sep):
    subprocess.run(["cmake", "--install", build], stdout=subprocess.DEVNULL, check=True)
else:
    prefix = os.path.join(build, "devel")

here = os.path.join(build, "downstream")
shutil.rmtree(here, ignore_errors=True)
# Optimised as little as its author may like: the library's speed does not depend on it, nor do its answers.
run("cmake", "-S", os.path.join(source, "test/downstream"), "-B", here, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
    "-DCMAKE_CXX_FLAGS_RELEASE=-O1", f"-DCMAKE_PREFIX_PATH={prefix}", "-DPYTHON_EXECUTABLE=/usr/bin/python3")
run("ninja", "-C", here)
program = os.path.join(here, "devel/lib/softarm_downstream/estimate_and_diagnose")

linked = run("ldd", program)
wanted = re.search(r"libsoftarm_core\.so\.\d+\.\d+ => (\S+)", linked)
if not wanted or not os.path.realpath(wanted.group(1)).startswith(prefix + os.sep):
    sys.exit("it is not linked to the libsoftarm_core.so of " + prefix)
read = re.findall(r"(\S+\.h)\b", subprocess.run(["ninja", "-C", here, "-t", "deps"], stdout=subprocess.PIPE, check=True,
                                                encoding="utf-8").stdout)
findings = [f"{path} was read: private" for path in read if os.path.realpath(path).startswith(source + "/src/")]
public = {name[len("include/"):] for name in tree.files(source) if name.startswith("include/")}
used = {match.group(1) for match in (re.search(r".*/include/(softarm/.*)", path) for path in read) if match}
findings += [f"include/{name} is read by nobody here: use it, or make it private" for name in sorted(public - used)]
run(program, os.path.join(source, "config/arms/online_200mm.yaml"))
tree.finish(findings, "headers that a downstream package reads")
