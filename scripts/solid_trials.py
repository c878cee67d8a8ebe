"""Trials as a laboratory would have them, of the finite-element arm's states of rest: markers with noise, clusters fitted as
rigid bodies, pressures logged; used by solid_arm.py and prove_solid.py. The arm itself is in test/data/solid."""
import csv
import math
import os
import subprocess

import numpy as np

RATE_HZ = 20.0
HOLD_S = 2.0            # of it the cameras' pictures are taken
SETTLE_S = 1.0          # between the last picture and a ramp, and again before the next: a line between pictures is no lag
RAMP_S = 2.0
MARKER_SD_M = 0.0003    # of one marker, per coordinate and picture
PRESSURE_SD_PA = 50.0
MOUNT_SD_DEG = 0.05     # how well a mount's attitude is known
MOUNT_SD_M = 0.0001
BASE_M = np.array([0.4, -0.2, 1.1])
# The arm's z axis, and the direction of gravity in the arm's frame where that axis does not say it, in the mocap frame.
MOUNTED = {"hanging": np.diag([1.0, -1.0, -1.0]), "standing": np.eye(3)}


def attitude(name, gravity):
    """Rotation from the arm's base frame to the mocap's, whose gravity is along -z."""
    if name in MOUNTED:
        return MOUNTED[name]
    down, along = np.asarray(gravity, float), np.array([0.0, 0.0, 1.0])
    down /= np.linalg.norm(down)
    arm = np.column_stack([down, along, np.cross(down, along)])
    room = np.column_stack([[0, 0, -1.0], [1.0, 0, 0], np.cross([0, 0, -1.0], [1.0, 0, 0])])
    return room @ arm.T


def small_turn(vector):
    """Rotation by a small vector."""
    angle = np.linalg.norm(vector)
    if angle == 0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def quaternion(turn):
    """x, y, z, w."""
    four = np.array([turn[0, 0] - turn[1, 1] - turn[2, 2], turn[1, 1] - turn[0, 0] - turn[2, 2],
                     turn[2, 2] - turn[0, 0] - turn[1, 1], np.trace(turn)])
    most = int(np.argmax(four))
    q = np.zeros(4)
    q[most] = math.sqrt(1 + four[most]) / 2
    if most == 3:
        q[:3] = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / (4 * q[3])
    else:
        i, j, k = most, (most + 1) % 3, (most + 2) % 3
        q[j] = (turn[j, i] + turn[i, j]) / (4 * q[i])
        q[k] = (turn[k, i] + turn[i, k]) / (4 * q[i])
        q[3] = (turn[k, j] - turn[j, k]) / (4 * q[i])
    return q if q[3] >= 0 else -q


def rigid_fit(reference, seen):
    """Rotation and place that carry the reference's points nearest to those seen (Kabsch 1976)."""
    middle, there = reference.mean(axis=0), seen.mean(axis=0)
    u, _, v = np.linalg.svd((reference - middle).T @ (seen - there))
    turn = v.T @ np.diag([1, 1, np.sign(np.linalg.det(v.T @ u.T))]) @ u.T
    return turn, there - turn @ middle


def read_states(path, bodies, markers):
    """The trials of a case: {name: [(attitude, payload_kg, pressures, markers: body x marker x 3 in m)]}."""
    trials = {}
    with open(path, newline="", encoding="ascii") as text:
        for row in csv.DictReader(text):
            marks = np.array([[[float(row[f"{body}_{i + 1}_{axis}_mm"]) for axis in "xyz"] for i in range(markers)]
                              for body in bodies]) * 1e-3
            trials.setdefault(row["trial"], []).append((row["attitude"], float(row["payload_kg"]),
                                                        [float(row[f"p{i}_pa"]) for i in (1, 2, 3)], marks))
    return trials


def reference_of(plan):
    """Where a body's markers sit on the skin at rest without gravity, its section's middle at 0."""
    around = np.radians(plan["marker_deg"])
    return plan["arm"]["radius_m"] * np.column_stack([np.cos(around), np.sin(around), 0 * around])


def logged(pressures, lie):
    """What the log says of pressures that the arm has: of one chamber an offset, or a valve that loses the first of what is
    asked of it."""
    said = list(pressures)
    if lie:
        which = lie["chamber"] - 1
        said[which] += lie.get("offset_pa", 0.0)
        if said[which] > 0:
            said[which] += lie.get("lost_pa", 0.0)
    return said


