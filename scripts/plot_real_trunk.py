#!/usr/bin/env python3
"""Remake the figures and tables of doc/real_arms.md's tendon trunk from its recordings.

    scripts/plot_real_trunk.py --data DATA --work work --out doc/images

The script imports DATA/tendon_trunk with `softarm import`, fits with `softarm identify`, estimates with `softarm estimate`,
diagnoses with `softarm diagnose`, prints the tables and draws

    real_trunk_paths.png     measured and predicted paths of tip and mid discs under the same inputs, 0, 100 and 300 g
    real_trunk_loops.png     the same over the angle of a motor
    real_trunk_payload.png   the payload estimated from the same
    real_trunk_decay.png     releases by hand: frequency and damping over the amplitude
"""
import argparse
import pathlib
import shutil
import subprocess
import sys
import time

try:
    import matplotlib
    import numpy as np

    import real_diagnosis
    import real_regression
    import real_trunk_facts
    from softarm_module import rows_of, softarm
except ImportError as error:
    sys.exit(f"{error}: apt-get install python3-matplotlib python3-sklearn")

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

START_S = 1.6e9  # of every imported recording, see config/layouts/template.yaml
PIECE_S = 15
HELD_OUT = (2, 5, 8)  # pieces of the recordings with 0 and 300 g; of 100 g all
LOADS = {"0g": ("observations_controlled_1", 0.0), "100g": ("observations_controlled_1_100g", 0.1),
         "300g": ("observations_controlled_1_300g", 0.3)}
PAST_S = (0.1, 0.3, 1, 3)  # lags of the angles in the black box
COLOURS = {"0g": "#1f6fb4", "100g": "#3a923a", "300g": "#d9730d"}
TIE = ["--tie", "*.bending_stiffness.base"]
FIT = ["--also-free", "*.rest_curvature.*", "--frames", "100"]
STARTED = time.monotonic()


def run(program, *arguments, fails=False):
    """What a command prints; with `fails` it may end with an error, which is part of what is shown."""
    call = [program, *map(str, arguments), "--force"]  # the folder is the script's own
    out = pathlib.Path(arguments[arguments.index("--out") + 1]).name
    print(f"{time.monotonic() - STARTED:5.0f} s  softarm {call[1]} -> {out}", file=sys.stderr, flush=True)
    done = subprocess.run(call, stdout=subprocess.PIPE, universal_newlines=True)
    if done.returncode != 0 and not fails:
        sys.exit(f"{' '.join(call)}: failed")
    return done.stdout


def import_all(program, data, work):
    for load, (name, kg) in LOADS.items():
        link = work / f"{load}.csv"
        shutil.copyfile(data / f"{name}.csv", link)
        run(program, "import", "tendon_trunk_controlled", link, "--inputs", data / "control_inputs_controlled_1.csv",
            "--payload", kg, "--split-every", PIECE_S, "--leave-out", "150:151", "--out", f"{work}/pieces/")
    run(program, "import", "tendon_trunk_zeros", data / "observations_zeros_0g.csv", "--out", work / "zeros.bag")
    run(program, "import", "tendon_trunk_decay", data / "observations_manual_decay_200g.csv", "--out", f"{work}/decay/")


def identify(program, work, name, loads, held_out, tie=True, robust=False, arm="tendon_trunk", more=()):
    bags = [work / f"pieces/{load}_{i}.bag" for load in loads for i in range(10)]
    return run(program, "identify", "--arm", arm, *bags, *more, *(TIE if tie else []), *FIT,
               *([] if robust else ["--not-robust"]), "--hold-out", ",".join(held_out), "--out", work / f"{name}.yaml", "--plot",
               work / f"plot_{name}", "--plot-all")


def lines_of(text, *words):
    return "\n".join("  " + line.strip() for line in text.splitlines() if any(word in line for word in words))


