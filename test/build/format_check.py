#!/usr/bin/python3
"""Our C++ is formatted as .clang-format says."""
import shutil
import subprocess
import sys

import tree

source, _ = tree.directories()
if not shutil.which("clang-format"):
    tree.lacks("no clang-format here (Debian package clang-format)")
names = [name for name in tree.files(source) if name.endswith((".h", ".cpp"))]
if not names:
    sys.exit("no C++ found")
run = subprocess.run(["clang-format", "--dry-run", "-Werror", "--style=file", *names], cwd=source,
                     stderr=subprocess.PIPE, encoding="utf-8", check=False)
unformatted = sorted({line.split(":")[0] for line in run.stderr.splitlines() if "error:" in line})
if run.returncode and not unformatted:
    sys.exit(run.stderr)
tree.finish([f"{name}: run clang-format -i on it" for name in unformatted], "unformatted files")
