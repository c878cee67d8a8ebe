#!/usr/bin/python3
"""Records, fits and diagnoses the worked example, and writes its page; scripts/worked_example builds and runs it."""
import argparse
import bisect
import csv
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import time

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

ARM = "online_200mm"
CASE = "case_001"
BLUE, ORANGE, GREY = "#1f6fb4", "#d9730d", "0.35"
EFFECT, SYMBOL = "base_compliance", "compliance_rad_per_nm"
EI = "segment_1.bending_stiffness.base"


def say(text):
    print(text, file=sys.stderr, flush=True)


class Steps:
    """Runs the program, and keeps what it said for the page."""

    def __init__(self, program, folder):
        self.program, self.folder, self.seconds = program, folder, {}

    def run(self, name, *arguments):
        say(f"softarm {' '.join(map(str, arguments))[:100]} ...")
        started = time.monotonic()
        # Progress is for whoever waits; what stands on standard output is for the page.
        done = subprocess.run([self.program, *map(str, arguments)], stdout=subprocess.PIPE, universal_newlines=True,
                              cwd=self.folder)
        if done.returncode != 0:
            sys.exit(f"softarm {arguments[0]}: failed")
        self.seconds[name] = time.monotonic() - started
        (self.folder / f"{name}.txt").write_text(done.stdout)
        return done.stdout


def stiffness_of(arm_text):
    """base_nm2 of an arm file."""
    return float(re.search(r"^ *base_nm2: *([0-9.eE+-]+)", arm_text, re.M).group(1))


def truth_of(folder):
    """What was sealed: EI, compliance of the base, chambers' gains."""
    text = (folder / f"campaign/truth/{CASE}/trial_01.truth.yaml").read_text()
    number = lambda key: float(re.search(key + r": *([0-9.eE+-]+)", text).group(1))
    return {"EI": number("stiffness_base_nm2"), "compliance": 1.0 / number("stiffness_nm_per_rad"),
            "gain": number("moment_gain_nm_per_pa")}


def frames_of(folder, trial):
    """Frames of one trial: stamps and EI where it is identifiable, median residual."""
    with open(folder / trial / "estimates.csv", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["status"] == "ok"]
    identifiable = [row for row in rows if row["identifiable_EI"] == "1"]
    return {"stamps": [float(row["stamp"]) for row in identifiable], "EI": [float(row["EI"]) for row in identifiable],
            "residual": statistics.median(float(row["rms_residual"]) for row in rows)}


def judge_frames(frames, truth_csv):
    """Error of EI of single frames against the truth of that instant (EI goes with the pressures), as shares."""
    with open(truth_csv, newline="") as file:
        truth = [(float(row["stamp"]), float(row["EI"])) for row in csv.DictReader(file)]
    stamps = [stamp for stamp, _ in truth]
    errors = [value / truth[min(bisect.bisect_left(stamps, stamp), len(truth) - 1)][1] - 1
              for stamp, value in zip(frames["stamps"], frames["EI"])]
    low, middle, high = statistics.quantiles(errors, n=4)
    return {"error": middle, "low": low, "high": high, "residual": frames["residual"],
            "EI": statistics.median(frames["EI"])}


