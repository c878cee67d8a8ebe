#!/usr/bin/python3
"""Draws what `softarm validate --out FOLDER` wrote: the pictures of doc/validation.md.

    scripts/softarm validate --out validation
    scripts/plot_validation.py validation --out doc/images --doc doc/validation.md

One picture per paper whose CSV files are there: validation_online.png, ... With --doc, the printed tables replace
those of that page.
"""
import argparse
import json
import os
import re

from plotting import die, one_line, plt, save
from softarm_module import softarm

NAN = float("nan")
IDEAL, REAL, THEIRS = "tab:blue", "tab:orange", "tab:gray"


class Rows:
    """One CSV file; columns as lists of numbers, empty cells as NaN."""

    def __init__(self, folder, name):
        path = os.path.join(folder, name + ".csv")
        with one_line():
            table = softarm.read_table(path)
        wrong = [column for column, cells in table.items() if cells.dtype.kind != "f"]
        if wrong:
            die(f"{path}: column {wrong[0]} has a cell that is no number")
        self.rows = [dict(zip(table, cells)) for cells in zip(*table.values())]

    def where(self, **conditions):
        chosen = object.__new__(Rows)
        chosen.rows = [row for row in self.rows if all(row[k] == v for k, v in conditions.items())]
        return chosen

    def __getitem__(self, column):
        return [row[column] for row in self.rows]

    def values(self, column):
        return sorted({row[column] for row in self.rows})


def finite(values):
    return [v for v in values if v == v]


def mean(values):
    values = finite(values)
    return sum(values) / len(values) if values else NAN


def online(folder):
    frames, weights = Rows(folder, "online_frames"), Rows(folder, "online_payload")
    figure, axes = plt.subplots(1, 3, figsize=(13, 4.2))
    methods = [("full_percent", "full\npoints", 2.94), ("end_percent", "end\norientation", 5.47),
               ("cc_points_percent", "CC all\npoints", 6.84), ("cc_end_percent", "CC end\npoint", 7.70)]
    cases = [(s, r) for s in (1, 0) for r in (0, 1) if frames.where(standing=s, real_like=r).rows]
    looks = {(1, 0): ("ideal, standing", IDEAL, None), (1, 1): ("real-like, standing", REAL, None),
             (0, 0): ("ideal, hanging", IDEAL, "//"), (0, 1): ("real-like, hanging", REAL, "//")}
    for k, case in enumerate(cases):
        name, colour, hatch = looks[case]
        chosen = frames.where(standing=case[0], real_like=case[1])
        loaded = [row for row in chosen.rows if row["payload_kg"] > 0]
        heights = [mean([row[m] for row in loaded]) for m, _, _ in methods]
        axes[0].bar([i + (k - 1.5) * 0.2 for i in range(4)], heights, 0.19, color=colour, hatch=hatch,
                    edgecolor="white", label=name)
    axes[0].hlines([m[2] for m in methods], [i - 0.42 for i in range(4)], [i + 0.42 for i in range(4)], color="k",
                   label="published")
    axes[0].set_xticks(range(4))
    axes[0].set_xticklabels([m[1] for m in methods])
    axes[0].set_ylabel("error (7), %")
    axes[0].set_title("Table II: shape, loaded")
    axes[0].legend(fontsize=8)

    chosen = frames.where(standing=1)
    for real, colour, name in ((0, IDEAL, "ideal"), (1, REAL, "real-like")):
        xs, ys = [], []
        for row in chosen.where(real_like=real).rows:
            if row["payload_kg"] > 0 and row["full_EI"] == row["full_EI"]:
                xs.append(row["set"] + (0.15 if real else -0.15))
                ys.append(1e3 * row["full_EI"])
        axes[1].plot(xs, ys, ".", color=colour, markersize=3, label=name)
    for row in chosen.where(real_like=0).rows:
        axes[1].plot([row["set"] - 0.4, row["set"] + 0.4], [1e3 * row["true_EI"]] * 2, "k-", linewidth=0.8)
    axes[1].set_xlabel("combination of pressures")
    axes[1].set_ylabel("EI, mN m²")
    axes[1].set_title("Table III: full points, standing, five loads (line: true)", fontsize=10)
    axes[1].legend(fontsize=8)

    for real, colour, name in ((0, IDEAL, "ideal"), (1, REAL, "real-like")):
        chosen = weights.where(standing=1, real_like=real)
        axes[2].plot([1e3 * v for v in chosen["payload_kg"]], [1e3 * v for v in chosen["estimated_kg"]], ".",
                     color=colour, markersize=4, label=name)
    axes[2].plot([135, 245], [135, 245], "k-", linewidth=0.8)
    axes[2].fill_between([135, 245], [105.1, 215.1], [164.9, 274.9], color=THEIRS, alpha=0.15,
                         label="published max error")
    axes[2].set_xlabel("weight, g")
    axes[2].set_ylabel("estimate, g")
    axes[2].set_title("unseen weights, standing")
    axes[2].legend(fontsize=8)
    return figure


