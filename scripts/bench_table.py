#!/usr/bin/python3
"""The table and the JSON of scripts/bench, from the results that it left in one folder.

Reads *_bench.json (Google Benchmark), estimate_*.log (the summaries of `softarm estimate`) and the CSVs of the baselines
(last column time_s), diagnose_*.json (seconds and MiB of `softarm diagnose`). Times are medians on one core, in microseconds unless
the key says otherwise; diagnoses use all cores. A figure that was not measured is left out.
"""
import argparse
import csv
import glob
import json
import os
import re
import statistics
import sys

MICROSECONDS = {"ns": 1e-3, "us": 1.0, "ms": 1e3, "s": 1e6}
# Key, meaning, unit and, from the project's goals, the bound (an upper one for times, a lower one for the rest).
ROWS = [
    ("static_solve", "one static solve with its derivatives", "us", 15),
    ("frame_fit_3d", "one frame fit, fully three-dimensional", "us", None),
    ("frame_fit_warm", "one frame fit, from the last frame's", "us", 100),
    ("frame_fit_warm_p99", "  its 99th percentile", "us", 400),
    ("frame_fit_cold", "one frame fit, from nothing", "us", 150),
    ("frame_fit_extended", "one frame fit, two effects in the model", "us", None),
    ("frame_fit_extended_memory", "  two effects, one with memory", "us", None),
    ("frame_fit_extended_ratio", "two effects against none, both warm", "x times", 2),
    ("frame_fit_extended_memory_ratio", "  one with memory", "x times", 4),
    ("mismatch_frame_120hz", "live monitor, one frame at 120 Hz", "us", 5),
    ("mismatch_frame_240hz", "  at 240 Hz", "us", 5),
    ("association_frame", "unlabelled points of one frame to 4 rings", "us", None),
    ("association_hidden_ring", "  60 ghosts, a ring hidden for 50 ms", "us", None),
    ("association_hidden_ring_ratio", "  against 4 ghosts, none hidden", "x times", None),
    ("identify_30_trials_ms", "12 constants from 30 trials", "ms", 1000),
    ("diagnose_tidy_s", "softarm diagnose, nine trials, tidy", "s", 10),
    ("diagnose_untidy_s", "  untidy", "s", 10),
    ("diagnose_unknown_s", "  untidy, and no effect explains it", "s", 30),
    ("diagnose_memory_mib", "  memory, the largest of the three", "MiB", 1024),
    ("offline_frames_per_s", "softarm estimate over a bag", "1/s", None),
    ("python_frames_per_s", "softarm.estimate_bags over the same bag", "1/s", None),
    ("ratio_python_program", "  against softarm estimate", "x", 0.8),
    ("ratio_octave_sqp", "cold fit against Octave sqp", "x", 4000),
    ("ratio_scipy_least_squares", "cold fit against SciPy least_squares", "x", 200),
]

PNEUMATIC = {"online_200mm", "semi_physical_200mm", "pouch_arm_one_segment", "pouch_arm"}


def benchmarks(folder):
    """Median CPU time in microseconds per benchmark name, and its counters as name_counter."""
    found = {}
    for path in sorted(glob.glob(os.path.join(folder, "*_bench.json"))):
        with open(path, encoding="utf-8") as text:
            runs = json.load(text)["benchmarks"]
        medians = {run["run_name"] for run in runs if run.get("aggregate_name") == "median"}
        for run in runs:
            if run.get("error_occurred"):
                sys.exit(f"{path}: {run['name']}: {run.get('error_message', 'failed')}")
            if run["run_name"] in medians and run.get("aggregate_name") != "median":
                continue
            if run.get("aggregate_name", "median") != "median":
                continue
            # BENCHMARK(...)->Iterations(n) and the like append to the name what is not part of it.
            name = run["run_name"].split("/")[0]
            scale = MICROSECONDS[run["time_unit"]]
            # A benchmark of many frames states the median frame itself; its mean would hide the slow ones.
            found[name] = run["median_us"] if "median_us" in run else run["cpu_time"] * scale
            for counter in ("p99_us", "p99"):
                if counter in run:
                    found[f"{name}_p99"] = run[counter]
    return found


