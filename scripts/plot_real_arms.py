#!/usr/bin/env python3
"""Remake the figures and tables of doc/real_arms.md from the recordings.

    scripts/plot_real_arms.py --data DATA --work work --out doc/images

The script imports the recordings of the pouch arm (DATA/pouch_arm) with `softarm import`, fits with `softarm identify`, each trial
unseen in its turn, estimates with `softarm estimate`, diagnoses with `softarm diagnose`, prints the tables and draws

    real_pouch_one_segment.png, real_pouch_two_segments.png   measured and predicted paths of the tip (and mid)
    real_pouch_loops.png                                      the same over pressure
    real_pouch_payload.png                                    the payload by bending, and by stretch
    real_pouch_diagnosis.png                                  what `softarm diagnose` finds: error of unseen trials
"""
import argparse
import pathlib
import shutil
import statistics
import sys

try:
    import matplotlib

    import real_diagnosis
    import real_laws
    import real_pouch
    import real_pouch_facts
    import real_regression
    from softarm_module import softarm
except ImportError as error:
    sys.exit(f"{error}: apt-get install python3-matplotlib python3-sklearn")

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from real_pouch import HAND_S, ONE, TWO, median_and_sd, rows_of, time_of  # noqa: E402

BLUE, ORANGE = "#1f6fb4", "#d9730d"
SOFTER_NM2 = 0.037  # what loaded frames say of EI, given the payload
PARTS = ("laws", "windows", "diagnosis")


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


def draw_payload(pouch, path):
    figure, grid = plt.subplots(1, 2, figsize=(9.5, 3.6), sharey=True)
    for axes, trial in zip(grid, ("load_1", "load_3")):
        for name, colour, label in (("stretch", BLUE, "by stretch and laws of the other trials"),
                                    ("bending", ORANGE, "by bending alone")):
            rows = [r for r in rows_of(pouch.work / name / trial / "estimates.csv") if r["status"] == "ok" and r["sd_payload"] is not None]
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


def one_segment(pouch, root, out):
    """Fits; each trial as the others predict it."""
    # EA is `rigid` in the arm file that ships; here it is a constant to be found.
    text = (root / "config/arms/pouch_arm_one_segment.yaml").read_text()
    start = pouch.work / "start.yaml"
    start.write_text(text.replace("axial_stiffness_n: rigid", "axial_stiffness_n: 190"))
    shapes = pouch.each_by_the_others("one", start, "one", [trial for _, trial, _ in ONE], "--hold", real_pouch.HOLD,
                                      "--also-free", real_pouch.FREE_ONE)
    draw_paths([(trial, trial, shapes[trial]) for _, trial, _ in ONE], [("tip", BLUE)], out / "real_pouch_one_segment.png")
    print_rest(shapes)
    print_stretch(shapes)
    free = pouch.identify("one_ei", start, "one", "--hold", "*.chamber_3.*,*.chamber_1.*,per_min_pressure", "--also-free",
                          real_pouch.FREE_ONE, "--hold-out-share", "0")
    print("\nEI freed:\n" + lines_of(free, "bending_stiffness", "LIMIT"))
    return shapes


def lines_of(text, *words):
    return "\n".join("  " + line.strip() for line in text.splitlines() if any(word in line for word in words))