def print_shape(rows):
    print("\nunseen pieces, every frame: error of each disc, mean distance (rms per direction), mm")
    for load in LOADS:
        text = []
        for disc in ("disc_1", "disc_2", "disc_3"):
            some = [r for r in rows if r["body"] == disc and r["trial"].split("_")[0] == load and r["held_out"] == 1]
            d = np.array([[float(r[f"after_{a}"]) - float(r[f"measured_{a}"]) for a in "xyz"] for r in some]) * 1e3
            m = np.array([[float(r[f"measured_{a}"]) for a in "xyz"] for r in some]) * 1e3
            text.append(f"{disc} {np.linalg.norm(d, axis=1).mean():.1f} "
                        f"({', '.join(f'{x:.1f}' for x in np.sqrt((d ** 2).mean(axis=0)))}; moves by "
                        f"{', '.join(f'{x:.0f}' for x in m.std(axis=0))})")
        print(f"  {load:<5}", ";  ".join(text))


def print_amplitude(rows):
    """Of the lowest disc in the unseen pieces of 0 and 300 g, over that without a load: measured and predicted."""
    size = {}
    for load in LOADS:
        some = [r for r in rows if r["body"] == "disc_3" and r["trial"] in {f"{load}_{i}" for i in HELD_OUT}]
        for what in ("measured", "after"):
            places = np.array([[float(r[f"{what}_{axis}"]) for axis in "xy"] for r in some])
            size[load, what] = np.sqrt(((places - places.mean(axis=0)) ** 2).sum(axis=1).mean())
    print("\namplitude of the lowest disc in pieces 2, 5 and 8, over that of 0 g: " + "; ".join(
        f"{load} measured {size[load, 'measured'] / size['0g', 'measured']:.3f}, predicted "
        f"{size[load, 'after'] / size['0g', 'after']:.3f}" for load in ("100g", "300g")))


def draw_paths(rows, path, piece=5):
    figure, grid = plt.subplots(4, 1, figsize=(9.5, 8.4), sharex=True)
    panels = [("disc_3", "x", "lowest disc, x (mm)"), ("disc_3", "y", "lowest disc, y (mm)"),
              ("disc_2", "x", "middle disc, x (mm)"), ("disc_2", "y", "middle disc, y (mm)")]
    for axes, (disc, axis, label) in zip(grid, panels):
        for load in ("0g", "300g"):
            some = sorted((r for r in rows if r["trial"] == f"{load}_{piece}" and r["body"] == disc),
                          key=lambda r: float(r["stamp"]))
            t = [float(r["stamp"]) - START_S for r in some]
            for column, style in (("measured", "-"), ("after", "--")):
                axes.plot(t, [1e3 * float(r[f"{column}_{axis}"]) for r in some], style, color=COLOURS[load], lw=1.4,
                          label=f"{load[:-1]} g {'measured' if column == 'measured' else 'predicted'}")
        axes.set_ylabel(label)
        axes.grid(alpha=0.25)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    grid[0].set_ylim(top=1.45 * grid[0].get_ylim()[1])  # room for the legend
    grid[0].legend(fontsize=8, frameon=False, loc="upper right", ncol=4)
    grid[0].set_title("an unseen piece, the same inputs with 0 and 300 g", fontsize=10)
    grid[-1].set_xlabel("time (s)")
    figure.tight_layout()
    figure.savefig(path, dpi=75)
    plt.close(figure)


def print_repeatability(data):
    """The same commands three times: 100 g against what 0 and 300 g say at the same instant, linear in the payload. Of three runs
    with errors of one size each, that difference has 1 + 4/9 + 1/9 times the variance of one."""
    runs = {load: 1e3 * np.genfromtxt(data / f"{name}.csv", delimiter=",", skip_header=1)[:15000, 1:10]
            for load, (name, _) in LOADS.items()}
    off = (runs["100g"] - (2 * runs["0g"] + runs["300g"]) / 3).reshape(-1, 3, 3)
    each = np.linalg.norm(off, axis=2).mean(axis=0)
    print("\nthe same commands again, mean distance of discs 1, 2, 3 and all, mm")
    for label, scale in (("from the two other runs", 1.0), ("of a run", np.sqrt(9 / 14))):
        print(f"  {label:<24}" + ", ".join(f"{scale * x:.1f}" for x in (*each, each.mean())))


def width_of(angle, place):
    """Of a loop, beside a cubic in the angle: rms, and where the angle falls less where it rises."""
    rest = place - np.polyval(np.polyfit(angle, place, 3), angle)
    rate = np.gradient(np.convolve(np.pad(angle, 2, "edge"), np.ones(5) / 5, "valid"))
    fast = np.abs(rate) > np.median(np.abs(rate))
    return f"{rest.std():.1f} ({rest[fast & (rate < 0)].mean() - rest[fast & (rate > 0)].mean():+.1f})"


