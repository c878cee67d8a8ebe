#!/usr/bin/python3
"""Every command that a page shows runs: in the order of its page, in a folder that looks like a checkout.

Those are the blocks of commands, and what stands within a sentence or a table with the arguments that it is run with. A program, a
command of it or an option that is only named there (`softarm import --leave-out`) is none, nor is what has a place to fill in (NAME, ...).
Those that take long, or a ROS graph, are run with SOFTARM_LONG_TESTS=1 (scripts/test --long); without it, of a launch file
roslaunch lists the nodes. What is never run stands in NOT_RUN, with the reason.
"""
import glob
import importlib.util
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

import tree

COMMAND = re.compile(r"(\w+=\S+ )*(scripts/|build/|softarm |ros\w+ |docker |mkdir |cd |git |catkin_make|source |ninja |eval |"
                     r"python3 |sed )")
INLINE = re.compile(r"(\w+=\S+ )*(scripts/softarm [\w-]+|scripts/(?!softarm )\S+|softarm [\w-]+|roslaunch|ros(topic|service|bag) \w+|ninja|rig_accuracy)"
                    r"( -\S+)*( [^-\s].*)")
PLACE = re.compile(r"(?<![\w$-])[A-Z]+\b|\.\.\.")
ROS = re.compile(r"(\w+=\S+ )*(roslaunch(?! --)|rostopic|rosservice|rosbag) ")
NOT_RUN = [
    (r"docker ", "there is no Docker here; build.dockerfile carries out the steps of the Dockerfile"),
    (r"(\w+=\S+ )*scripts/test\b", "it is what runs this test"),
    (r"scripts/(bench|python scripts/bench_python\.py)\b", "speed is not measured in a test"),
    (r"scripts/fuzz\b", "long.fuzz is it"),
    (r".*…", "abridged: scripts/plot_real_trunk.py has the whole of it"),
    (r"softarm (estimate|diagnose) --arm both\.yaml ", "goes on from the one that is abridged"),
    (r"softarm estimate --arm pouch_arm_one_segment whole/", "goes on from scripts/plot_real_arms.py"),
    (r"scripts/real_interventions\.py", "twenty minutes; scripts/prove --worlds real replaces it"),
    (r"scripts/solid_arm --(cases|checks)", "some ten minutes of a finite-element solver a case"),
    (r"scripts/prove\b", "half an hour to hours; build.prove_* check its parts"),
    (r"rig_accuracy --effects", "minutes, and two effects are above its bound since steps and elements became fewer, as the page says"),
    (r"scripts/table_rig_effects\.py", "goes on from it"),
    (r"ninja -C build/sanitize", "an hour of compiling with sanitizers"),
]
if importlib.util.find_spec("matplotlib") is None and not tree.fresh_checkout():
    NOT_RUN.append((r"scripts/plot_\w+\.py", "python3-matplotlib, which it wants, is not installed"))
LONG = [
    r"scripts/demo\b", r"scripts/accuracy\b", r"ninja ", r"build/test/estimate_test", r"catkin_make", r"git clone", r"mkdir -p ws", r"source devel/",
    r"scripts/softarm validate", r"scripts/plot_real_\w+\.py", r"scripts/solid_arm ", r"scripts/softarm campaign development --cases 20",
    r"softarm \w+ .*campaign/case_001", r"softarm campaign worked_example", r"scripts/softarm diagnose .*(campaign/case_001|bags/)",
    r"softarm diagnose --arm one\.yaml", r"softarm identify .*test/data/solid", r"scripts/softarm batch --engine slurm",
    r"scripts/plot_validation\.py", r"rig_accuracy ", r"scripts/plot_rig\.py",  # these go on from validate and rig_accuracy
    r"softarm identify --arm tendon_trunk work/decay", r"scripts/softarm (check|diagnose) --arm my_arm\.yaml trials/\*\.bag +# is the",
]
# What a page takes for given.
GIVEN = {
    "README.md": "trial.csv trials", "doc/batch.md": "my_arm.yaml trials trials.yaml", "doc/check.md": "my_arm.yaml trial.bag trials",
    "doc/commands.md": "my_arm.yaml trial.bag trials trial.csv data_collect_1.txt .zfunc",
    "doc/identify.md": "my_arm.yaml trials", "doc/messages.md": "left.yaml right.yaml", "doc/mismatch.md": "my_arm.yaml",
    "doc/recording.md": "my_arm.yaml trial.bag trial.csv", "doc/rig.md": "doc/images",
    "doc/validation.md": "doc/images doc/validation.md", "doc/real_arms.md": "DATA work 0g.csv control_inputs_controlled_1.csv",
    "doc/solid_arm.md": "bags", "doc/worked_example.md": "my_arm.yaml trials",
}
# What is asked, answered line by line on a terminal.
ANSWERS = {"scripts/softarm new-arm": "chambers 1 0.2 0.2 0.04 3 4 0,120,240 base 0.03 asked.yaml asked_layout.yaml"}
NEW_ARM = ("new-arm --kind chambers --segments 1 --length 0.2 --mass 0.2 --diameter 0.04 --actuators 3 "
           "--bodies ring_1:0.05,ring_2:0.1,ring_3:0.15,ring_4:0.2 --force --out ")