def payload_of_one(pouch, out):
    trials = [trial for _, trial, _ in ONE]
    pouch.run("estimate", "--arm", "pouch_arm_one_segment", *pouch.whole(trials), "--out", pouch.work / "bending")
    table, notes = [], []
    for trial in trials:
        arm = pouch.work / f"one_without_{trial}.yaml"
        pouch.run("estimate", "--arm", arm, *pouch.whole([trial]), "--out", pouch.work / "stretch")
        cells = []
        for name in ("bending", "stretch"):
            rows = pouch.estimates(name, trial)
            cells += [f"{median_and_sd(rows, 'payload', *span)} kg" for span in ((5, 5.7), (11, 30))]
            told = 100 * sum(row["identifiable_payload"] == 1 for row in rows) / len(rows)
            notes.append(f"  {trial:<10}{name:<8} told in {told:.0f} % of {len(rows)} frames, rms residual "
                         f"{statistics.median(1e3 * float(row['rms_residual']) for row in rows if row['status'] == 'ok'):.2f} mm")
        laws = softarm.load_arm(arm)
        stretch = next(one.value for name, one in laws.constants.items() if name.endswith(".axial_stiffness"))
        notes.append(f"  {trial:<10}laws of the others: EA {stretch:g} N, prior's "
                     + ", ".join(f"{key} {value:g}" for key, value in laws.to_dict()["estimator"]["prior"].items()
                                 if key.startswith(("length", "axial")) and "sd" in key))
        known = ", then 0.4 kg" if trial in HAND_S else ""
        table.append(f"| {trial}, 0{known} | " + " | ".join(cells) + " |")
    print("\n| trial, true payload | bending, 5-5.7 s | bending, 11-30 s | stretch, 5-5.7 s | stretch, 11-30 s |\n|---|---|---|---|---|")
    print("\n".join(table + [""] + notes))
    draw_payload(pouch, out / "real_pouch_payload.png")
    loaded = [trial for trial in trials if trial in HAND_S]
    pouch.run("estimate", "--arm", "pouch_arm_one_segment", *pouch.whole(loaded), "--unknown", "stiffness", "--payload",
              real_pouch.LOAD_KG, "--out", pouch.work / "stiffness")
    for trial in loaded:
        rows = pouch.estimates("stiffness", trial)
        print(f"  {trial}: EI {median_and_sd(rows, 'EI', 11, 30, 3)} N m^2, given the payload; identifiable in "
              f"{sum(row['identifiable_EI'] == '1' for row in rows)} of {len(rows)} frames")


def payload_of_two(pouch):
    """Of both segments and the steps, by the arm file as it ships."""
    trials = ["no_load", "load", "set_1"]
    pouch.run("estimate", "--arm", "pouch_arm", *pouch.whole(trials), *[pouch.work / f"steps/set_{k}.bag" for k in (2, 3)],
              "--unknown", "payload", "--out", pouch.work / "bending_two")
    print("\npayload of two segments, kg: medians; frames")
    for trial in trials + ["set_2", "set_3"]:
        rows = pouch.estimates("bending_two", trial)
        rows = [row for row in rows if row["segment"] == rows[0]["segment"]]
        spans = ((0, 5.6), (12, 40)) if trial == "load" else ((0, 10), (10, 20), (20, 40))
        statuses = {row["status"] for row in rows}
        good = [row for row in rows if row["status"] == "ok"]
        residual = f", rms residual {statistics.median(1e3 * float(row['rms_residual']) for row in good):.2f} mm" if good else ""
        print(f"  {trial:<8} " + ", ".join(f"{a:g} to {b:g} s {median_and_sd(rows, 'payload', a, b)}" for a, b in spans) +
              f"; told in {sum(row['identifiable_payload'] == '1' for row in rows)} of {len(rows)} frames; " +
              ", ".join(f"{status} {sum(row['status'] == status for row in rows)}" for status in sorted(statuses)) + residual)


def print_jitter(rows, from_s, to_s):
    """Of the tip at held pressures."""
    some = [row for row in rows if row["body"] == "tip" and from_s <= time_of(row) < to_s]
    text = []
    for column, what in (("measured_x", "measured"), ("after_x", "predicted")):
        x = [1e3 * float(row[column]) for row in some]
        jumps = statistics.pstdev(b - a for a, b in zip(x, x[1:])) / 2 ** 0.5
        text.append(f"{what} {min(x):.1f} to {max(x):.1f} mm, from frame to frame {jumps:.2f} mm (sd)")
    print(f"\ntwo segments, no_load, held, {from_s} to {to_s} s: tip towards the bend " + "; ".join(text))


