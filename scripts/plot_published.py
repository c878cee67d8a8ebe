#!/usr/bin/python3
"""Compares the load moments printed in the online paper with statics: shapes of the same arm, and the stiffness that
the printed law finds from points of an exact arm. Draws the figure and prints the tables of doc/published_model.md.

    scripts/plot_published.py --out doc/images/published_laws.png

The script is independent of src/published/published.cpp, and must agree with it.
"""
import argparse
import math

from plotting import plt, save  # first: it says what is not installed
import numpy as np
from scipy.optimize import least_squares

GRAVITY = 9.81
LENGTH, WEIGHT, STIFFNESS = 0.2, 0.2 * GRAVITY, 0.038  # m, N, N m^2
NODES = 201
MOUNTINGS = {"standing": 1.0, "hanging": -1.0}
PAYLOADS_KG = [0.0, 0.05, 0.10, 0.15, 0.17, 0.19, 0.21, 0.23]
MOMENTS = {0.1: "tab:green", 0.2: "tab:orange", 0.3: "tab:blue"}  # N m


def integral(values, spacing):
    return np.concatenate([[0.0], np.cumsum(0.5 * spacing * (values[1:] + values[:-1]))])


def shape(moment, stiffness, length, payload, sign, printed):
    """theta, w, z at the nodes by the relaxed fixed point; payload in N."""
    spacing = length / (NODES - 1)
    s = np.linspace(0.0, length, NODES)
    loads = length**2 / stiffness * (4.0 * payload / math.pi**2 + WEIGHT / 7.8373)
    curvature = np.full(NODES, moment / stiffness)
    for _ in range(5000):
        theta = integral(curvature, spacing)
        w = integral(np.sin(theta), spacing)
        if printed:
            term = integral(np.sin(theta) * (w[-1] - w), spacing)
            added = payload * math.sin(theta[-1]) * (w[-1] - w) + WEIGHT / length * (term[-1] - term)
        else:
            term = integral(w, spacing)
            added = payload * (w[-1] - w) + WEIGHT / length * (term[-1] - term - w * (length - s))
        change = (moment + sign * added) / stiffness - curvature
        if np.max(np.abs(change)) * length < 1e-11:
            return theta, w, integral(np.cos(theta), spacing)
        curvature += change / (1.0 + loads)
    raise RuntimeError("the fixed point did not settle")


def points_mm(parameters, payload, sign, printed):
    """The paper's four points, L/4 ... L."""
    _, w, z = shape(*parameters, payload, sign, printed)
    nodes = (NODES - 1) // 4 * np.arange(1, 5)
    return 1e3 * np.concatenate([w[nodes], z[nodes]])


def fit_printed(moment, payload, sign):
    """M_0, EI, L of the printed law for exact points, and what is left in mm per point (rms)."""
    truth = np.array([moment, STIFFNESS, LENGTH])
    measured = points_mm(truth, payload, sign, printed=False)
    result = least_squares(lambda share: points_mm(share * truth, payload, sign, printed=True) - measured, np.ones(3),
                           bounds=([0.0, 0.05, 0.5], [10.0, 20.0, 2.0]), xtol=1e-12, ftol=1e-12, gtol=1e-12)
    return result.x * truth, math.sqrt(np.sum(result.fun**2) / 4.0)


def draw_shapes(axes, name):
    print(f"{name}, M0 0.3 N m, EI {STIFFNESS} N m^2: payload kg, tip angle deg (statics, printed), tips apart mm")
    for payload_kg, colour in zip([0.0, 0.10, 0.23], ["0.6", "tab:orange", "tab:blue"]):
        tips = []
        for printed, style in ((False, "-"), (True, "--")):
            theta, w, z = shape(0.3, STIFFNESS, LENGTH, payload_kg * GRAVITY, MOUNTINGS[name], printed)
            label = None if printed else f"{payload_kg:.2f} kg"
            axes.plot(1e3 * w, MOUNTINGS[name] * 1e3 * z, style, color=colour, lw=1.8, label=label)
            axes.plot(1e3 * w[-1], MOUNTINGS[name] * 1e3 * z[-1], "o", ms=4, color=colour)
            tips.append((math.degrees(theta[-1]), w[-1], z[-1]))
        apart = 1e3 * math.hypot(tips[0][1] - tips[1][1], tips[0][2] - tips[1][2])
        print(f"  {payload_kg:.2f}  {tips[0][0]:6.1f} {tips[1][0]:6.1f}  {apart:5.1f}")
    axes.set_aspect("equal")
    axes.set_xlabel("deflection w (mm)")
    axes.set_title(f"{name}, $M_0$ 0.3 N m")
    axes.grid(alpha=0.3)


def draw_fits(axes):
    for name, sign in MOUNTINGS.items():
        for moment, colour in MOMENTS.items():
            shares = []
            print(f"printed law fitted to exact points, {name}, M0 {moment} N m: payload kg, EI %, M0 %, L %, rms mm")
            for payload_kg in PAYLOADS_KG:
                found, rms = fit_printed(moment, payload_kg * GRAVITY, sign)
                off = 100.0 * (found / np.array([moment, STIFFNESS, LENGTH]) - 1.0)
                shares.append(100.0 + off[1])
                print(f"  {payload_kg:.2f}  {off[1]:+6.1f} {off[0]:+6.1f} {off[2]:+6.2f}  {rms:.3f}")
            axes.plot(PAYLOADS_KG, shares, "-o" if name == "standing" else "--s", ms=3.5, color=colour,
                      label=f"{name}, {moment} N m")
    axes.axhline(100.0, color="0.3", lw=1)
    axes.set_ylim(0, 110)
    axes.set_xlabel("payload (kg)")
    axes.set_ylabel("EI found, % of the true one")
    axes.set_title("printed law fitted to exact points")
    axes.grid(alpha=0.3)
    axes.legend(fontsize=7, ncol=2, loc="lower center")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", required=True, help="the picture to write (PNG)")
    arguments = parser.parse_args()
    figure, (standing, hanging, fits) = plt.subplots(1, 3, figsize=(12, 4.2), constrained_layout=True,
                                                     gridspec_kw={"width_ratios": [1, 0.8, 1.4]})
    draw_shapes(standing, "standing")
    draw_shapes(hanging, "hanging")
    standing.set_ylabel("height over the base (mm)")
    hanging.plot([], [], "k-", label="statics")
    hanging.plot([], [], "k--", label="as printed")
    hanging.legend(fontsize=7, loc="upper right")
    draw_fits(fits)
    save(figure, arguments.out, dpi=90)


if __name__ == "__main__":
    main()