source, build = tree.directories()
long_run = os.environ.get("SOFTARM_LONG_TESTS") == "1"
PROGRAM = os.path.join(build, "devel", "lib", "softarm_estimator", "softarm")


def blocks(name, text):
    """(line, commands) of each block of commands, and of each command within a line, which those of doc/commands.md's tables are."""
    inside, found = None, []
    for number, line in enumerate(text.split("\n"), 1):
        if line.startswith("```"):
            if inside and re.fullmatch(r"```(sh|bash)?", inside[0]):
                found.append((inside[1], commands(inside[2])))
            inside = None if inside else (line, number + 1, [])
        elif inside:
            inside[2].append(line)
        elif name == "doc/commands.md" and line.startswith("|"):
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            for cell in cells[:2]:
                for code in re.findall(r"^`((?:scripts/softarm|roslaunch) [^`]*)`$", cell):
                    found.append((number, [code]))
        else:
            found += [(number, [code]) for code in re.findall(r"`([^`]*)`", line) if INLINE.fullmatch(code) and not PLACE.search(code)]
    return [(number, listed) for number, listed in found if listed]


def commands(lines):
    """The commands of a block: those after a $ where there are such; none where it is something else."""
    transcript = [line[2:] for line in lines if line.startswith("$ ")]
    joined = re.sub(r"\\\n\s*", "", "\n".join(transcript or lines)).split("\n")
    listed = [line for line in joined if line.strip() and not line.startswith("#")]
    return listed if all(COMMAND.match(line) for line in listed) else []


def matching(rules, command):
    return next((rule for rule in rules if re.match(rule[0] if isinstance(rule, tuple) else rule, command)), None)


def recording(path):
    """A recording as CSV, in the columns that `new-arm` writes a layout for: an arm of constant curvature that bends."""
    names = ["time_s"] + [f"{body}_{axis}" for body in ("base", "ring_1", "ring_2", "ring_3", "ring_4")
                          for axis in ("x", "y", "z", "qx", "qy", "qz", "qw")] + ["p1_kPa", "p2_kPa", "p3_kPa"]
    with open(path, "w", encoding="utf-8") as file:
        print(",".join(names), file=file)
        for i in range(1200):
            bent = 0.5 + 0.4 * math.sin(0.01 * i)  # pressure, against a curvature
            k = 6.0 * bent
            row = [i / 120.0]
            for s in (0.0, 0.05, 0.1, 0.15, 0.2):
                turn = math.pi - k * s  # hanging
                row += [(1 - math.cos(k * s)) / k, 0.0, 1.0 - math.sin(k * s) / k, 0.0, math.sin(turn / 2), 0.0, math.cos(turn / 2)]
            print(",".join(f"{value:.6f}" for value in row + [40.0 * bent, 0.0, 0.0]), file=file)