def draw_loops(rows, path, piece=5, motors=(1, 2, 3)):
    """Lowest disc along the direction in which a motor moves it, over the angle of that motor."""
    figure, grid = plt.subplots(2, len(motors), figsize=(11, 6.4), sharey=True)
    print("\nwidth of the loops, lowest disc over a motor's angle, mm: rms beside a cubic (angle falls less angle rises)")
    for line, load in zip(grid, ("0g", "300g")):
        some = sorted((r for r in rows if r["trial"] == f"{load}_{piece}" and r["body"] == "disc_3"),
                      key=lambda r: float(r["stamp"]))
        angles = np.array([[float(r[f"motor_{i}"]) for i in range(1, 7)] for r in some])
        read = np.r_[True, np.abs(np.diff(angles, axis=0)).max(axis=1) > 0]  # repeated in between
        some, angles = [r for r, new in zip(some, read) if new], angles[read]
        places = {what: 1e3 * np.array([[float(r[f"{what}_{axis}"]) for axis in "xy"] for r in some])
                  for what in ("measured", "after")}
        slopes = np.linalg.lstsq(np.column_stack([angles, np.ones(len(angles))]), places["measured"], rcond=None)[0]
        for axes, motor in zip(line, motors):
            along = slopes[motor - 1] / np.linalg.norm(slopes[motor - 1])
            others = np.delete(angles, motor - 1, axis=1) @ np.delete(slopes[:6], motor - 1, axis=0)
            widths = [width_of(angles[:, motor - 1], (places[what] - others) @ along) for what in ("measured", "after")]
            print(f"  {load:<5} motor {motor}: measured {widths[0]}, predicted {widths[1]}")
            for what, colour, label in (("measured", COLOURS["0g"], "measured"), ("after", COLOURS["300g"], "predicted")):
                axes.plot(57.29578 * angles[:, motor - 1], (places[what] - others) @ along, color=colour, lw=0.9, label=label)
            axes.set_title(f"motor {motor}, {load[:-1]} g", fontsize=10)
            axes.grid(alpha=0.25)
            for side in ("top", "right"):
                axes.spines[side].set_visible(False)
        line[0].set_ylabel("lowest disc, less the other motors (mm)")
    for axes in grid[-1]:
        axes.set_xlabel("angle of the motor (deg)")
    grid[0][0].legend(fontsize=8, frameon=False)
    figure.tight_layout()
    figure.savefig(path, dpi=75)
    plt.close(figure)


def payloads(work, folder, load, piece):
    rows = [r for r in rows_of(work / folder / f"{load}_{piece}/estimates.csv") if r["status"] == "ok"]
    first = rows[0]["segment"]
    rows = [r for r in rows if r["segment"] == first and r["sd_payload"] is not None]
    return (np.array([float(r["stamp"]) - START_S for r in rows]), np.array([float(r["payload"]) for r in rows]),
            np.array([float(r["sd_payload"]) for r in rows]), np.array([r["identifiable_payload"] == 1 for r in rows]))


def print_payload(work, folder, pieces):
    print(f"\n{folder}: payload (kg) of the last frame of each unseen piece; all frames: identifiable, and so but 2 sd off")
    for load, (_, truth) in LOADS.items():
        cells, identifiable, wrong, inside, count = [], 0, 0, 0, 0  # of frames
        for piece in pieces:
            _, kg, sd, flags = payloads(work, folder, load, piece)
            cells.append(f"{kg[-1]:.2f} ± {sd[-1]:.2f}")
            inside += np.sum(np.abs(kg - truth) < 1.96 * sd)
            identifiable += np.sum(flags)
            wrong += np.sum(flags & (np.abs(kg - truth) > 1.96 * sd))
            count += len(kg)
        print(f"  {load:<5}", ", ".join(cells), f"  95 % intervals hold it in {100 * inside / count:.0f} % of frames; "
              f"identifiable {100 * identifiable / count:.0f} %, wrongly {100 * wrong / count:.1f} %")


