#!/usr/bin/python3
"""Draws what `softarm identify --plot DIR` wrote: measured against predicted tip before and after, the errors of fitted
and unseen trials, and each constant with its 95 % interval against its start.

    scripts/plot_identify.py DIR --out identify.png
    scripts/plot_identify.py --joints --out doc/images/identify_joints.png      # how joints that yield bend an arm
    scripts/plot_identify.py --wall --out doc/images/identify_wall.png          # how a viscoelastic wall follows
    scripts/plot_identify.py --laws --out doc/images/identify_saturation.png    # how moments saturate and EI grows
"""
import argparse
import json
import math
import os

from plotting import die, plt, save, table_of  # first: it says what is not installed
from softarm_module import softarm
import numpy as np

GRAVITY_M_S2 = 9.80665
GAIN_NM_PER_PA = 6e-6
COLOURS = {"before": "0.65", "after": "C0", "unseen": "C1"}


def read(folder, name, numbers, texts):
    path = os.path.join(folder, name)
    if not os.path.exists(path):
        die(f"{path}: is not there; softarm identify --plot writes it")
    return table_of(path, numbers, texts)


def draw_tip(axes, rows, axis):
    """Predicted against measured coordinate of the last body, mm."""
    tip = rows["body"][-1]
    measured, before, after = (1e3 * rows[f"{what}_{axis}"] for what in ("measured", "before", "after"))
    for held in (0, 1):
        chosen = (rows["body"] == tip) & (rows["held_out"] == held)
        if not chosen.any():
            continue
        axes.plot(measured[chosen], before[chosen], ".", ms=3, color=COLOURS["before"], label=None if held else "before")
        axes.plot(measured[chosen], after[chosen], ".", ms=4, color=COLOURS["unseen" if held else "after"],
                  label="after, " + ("unseen" if held else "fitted"))
    limits = axes.get_xlim()
    axes.plot(limits, limits, "k-", lw=0.6)
    axes.set_xlabel(f"measured {axis} of {tip} (mm)")
    axes.set_ylabel("predicted (mm)")
    axes.grid(alpha=0.3)


def draw_errors(axes, rows):
    """Mean error of each frame's bodies, sorted, mm."""
    _, frame = np.unique(np.char.add(np.char.add(rows["trial"].astype(str), " "), rows["stamp"].astype(str)), return_inverse=True)
    for held, label, colour in ((0, "fitted", COLOURS["after"]), (1, "unseen", COLOURS["unseen"])):
        for column, style in (("error_before", ":"), ("error_after", "-")):
            known = (rows["held_out"] == held) & ~np.isnan(rows[column])
            sums, counts = np.bincount(frame[known], 1e3 * rows[column][known]), np.bincount(frame[known])
            values = np.sort(sums[counts > 0] / counts[counts > 0])
            if len(values):
                axes.plot(values, 100.0 * np.arange(1, len(values) + 1) / len(values), style, color=colour,
                          label=f"{label}, {column[6:]}")
    axes.set_xscale("log")
    axes.set_xlabel("mean error of a frame's bodies (mm)")
    axes.set_ylabel("share of the frames (%)")
    axes.grid(alpha=0.3, which="both")
    axes.legend(fontsize=8)


def draw_constants(axes, rows):
    """Value over start with its 95 % interval; those not determined faint."""
    # Near zero a constant's size is what would matter.
    unit = np.where(rows["initial"] != 0.0, np.abs(rows["initial"]), rows["scale"])
    value, start, half = rows["value"] / unit, rows["initial"] / unit, np.minimum(1.96 * rows["sd"] / unit, 10.0)
    y = np.arange(len(value))[::-1]
    for k, determined in enumerate(rows["determined"] == 1):
        axes.errorbar([value[k]], [y[k]], xerr=[half[k]], fmt="o", ms=4, capsize=3, color="C0" if determined else "0.6")
        axes.plot([start[k]], [y[k]], "|", ms=12, color="k")
    axes.set_yticks(y)
    axes.set_yticklabels([name + ("" if determined else " (not identifiable)")
                          for name, determined in zip(rows["name"], rows["determined"] == 1)], fontsize=8)
    axes.set_xlim(min(0.0, value.min() - 0.3), max(2.0, value.max() + 0.3))
    axes.set_xlabel("value over start (bar: start), 95 % interval")
    axes.grid(alpha=0.3, axis="x")


