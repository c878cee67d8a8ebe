#!/usr/bin/python3
"""Finds pressures that move the last body of an arm around a circle, by the model's Jacobian (damped least squares).

    scripts/python python/examples/reach.py --out reach.png
    scripts/python python/examples/reach.py --arm my_arm.yaml --radius 0.03 --payload 0.1
"""
import argparse
import sys

import numpy as np

import softarm

HIGHEST_PA = 100e3
DAMPING_M = 1e-4  # of the least squares: steps that gain less than this are not worth their pressure


def reach(model, chambers, target_m, u_pa, payload_kg):
    """Pressures for one place across the arm's axis, from those of the last; and how far off it stays, m."""
    names = [one.name for one in model.arm.inputs]
    columns = [names.index(name) for name in chambers]
    for _ in range(20):
        shape = model.solve(dict(zip(chambers, u_pa)), payload_kg, gravity_base_m_s2=[0.0, 0.0, 9.81], jacobians=True)
        miss_m = target_m - shape.bodies_p_base_m[0, -1, :2]
        if np.linalg.norm(miss_m) < 1e-6:
            break
        by_bar = shape.jacobians.bodies_by_inputs[0, -1, :2, columns].T * 1e5
        step_bar = by_bar.T @ np.linalg.solve(by_bar @ by_bar.T + DAMPING_M**2 * np.eye(2), miss_m)
        u_pa = np.clip(u_pa + 1e5 * step_bar, 0.0, HIGHEST_PA)
    return u_pa, float(np.linalg.norm(miss_m)), shape


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--arm", default="online_200mm", help="one with pressure chambers (default: %(default)s)")
    parser.add_argument("--radius", type=float, default=0.03, help="of the circle, m (default: %(default)s)")
    parser.add_argument("--payload", type=float, default=0.0, help="kg (default: %(default)s)")
    parser.add_argument("--places", type=int, default=24)
    parser.add_argument("--out", help="the picture, .png or .pdf")
    arguments = parser.parse_args()

    arm = softarm.load_arm(arguments.arm)
    chambers = [one.name for one in arm.inputs if one.kind == "pressure"]
    if not chambers:
        sys.exit(f"reach: {arm.name}: has no pressure chamber")
    model = softarm.Model(arm)
    u_pa, places, shapes = np.full(len(chambers), 20e3), [], []
    angles = np.linspace(0.0, 2.0 * np.pi, arguments.places, endpoint=False)
    for angle in angles:
        u_pa, miss_m, shape = reach(model, chambers, arguments.radius * np.array([np.cos(angle), np.sin(angle)]), u_pa, arguments.payload)
        places.append([*u_pa, miss_m])
        shapes.append(shape)
    path = np.array(places)
    print(f"{arguments.places} places on a circle of {1e3 * arguments.radius:.0f} mm: at most {1e3 * path[:, -1].max():.4f} mm off; pressures "
          f"{1e-3 * path[:, :-1].min():.1f} to {1e-3 * path[:, :-1].max():.1f} kPa")
    if not arguments.out:
        return
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from mpl_toolkits.mplot3d import Axes3D

    figure = plt.figure(figsize=(10.0, 3.8))
    drive, arms = figure.add_subplot(1, 2, 1), figure.add_subplot(1, 2, 2, projection="3d")
    assert isinstance(arms, Axes3D)
    for k, name in enumerate(chambers):
        drive.plot(np.degrees(angles), 1e-3 * path[:, k], ".-", label=name)
    drive.set(xlabel="place on the circle (°)", ylabel="pressure (kPa)")
    drive.legend(fontsize=8)
    for shape in shapes:
        arms.plot(*(1e3 * shape.p_base_m[0].T), color="C0", lw=0.8)
    arms.invert_zaxis()
    arms.set(xlabel="x (mm)", ylabel="y (mm)", zlabel="z (mm)", title="hanging")
    figure.tight_layout()
    figure.savefig(arguments.out, dpi=90)


if __name__ == "__main__":
    try:
        main()
    except (softarm.Error, ValueError) as why:
        sys.exit(f"reach: {why}")
