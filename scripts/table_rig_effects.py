#!/usr/bin/python3
"""Prints the table of doc/rig.md: error, size and speed of every effect that acts on the arm, from rig_accuracy's CSV.

rig_accuracy --effects > effects.csv; scripts/table_rig_effects.py effects.csv
"""
import argparse
import collections
import csv
import sys

COLUMNS = ["effect", "in", "step, mm", "elements, mm", "moves a ring, mm", "x real time"]


def number(text):
    value = float(text)
    if value < 5e-5:
        return "0"
    return f"{value:.4f}" if value < 0.1 else f"{value:.2g}" if value < 10 else f"{value:.0f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("csv", help="output of rig_accuracy --effects")
    options = parser.parse_args()
    with open(options.csv, newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["step_worst_mm"]]
    if not rows:
        sys.exit(f"table_rig_effects.py: {options.csv}: no rows of effects that act on the arm")

    # One line per effect and scenario, its forms side by side.
    lines = collections.OrderedDict()
    for row in rows:
        lines.setdefault((row["effect"], row["scenario"]), []).append(row)
    print("| " + " | ".join(COLUMNS) + " |")
    print("|---" * len(COLUMNS) + "|")
    for (effect, scenario), forms in lines.items():
        names = ", ".join(row["form"] for row in forms if row["form"])

        def cell(key, show=number):
            return " / ".join(show(row[key]) for row in forms)
        name = f"`{effect}`" + (f" {names}" if names else "") if effect != "ideal" else "nothing hidden"
        print(f"| {name} | `{scenario}` | {cell('step_worst_mm')} | {cell('elements_worst_mm')} | "
              f"{cell('arm_mm')} | {cell('speed', lambda text: f'{float(text):.0f}')} |")


if __name__ == "__main__":
    main()