class Folder:
    """A folder in which a page's commands run, with what they take for given."""

    def __init__(self, page):
        self.path = tempfile.mkdtemp(dir=build, prefix="page_commands_")
        os.mkdir(self.at("scripts"))
        for script in os.listdir(os.path.join(source, "scripts")):
            target = os.path.join(source, "scripts", script)
            if os.access(target, os.X_OK) and not script.endswith(".py"):
                with open(self.at("scripts", script), "w", encoding="utf-8") as wrapper:
                    wrapper.write(f'#!/bin/bash\nexec "{target}" "$@"\n')
                os.chmod(self.at("scripts", script), 0o755)
            elif os.path.isfile(target):
                os.symlink(target, self.at("scripts", script))
        for name in ("config", "test", "python"):
            os.symlink(os.path.join(source, name), self.at(name))
        os.symlink(build, self.at("build"))
        for name in GIVEN.get(page, "").split():
            self.give(name)

    def at(self, *names):
        return os.path.join(self.path, *names)

    def softarm(self, arguments):
        subprocess.run([PROGRAM, *arguments.split()], cwd=self.path, stdout=subprocess.DEVNULL, check=True)

    def give(self, name):
        data = os.environ.get("SOFTARM_DATA", "")
        if name.endswith("m.yaml") or name in ("left.yaml", "right.yaml"):
            self.softarm(NEW_ARM + name)
        elif name == "trials":
            os.mkdir(self.at(name))
            arm = self.at("given_arm.yaml")
            self.softarm(NEW_ARM + arm)
            for seed in (1, 2, 3):
                self.softarm(f"simulate {arm} --seconds 8 --seed {seed} --out trials/trial_{seed}.bag")
        elif name == "bags":
            os.mkdir(self.at(name))
        elif name == "trial.bag":
            self.softarm("simulate demo --seconds 30 --out trial.bag")
        elif name == "trial.csv":
            recording(self.at(name))
        elif name == "trials.yaml":
            with open(self.at(name), "w", encoding="utf-8") as file:
                file.write("arm: my_arm.yaml\njobs:\n  - trials\n")
        elif name == "DATA":
            os.symlink(data, self.at(name))
        elif name in ("0g.csv", "control_inputs_controlled_1.csv"):
            original = "observations_controlled_1.csv" if name == "0g.csv" else name
            os.symlink(os.path.join(data, "tendon_trunk", original), self.at(name))
        elif name == "doc/validation.md":
            shutil.copy(os.path.join(source, name), self.at(name))
        elif name == "data_collect_1.txt":
            os.symlink(os.path.join(data, "pouch_arm/one_segment/no_load", name), self.at(name))
        else:
            os.makedirs(self.at(name))

    def give_again(self, page, listed):
        """What `rosbag record` has written over, which had nothing to record."""
        if any(command.startswith("rosbag record -O trial.bag") for command in listed) and "trial.bag" in GIVEN.get(page, "").split():
            self.softarm("simulate demo --seconds 30 --force --out trial.bag")

    def left_in_a_checkout(self):
        """What commands wrote at the top of a checkout that git would take for the package's: the tests look at its files."""
        own = {"scripts", "config", "test", "python", "build", "said", "ros_home", "jobs", "given_arm.yaml", "given_arm_layout.yaml"}
        names = [name + "/" * os.path.isdir(self.at(name)) for name in sorted(os.listdir(self.path))
                 if name not in own and not name.endswith(".log")]
        ignored = subprocess.run(["git", "-C", source, "check-ignore", "--no-index", *names], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                                 encoding="utf-8", check=False)
        return [] if ignored.returncode > 1 else [name for name in names if name not in ignored.stdout.split("\n")]


