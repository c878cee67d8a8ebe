#!/usr/bin/python3
"""Compares the speed of the module with that of the program over the same bags: frames per second, and their ratio.

    scripts/python scripts/bench_python.py trial.bag [...] [--arm online_200mm] [--runs 7] [--json FILE]

Both take turns on one bag at a time, and read it from the start. The program's rate is the one that it prints itself, without its
start; the program also writes estimates.csv. The module's run makes arrays. Both watch for alarms.
"trial" is the rate over a trial that was read beforehand. "cpu" counts all of the processor's time, including the program's start;
other work on the machine disturbs it less. All figures are medians of the runs.
"""
import argparse
import json
import os
import re
import resource
import statistics
import subprocess
import tempfile
import time

from softarm_module import softarm

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def used(who):
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime


def timed(who, call):
    """Wall and processor's seconds."""
    wall, cpu = time.perf_counter(), used(who)
    call()
    return time.perf_counter() - wall, used(who) - cpu


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bags", nargs="+")
    parser.add_argument("--arm", default="online_200mm")
    parser.add_argument("--runs", type=int, default=7)
    parser.add_argument("--program", default=os.path.join(ROOT, "build", "install", "lib", "softarm_estimator", "softarm"))
    parser.add_argument("--json")
    arguments = parser.parse_args()

    arm = softarm.load_arm(arguments.arm)
    frames = [len(one) for one in softarm.estimate_bags(arm, arguments.bags, jobs=1)]
    trials = softarm.read_bags(arm, arguments.bags, jobs=1)
    times = {"program": [], "module": [], "trial": []}
    with tempfile.TemporaryDirectory() as out:
        command = [arguments.program, "estimate", "--arm", arguments.arm, *arguments.bags, "--jobs", "1", "--out", out, "--force"]
        printed = []

        def program():
            text = subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
            printed.append(sum(n / float(rate) for n, rate in zip(frames, re.findall(r"^frames_per_s: (\S+)", text, re.M))))

        for _ in range(arguments.runs):
            cpu = timed(resource.RUSAGE_CHILDREN, program)[1]
            times["program"].append((printed[-1], cpu))
            times["module"].append(timed(resource.RUSAGE_SELF, lambda: softarm.estimate_bags(arm, arguments.bags, jobs=1)))
            times["trial"].append(timed(resource.RUSAGE_SELF, lambda: [softarm.estimate(trial) for trial in trials]))
    found = {"frames": sum(frames)}
    for k, clock in enumerate(("wall", "cpu")):
        for name, pairs in times.items():
            found[f"{name}_frames_per_{clock}_s"] = sum(frames) / statistics.median(pair[k] for pair in pairs)
        found[f"ratio_{clock}"] = found[f"module_frames_per_{clock}_s"] / found[f"program_frames_per_{clock}_s"]
    for name, value in found.items():
        print(f"{name:<28} {value:10.2f}" if "ratio" in name else f"{name:<28} {value:10.0f}")
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump(found, file, indent=1)


if __name__ == "__main__":
    main()
