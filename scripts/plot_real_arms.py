#!/usr/bin/env python3
"""Remake the figures and tables of doc/real_arms.md from the recordings.

    scripts/plot_real_arms.py --data DATA --work work --out doc/images

imports the recordings of the pouch arm (DATA/pouch_arm) with `softarm import`, fits with `softarm identify`, each trial
held out in its turn, estimates with `softarm estimate`, diagnoses with `softarm diagnose`, prints the tables and draws

    real_pouch_one_segment.png, real_pouch_two_segments.png   measured and predicted paths of the tip (and mid)
    real_pouch_loops.png                                      the same over pressure
    real_pouch_payload.png                                    the payload by bending, and by stretch
    real_pouch_diagnosis.png                                  what `softarm diagnose` finds: error of unseen trials
"""
import argparse
import csv
import pathlib
import re
import shutil
import statistics
import subprocess
import sys

try:
    import matplotlib

    import real_diagnosis
    import real_regression
except ImportError as error:
    sys.exit(f"{error}: apt-get install python3-matplotlib python3-sklearn")

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

START_S = 1.6e9  # of every imported recording, see config/layouts/template.yaml
HOLD = "*.bending_stiffness.*,*.chamber_3.*,*.chamber_1.*"
PAST_S = (0.3, 1, 3, 10)  # lags of the inputs in the black box
BLUE, ORANGE, GREY = "#1f6fb4", "#d9730d", "0.55"

# recording, trial, what is known of its payload
ONE = [
    ("no_load/data_collect_1", "no_load_1", ["--payload", "0"]),
    ("no_load/data_collect_3", "no_load_3", ["--payload", "0"]),
    ("load_400g/data_collect_1", "load_1", "--payload 0 --payload 10.3:0.4 --leave-out 7.0:10.3".split()),
    ("load_400g/data_collect_3", "load_3", "--payload 0 --payload 10.5:0.4 --leave-out 5.7:10.5".split()),
]
TWO = [
    ("no_load/data_collect_1", "no_load", ["--payload", "0"]),
    ("load_400g/data_collect_1", "load", "--payload 0 --payload 12:0.4 --leave-out 5.6:12".split()),
]
HAND_S = {"load_1": (7.0, 10.3), "load_3": (5.7, 10.5), "load": (5.6, 12.0)}


class Pouch:
    """The recordings of the pouch arm through the program."""

    def __init__(self, program, data, work):
        self.program, self.data, self.work = program, data / "pouch_arm", work
        for folder in ("one", "two", "steps", "whole"):
            (work / folder).mkdir(parents=True, exist_ok=True)

    def run(self, *arguments):
        call = [self.program, *map(str, arguments)]
        done = subprocess.run(call, stdout=subprocess.PIPE, universal_newlines=True)
        if done.returncode != 0:
            sys.exit(f"{' '.join(call)}: failed")
        return done.stdout

    def import_all(self):
        for folder, layout, recordings in (("one", "pouch_arm_one_segment", ONE), ("two", "pouch_arm", TWO)):
            source = self.data / ("one_segment" if folder == "one" else "two_segment")
            for recording, trial, known in recordings:
                self.run("import", layout, source / f"{recording}.txt", *known, "--out", self.work / folder / f"{trial}.bag")
                if folder == "one":  # the whole trial, its payload not given
                    self.run("import", layout, source / f"{recording}.txt", "--out", self.work / "whole" / f"{trial}.bag")
        for number in (2, 3):
            self.run("import", "pouch_arm_steps", self.data / f"steps/set_{number}/data_collect_1.txt", "--out",
                     self.work / "steps" / f"set_{number}.bag")

    def identify(self, name, arm, folder, *options, plot="--plot-all"):
        """plot: --plot-all draws all frames; None those that are fitted or judged."""
        bags = sorted((self.work / folder).glob("*.bag"))
        return self.run("identify", "--arm", arm, *bags, "--not-robust", "--out", self.work / f"{name}.yaml", "--plot",
                        self.work / f"plot_{name}", *([plot] if plot else []), *options)

    def each_by_the_others(self, name, arm, folder, trials, *options):
        """Prints the table of --leave-one-out; the trials as predicted by fits to the others, and a black box beside them."""
        said = self.identify(name, arm, folder, *options, "--leave-one-out", plot=None)
        print(said)
        by_others = said[said.index("each trial by the fit to the others"):]
        judged = {trial: found.time for trial, found in real_regression.sequences_of(self.work / f"plot_{name}/shapes.csv").items()}
        unseen, table = {}, {}
        for trial in trials:
            self.identify(f"{name}_without_{trial}", arm, folder, *options, "--hold-out", trial)
            shapes = self.work / f"plot_{name}_without_{trial}/shapes.csv"
            sequences = real_regression.sequences_of(shapes)
            unseen[trial] = [row for row in rows_of(shapes) if row["trial"] == trial]
            table.update(real_regression.errors(sequences, [trial], PAST_S, judged, step=2))
            # --hold-out keeps the arm file's constants where they predict better; --leave-one-out does not.
            table[trial]["physics"] = float(re.search(rf"^ +{trial} +([0-9.]+) mm", by_others, re.M).group(1))
        real_regression.print_errors(name, table)
        return unseen


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def time_of(row):
    return float(row["stamp"]) - START_S