class Block:
    """Runs one block in a shell of its own; `failed` is what went wrong."""

    def __init__(self, folder, page, number, listed, in_table):
        self.folder, self.where = folder, f"{page}:{number}"
        self.graph = long_run and any(ROS.match(command) for command in listed)
        self.failed, self.ran, self.left = [], 0, 0
        script = ["set -o pipefail", f'source "{build}/install/setup.bash"', f'export PATH="{os.path.dirname(PROGRAM)}:$PATH"']
        if self.graph:
            script += ["roscore -p $PORT > roscore.log 2>&1 &", "until rosparam list > /dev/null 2>&1; do sleep 0.2; done"]
        for command in listed:
            script += self.lines(command, in_table)
        if self.graph:
            script += ["jobs -p > jobs", "kill -INT $(jobs -p) 2> /dev/null", "wait"]
        if self.ran:
            self.run("\n".join(script))

    def lines(self, command, in_table):
        if matching(NOT_RUN, command) or (not long_run and matching(LONG, command)):
            self.left += 1
            return []
        command = command.replace("git clone REPOSITORY_URL", f"git clone -q {source}").split("  #")[0].rstrip()
        written = re.search(r" --out (\S+)", command)
        before = [f"rm -rf {written.group(1)}"] if in_table and written else []
        said = f"echo '@@' {self.quoted(command)} >&2"
        if ROS.match(command) and not long_run:
            if "roslaunch " not in command:
                self.left += 1
                return []
            command = command.replace("roslaunch ", "roslaunch --nodes ", 1)
        elif ROS.match(command) and "roslaunch " in command:
            log = f"launched_{self.ran}.log"
            self.ran += 1
            return [*before, said, f"{command} > {log} 2>&1 &", "sleep 8", f"grep -q 'started with pid' {log} || {{ cat {log} >&2; exit 1; }}",
                    f"! grep -E 'process has died|Traceback|ERROR' {log} >&2 || exit 1"]
        elif ROS.match(command) and "rosservice" not in command:
            command = f"{{ timeout -s INT 6 {command} || [ $? = 124 ]; }}"
        elif command in ANSWERS:
            command = f"printf '%s\\n' {ANSWERS[command]} | script -qec '{command}' /dev/null"
            self.ran += 1
            return [*before, said, f"{command} || exit 1"]
        self.ran += 1
        return [*before, said, f"{command} {'' if ROS.match(command) else '< /dev/null'} || exit 1"]

    @staticmethod
    def quoted(text):
        return "'" + text.replace("'", "'\\''") + "'"

    def run(self, script):
        environment = {**os.environ, "SOFTARM_BUILD_DIR": build, "HOME": self.folder.path, "ROS_HOME": self.folder.at("ros_home"),
                       "PORT": str(12000 + os.getpid() % 20000), "CCACHE_DIR": os.environ.get("CCACHE_DIR", os.path.join(build, "ccache"))}
        environment.update(ROS_MASTER_URI=f"http://localhost:{environment['PORT']}", ROS_IP="127.0.0.1")
        shell = ["bash", "-c", script]
        if self.graph and shutil.which("xvfb-run"):
            shell = ["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24", *shell]
        with open(self.folder.at("said"), "w+", encoding="utf-8") as said:
            begun = time.time()
            done = subprocess.run(shell, cwd=self.folder.path, env=environment, stdout=said, stderr=subprocess.STDOUT,
                                  stdin=subprocess.DEVNULL, check=False)
            said.seek(0)
            lines = said.read().split("\n")
        if time.time() - begun > 5.0:
            print(f"{self.where}: {time.time() - begun:.0f} s")
        if done.returncode:
            last = max((i for i, line in enumerate(lines) if line.startswith("@@ ")), default=0)
            self.failed.append(f"{self.where}: status {done.returncode}: {lines[last][3:]}\n  " +
                               "\n  ".join(line for line in lines[last + 1:] if line.strip())[-1500:])


def main():
    if not os.path.exists(PROGRAM) or not os.path.exists(os.path.join(build, "install", "setup.bash")):
        tree.skip("there is no program, or it is not installed")
    data = os.path.isdir(os.path.join(os.environ.get("SOFTARM_DATA", ""), "pouch_arm"))
    findings, counts, used = [], {"run": 0, "left": 0}, set()
    for page in tree.files(source):
        if not page.endswith(".md") or page.startswith("third_party/"):
            continue
        if len(sys.argv) > 3 and page not in sys.argv[3:]:
            continue
        with open(os.path.join(source, page), encoding="utf-8") as file:
            found = blocks(page, file.read())
        for command in (command for _, listed in found for command in listed):
            used |= {rule for rule in (matching(NOT_RUN, command), matching(LONG, command)) if rule}
        if not found or (not data and page == "doc/real_arms.md"):
            continue
        folder = Folder(page)
        for number, listed in found:
            if not data and "data_collect_1.txt" in listed[0]:
                continue
            block = Block(folder, page, number, listed, page == "doc/commands.md" and len(listed) == 1)
            findings += block.failed
            if block.graph:
                folder.give_again(page, listed)
            counts["run"] += block.ran
            counts["left"] += block.left
        if page == "README.md":
            findings += [f"{page}: {name}: .gitignore does not have what its commands write" for name in folder.left_in_a_checkout()]
        shutil.rmtree(folder.path)
    if len(sys.argv) <= 3:
        findings += [f"a rule that no command needs: {rule}" for rule in (*NOT_RUN, *LONG) if rule not in used]
        if counts["run"] < 40:
            sys.exit(f"only {counts['run']} commands were run: this check does not find them")
    print(f"{counts['run']} commands run, {counts['left']} left out")
    tree.finish(findings, "commands of the pages that fail")


main()
