#!/usr/bin/python3
"""Draws estimates.csv of `softarm estimate`: tip angle, φ, moment, stiffness, length, payload and residual over time with
their standard deviations. Frames in which a value is identifiable are drawn solid, the others faint. Times at which the payload
changes or has just changed (`settling`) are hatched.

    scripts/plot_estimates.py estimates/trial/estimates.csv --out trial.png

The truth of a trial of the virtual rig, trial.truth.csv, is drawn, too, if it is in the folder above that of estimates.csv or one
further up, as it is when both commands were run in one folder. --truth names another file.
"""
import argparse
import os

from plotting import die, plt, save, table_of  # first: it says what is not installed
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

DEGREES = 180.0 / np.pi
VAGUE_RAD = 0.5  # of φ: beyond this standard deviation it is drawn faint
# Column, label, its standard deviation's column, the flag that says whether the frame identifies it, scale, of the truth.
PANELS = [
    ("theta_tip", "tip angle (°)", None, None, DEGREES, "theta_tip"),
    ("phi", "φ (°)", "sd_phi", None, DEGREES, "phi"),
    ("M0", "$M_0$ (N m)", "sd_M0", None, 1.0, "M0"),
    ("EI", "EI (N m²)", "sd_EI", "identifiable_EI", 1.0, "EI"),
    ("L", "L (mm)", "sd_L", None, 1e3, "L"),
    ("payload", "payload (g)", "sd_payload", "identifiable_payload", 1e3, "payload"),
    ("rms_residual", "residual (mm)", None, None, 1e3, None),
]
SETTLING = dict(facecolor="0.93", edgecolor="0.8", hatch="//", lw=0)
OF_THE_ARM = ("theta_tip", "payload")  # not of a segment


def read(path, segment):
    """The columns of the frames that have an estimate of this segment."""
    rows = table_of(path, ["stamp", "segment", *(name for panel in PANELS for name in (panel[0], *panel[2:4]) if name)], ["status"])
    chosen = (rows["segment"] == segment) & (rows["status"] == "ok")
    if not chosen.any():
        die(f"{path}: no frame of segment {segment} has an estimate")
    return {name: column[chosen] for name, column in rows.items()}


def truth_beside(path):
    """trial.truth.csv of ESTIMATES/trial/estimates.csv, if it lies where the trial was simulated."""
    folder = os.path.dirname(os.path.abspath(path))
    for above in (os.path.dirname(folder), os.path.dirname(os.path.dirname(folder))):
        found = os.path.join(above, os.path.basename(folder) + ".truth.csv")
        if os.path.isfile(found):
            return found
    return None


def read_truth(path, rows):
    """None where it is of another time."""
    truth = table_of(path, ["stamp"])
    wrong = [panel[5] for panel in PANELS if panel[5] in truth and truth[panel[5]].dtype.kind != "f"]
    if wrong:
        die(f"{path}: column {wrong[0]} has a cell that is no number")
    apart = truth["stamp"][0] > rows["stamp"][-1] or truth["stamp"][-1] < rows["stamp"][0]
    return None if apart else truth


def finite(values):
    return values[np.isfinite(values)]


def true_values(truth, column, segment):
    """As the estimate has them: M0 is not negative, and without a moment there is no direction."""
    suffix = "" if segment == 1 or column in OF_THE_ARM else f"_{segment}"
    values = truth.get(column + suffix, np.full(len(truth["stamp"]), np.nan))
    if column not in ("M0", "phi"):
        return values
    moments = truth.get("M0" + suffix, np.full(len(values), np.nan))
    if column == "M0":
        return np.abs(moments)
    least = 0.02 * np.max(np.abs(finite(moments)), initial=0.0)
    turned = np.where(moments >= 0.0, values, values + np.pi)
    turned = np.where(np.abs(moments) > least, (turned + np.pi) % (2.0 * np.pi) - np.pi, np.nan)
    turned[1:][np.abs(np.diff(turned)) > np.pi] = np.nan
    return turned


def draw_truth(axes, truth, start, panel, segment):
    column, scale = panel[5], panel[4]
    if not truth or column is None:
        return np.array([])
    values = scale * true_values(truth, column, segment)
    axes.plot(truth["stamp"] - start, values, "-", lw=1.2, color="black", zorder=3)
    return finite(values)