def arm_of(segments, **more):
    """An arm of these segments, held level."""
    keys = {"format": 1, "name": "drawn", "gravity_m_s2": [0.0, 0.0, -GRAVITY_M_S2], "base": {"fixed": {"attitude": "horizontal"}},
            "segments": [{"name": f"segment_{k + 1}", "diameter_m": 0.04, "torsional_stiffness_nm2": 100.0, **segment}
                         for k, segment in enumerate(segments)], "bodies": [{"name": "tip", "arclength_m": "tip"}], **more}
    return softarm.parse_arm(json.dumps(keys))  # which is YAML


def laws_at(pressures_pa, chamber=(), segment=(), stiffness=()):
    """M0 and EI by the laws, of an arm with two opposite chambers; the second's moment does not count. Pressures (n, 2)."""
    chambers = [{"input": f"chamber_{k + 1}", "bending_direction_deg": 180.0 * k, "moment_gain_nm_per_pa": gain, **dict(chamber)}
                for k, gain in enumerate((GAIN_NM_PER_PA, 0.0))]
    arm = arm_of([{"length_m": 0.2, "mass_per_length_kg_m": 0.0, "bending_stiffness": {"base_nm2": 0.027, **dict(stiffness)},
                   "chambers": chambers, **dict(segment)}],
                 inputs={"pressures": [{"name": one["input"], "topic": one["input"]} for one in chambers]})
    shapes = softarm.Model(arm, points=2).solve(pressures_pa)
    return shapes.M0_nm[:, 0], shapes.EI_nm2[:, 0]


def draw_laws(path):
    """Moment and EI over pressure by the laws of an arm file; dashed, by the virtual rig's own."""
    figure, (own, common, growth) = plt.subplots(1, 3, figsize=(12, 3.8))
    kpa = np.linspace(0.0, 100.0, 201)
    alone = np.stack([1e3 * kpa, 0.0 * kpa], axis=1)
    for k, a in enumerate((0.0, 5e-6, 2e-5, 5e-5)):
        own.plot(kpa, laws_at(alone, {"saturation_per_pa": a})[0], color=f"C{k}", label=f"a = {a:.0e} /Pa" if a else "in proportion")
        if a:  # the same slope at 0: 1 - z + ... is 1 - z / 2 + ... of twice the saturation
            own.plot(kpa, GAIN_NM_PER_PA * (1.0 - np.exp(-2.0 * a * 1e3 * kpa)) / (2.0 * a), "--", lw=1, color=f"C{k}")
    own.plot([], [], "k--", lw=1, label="the virtual rig's law")
    own.set_title("one chamber alone: c p / (1 + a p)", fontsize=10)
    for k, b in enumerate((0.0, 5e-6, 2e-5)):
        for other, style in ((0.0, "-"), (50e3, ":")):
            moment = laws_at(np.stack([1e3 * kpa, other + 0.0 * kpa], axis=1), segment={"chambers_saturation_per_pa": b})[0]
            common.plot(kpa, moment, style, color=f"C{k}", label=(f"b = {b:.0e} /Pa" if b else "in proportion") if not other else None)
    common.plot([], [], "k:", label="another chamber at 50 kPa")
    common.set_title("all chambers: c p / (1 + b (sum of all))", fontsize=10)
    both = np.stack([1e3 * kpa, 1e3 * kpa], axis=1)
    for k, slope in enumerate((0.0, 1e-7, 3e-7)):
        growth.plot(kpa, laws_at(both, stiffness={"per_mean_pressure_nm2_per_pa": slope})[1], color=f"C{k}",
                    label=f"{slope:.0e} N m²/Pa" if slope else "constant")
        if slope:
            growth.plot(kpa, 0.027 + slope * 5e4 * (kpa / 50.0) ** 0.7, "--", lw=1, color=f"C{k}")
    growth.plot([], [], "k--", lw=1, label="the virtual rig's law")
    growth.set_title("EI = base + per_mean_pressure * mean", fontsize=10)
    growth.set_ylim(0, None)
    for axes, across, up in ((own, "pressure (kPa)", "moment (N m)"), (common, "pressure of one (kPa)", "its moment (N m)"),
                             (growth, "mean pressure (kPa)", "EI (N m²)")):
        axes.set_xlabel(across)
        axes.set_ylabel(up)
        axes.set_xlim(0, 100)
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8)
    figure.tight_layout()
    save(figure, path, dpi=75)