def draw(path, truth, report, frames, after_frames):
    figure, (single, joint, unseen) = plt.subplots(1, 3, figsize=(11.5, 3.6), gridspec_kw={"width_ratios": [1.25, 0.8, 1.15]})
    names = sorted(frames)
    for k, (values, colour, label) in enumerate(((frames, ORANGE, "arm file fitted without it"),
                                                (after_frames, BLUE, "with the base's yielding"))):
        if not values:
            continue
        at = [i + 1 + (0.14 if k else -0.14) for i in range(len(names))]
        mid = [100 * values[n]["error"] for n in names]
        single.errorbar(at, mid, yerr=[[m - 100 * values[n]["low"] for m, n in zip(mid, names)],
                                       [100 * values[n]["high"] - m for m, n in zip(mid, names)]],
                        fmt="o" if k == 0 else "s", color=colour, ms=4, lw=1.2, capsize=2, label=label)
    single.axhline(0, color="k", lw=1.4, label="truth")
    single.set_xlabel("trial")
    single.set_xticks(range(1, len(names) + 1))
    single.set_ylabel("error of EI, single frames (%)")
    single.set_title("frames one by one: medians and quartiles", fontsize=9)
    single.margins(y=0.3)
    single.legend(fontsize=7, frameon=False, loc="upper center", ncol=2)

    shift = next(s for s in report["shifts"] if s["name"] == EI)
    for x, key, colour in ((0, "before", ORANGE), (1, "after", BLUE)):
        joint.errorbar([x], [1e3 * shift[key]], yerr=[1.645e3 * shift[f"sd_{key}"]], fmt="o" if x == 0 else "s",
                       color=colour, capsize=3)
    joint.axhline(1e3 * truth["EI"], color="k", lw=1.4)
    joint.set_xlim(-0.6, 1.6)
    joint.set_xticks([0, 1])
    joint.set_xticklabels(["without", "with it"])
    joint.set_ylabel("EI of all trials together (mN m²)")
    joint.set_title("one arm for all trials", fontsize=9)

    trials = report["trials"]
    at = range(1, len(trials) + 1)
    unseen.bar([x - 0.2 for x in at], [1e3 * t["held_out_rms_before_m"] for t in trials], 0.38, color=ORANGE, label="without")
    unseen.bar([x + 0.2 for x in at], [1e3 * t["held_out_rms_after_m"] for t in trials], 0.38, color=BLUE, label="with it",
               hatch="//", edgecolor="white")
    unseen.axhline(1e3 * report["noise_floor_m"], color="k", lw=1.2, ls="--", label="noise alone")
    unseen.set_xticks(list(at))
    unseen.set_xlabel("trial, predicted by a fit to the others")
    unseen.set_ylabel("rms error (mm)")
    unseen.set_title("trials that the fit has not seen", fontsize=9)
    unseen.margins(y=0.2)
    unseen.legend(fontsize=7, frameon=False, loc="upper center", ncol=3)
    for axes in (single, joint, unseen):
        axes.grid(alpha=0.25)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    figure.tight_layout()
    figure.savefig(path, dpi=90)
    plt.close(figure)


def screenshot(page, picture):
    """By Chromium, where there is one; else the picture that is there stays."""
    browser = next((b for b in ("chromium", "chromium-browser", "google-chrome") if shutil.which(b)), None)
    if browser is None:
        say("no chromium: the picture of the report is not made anew")
        return
    subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--window-size=1100,1500",
                    "--virtual-time-budget=8000", f"--user-data-dir={picture.parent / '.profile'}",
                    f"--screenshot={picture}", f"file://{page}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                   timeout=120, check=True)
    shutil.rmtree(picture.parent / ".profile", ignore_errors=True)


def lines(text, *patterns):
    """The lines that have one of these."""
    return "\n".join(line.rstrip() for line in text.splitlines() if any(re.search(p, line) for p in patterns))


def percent(value, truth):
    return f"{100 * (value / truth - 1):+.1f} %"