def draw(axes, rows, times, panel, colour):
    column, name, sd_column, identifiable_column, scale, _ = panel
    values = scale * rows[column]
    identifiable = rows[identifiable_column] == 1 if identifiable_column else np.ones(len(values), bool)
    if column == "phi":
        identifiable = rows[sd_column] < VAGUE_RAD
    axes.plot(times, np.where(identifiable, np.nan, values), ".", ms=2, alpha=0.25, color=colour)
    axes.plot(times, np.where(identifiable, values, np.nan), ".", ms=3, color=colour)
    if sd_column:
        sds = scale * rows[sd_column]
        axes.fill_between(times, values - sds, values + sds, color=colour, alpha=0.15, lw=0)
    axes.set_ylabel(name)
    axes.grid(alpha=0.3)
    if identifiable_column:
        if finite(rows[sd_column]).size:
            note = f"identifiable in {100.0 * identifiable.mean():.0f} % of the frames"
        else:  # of EI and payload one is given where the other is estimated
            other = finite(rows["sd_payload" if column == "EI" else "sd_EI"]).size
            note = "given, not estimated" if other or len(set(finite(values))) <= 1 else "not determined in any frame"
        axes.text(0.995, 0.04, note, transform=axes.transAxes, ha="right", fontsize=8)
    return finite(values)


def shade_settling(axes, rows, times):
    """Whether there is such a frame. Older tables have no such column."""
    settling = rows.get("settling", np.zeros(len(times))) == 1
    changes = np.flatnonzero(np.diff(np.concatenate([[False], settling, [False]]).astype(int)))
    for first, end in zip(changes[::2], changes[1::2]):
        axes.axvspan(times[first], times[min(end, len(times) - 1)], zorder=0, **SETTLING)
    return bool(settling.any())


def legend(figure, with_truth, with_settling):
    grey = "0.35"
    looks = [Line2D([], [], ls="", marker=".", ms=7, color=grey, label="estimated, identifiable"),
             Line2D([], [], ls="", marker=".", ms=7, alpha=0.3, color=grey, label="estimated, not identifiable"),
             Patch(color=grey, alpha=0.2, lw=0, label="± 1 standard deviation")]
    if with_settling:
        looks.append(Patch(label="the payload changes, or has just changed", **SETTLING))
    if with_truth:
        looks.append(Line2D([], [], color="black", lw=1, label="truth"))
    figure.legend(handles=looks, loc="upper center", ncol=2, frameon=False, fontsize=9)


def limits(values):
    """A few wild values must not flatten the rest."""
    low, high = values[len(values) // 50], values[-1 - len(values) // 50]
    margin = 0.25 * (high - low) or 0.1 * abs(high) or 1e-3
    return low - margin, high + margin


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("csv", nargs="+", help="estimates.csv; several are drawn side by side")
    parser.add_argument("--out", required=True, help="the picture, .png or .pdf")
    parser.add_argument("--segment", type=int, default=1, help="counted from 1 at the base (default: %(default)s)")
    parser.add_argument("--title", nargs="*", default=[], help="one per file")
    parser.add_argument("--truth", nargs="*", default=[], help="TRIAL.truth.csv of softarm simulate, one per file")
    arguments = parser.parse_args()

    count = len(arguments.csv)
    figure, grid = plt.subplots(len(PANELS), count, sharex="col", sharey="row", squeeze=False,
                                figsize=(4.6 * count + 1.0, 12.5))
    with_truth = with_settling = False
    for c, path in enumerate(arguments.csv):
        rows = read(path, arguments.segment)
        start = rows["stamp"][0]
        times = rows["stamp"] - start
        truth_file = arguments.truth[c] if c < len(arguments.truth) else truth_beside(path)
        truth = read_truth(truth_file, rows) if truth_file else None
        with_truth = with_truth or bool(truth)
        for r, panel in enumerate(PANELS):
            with_settling |= shade_settling(grid[r][c], rows, times)
            values = draw(grid[r][c], rows, times, panel, f"C{r}")
            values = np.sort(np.concatenate([values, draw_truth(grid[r][c], truth, start, panel, arguments.segment)]))
            if values.size:
                low, high = limits(values)
                old_low, old_high = grid[r][c].get_ylim() if c else (low, high)
                grid[r][c].set_ylim(min(old_low, low), max(old_high, high))
        grid[0][c].set_xlim(0.0, max(times[-1], 1e-3))
        grid[0][c].set_title(arguments.title[c] if c < len(arguments.title) else path, fontsize=10)
        grid[-1][c].set_xlabel("time (s)")
    figure.tight_layout(rect=(0.0, 0.0, 1.0, 0.955))
    legend(figure, with_truth, with_settling)
    save(figure, arguments.out, dpi=80)


if __name__ == "__main__":
    main()