def with_gaps(times, values, longest_s=0.7):
    """Breaks the line where nothing was recorded."""
    out_t, out_v = [], []
    for i, t in enumerate(times):
        if i and t - times[i - 1] > longest_s:
            out_t.append(t)
            out_v.append(float("nan"))
        out_t.append(t)
        out_v.append(values[i])
    return out_t, out_v


def draw_path(axes, rows, body, axis, colour, label):
    rows = [row for row in rows if row["body"] == body]
    times = [time_of(row) for row in rows]
    for column, style, what in ((f"measured_{axis}", "-", "measured"), (f"after_{axis}", "--", "predicted")):
        values = [1e3 * float(row[column]) for row in rows]
        axes.plot(*with_gaps(times, values), style, color=colour, lw=1.6 if style == "-" else 1.3,
                  label=f"{label} {what}".strip())


def draw_paths(columns, bodies, path):
    """columns: title, trial, rows of its shapes.csv; one above the other: towards the bending, and along the arm."""
    figure, grid = plt.subplots(2, len(columns), figsize=(3.4 * len(columns), 5.2), sharex="col", squeeze=False)
    for k, (title, trial, rows) in enumerate(columns):
        rows = [row for row in rows if row["trial"] == trial]
        for axes, axis in zip(grid[:, k], "xz"):
            for body, colour in bodies:
                draw_path(axes, rows, body, axis, colour, body if len(bodies) > 1 else "")
            if trial in HAND_S:
                axes.axvspan(*HAND_S[trial], color="0.9", lw=0)
            axes.grid(alpha=0.25)
            for side in ("top", "right"):
                axes.spines[side].set_visible(False)
        error = statistics.mean(1e3 * float(row["error_after"]) for row in rows)
        grid[0][k].set_title(f"{title}\nmean error {error:.1f} mm", fontsize=10)
        grid[1][k].set_xlabel("time (s)")
    grid[0][0].set_ylabel("towards the bend (mm)")
    grid[1][0].set_ylabel("along the arm (mm)")
    many = len(bodies) > 1
    grid[1 if many else 0][0].legend(fontsize=8, frameon=False, loc="center" if many else "lower right")
    figure.tight_layout()
    figure.savefig(path, dpi=75)
    plt.close(figure)


def draw_loops(columns, path):
    """columns: title, input, rows of a trial's shapes.csv; the tip towards the bend over a pressure (lag 0.3 s, against its
    noise), from the dot on."""
    figure, grid = plt.subplots(2, 4, figsize=(13, 6.2))
    for axes, (title, name, rows) in zip(grid.flat, columns):
        rows = [row for row in rows if row["body"] == "tip"]
        times = real_regression.np.array([time_of(row) for row in rows])
        noisy = real_regression.np.array([[1e-3 * float(row[name])] for row in rows])
        pressure = list(real_regression.lagged(times, noisy, 0.3)[:, 0])
        for column, width, colour, what in (("after_x", 0.7, ORANGE, "predicted"), ("measured_x", 1.6, BLUE, "measured")):
            values = [1e3 * float(row[column]) for row in rows]
            axes.plot(with_gaps(times, pressure)[1], with_gaps(times, values)[1], color=colour, lw=width, label=what)
            axes.plot(pressure[0], values[0], "o", color=colour, ms=5)
        axes.set_title(title, fontsize=10)
        axes.set_xlabel(f"{name} (kPa over ambient)")
        axes.grid(alpha=0.25)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    for row in grid:
        row[0].set_ylabel("tip, towards the bend (mm)")
    grid[0][0].legend(fontsize=8, frameon=False, loc="center")
    figure.tight_layout()
    figure.savefig(path, dpi=75)
    plt.close(figure)


