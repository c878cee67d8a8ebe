#!/usr/bin/python3
"""Computes a silicone arm by finite elements (gmsh, CalculiX) through its states of rest; scripts/solid_arm runs it."""
import argparse
import concurrent.futures
import copy
import json
import math
import os
import random
import sys

import numpy as np

import solid_deck
import solid_mesh
import solid_trials


def say(text):
    print(text, file=sys.stderr, flush=True)


def read_plan(path):
    with open(path, encoding="utf-8") as text:
        return json.load(text)


def arm_of(plan, case):
    """The arm of a case: what all have, and what is hidden in it."""
    arm = copy.deepcopy(plan["arm"])
    arm.update(plan["cases"][case].get("arm", {}))
    return arm


def chambers_of(arm):
    radii = arm.get("chamber_radii_m", [arm["chamber_radius_m"]] * 3)
    return [solid_mesh.Chamber(radius, arm["chamber_offset_m"], math.radians(azimuth))
            for radius, azimuth in zip(radii, arm["chamber_azimuth_deg"])]


def mesh_of(arm, planes_m, halvings=0):
    planes = list(planes_m)

    def is_cap(layer):
        return planes[layer + 1] <= arm["cap_m"] + 1e-9 or planes[layer] >= arm["length_m"] - arm["cap_m"] - 1e-9

    return solid_mesh.drawn_out(solid_mesh.section(arm["radius_m"], chambers_of(arm), halvings), planes, is_cap)


def clusters_of(mesh, plan):
    """Nodes of the skin that carry each body's markers."""
    points = mesh.section.points[mesh.section.rim]
    angles = np.degrees(np.arctan2(points[:, 1], points[:, 0]))
    rim = [mesh.section.rim[int(np.argmin(np.abs((angles - wanted + 180) % 360 - 180)))] for wanted in plan["marker_deg"]]
    return {name: mesh.plane(mesh.nearest_plane(height))[rim] for name, height in plan["bodies"].items()}


def trials_of(plan, case):
    """Name, attitude, payload and pressures of each state of each trial; the first state is at rest without pressure."""
    dice = random.Random(plan["cases"][case]["commands"])
    trials = []
    for attitude in plan["attitudes"]:
        for payload in plan["payloads_kg"]:
            states = [[0.0, 0.0, 0.0]]
            while len(states) < plan["states"]:
                drawn = [0.0 if dice.random() < plan["off_share"] else round(dice.uniform(0.1, 1) * plan["highest_pa"], -2)
                         for _ in range(3)]
                if 0 < sum(drawn) <= plan["highest_sum_pa"]:
                    states.append(drawn)
            trials.append((f"{attitude}_{'loaded' if payload else 'empty'}", attitude, payload, states))
    return [trial for trial in trials if trial[0] not in plan["cases"][case].get("without", [])]


def compute_trial(plan, case, trial, work, mesh, arm):
    name, attitude, payload, states = trial
    clusters = clusters_of(mesh, plan)
    if arm.get("wall"):
        free = {**arm, "wall": None}
        places = compute_trial(plan, case, trial, work, mesh, free)
        if not reaches(arm["wall"], plan, places):
            return places
    seen = np.concatenate(list(clusters.values()))
    deck = solid_deck.Deck(mesh, arm)
    deck.add_steps(states, plan["attitudes"][attitude], payload, seen)
    moved, seconds = solid_deck.solve(deck, work, name)
    say(f"{case} {name}: {len(states)} states in {seconds:.0f} s")
    return mesh.nodes[seen][None] + moved


def reaches(wall, plan, places):
    """Whether the arm would come to a wall that is not there: a body sits at its height."""
    body = list(plan["bodies"].values()).index(wall["height_m"])
    count = len(plan["marker_deg"])
    return bool((wall["side"] * places[:, body * count:(body + 1) * count, 0] > wall["distance_m"] - 1e-3).any())


def columns_of(plan):
    marks = [f"{name}_{i + 1}_{axis}_mm" for name in plan["bodies"] for i in range(len(plan["marker_deg"])) for axis in "xyz"]
    return ["trial", "state", "attitude", "payload_kg", "p1_pa", "p2_pa", "p3_pa"] + marks


def compute_case(plan, case, work, out, jobs, only=None):
    """Writes the places of all markers in all states, in the arm's frame; returns the path."""
    arm = arm_of(plan, case)
    mesh = mesh_of(arm, plan["planes_m"])
    trials = [trial for trial in trials_of(plan, case) if only is None or trial[0] in only]
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        places = list(pool.map(lambda trial: compute_trial(plan, case, trial, work, mesh, arm), trials))
    path = os.path.join(out, case + ".csv")
    with open(path + ".part", "w", encoding="ascii") as text:
        text.write(",".join(columns_of(plan)) + "\n")
        for (name, attitude, payload, states), found in zip(trials, places):
            for number, (pressures, marks) in enumerate(zip(states, found)):
                cells = [name, str(number), attitude, f"{payload:g}", *(f"{p:.0f}" for p in pressures),
                         *(f"{1e3 * x:.3f}" for x in marks.ravel())]
                text.write(",".join(cells) + "\n")
    os.replace(path + ".part", path)
    return path


def main():
    parser = argparse.ArgumentParser(prog="solid_arm", description=__doc__.splitlines()[0])
    parser.add_argument("--plan", required=True)
    parser.add_argument("--work", required=True)
    parser.add_argument("--programs", required=True)
    parser.add_argument("--out", metavar="DIR", help="where the results go (default: beside the plan)")
    parser.add_argument("--cases", help="names of cases of the plan, separated by commas (default: all)")
    parser.add_argument("--trials", help="only these trials, separated by commas")
    parser.add_argument("--jobs", type=int, default=1, help="solvers at a time")
    parser.add_argument("--trials-of", metavar="CASE", help="make bags from the results of this case")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--picture", metavar="FILE")
    parser.add_argument("--checks", action="store_true")
    options = parser.parse_args()
    plan = read_plan(options.plan)
    cases = options.cases.split(",") if options.cases else list(plan["cases"])
    unknown = set(cases) - set(plan["cases"])
    if unknown:
        sys.exit(f"solid_arm: --cases: no case {', '.join(sorted(unknown))}; there are {', '.join(plan['cases'])}")
    if options.picture:
        import solid_picture
        solid_picture.draw(plan, options.work, options.picture)
        return
    if options.checks:
        import solid_checks
        solid_checks.show(plan, options.work)
        return
    if options.trials_of:
        if options.trials_of not in plan["trials"] or not options.out:
            sys.exit(f"solid_arm: --trials-of needs --out, and one of {', '.join(plan['trials'])}")
        program = os.path.join(options.programs, "softarm")
        print("\n".join(solid_trials.write_trials(plan, os.path.dirname(os.path.abspath(options.plan)), options.trials_of,
                                                  options.out, options.seed, program)))
        return
    out = options.out or os.path.dirname(os.path.abspath(options.plan))
    os.makedirs(out, exist_ok=True)
    for case in cases:
        try:
            say("written: " + compute_case(plan, case, options.work, out, options.jobs,
                                           options.trials.split(",") if options.trials else None))
        except solid_deck.NotSolved as failed:
            sys.exit(f"solid_arm: {failed}")


if __name__ == "__main__":
    main()