def follow(drive, step_s, time_s, begin):
    """An element's state: exact where the drive goes straight."""
    kept = math.exp(-step_s / time_s)
    mean = (1 - kept) * time_s / step_s
    state = [begin]
    for last, now in zip(drive, drive[1:]):
        state.append(kept * state[-1] + (mean - kept) * last + (1 - mean) * now)
    return state


def draw_wall(path):
    """Share of the laws' curvature over time, and over pressure, of walls with one element and two."""
    walls = (("no wall", [], "0.6"), ("0.8 s: 0.3", [(0.8, 0.3)], "C0"),
             ("0.8 s: 0.2, 10 s: 0.3", [(0.8, 0.2), (10, 0.3)], "C1"))
    figure, (hold, loop, start) = plt.subplots(1, 3, figsize=(12, 3.8))
    step_s = 0.02
    times = [step_s * i for i in range(1501)]
    for name, elements, colour in walls:
        def present(drive, begin=0.0):
            out = list(drive)
            for time_s, share in elements:
                state = follow(drive, step_s, time_s, drive[0] + begin)
                out = [o - share * (u - w) for o, u, w in zip(out, drive, state)]
            return out
        stepped = [0.0 if t < 1 else 1.0 if t < 16 else 0.0 for t in times]
        hold.plot(times, present(stepped), color=colour, label=name)
        for period, style in ((4.0, "-"), (20.0, ":")):
            ramp = [1 - abs(2 * ((t / period) % 1) - 1) for t in times]
            last = int(2 * period / step_s) if period < 10 else len(ramp) - int(10 / step_s)
            first = last - int(period / step_s)
            if elements or period < 10:
                loop.plot([50 * r for r in ramp[max(0, first):last]], present(ramp)[max(0, first):last], style, color=colour,
                          label=f"{name}, {period:.0f} s" if elements else name)
        start.plot(times, present([1.0] * len(times), -0.5), color=colour, label=name)
    hold.set_title("inflated for 15 s", fontsize=10)
    loop.set_title("up and down, in 4 and 20 s", fontsize=10)
    start.set_title("at constant inputs, begun at half", fontsize=10)
    for axes, across in ((hold, "time (s)"), (loop, "pressure (kPa)"), (start, "time (s)")):
        axes.set_xlabel(across)
        axes.set_ylim(0, 1.05)
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8, loc="lower right" if axes is not hold else "center")
    hold.set_ylabel("curvature / the laws' at full inflation")
    figure.tight_layout()
    save(figure, path, dpi=75)


def sagging(compliances, stiffness_nm2, tip_n, weight_n=1.0, segment_m=0.1):
    """An arm of segments of one length, clamped level, a joint before each, under its weight and a force at the tip: slope (rad,
    below the horizontal) along it, x and z (m)."""
    arm = arm_of([{"length_m": segment_m, "mass_per_length_kg_m": weight_n / GRAVITY_M_S2 / (segment_m * len(compliances)),
                   "bending_stiffness": {"base_nm2": stiffness_nm2}, "joint_compliance_rad_per_nm": compliance}
                  for compliance in compliances])
    shape = softarm.Model(arm, points=201).solve(payload_kg=tip_n / GRAVITY_M_S2, gravity_base_m_s2=[-GRAVITY_M_S2, 0.0, 0.0])
    qx, qy, qz, qw = shape.q_base_xyzw[0].T
    slope = np.arctan2(-2.0 * (qx * qz + qw * qy), 1.0 - 2.0 * (qx * qx + qy * qy))
    return slope, shape.p_base_m[0, :, 2], shape.p_base_m[0, :, 0]


