"""The recordings of the pouch arm through the program; used by plot_real_arms.py and real_laws.py."""
import json
import statistics
import subprocess
import sys
import time

import real_regression
from softarm_module import rows_of
from real_recordings import FREE, FREE_ONE, HOLD, HOLD_STEPS, ONE, TWO  # noqa: F401  for the scripts that use this one

START_S = 1.6e9  # of every imported recording, see config/layouts/template.yaml
PAST_S = (0.3, 1, 3, 10)  # lags of the inputs in the black box

HAND_S = {"load_1": (7.0, 10.3), "load_3": (5.7, 10.5), "load": (5.6, 12.0)}
LOAD_KG = 0.4
# Rows of the page's table beside a black box: what is to be reached (mm), and groups of trials.
BLACK_BOX = {
    "one": [("one segment: no_load_1, no_load_3", 4, [["no_load_1"], ["no_load_3"]]), ("load_1, load_3", 4, [["load_1"], ["load_3"]]),
            ("all four", 4, [["no_load_1", "no_load_3", "load_1", "load_3"]])],
    "two": [("two segments: no_load, load", 5, [["no_load"], ["load"]]), ("both", 5, [["no_load", "load"]])],
    "steps": [("steps: set_2, set_3", "", [["set_2"], ["set_3"]])],
}


class Pouch:
    """The recordings of the pouch arm through the program."""

    def __init__(self, program, data, work):
        self.program, self.data, self.work, self.started = program, data / "pouch_arm", work, time.monotonic()
        for folder in ("one", "two", "steps", "whole"):
            (work / folder).mkdir(parents=True, exist_ok=True)

    def run(self, *arguments):
        call = [self.program, *map(str, arguments), "--force"]  # the folder is the script's own
        out = arguments[arguments.index("--out") + 1].name
        print(f"{time.monotonic() - self.started:5.0f} s  softarm {call[1]} -> {out}", file=sys.stderr, flush=True)
        done = subprocess.run(call, stdout=subprocess.PIPE, universal_newlines=True)
        if done.returncode != 0:
            sys.exit(f"{' '.join(call)}: failed")
        return done.stdout

    def import_all(self):
        for folder, layout, recordings in (("one", "pouch_arm_one_segment", ONE), ("two", "pouch_arm", TWO)):
            source = self.data / ("one_segment" if folder == "one" else "two_segment")
            for recording, trial, known in recordings:
                self.run("import", layout, source / f"{recording}.txt", *known, "--out", self.work / folder / f"{trial}.bag")
                # the whole trial, its payload not given
                self.run("import", layout, source / f"{recording}.txt", "--out", self.work / "whole" / f"{trial}.bag")
        for number in (1, 2, 3):
            self.run("import", "pouch_arm_steps", self.data / f"steps/set_{number}/data_collect_1.txt", "--out",
                     self.work / ("whole" if number == 1 else "steps") / f"set_{number}.bag")

    def whole(self, trials):
        return [self.work / "whole" / f"{trial}.bag" for trial in trials]

    def identify(self, name, arm, folder, *options, plot="--plot-all"):
        """plot: --plot-all draws all frames; None those that are fitted or judged."""
        bags = sorted((self.work / folder).glob("*.bag"))
        return self.run("identify", "--arm", arm, *bags, "--not-robust", "--out", self.work / f"{name}.yaml", "--plot",
                        self.work / f"plot_{name}", *([plot] if plot else []), *options)

    def errors(self, name, arm, folder, *options):
        """Mean error of all fitted trials, and of each by the others (mm); all that the fit found."""
        found = self.work / f"{name}.json"
        bags = sorted((self.work / folder).glob("*.bag"))
        self.run("identify", "--arm", arm, *bags, "--not-robust", "--leave-one-out", "--json", found, "--out",
                 self.work / f"{name}.yaml", *options)
        result = json.loads(found.read_text())
        return 1e3 * result["fitted"]["mean_m"], 1e3 * result["leave_one_out"]["after"]["mean_m"], result

    def each_by_the_others(self, name, arm, folder, trials, *options):
        """Prints the table of --leave-one-out; the trials as predicted by fits to the others, and a black box beside them."""
        found = self.work / f"{name}.json"
        print(self.identify(name, arm, folder, *options, "--leave-one-out", "--json", found, plot=None))
        by_others = {one["name"]: 1e3 * one["after"]["mean_m"] for one in json.loads(found.read_text())["leave_one_out"]["trials"]}
        judged = {trial: found.time for trial, found in real_regression.sequences_of(self.work / f"plot_{name}/shapes.csv").items()}
        unseen, table = {}, {}
        for trial in trials:
            self.identify(f"{name}_without_{trial}", arm, folder, *options, "--hold-out", trial)
            shapes = self.work / f"plot_{name}_without_{trial}/shapes.csv"
            sequences = real_regression.sequences_of(shapes)
            unseen[trial] = [row for row in rows_of(shapes) if row["trial"] == trial]
            table.update(real_regression.errors(sequences, [trial], PAST_S, judged, step=2))
            # --hold-out keeps the arm file's constants where they predict better; --leave-one-out does not.
            table[trial]["physics"] = by_others[trial]
        real_regression.print_errors(name, table, BLACK_BOX[folder])
        return unseen

    def estimates(self, folder, trial):
        return rows_of(self.work / folder / trial / "estimates.csv")


def time_of(row):
    return row["stamp"] - START_S


def median_of(rows, column, from_s, to_s):
    values = [row[column] for row in rows
              if row["status"] == "ok" and row[column] is not None and from_s <= time_of(row) < to_s]
    return statistics.median(values) if values else float("nan")


def median_and_sd(rows, column, from_s, to_s, digits=2):
    return " ± ".join(f"{median_of(rows, name, from_s, to_s):.{digits}f}" for name in (column, f"sd_{column}"))