def rows_of(states, plan, reference, dice, lie=None):
    """Rows of a recording: time, base, bodies (empty while the arm is on its way), pressures in kPa."""
    turn = attitude(states[0][0], plan["attitudes"][states[0][0]])
    base_turn = turn @ small_turn(np.radians(MOUNT_SD_DEG) * dice.standard_normal(3))
    base = [*(BASE_M + MOUNT_SD_M * dice.standard_normal(3)), *quaternion(base_turn)]
    rows, before, now = [], None, 0.0

    def row(pressures, poses):
        log = np.round(np.array(logged(pressures, lie)) + PRESSURE_SD_PA * dice.standard_normal(3), -1) / 1e3
        rows.append([f"{now:.3f}", *(f"{x:.6f}" for x in base), *poses, *(f"{p:.2f}" for p in log)])

    empty = [""] * 7 * len(plan["bodies"])
    for _, _, pressures, marks in states + [states[0]]:
        for i in range(int((RAMP_S + 2 * SETTLE_S) * RATE_HZ) if before is not None else 0):
            done = min(1.0, max(0.0, (i / RATE_HZ - SETTLE_S) / RAMP_S))
            share = done * done * (3 - 2 * done)
            row([a + share * (b - a) for a, b in zip(before, pressures)], empty)
            now += 1 / RATE_HZ
        for _ in range(int(HOLD_S * RATE_HZ)):
            poses = []
            for body, seen in zip(plan["bodies"], marks):
                found, place = rigid_fit(reference, seen @ turn.T + BASE_M + MARKER_SD_M * dice.standard_normal(seen.shape))
                poses += [f"{x:.6f}" for x in [*place, *quaternion(found)]]
            row(pressures, poses)
            now += 1 / RATE_HZ
        before = pressures
    return rows


def layout(plan):
    """The layout for `softarm import`."""
    names = list(plan["bodies"])
    bodies = "".join(f"    - {{name: {name}, position: [{c}, {c + 1}, {c + 2}], "
                     f"orientation: [{c + 3}, {c + 4}, {c + 5}, {c + 6}], orientation_order: xyzw}}\n"
                     for name, c in zip(["base"] + names, range(2, 2 + 7 * (len(names) + 1), 7)))
    first = 2 + 7 * (len(names) + 1)
    inputs = "".join(f"    - {{topic: /pressure/chamber_{i + 1}, column: {first + i}}}\n" for i in range(3))
    return ("header: true\ntime: {column: 1, unit: s}\nmocap:\n  unit: m\n  up: z\n  bodies:\n" + bodies +
            "pressures:\n  unit: kPa\n  reference: gauge\n  inputs:\n" + inputs)


def write_trials(plan, results, trials, out, seed, program, beside=None):
    """Makes the bags of a case of the plan's "trials": results of one of its cases, and what the log says of them. Returns
    their paths. seed: a number, or several. beside: another case; only the trials that it has, too: with a wall the solver found
    some states in vain."""
    os.makedirs(out, exist_ok=True)
    reference, told = reference_of(plan), plan["trials"][trials]
    with open(os.path.join(out, "layout.yaml"), "w", encoding="ascii") as text:
        text.write(layout(plan))
    found = read_states(os.path.join(results, told["case"] + ".csv"), plan["bodies"], len(reference))
    if beside is not None:
        others = read_states(os.path.join(results, plan["trials"][beside]["case"] + ".csv"), plan["bodies"], len(reference))
        found = {trial: states for trial, states in found.items() if trial in others}
    bags = []
    for number, (_, states) in enumerate(sorted(found.items())):
        dice = np.random.Generator(np.random.PCG64([*np.atleast_1d(seed), number]))
        recording = os.path.join(out, f"trial_{number + 1}.csv")
        columns = [f"{body}_{c}" for body in ["base", *plan["bodies"]] for c in ("x", "y", "z", "qx", "qy", "qz", "qw")]
        with open(recording, "w", encoding="ascii") as text:
            text.write(",".join(["t", *columns, "p1", "p2", "p3"]) + "\n")
            text.writelines(",".join(row) + "\n" for row in rows_of(states, plan, reference, dice, told.get("lie")))
        bags.append(os.path.join(out, f"trial_{number + 1}.bag"))
        subprocess.run([program, "import", os.path.join(out, "layout.yaml"), recording, "--payload", f"{states[0][1]:g}",
                        "--out", bags[-1], "--force"], check=True, capture_output=True)
        os.remove(recording)
    return bags