def draw_joints(path):
    """Two segments held level: shape, sag and slope with joints that yield, beside a softer arm of the same sag."""
    figure, (shape, sag, turn) = plt.subplots(1, 3, figsize=(12, 3.8))
    stiffness, load = 0.06, 0.5

    def softer(low, high, target):
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if sagging((0, 0), middle, load)[2][-1] < target else (low, middle)
        return low

    rows = [("rigid joints", (0.0, 0.0), stiffness, "0.6"), ("base: 1 rad/(N m)", (1.0, 0.0), stiffness, "C0"),
            ("between: 2 rad/(N m)", (0.0, 2.0), stiffness, "C1")]
    target = sagging(rows[1][1], stiffness, load)[2][-1]
    soft = softer(0.01, stiffness, target)
    rows.append((f"rigid joints, EI {stiffness} → {soft:.3f} N m²", (0.0, 0.0), soft, "C0"))
    for k, (name, compliances, bending, colour) in enumerate(rows):
        style = "--" if k == 3 else "-"
        slope, x, z = sagging(compliances, bending, load)
        shape.plot(1e3 * x, 1e3 * z, style, color=colour, label=name)
        turn.plot(np.linspace(0.0, 200.0, len(slope)), np.degrees(slope), style, color=colour)
        loads = [0.05 * i for i in range(21)]
        sag.plot(loads, [-1e3 * sagging(compliances, bending, n)[2][-1] for n in loads], style, color=colour, label=name)
    shape.set_aspect("equal", adjustable="datalim")
    for axes, title, across, up in ((shape, f"held level, {load} N at the tip, 1 N of its own", "x (mm)", "z (mm)"),
                                    (sag, "sag of the tip", "force at the tip (N)", "mm"),
                                    (turn, "slope: a joint turns at once, EI along the arm", "arclength (mm)", "degrees")):
        axes.set_title(title, fontsize=10)
        axes.set_xlabel(across)
        axes.set_ylabel(up)
        axes.grid(alpha=0.3)
    sag.set_ylim(0, 150)
    sag.legend(fontsize=8, loc="upper left")
    figure.tight_layout()
    save(figure, path, dpi=75)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", help="folder that softarm identify --plot wrote")
    parser.add_argument("--laws", action="store_true", help="draw saturation and growth of EI, without a recording")
    parser.add_argument("--joints", action="store_true", help="draw how joints that yield bend an arm, without a recording")
    parser.add_argument("--wall", action="store_true", help="draw how a viscoelastic wall follows, without a recording")
    parser.add_argument("--out", required=True, help="the picture, .png or .pdf")
    arguments = parser.parse_args()
    if arguments.laws:
        draw_laws(arguments.out)
        return
    if arguments.joints:
        draw_joints(arguments.out)
        return
    if arguments.wall:
        draw_wall(arguments.out)
        return
    if not arguments.folder:
        parser.error("name the folder that `softarm identify --plot` wrote, or give --laws, --joints or --wall")
    places = [f"{what}_{axis}" for what in ("measured", "before", "after") for axis in "xyz"]
    shapes = read(arguments.folder, "shapes.csv", ["stamp", "held_out", "error_before", "error_after", *places], ["trial", "body"])
    constants = read(arguments.folder, "constants.csv", ["initial", "value", "sd", "scale", "determined"], ["name"])
    figure, grid = plt.subplots(2, 3, figsize=(15, 9))
    for axes, axis in zip(grid[0], "xyz"):
        draw_tip(axes, shapes, axis)
    grid[0][0].legend(fontsize=8)
    draw_errors(grid[1][0], shapes)
    grid[1][1].remove()
    grid[1][2].remove()
    draw_constants(figure.add_subplot(2, 3, (5, 6)), constants)
    figure.tight_layout()
    save(figure, arguments.out, dpi=80)


if __name__ == "__main__":
    main()