def median_of(rows, column, from_s, to_s):
    values = [float(row[column]) for row in rows
              if row["status"] == "ok" and row[column] and from_s <= time_of(row) < to_s]
    return statistics.median(values) if values else float("nan")


def draw_payload(pouch, path):
    figure, grid = plt.subplots(1, 2, figsize=(9.5, 3.6), sharey=True)
    for axes, trial in zip(grid, ("load_1", "load_3")):
        for name, colour, label in (("stretch", BLUE, "by stretch and laws of the other trials"),
                                    ("bending", ORANGE, "by bending alone")):
            rows = [r for r in rows_of(pouch.work / name / trial / "estimates.csv") if r["status"] == "ok" and r["sd_payload"]]
            times = [time_of(r) for r in rows]
            value = [float(r["payload"]) for r in rows]
            sd = [float(r["sd_payload"]) for r in rows]
            axes.fill_between(times, [v - s for v, s in zip(value, sd)], [v + s for v, s in zip(value, sd)],
                              color=colour, alpha=0.18, lw=0)
            axes.plot(times, value, color=colour, lw=1.4, label=label)
        hand = HAND_S[trial]
        axes.plot([0, hand[0]], [0, 0], "k", lw=2.2, label="true")
        axes.plot([hand[1], 30], [0.4, 0.4], "k", lw=2.2)
        axes.axvspan(*hand, color="0.9", lw=0)
        axes.set_title(trial, fontsize=10)
        axes.set_xlabel("time (s)")
        axes.set_ylim(-0.6, 2.7)
        axes.grid(alpha=0.25)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    grid[0].set_ylabel("payload (kg), one standard deviation")
    grid[0].legend(fontsize=8, frameon=False, loc="upper right")
    figure.tight_layout()
    figure.savefig(path, dpi=75)
    plt.close(figure)


def chord_mm(rows, from_s, to_s):
    """Mean distance from base to tip."""
    return statistics.mean(
        1e3 * sum(float(row[f"measured_{axis}"]) ** 2 for axis in "xyz") ** 0.5
        for row in rows if from_s <= time_of(row) < to_s)


def print_stretch(shapes):
    """EA from the step of the distance base to tip in one trial, payload of the other."""
    print("\nstretch by 0.4 kg, distance base to tip")
    found = {}
    for trial, before in (("load_1", (5.0, 7.0)), ("load_3", (5.0, 5.7))):
        empty = chord_mm(shapes[trial], *before)
        for after in ((11, 15), (25, 30)):
            step = chord_mm(shapes[trial], *after) - empty
            found[trial, after] = 0.4 * 9.80665 * empty / step, empty, step
            print(f"  {trial} {after[0]}-{after[1]} s: {empty:.2f} mm + {step:.2f} mm, EA {found[trial, after][0]:.0f} N")
    for known, other in (("load_1", "load_3"), ("load_3", "load_1")):
        stiffness = found[known, (11, 15)][0]
        for after in ((11, 15), (25, 30)):
            _, empty, step = found[other, after]
            print(f"  EA of {known}: {other} {after[0]}-{after[1]} s carries {stiffness * step / empty / 9.80665:.3f} kg")


