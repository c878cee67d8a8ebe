#!/usr/bin/python3
"""catkin_lint finds nothing, warnings included."""
import os
import shutil
import subprocess
import sys

import tree

source, _ = tree.directories()
if not shutil.which("catkin_lint"):
    tree.lacks("no catkin_lint here (Debian package catkin-lint)")
# Offline: what it reports must not depend on a rosdep database that may be on this machine or not.
run = subprocess.run(["catkin_lint", "-W1", "--strict", "--offline", source], encoding="utf-8", check=False,
                     stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                     env={**os.environ, "PATH": "/usr/sbin:/usr/bin:/sbin:/bin:" + os.environ["PATH"]})
print(run.stdout, end="")
if "checked 1 packages" not in run.stdout:
    sys.exit("catkin_lint did not look at the package")
sys.exit(run.returncode)
