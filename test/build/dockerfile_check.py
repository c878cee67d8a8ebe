#!/usr/bin/python3
"""The Dockerfile makes an image that works: its steps, carried out in a root folder of Debian's, as there is no Docker here.

One of the long tests (scripts/test --long): it downloads Debian's packages and compiles everything. Needs root.
SOFTARM_DEBIAN_DIR names another folder than dockerfile/ of the build. Where CCACHE_DIR is set, the compiler's results are kept
there: the root folder then also has ccache.
"""
import json
import os
import re
import shlex
import shutil
import subprocess
import sys

import tree

CODENAMES = {"debian:12": "bookworm"}

source, build = tree.directories()
folder = os.environ.get("SOFTARM_DEBIAN_DIR") or os.path.join(build, "dockerfile")
root = os.path.join(folder, "image")
cache = os.environ.get("CCACHE_DIR")


def shell(*words):
    """Runs functions of scripts/debian_root.sh."""
    script = 'source "$0/scripts/lib.sh"; source "$0/scripts/debian_root.sh"; "$@"'
    return subprocess.run(["bash", "-c", script, source, *words], stdin=subprocess.DEVNULL, check=False,
                          env={**os.environ, "SOFTARM_BUILD_DIR": build}).returncode


def steps(text):
    """(instruction, the rest of its line) of a Dockerfile."""
    text = re.sub(r"\\\n", " ", re.sub(r"^#.*\n", "", text, flags=re.M))
    return [line.split(None, 1) for line in text.splitlines() if line.strip()]


def ignored(path, patterns):
    """Whether .dockerignore leaves a file of the checkout out: a folder at its top, or one of that name anywhere."""
    folders = path.split("/")
    return any(pattern[3:].strip("/") in folders if pattern.startswith("**/") else pattern.strip("/") == folders[0]
               for pattern in patterns)


class Image:
    def __init__(self):
        self.shell, self.environment, self.at, self.command = ["/bin/sh", "-c"], {}, "/", None

    def run(self, words):
        settings = [f"{name}={value}" for name, value in self.environment.items()]
        if cache:
            settings += [f"CCACHE_DIR={cache}", f"CCACHE_BASEDIR={self.at}", "CCACHE_SLOPPINESS=pch_defines,time_macros",
                         "CMAKE_CXX_COMPILER_LAUNCHER=ccache"]
        return shell("in_debian_root", root, *([cache] if cache else []), "--", *settings,
                     "/bin/sh", "-c", 'cd "$0" && exec "$@"', self.at, *words)

    def step(self, name, rest):
        """Carries one step out; returns its exit status."""
        if name == "FROM":
            base = os.path.join(folder, CODENAMES[rest])
            status = shell("debian_root", CODENAMES[rest], base)
            shutil.rmtree(root, ignore_errors=True)
            status = status or subprocess.run(["cp", "-a", base, root], check=False).returncode
            return status or (cache and self.run(["sh", "-c", "apt-get -qq update && apt-get -qq install -y ccache > /dev/null"]))
        if name == "SHELL":
            self.shell = json.loads(rest)
        elif name == "ENV":
            self.environment.update(word.split("=", 1) for word in shlex.split(rest))
        elif name == "WORKDIR":
            self.at = os.path.join(self.at, rest)
            os.makedirs(root + self.at, exist_ok=True)
        elif name == "COPY":
            self.copy(shlex.split(rest))
        elif name == "RUN":
            return self.run([*self.shell, rest])
        elif name == "CMD":
            self.command = json.loads(rest)
        else:
            sys.exit(f"Dockerfile: {name}: this test does not know that step; teach it")
        return 0

    def copy(self, words):
        with open(os.path.join(source, ".dockerignore"), encoding="utf-8") as file:
            patterns = file.read().split()
        *origins, target = words
        target = root + os.path.normpath(os.path.join(self.at, target))
        for origin in origins:
            for name in tree.files(source) if origin == "." else [origin]:
                if ignored(name, patterns):
                    continue
                to = os.path.join(target, name if origin == "." else os.path.basename(name))
                os.makedirs(os.path.dirname(to), exist_ok=True)
                shutil.copy2(os.path.join(source, name), to, follow_symlinks=False)


def main():
    if os.environ.get("SOFTARM_LONG_TESTS") != "1":
        tree.skip("one of the long tests: scripts/test --long")
    if os.getuid() != 0 or not shutil.which("debootstrap"):
        tree.skip("not root, or no debootstrap")
    with open(os.path.join(source, "Dockerfile"), encoding="utf-8") as file:
        listed = steps(file.read())
    os.makedirs(folder, exist_ok=True)
    image, findings = Image(), []
    for name, rest in listed:
        print(f"--- {name} {rest}", flush=True)
        status = image.step(name, rest)
        if status:
            tree.finish([f"Dockerfile: {name} {rest}: exit status {status}"], "steps of the Dockerfile that fail")
    # What is said to work in a container.
    trials = [["scripts/demo", "--headless", "--seconds", "10"], ["scripts/softarm", "--version"],
              [*image.command[:-1], "-ic", "rosrun softarm_estimator softarm --version && rospack find softarm_estimator"]]
    for words in trials:
        print(f"--- {' '.join(words)}", flush=True)
        status = image.run(words)
        if status:
            findings.append(f"docker run ... {' '.join(words)}: exit status {status}")
    tree.finish(findings, "what the image of the Dockerfile does not do")


main()