def print_rest(shapes):
    print("\nunloaded, inflated (5.0-5.7 s) and before the first inflation (0-0.5 s): tip towards the bend, distance")
    for trial in ("no_load_1", "load_1", "no_load_3", "load_3"):
        rows = [row for row in shapes[trial] if row["trial"] == trial]
        text = []
        for span in ((0, 0.5), (5.0, 5.7), (29.0, 29.9)):
            x = statistics.mean(1e3 * float(r["measured_x"]) for r in rows if span[0] <= time_of(r) < span[1])
            text.append(f"{span[0]} s: {x:.1f} mm, {chord_mm(rows, *span):.1f} mm")
        print(f"  {trial:<10}", "; ".join(text))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=pathlib.Path, required=True, help="folder that holds pouch_arm/")
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for bags and results")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder for the pictures")
    root = pathlib.Path(__file__).resolve().parent.parent
    parser.add_argument("--program", default=str(root / "scripts" / "softarm"), help="default: scripts/softarm")
    arguments = parser.parse_args()
    if not (arguments.data / "pouch_arm").is_dir():
        sys.exit(f"--data {arguments.data}: there is no folder pouch_arm in it")
    if shutil.which(arguments.program) is None:
        sys.exit(f"--program {arguments.program}: cannot be run")
    arguments.out.mkdir(parents=True, exist_ok=True)
    work = arguments.work
    pouch = Pouch(arguments.program, arguments.data, work)
    pouch.import_all()

    # One segment. EA is `rigid` in the arm file that ships; here it is a constant to be found.
    text = (root / "config/arms/pouch_arm_one_segment.yaml").read_text()
    (work / "start.yaml").write_text(text.replace("axial_stiffness_n: rigid", "axial_stiffness_n: 190"))
    free = "length,*.rest_curvature.*,axial_stiffness"
    shapes = pouch.each_by_the_others("one", work / "start.yaml", "one", [trial for _, trial, _ in ONE], "--hold", HOLD,
                                      "--also-free", free)
    draw_paths([(trial, trial, shapes[trial]) for _, trial, _ in ONE], [("tip", BLUE)],
               arguments.out / "real_pouch_one_segment.png")
    print_rest(shapes)
    print_stretch(shapes)

    # Its payload.
    bags = sorted((work / "whole").glob("*.bag"))
    pouch.run("estimate", "--arm", "pouch_arm_one_segment", *bags, "--out", work / "bending")
    print("\npayload, kg, and its sd: 5-5.7 s, 11-30 s; share of frames in which it is identifiable")
    for _, trial, _ in ONE:
        pouch.run("estimate", "--arm", work / f"one_without_{trial}.yaml", work / f"whole/{trial}.bag", "--out",
                  work / "stretch")
        for name in ("bending", "stretch"):
            rows = rows_of(work / name / trial / "estimates.csv")
            cells = [f"{median_of(rows, 'payload', *s):.2f} +- {median_of(rows, 'sd_payload', *s):.2f}"
                     for s in ((5, 5.7), (11, 30))]
            identifiable = sum(row["identifiable_payload"] == "1" for row in rows) / len(rows)
            print(f"  {trial:<12}{name:<10}{cells[0]}   {cells[1]}   {identifiable:.2f}")
    draw_payload(pouch, arguments.out / "real_pouch_payload.png")

    # Two segments. EA stays as in the arm file: only one of the two trials has a load.
    free = "length,*.rest_curvature.*"
    two = pouch.each_by_the_others("two", "pouch_arm", "two", [trial for _, trial, _ in TWO], "--hold", HOLD, "--also-free", free)
    columns = [(f"two_segment {trial}, held out", trial, two[trial]) for _, trial, _ in TWO]
    hold = HOLD.replace("*.chamber_1.*", "*.chamber_1.elongation")
    pouch.identify("steps_fitted", "pouch_arm", "steps", "--hold", hold, "--also-free", free, "--leave-one-out")
    fitted = rows_of(work / "plot_steps_fitted/shapes.csv")
    pouch.each_by_the_others("steps", "pouch_arm", "steps", ["set_2", "set_3"], "--hold", hold, "--also-free", free)
    for trial in ("set_2", "set_3"):
        columns.append((f"steps {trial}, fitted", trial, [row for row in fitted if row["trial"] == trial]))
    draw_paths(columns, [("tip", BLUE), ("mid", ORANGE)], arguments.out / "real_pouch_two_segments.png")

    loops = [(f"one segment, {trial}, held out", "chamber_2", shapes[trial]) for _, trial, _ in ONE]
    for title, trial, rows in columns:
        loops.append((title.replace("two_segment", "two segments,"), "chamber_2", rows))
    draw_loops(loops, arguments.out / "real_pouch_loops.png")

    # What the arm file leaves out.
    # EI is a guess in the arm file; loaded frames, given the payload, say some 0.037 N m^2 instead.
    softer = re.sub(r"base_nm2: 0.15\b", "base_nm2: 0.037", (work / "one.yaml").read_text())
    softer = re.sub(r"moment_gain_nm_per_pa: ([0-9.e-]+)",
                    lambda gain: f"moment_gain_nm_per_pa: {float(gain.group(1)) * 0.037 / 0.15:.4g}", softer)
    (work / "one_softer.yaml").write_text(softer)
    reports = {}
    for name, arm, folder in (("one segment", "one", "one"), ("one segment, EI 0.037", "one_softer", "one"),
                              ("two segments", "two", "two")):
        reports[name] = real_diagnosis.diagnose(pouch.program, work / f"{arm}.yaml", sorted((work / folder).glob("*.bag")),
                                                work / f"report_{arm}", "--hold", HOLD)
        real_diagnosis.print_report(name, reports[name])
    real_diagnosis.draw(reports, arguments.out / "real_pouch_diagnosis.png")


if __name__ == "__main__":
    main()
