#!/usr/bin/python3
"""Our C++ is formatted as .clang-format says."""
import re
import shutil
import subprocess
import sys

import tree

DEVELOPED_WITH = 14  # Debian 12's

source, _ = tree.directories()
if not shutil.which("clang-format"):
    tree.lacks("no clang-format here (Debian package clang-format)")
said = subprocess.run(["clang-format", "--version"], stdout=subprocess.PIPE, encoding="utf-8", check=True).stdout
version = re.search(r"version (\d+)", said)
if version and int(version.group(1)) > DEVELOPED_WITH:
    tree.skip(f"clang-format {version.group(1)} formats otherwise than {DEVELOPED_WITH}")
names = [name for name in tree.files(source) if name.endswith((".h", ".cpp"))]
if not names:
    sys.exit("no C++ found")
run = subprocess.run(["clang-format", "--dry-run", "-Werror", "--style=file", *names], cwd=source,
                     stderr=subprocess.PIPE, encoding="utf-8", check=False)
unformatted = sorted({line.split(":")[0] for line in run.stderr.splitlines() if "error:" in line})
if run.returncode and not unformatted:
    sys.exit(run.stderr)
tree.finish([f"{name}: run clang-format -i on it" for name in unformatted], "unformatted files")