def two_segments(pouch, shapes, out):
    """Fits of both segments and of the steps, beside those of one segment in the pictures."""
    # EA stays as in the arm file: only one of the two trials has a load.
    options = ["--hold", real_pouch.HOLD, "--also-free", real_pouch.FREE]
    two = pouch.each_by_the_others("two", "pouch_arm", "two", [trial for _, trial, _ in TWO], *options)
    columns = [(f"two_segment {trial}, unseen", trial, two[trial]) for _, trial, _ in TWO]
    options[1] = real_pouch.HOLD_STEPS
    pouch.identify("steps_fitted", "pouch_arm", "steps", *options, "--leave-one-out")
    fitted = rows_of(pouch.work / "plot_steps_fitted/shapes.csv")
    pouch.each_by_the_others("steps", "pouch_arm", "steps", ["set_2", "set_3"], *options)
    for trial in ("set_2", "set_3"):
        columns.append((f"steps {trial}, fitted", trial, [row for row in fitted if row["trial"] == trial]))
    draw_paths(columns, [("tip", BLUE), ("mid", ORANGE)], out / "real_pouch_two_segments.png")
    loops = [(f"one segment, {trial}, unseen", "chamber_2", shapes[trial]) for _, trial, _ in ONE]
    for title, trial, rows in columns:
        loops.append((title.replace("two_segment", "two segments,"), "chamber_2", rows))
    draw_loops(loops, out / "real_pouch_loops.png")
    print_jitter(two["no_load"], 13, 28)
    bags = sorted((pouch.work / "two").glob("*.bag"))
    options[1] = real_pouch.HOLD
    robust = pouch.run("identify", "--arm", "pouch_arm", *bags, *options, "--out", pouch.work / "two_robust.yaml")
    print("\ntwo segments, without --not-robust:\n" + lines_of(robust, "outliers:", "misfit:"))


def diagnosis(pouch, out):
    """What the arm file leaves out."""
    real_laws.scaled(softarm.load_arm(pouch.work / "one.yaml"), SOFTER_NM2).save(pouch.work / "one_softer.yaml", force=True)
    reports = {}
    for name, arm, folder in (("one segment", "one", "one"), (f"one segment, EI {SOFTER_NM2}", "one_softer", "one"),
                              ("two segments", "two", "two")):
        reports[name] = real_diagnosis.diagnose(pouch.program, pouch.work / f"{arm}.yaml",
                                                sorted((pouch.work / folder).glob("*.bag")), pouch.work / f"report_{arm}",
                                                "--hold", real_pouch.HOLD)
        real_diagnosis.print_report(name, reports[name])
    real_diagnosis.draw(reports, out / "real_pouch_diagnosis.png")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=pathlib.Path, required=True, help="folder that contains pouch_arm/")
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for bags and results")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder for the pictures")
    parser.add_argument("--skip", nargs="+", choices=PARTS, default=[], metavar="PART", help="parts to leave out: " + ", ".join(PARTS))
    root = pathlib.Path(__file__).resolve().parent.parent
    parser.add_argument("--program", default=str(root / "scripts" / "softarm"), help="default: scripts/softarm")
    arguments = parser.parse_args()
    if not (arguments.data / "pouch_arm").is_dir():
        sys.exit(f"--data {arguments.data}: there is no folder pouch_arm in it")
    if shutil.which(arguments.program) is None:
        sys.exit(f"--program {arguments.program}: cannot be run")
    arguments.out.mkdir(parents=True, exist_ok=True)
    pouch = real_pouch.Pouch(arguments.program, arguments.data, arguments.work)
    real_pouch_facts.print_facts(pouch.data)
    pouch.import_all()
    shapes = one_segment(pouch, root, arguments.out)
    payload_of_one(pouch, arguments.out)
    two_segments(pouch, shapes, arguments.out)
    payload_of_two(pouch)
    if "windows" not in arguments.skip:
        real_laws.print_windows(pouch)
    if "laws" not in arguments.skip:
        real_laws.print_laws(pouch, root)
    if "diagnosis" not in arguments.skip:
        diagnosis(pouch, arguments.out)


if __name__ == "__main__":
    main()