def draw_payload(work, folder, path):
    figure, grid = plt.subplots(1, len(HELD_OUT), figsize=(9.5, 3.6), sharey=True)
    for axes, piece in zip(grid, HELD_OUT):
        for load, (_, truth) in LOADS.items():
            t, kg, sd, _ = payloads(work, folder, load, piece)
            axes.fill_between(t, kg - sd, kg + sd, color=COLOURS[load], alpha=0.15, lw=0)
            axes.plot(t, kg, color=COLOURS[load], lw=1.4, label=f"{load[:-1]} g")
            axes.axhline(truth, color=COLOURS[load], lw=1, ls=":")
        axes.set_title(f"unseen piece {piece}", fontsize=10)
        axes.set_xlabel("time (s)")
        axes.set_ylim(-0.15, 0.75)
        axes.grid(alpha=0.25)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    grid[0].set_ylabel("payload (kg), one standard deviation")
    grid[0].legend(fontsize=8, frameon=False, loc="upper right")
    figure.tight_layout()
    figure.savefig(path, dpi=75)
    plt.close(figure)


def swings(data):
    """Half swings of each release along its main direction: amplitude (mm), frequency (Hz), damping ratio."""
    raw = np.genfromtxt(data / "observations_manual_decay_200g.csv", delimiter=",", skip_header=1)
    found, rests = [], []
    for trial in np.unique(raw[:, 0]):
        tip = 1e3 * raw[raw[:, 0] == trial][:, 7:10]
        if tip[-50:].std(axis=0).max() > 1.0:  # a hand takes it up again before the end
            continue
        rest = tip[-30:].mean(axis=0)
        rests.append(rest)
        plane = (tip - rest)[:, [0, 2]]
        path = plane @ np.linalg.svd(plane, full_matrices=False)[2][0]
        peaks = [k for k in range(2, len(path) - 2) if abs(path[k]) == np.abs(path[k - 2:k + 3]).max()]
        swing = [peaks[0]] if peaks else []
        for k in peaks[1:]:  # the largest of each half swing
            if path[k] * path[swing[-1]] < 0:
                swing.append(k)
            elif abs(path[k]) > abs(path[swing[-1]]):
                swing[-1] = k
        for a, b in zip(swing[1:], swing[2:]):  # the first one is the hand's
            if abs(path[b]) < 1.0:  # friction holds it; what is left is the cameras
                break
            decrement = np.log(abs(path[a] / path[b])) / np.pi
            found.append((abs(path[a]), 50.0 / (b - a), decrement / np.hypot(1.0, decrement)))
    return np.array(found), np.array(rests)