def frames_per_second(folder):
    rates = []
    for path in glob.glob(os.path.join(folder, "estimate_*.log")):
        with open(path, encoding="utf-8", errors="replace") as text:
            rates += [float(rate) for rate in re.findall(r"^\s*frames_per_s:\s*([0-9.eE+]+)", text.read(), re.M)]
    return statistics.median(rates) if rates else None


def diagnoses(folder):
    found = {}
    for path in glob.glob(os.path.join(folder, "diagnose_*.json")):
        with open(path, encoding="utf-8") as text:
            measured = json.load(text)
        found[os.path.basename(path)[: -len(".json")] + "_s"] = measured["s"]
        found["diagnose_memory_mib"] = max(measured["mib"], found.get("diagnose_memory_mib", 0.0))
    return found


def python_module(folder):
    path = os.path.join(folder, "python.json")
    if not os.path.exists(path):
        return {}
    with open(path, encoding="utf-8") as text:
        measured = json.load(text)
    return {"python_frames_per_s": measured["module_frames_per_wall_s"], "ratio_python_program": measured["ratio_wall"]}


def baseline_us(path):
    if not os.path.exists(path):
        return None
    with open(path, encoding="utf-8", newline="") as text:
        times = [float(row["time_s"]) for row in csv.DictReader(text)]
    return 1e6 * statistics.median(times) if times else None


def verdict(unit, value, bound):
    if bound is None:
        return ""
    upper = unit in ("us", "ms", "s", "MiB", "x times")
    met = value <= bound if upper else value >= bound
    return f"{'at most' if upper else 'at least'} {bound:,}: {'met' if met else 'NOT MET'}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--json", metavar="FILE")
    arguments = parser.parse_args()

    figures = benchmarks(arguments.folder)
    if "identify_30_trials" in figures:
        figures["identify_30_trials_ms"] = figures.pop("identify_30_trials") / 1e3
    for key, usual in (("frame_fit_extended", "frame_fit_warm"), ("frame_fit_extended_memory", "frame_fit_warm"),
                       ("association_hidden_ring", "association_frame")):
        if key in figures and figures.get(usual):
            figures[f"{key}_ratio"] = figures[key] / figures[usual]
    figures.update(diagnoses(arguments.folder))
    rate = frames_per_second(arguments.folder)
    if rate is not None:
        figures["offline_frames_per_s"] = rate
    figures.update(python_module(arguments.folder))
    print(f"{'':28}{'':42}{'median':>12}")
    for key, name in (("octave_sqp", "Octave sqp"), ("scipy_lsq", "SciPy least_squares")):
        time_us = baseline_us(os.path.join(arguments.folder, f"{key}.csv"))
        if time_us is None:
            continue
        ratio = "ratio_octave_sqp" if key == "octave_sqp" else "ratio_scipy_least_squares"
        if figures.get("frame_fit_cold"):
            figures[ratio] = time_us / figures["frame_fit_cold"]
        print(f"{'':28}{name + ', one frame, from nothing':42}{time_us:12,.0f} us")

    known = {row[0] for row in ROWS}
    others = [(key, "", "us", None) for key in figures if key not in known]
    # One per shipped arm; the bound is that of its drive.
    others = [
        (key, f"  the same, {key[len('static_solve_'):]}", unit, 15 if key[len("static_solve_"):] in PNEUMATIC else 40)
        if key.startswith("static_solve_") and key != "static_solve_warm"
        else (key, meaning, unit, bound)
        for key, meaning, unit, bound in others
    ]
    for key, meaning, unit, bound in ROWS + others:
        if key not in figures:
            print(f"{key:28}{meaning:42}{'not measured':>12}")
            continue
        print(f"{key:28}{meaning:42}{figures[key]:12,.1f} {unit.split()[0]:4}{verdict(unit, figures[key], bound)}".rstrip())

    if arguments.json:
        # Written beside and renamed: never half a file.
        with open(arguments.json + ".part", "w", encoding="utf-8") as text:
            json.dump(figures, text, indent=2)
            text.write("\n")
        os.replace(arguments.json + ".part", arguments.json)


if __name__ == "__main__":
    main()
