"""What the checks of this folder share: files of the tree, depfiles of the build, and how a check ends.

Every check is called as `<check>.py SOURCE_DIR BUILD_DIR`, prints one line per finding and exits with 1 where there
are any, 77 (skipped) where its tool is absent. On a fresh checkout (SOFTARM_FRESH_CHECKOUT=1, .ci/run) that is a failure: scripts/test
has just installed the tools, and a check that does not run would not be missed.
"""
import os
import re
import subprocess
import sys
import unittest

SKIPPED = 77


def directories():
    source, build = (os.path.realpath(path) for path in sys.argv[1:3])
    return source, build


def files(source):
    """Paths, relative to the source folder, of what git tracks or would track, or of everything in a tree without git."""
    listed = subprocess.run(["git", "-C", source, "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
                            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
    if listed.returncode == 0:
        names = set(os.fsdecode(listed.stdout).split("\0")) - {""}
    else:
        names = {os.path.relpath(os.path.join(folder, name), source)
                 for folder, _, found in os.walk(source) for name in found}
        names = {name for name in names if not re.match(r"(build|\.git)(/|$)", name)}
    return sorted(name for name in names if os.path.isfile(os.path.join(source, name)))


def dependencies(build):
    """Maps each object file and precompiled header of the build (relative path) to the files that it was made from."""
    if os.path.exists(os.path.join(build, "build.ninja")):
        text = subprocess.run(["ninja", "-C", build, "-t", "deps"], stdout=subprocess.PIPE, check=True,
                              encoding="utf-8").stdout
        blocks = re.findall(r"^(\S.*?\.(?:o|gch)): #deps.*\n((?:    .*\n)*)", text, re.M)
        read = {name: [line.strip() for line in lines.splitlines()] for name, lines in blocks}
    else:
        read = {}
        for folder, _, names in os.walk(build):
            for name in (n for n in names if n.endswith((".o.d", ".gch.d"))):
                with open(os.path.join(folder, name), encoding="utf-8") as depfile:
                    words = depfile.read().replace("\\\n", " ").split(":", 1)[1].split()
                read[os.path.relpath(os.path.join(folder, name[:-2]), build)] = words
    return {name: [os.path.realpath(os.path.join(build, path)) for path in paths] for name, paths in read.items()}


def objects_of(build, target):
    """The dependencies of one target's objects; ends the check where there are none, as nothing would be checked."""
    found = {name: paths for name, paths in dependencies(build).items() if f"/{target}.dir/" in f"/{name}"}
    if not found:
        sys.exit(f"{target}: no depfiles in {build}; build it first")
    return found


def finish(findings, what):
    for finding in findings:
        print(finding)
    if findings:
        sys.exit(f"{what}: {len(findings)} finding(s)")
    print(f"{what}: none")


def skip(why):
    print(f"skipped: {why}")
    sys.exit(SKIPPED)


def fresh_checkout():
    return bool(os.environ.get("SOFTARM_FRESH_CHECKOUT"))


def lacks(what):
    """Ends a check without something that scripts/test installs or builds."""
    if fresh_checkout():
        sys.exit(f"{what}: scripts/test should have installed or built it")
    skip(what)


def skip_unless_there(there, what):
    """As a decorator: the same of one test of a check."""
    if there or fresh_checkout():  # then the test fails by itself
        return lambda test: test
    return unittest.skip(what)
