#!/usr/bin/python3
"""Doxygen reads the public headers without a warning."""
import os
import shutil
import subprocess
import sys
import tempfile

import tree

source, _ = tree.directories()
if not shutil.which("doxygen"):
    tree.lacks("no doxygen here (Debian package doxygen)")
with open(os.path.join(source, "doc/Doxyfile"), encoding="utf-8") as file:
    settings = file.read()
with tempfile.TemporaryDirectory() as out:
    run = subprocess.run(["doxygen", "-"], input=f"{settings}\nOUTPUT_DIRECTORY = {out}\n", cwd=source, check=False,
                         stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, encoding="utf-8")
    pages = sum(name.endswith("_8h.html") for _, _, files in os.walk(out) for name in files)
if "unsupported tag" in run.stderr:
    tree.skip("this doxygen is older than doc/Doxyfile, and warns of other things")
headers = [name for name in tree.files(source) if name.startswith("include/") and name.endswith(".h")]
if run.returncode or pages < len(headers):
    sys.exit(f"doxygen made {pages} pages of {len(headers)} headers\n{run.stderr}")
findings = [line.replace(source + "/", "") for line in run.stderr.splitlines() if line.strip()]
tree.finish(findings, "warnings of doxygen")