def semi_physical(folder):
    shapes = Rows(folder, "semi_physical_shapes")
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.8), sharey=True)
    for real, axis in enumerate(axes):
        chosen = shapes.where(real_like=real)
        for k, (column, colour, name) in enumerate((("ours_m", IDEAL, "identify, exact statics"),
                                                    ("theirs_m", THEIRS, "procedure and load moments as printed"))):
            for load, hatch in ((0.0, None), (0.2, "//")):
                heights = [100 * mean(chosen.where(trial=t, payload_kg=load)[column]) for t in chosen.values("trial")]
                offset = (k - 0.5) * 0.4 + (0.1 if load else -0.1)
                axis.bar([t + offset for t in chosen.values("trial")], heights, 0.19, color=colour, hatch=hatch,
                         edgecolor="white", label=f"{name}, {1e3 * load:.0f} g")
        axis.axhline(0.85, color="k", linewidth=0.8, label="published mean")
        axis.axhline(3.1, color="k", linewidth=0.8, linestyle=":", label="published maximum")
        axis.set_yscale("log")
        axis.set_xlabel("trial not fitted")
        axis.set_title(("ideal arm", "real-like arm")[real])
    axes[0].set_ylabel("mean error of three points, cm")
    axes[0].set_ylim(0.03, 30)
    figure.legend(*axes[0].get_legend_handles_labels(), fontsize=8, ncol=3, loc="upper center")
    figure.tight_layout(rect=(0, 0, 1, 0.87))
    return figure


def single_chamber(folder):
    surface = Rows(folder, "single_chamber_surface")
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.8))
    pressures = surface.values("pressure_pa")
    colours = plt.cm.viridis([i / len(pressures) for i in range(len(pressures))])
    for pressure, colour in zip(pressures, colours):
        chosen = surface.where(pressure_pa=pressure)
        force = [1e3 * f for f in chosen["force_n"]]
        axes[0].plot(force, [k for k in chosen["printed_boundary"]], color=colour,
                     label=f"{pressure / 1e3:.0f} kPa")
        axes[0].plot(force, [k for k in chosen["printed_initial"]], color=colour, linestyle="--")
        axes[1].plot(force, [k for k in chosen["fitted_boundary"]], color=colour, label=f"{pressure / 1e3:.0f} kPa")
    axes[0].set_title("constants as printed: boundary values (full), initial values (dashed)", fontsize=9)
    axes[1].set_title("the modulus that each published stiffness asks for", fontsize=9)
    published = [(51, 3.4), (64, 4.3), (73, 4.9), (89, 5.9)]
    for axis in axes:
        axis.plot([p[0] for p in published], [p[1] for p in published], "kx", label="published, force / 15 mm")
        axis.set_xlabel("tip force, mN")
        axis.set_ylim(1.5, 6.6)
        axis.legend(fontsize=7)
    axes[0].set_ylabel("tangent k, mN/mm")
    return figure


def hybrid(folder):
    rigidity, moduli, tips = Rows(folder, "hybrid_rigidity"), Rows(folder, "hybrid_modulus"), Rows(folder, "hybrid_tips")
    figure, axes = plt.subplots(1, 3, figsize=(13, 4.0))
    kpa = [p / 1e3 for p in moduli["pressure_pa"]]
    for column, name in (("printed", "(26) set equal to"), ("chain_rule", "(26) as it stands"),
                         ("tangent", "uniaxial tangent modulus")):
        axes[0].plot(kpa, [1e5 * v for v in moduli[column]], label=name)
    axes[0].axhline(0.0, color="k", linewidth=0.5)
    axes[0].set_title("EI by the printed constants")
    axes[0].set_xlabel("pressure, kPa")
    axes[0].set_ylabel("EI, 1e-5 N m²")
    axes[0].legend(fontsize=8)
    kpa = [p / 1e3 for p in rigidity["pressure_pa"]]
    axes[1].plot(kpa, [1e4 * v for v in rigidity["true"]], "k-", linewidth=0.8, label="true")
    for column, colour, name in (("ideal", IDEAL, "ideal"), ("real_like", REAL, "real-like")):
        axes[1].errorbar(kpa, [1e4 * v for v in rigidity[column]], [1.96e4 * v for v in rigidity[column + "_sd"]],
                         fmt="o", color=colour, markersize=4, label=name + ", 95 %")
    axes[1].set_title("Figure 8: EI identified from the tip")
    axes[1].set_xlabel("pressure, kPa")
    axes[1].set_ylabel("EI, 1e-4 N m²")
    axes[1].legend(fontsize=8)
    chosen = tips.where(real_like=1, experiment=3)
    for prefix, style, name in (("measured", "ko", "measured (rig, real-like)"), ("ours", "C0x", "predicted"),
                                ("printed", "C3+", "printed equations")):
        axes[2].plot([1e3 * v for v in chosen[prefix + "_y"]], [1e3 * v for v in chosen[prefix + "_x"]], style,
                     markersize=6, fillstyle="none", label=name)
    axes[2].set_aspect("equal")
    axes[2].set_ylim(-45, 40)
    axes[2].set_title("tip at 30 kPa: tendon 2 (right), 3 (left)", fontsize=10)
    axes[2].set_xlabel("y, mm")
    axes[2].set_ylabel("x, mm")
    axes[2].legend(fontsize=8)
    return figure


