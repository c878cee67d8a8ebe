#!/usr/bin/python3
"""Draws how fast the virtual rig's own error falls with finer elements and smaller steps, from rig_accuracy's CSV.

scripts/plot_rig.py rig_accuracy.csv --out doc/images/rig_convergence.png
"""
import argparse
import collections

from plotting import die, plt, save, table_of

ALLOWED_MM = 0.02
PANELS = [("elements", "elements along each segment", "in motion, against 4 x as many"),
          ("step", "time step (ms)", "in motion, against 1/12 of the usual step"),
          ("statics", "elements along each segment", "at rest, against the statics of rod/")]


def read(path):
    series = collections.defaultdict(lambda: collections.defaultdict(dict))
    table = table_of(path, ["value", "worst_mm"], ["kind", "scenario"])
    for kind, scenario, value, worst_mm in zip(*(table[name] for name in ("kind", "scenario", "value", "worst_mm"))):
        series[kind][scenario][(1e3 if kind == "step" else 1.0) * value] = worst_mm
    return series


def slope(axes, x, y, order, x_to):
    """A line of that order beside the curves."""
    axes.plot([x, x_to], [y, y * (x_to / x) ** order], color="0.5", linestyle=":", linewidth=1)
    axes.annotate(f"order {abs(order)}", (x_to, y * (x_to / x) ** order), color="0.4", fontsize=8,
                  xytext=(3, 0), textcoords="offset points")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("csv", help="output of rig_accuracy")
    parser.add_argument("--out", required=True, help="picture to write")
    options = parser.parse_args()
    series = read(options.csv)
    missing = [kind for kind, _, _ in PANELS if not series[kind]]
    if missing:
        die(f"{options.csv}: no rows of kind {', '.join(missing)}")

    figure, all_axes = plt.subplots(1, len(PANELS), figsize=(13, 4.2), sharey=True)
    for axes, (kind, label, title) in zip(all_axes, PANELS):
        for scenario, points in sorted(series[kind].items()):
            x = sorted(points)
            axes.plot(x, [max(points[v], 1e-7) for v in x], marker="o", markersize=4, linewidth=1.4, label=scenario)
        axes.axhline(ALLOWED_MM, color="firebrick", linewidth=1, linestyle="--")
        axes.set(xscale="log", yscale="log", xlabel=label, title=title)
        axes.grid(which="major", alpha=0.3)
        ticks = sorted({v for points in series[kind].values() for v in points})
        axes.set_xticks(ticks)
        axes.set_xticklabels([f"{v:.3g}" for v in ticks], fontsize=8, rotation=45 if kind == "step" else 0)
        axes.minorticks_off()
    demo = series["step"].get("demo")
    if demo:
        x = max(demo)
        slope(all_axes[1], x, 0.5 * demo[x], 2, min(demo))
    all_axes[0].set_ylabel("largest error of a ring (mm)")
    all_axes[0].annotate("allowed", (all_axes[0].get_xlim()[0], ALLOWED_MM), color="firebrick", fontsize=8,
                         xytext=(4, 3), textcoords="offset points")
    all_axes[2].legend(fontsize=8, frameon=False)
    figure.tight_layout()
    save(figure, options.out, dpi=110)


if __name__ == "__main__":
    main()