def work(steps, arguments):
    """Everything, in the order in which a laboratory would do it; what the page needs."""
    folder = steps.folder
    campaign = arguments.campaign or arguments.root / "config/campaigns/worked_example.yaml"
    steps.run("campaign", "campaign", campaign, "--cases", 1, "--seed", arguments.seed, "--out", "campaign")
    trials = sorted(str(p.relative_to(folder)) for p in (folder / "campaign" / CASE).glob("*.bag"))
    found = {"trials": len(trials)}
    found["identify"] = steps.run("identify", "identify", "--arm", ARM, *trials, "--leave-one-out", "--out", "my_arm.yaml")
    found["estimate"] = steps.run("estimate", "estimate", "--arm", "my_arm.yaml", *trials, "--out", "estimates")
    found["diagnose"] = steps.run("diagnose", "diagnose", "--arm", "my_arm.yaml", *trials, "--out", "report")
    found["extended"] = None
    if (folder / "report/arm_extended.yaml").is_file():
        found["extended"] = steps.run("extended", "estimate", "--arm", "report/arm_extended.yaml", *trials, "--out",
                                      "estimates_extended")
    names = [pathlib.Path(t).stem for t in trials]
    before = {n: frames_of(folder / "estimates", n) for n in names}
    after = {n: frames_of(folder / "estimates_extended", n) for n in names} if found["extended"] else {}
    found["report"] = json.loads((folder / "report/report.json").read_text())
    # The truth is opened last.
    found["truth"] = truth_of(folder)
    for key, frames in (("frames", before), ("after_frames", after)):
        found[key] = {n: judge_frames(f, folder / f"campaign/truth/{CASE}/{n}.truth.csv") for n, f in frames.items()}
    found["identified"] = stiffness_of((folder / "my_arm.yaml").read_text())
    return found


def judge(found):
    """What the page says must be so."""
    report, truth = found["report"], found["truth"]
    shift = next(s for s in report["shifts"] if s["name"] == EI)
    wrong = abs(found["identified"] / truth["EI"] - 1)
    checks = [
        (wrong > 0.03, "the fit that does not know of the base is wrong about EI"),
        ([e["name"] for e in report["effects"]] == [EFFECT], f"{EFFECT} is named, and nothing else"),
        (report["verdict"] in ("explained", "partly_explained") and report["explained_share"] > 0.9,
         "it explains nine tenths or more of what could be explained"),
        (abs(shift["after"] / truth["EI"] - 1) < 0.25 * wrong, "three quarters of EI's bias or more are gone"),
        (report["extended"]["held_out_weighted_rms_m"] < 0.6 * report["baseline"]["held_out_weighted_rms_m"], "unseen trials are predicted better"),
    ]
    if found["after_frames"]:
        bias = {key: abs(statistics.median(f["error"] for f in found[key].values())) for key in ("frames", "after_frames")}
        checks.append((bias["after_frames"] < 0.5 * bias["frames"], "frames by the extended arm file have the right EI"))
    for good, what in checks:
        say(f"{'yes' if good else 'NO '}  {what}")
    return all(good for good, _ in checks)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--root", type=pathlib.Path, required=True, help="folder of the checkout")
    parser.add_argument("--program", required=True, help="path of the program softarm")
    parser.add_argument("--work", "--out", type=pathlib.Path, required=True, help="folder for recordings, arm files and the report")
    parser.add_argument("--doc", type=pathlib.Path, help="the page (default: doc/worked_example.md)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--campaign", type=pathlib.Path, help="another campaign file")
    arguments = parser.parse_args()
    folder = arguments.work.resolve()
    if (folder / "campaign").exists():
        shutil.rmtree(folder / "campaign")
    folder.mkdir(parents=True, exist_ok=True)
    page = (arguments.doc or arguments.root / "doc/worked_example.md").resolve()
    steps = Steps(str(pathlib.Path(arguments.program).resolve()), folder)
    found = work(steps, arguments)
    if not judge(found):
        sys.exit("scripts/worked_example: a statement of the page would be wrong; nothing is written")
    import worked_example_text
    images = page.parent / "images"
    images.mkdir(parents=True, exist_ok=True)
    draw(images / "worked_example.png", found["truth"], found["report"], found["frames"], found["after_frames"])
    screenshot(folder / "report/report.html", images / "worked_example_report.png")
    text = worked_example_text.page(found, steps, lines, percent)
    part = page.with_suffix(".part")
    part.write_text(text)
    os.replace(part, page)
    say(f"written: {page}")


if __name__ == "__main__":
    main()
