#!/usr/bin/python3
"""Draws estimates.csv of `softarm estimate`: tip angle, moment, stiffness, length and payload over time with their
standard deviations. Frames in which a value is identifiable are drawn solid, the others faint.

    scripts/plot_estimates.py estimates/trial/estimates.csv --out trial.png
"""
import argparse
import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend is chosen first)

NAN = float("nan")
# Column, label, its standard deviation's column, the flag that says whether the frame identifies it.
PANELS = [
    ("theta_tip", "tip angle (rad)", None, None),
    ("M0", "$M_0$ (N m)", "sd_M0", None),
    ("EI", "EI (N m²)", "sd_EI", "identifiable_EI"),
    ("L", "L (m)", "sd_L", None),
    ("payload", "payload (kg)", "sd_payload", "identifiable_payload"),
]


def read(path, segment):
    with open(path, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if int(row["segment"]) == segment and row["status"] == "ok"]
    if not rows:
        sys.exit(f"plot_estimates: {path}: no frame of segment {segment} has an estimate")
    return rows


def numbers(rows, column):
    return [float(row[column]) if row[column] else NAN for row in rows]


def finite(values):
    return sorted(v for v in values if v == v)


def draw(axes, rows, times, panel, colour):
    column, name, sd_column, identifiable_column = panel
    values = numbers(rows, column)
    identifiable = [row[identifiable_column] == "1" for row in rows] if identifiable_column else [True] * len(rows)
    axes.plot(times, [v if not t else NAN for v, t in zip(values, identifiable)], ".", ms=2, alpha=0.25, color=colour)
    axes.plot(times, [v if t else NAN for v, t in zip(values, identifiable)], ".", ms=3, color=colour)
    if sd_column:
        sds = numbers(rows, sd_column)
        axes.fill_between(times, [v - s for v, s in zip(values, sds)], [v + s for v, s in zip(values, sds)],
                          color=colour, alpha=0.15, lw=0)
    axes.set_ylabel(name)
    axes.grid(alpha=0.3)
    if identifiable_column:
        estimated = any(row[sd_column] for row in rows)
        share = 100.0 * sum(identifiable) / len(identifiable)
        if estimated:
            note = f"identifiable in {share:.0f} % of the frames"
        else:  # a value that changes without a standard deviation rests on what the estimator takes for likely
            note = "given, not estimated" if len(set(finite(values))) <= 1 else "not determined in any frame"
        axes.text(0.995, 0.04, note, transform=axes.transAxes, ha="right", fontsize=8)
    return finite(values)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("csv", nargs="+", help="estimates.csv; several are drawn side by side")
    parser.add_argument("--out", required=True, help="the picture, .png or .pdf")
    parser.add_argument("--segment", type=int, default=1, help="counted from 1 at the base (default: %(default)s)")
    parser.add_argument("--title", nargs="*", default=[], help="one per file")
    arguments = parser.parse_args()

    count = len(arguments.csv)
    figure, grid = plt.subplots(len(PANELS), count, sharex="col", sharey="row", squeeze=False,
                                figsize=(4.6 * count + 1.0, 9.5))
    for c, path in enumerate(arguments.csv):
        rows = read(path, arguments.segment)
        start = float(rows[0]["stamp"])
        times = [float(row["stamp"]) - start for row in rows]
        for r, panel in enumerate(PANELS):
            values = draw(grid[r][c], rows, times, panel, f"C{r}")
            if values:  # a few wild values must not flatten the rest
                low, high = values[len(values) // 50], values[-1 - len(values) // 50]
                margin = 0.25 * (high - low) or 0.1 * abs(high) or 1e-3
                old_low, old_high = grid[r][c].get_ylim() if c else (low, high)
                grid[r][c].set_ylim(min(old_low, low - margin), max(old_high, high + margin))
        grid[0][c].set_title(arguments.title[c] if c < len(arguments.title) else path, fontsize=10)
        grid[-1][c].set_xlabel("time (s)")
    figure.tight_layout()
    figure.savefig(arguments.out, dpi=80)


if __name__ == "__main__":
    main()