def cable(folder):
    marks = Rows(folder, "cable_marks")
    figure, axes = plt.subplots(1, 3, figsize=(13, 4.2))
    panels = [("real-like arm, 14.63 g at the tip", marks.where(truth=1, mid_span=0, load_kg=0.01463)),
              ("real-like arm, 29.21 g at the tip", marks.where(truth=1, mid_span=0, load_kg=0.02921)),
              ("real-like arm, 29.21 g at 0.12 m", marks.where(truth=1, mid_span=1))]
    for axis, (title, rows) in zip(axes, panels):
        for i, pwm in enumerate(rows.values("pwm")):
            chosen = rows.where(pwm=pwm)
            for prefix, style, name in (("measured", "ko", "marks"), ("ours", "C0-", "exact statics"),
                                        ("theirs", "C3--", "their model")):
                axis.plot([0] + [1e3 * v for v in chosen[prefix + "_along"]],
                          [0] + [1e3 * v for v in chosen[prefix + "_up"]], style, markersize=3, linewidth=1,
                          label=name if i == 0 else None)
        axis.set_aspect("equal")
        axis.set_xlim(0, 245)
        axis.set_ylim(-130, 80)
        axis.set_title(title, fontsize=10)
        axis.set_xlabel("along, mm")
    axes[0].set_ylabel("up, mm")
    axes[0].legend(fontsize=8)
    return figure


PICTURES = {"online": (online, "online_frames"), "semi_physical": (semi_physical, "semi_physical_shapes"),
            "single_chamber": (single_chamber, "single_chamber_surface"), "hybrid": (hybrid, "hybrid_tips"),
            "cable": (cable, "cable_marks")}


def renew_tables(folder, page):
    """Every "<!-- table ID -->" and the block after it: the text of that table."""
    path = os.path.join(folder, "validation.json")
    try:
        with open(path, encoding="utf-8") as file:
            papers = json.load(file)["papers"]
        tables = {table["id"]: table["text"] for paper in papers for table in paper["tables"]}
    except (OSError, ValueError, KeyError, TypeError) as why:
        die(f"{path}: not what softarm validate writes ({why})")
    try:
        with open(page, encoding="utf-8") as file:
            text = file.read()
    except (OSError, UnicodeDecodeError) as why:
        die(f"{page}: {getattr(why, 'strerror', None) or 'no text'}")

    def renewed(found):
        name = found.group(1)
        return f"<!-- table {name} -->\n```\n{tables[name]}```\n" if name in tables else found.group(0)

    text = re.sub(r"<!-- table (\S+) -->\n```\n.*?```\n", renewed, text, flags=re.DOTALL)
    try:
        with open(page, "w", encoding="utf-8") as file:
            file.write(text)
    except OSError as why:
        die(f"{page}: cannot be written: {why.strerror}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", help="folder that softarm validate --out wrote")
    parser.add_argument("--out", help="folder for the pictures (default: that of the data)")
    parser.add_argument("--doc", help="page whose tables are replaced: doc/validation.md")
    options = parser.parse_args()
    drawn = 0
    for name, (draw, needed) in PICTURES.items():
        if not os.path.exists(os.path.join(options.folder, needed + ".csv")):
            continue
        try:
            figure = draw(options.folder)
        except KeyError as why:
            die(f"{options.folder}: no column {why.args[0]} in the CSV files of {name}")
        if name != "semi_physical":  # has laid itself out around its legend
            figure.tight_layout()
        path = os.path.join(options.out or options.folder, f"validation_{name}.png")
        save(figure, path, dpi=100)
        print(path)
        drawn += 1
    if drawn == 0:
        die(f"{options.folder}: no CSV files of softarm validate are there")
    if options.doc:
        renew_tables(options.folder, options.doc)


if __name__ == "__main__":
    main()