def decay(data, path):
    found, rests = swings(data)
    spread = rests.std(axis=0)
    print(f"\nreleases: {len(rests)} that end at rest, {len(found)} half swings; the lowest disc comes to rest within "
          f"{spread[0]:.1f}, {spread[2]:.1f} mm (sd, level), {spread[1]:.1f} mm (height)")
    print("  amplitude (mm)   frequency (Hz)   damping ratio: medians")
    for low, high in ((30, 120), (10, 30), (3, 10), (1, 3)):
        some = found[(found[:, 0] >= low) & (found[:, 0] < high)]
        print(f"  {low:>4} to {high:<6}    {np.median(some[:, 1]):.2f}             {np.median(some[:, 2]):.2f}   ({len(some)})")
    figure, grid = plt.subplots(1, 2, figsize=(9.5, 3.2))
    for axes, column, label in zip(grid, (1, 2), ("frequency (Hz)", "damping ratio")):
        axes.semilogx(found[:, 0], found[:, column], "o", color=COLOURS["0g"], ms=4, alpha=0.6)
        axes.set_xlabel("amplitude of the half swing (mm)")
        axes.set_ylabel(label)
        axes.set_ylim(0, 5.4 if column == 1 else 0.6)
        axes.grid(alpha=0.25)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    figure.tight_layout()
    figure.savefig(path, dpi=75)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=pathlib.Path, required=True, help="folder that contains tendon_trunk/")
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for bags and results")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder for the pictures")
    root = pathlib.Path(__file__).resolve().parent.parent
    parser.add_argument("--program", default=str(root / "scripts" / "softarm"), help="default: scripts/softarm")
    arguments = parser.parse_args()
    data, work, program = arguments.data / "tendon_trunk", arguments.work, arguments.program
    if not data.is_dir():
        sys.exit(f"--data {arguments.data}: there is no folder tendon_trunk in it")
    if shutil.which(program) is None:
        sys.exit(f"--program {program}: cannot be run")
    for folder in (work, arguments.out):
        folder.mkdir(parents=True, exist_ok=True)
    real_trunk_facts.print_facts({load: name for load, (name, _) in LOADS.items()}, data)
    import_all(program, data, work)

    held_out = [f"{load}_{i}" for load in ("0g", "300g") for i in HELD_OUT]
    print(identify(program, work, "both", LOADS, held_out + [f"100g_{i}" for i in range(10)]))
    print(identify(program, work, "unloaded", ["0g"], [f"0g_{i}" for i in HELD_OUT]))
    free = identify(program, work, "each_ei", LOADS, held_out + [f"100g_{i}" for i in range(10)], tie=False)
    print("EI of each segment by itself:\n" + lines_of(free, "bending_stiffness", "LIMIT"))
    robust = identify(program, work, "unloaded_robust", ["0g"], [f"0g_{i}" for i in HELD_OUT], robust=True)
    print("0 g only, without --not-robust:\n" + lines_of(robust, "outliers:", "misfit:", ", after"))
    shapes = rows_of(work / "plot_both/shapes.csv")
    print_shape(shapes)
    print_amplitude(shapes)
    draw_paths(shapes, arguments.out / "real_trunk_paths.png")
    draw_loops(shapes, arguments.out / "real_trunk_loops.png")
    unseen = held_out + [f"100g_{i}" for i in range(10)]
    table = real_regression.errors(real_regression.sequences_of(work / "plot_both/shapes.csv"), unseen, PAST_S, step=8)
    pieces = {load: [name for name in unseen if name.startswith(f"{load}_")] for load in LOADS}
    real_regression.print_errors("every frame of the unseen pieces", table, [
        ("trunk, every frame: 0 g, 300 g", 5, [pieces["0g"], pieces["300g"]]), ("100 g", 5, [pieces["100g"]]),
        (f"all {len(unseen)} pieces", 5, [unseen])])
    print_repeatability(data)

    bags = [work / f"pieces/{load}_{i}.bag" for load in LOADS for i in HELD_OUT]
    shipped = softarm.load_arm(root / "config/arms/tendon_trunk.yaml")
    stiffnesses = {name: one.value for name, one in shipped.constants.items() if name.endswith(".bending_stiffness.base")}
    guesses = []
    for name, factor in (("half", 0.5), ("twice", 2.0)):  # an EI that nobody identified, laws from 0 g
        start = work / f"start_{name}.yaml"
        shipped.with_constants({name: float(f"{factor * ei:.4g}") for name, ei in stiffnesses.items()}).save(start, force=True)
        identify(program, work, f"unloaded_{name}", ["0g"], [f"0g_{i}" for i in HELD_OUT], tie=False, arm=start,
                 more=["--hold", "*.bending_stiffness.*"])
        guesses.append((f"window_{name}", f"unloaded_{name}", PIECE_S))
    for folder, arm, window in (("frame", "both", 0), ("window", "both", PIECE_S), ("window_unloaded", "unloaded", PIECE_S), *guesses):
        run(program, "estimate", "--arm", work / f"{arm}.yaml", *bags, "--unknown", "payload", "--prior", "on", "--window",
            window, "--out", work / folder)
        print_payload(work, folder, HELD_OUT)
    draw_payload(work, "window", arguments.out / "real_trunk_payload.png")
    decay(data, arguments.out / "real_trunk_decay.png")
    releases = sorted((work / "decay").glob("*.bag"))
    # Not one frame can be: no motor angles were recorded, and three discs alone do not tell three segments.
    run(program, "estimate", "--arm", "tendon_trunk", *releases, "--out", work / "releases", fails=True)
    statuses = [r["status"] for bag in releases for r in rows_of(work / f"releases/{bag.stem}/estimates.csv")]
    print("  estimated frame by frame: " + ", ".join(f"{status} {statuses.count(status)}" for status in sorted(set(statuses))))

    # What the arm file leaves out: from pieces of all three recordings.
    report = real_diagnosis.diagnose(program, work / "both.yaml", bags, work / "report", *TIE)
    real_diagnosis.print_report("tendon trunk", report)


if __name__ == "__main__":
    main()
