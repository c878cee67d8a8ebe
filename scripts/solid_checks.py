"""The finite elements against closed forms, and against finer meshes of themselves; used by the tests and `solid_arm --checks`."""
import copy
import math

import numpy as np

import solid_arm
import solid_deck
import solid_trials

FROM_TO_M = (0.05, 0.15)  # away from the clamp, which keeps the section from growing narrower or wider


def full_cylinder(plan):
    """The arm without chambers: rubber from end to end, no plate, no weight to speak of."""
    arm = copy.deepcopy(plan["arm"])
    arm.update({"cap_m": arm["length_m"], "plate_m": 0.0, "density_kg_m3": 1e-3, "stiffening": 0.0})
    return arm


def bent_cylinder(plan, loads_kg, work, halvings=0):
    """Under weights that pull the tip across: displacement of the tip's middle (across, along), and by how much the section
    at 150 mm turns more than that at 50 mm."""
    arm = full_cylinder(plan)
    mesh = solid_arm.mesh_of(arm, plan["planes_m"], halvings)
    middle = mesh.plane(len(mesh.heights) - 1)
    middle = middle[[int(np.argmin(np.linalg.norm(mesh.nodes[middle][:, :2], axis=1)))]]
    rims = [mesh.plane(mesh.nearest_plane(height))[mesh.section.rim] for height in FROM_TO_M]
    found = []
    for load in loads_kg:
        deck = solid_deck.Deck(mesh, arm)
        deck.add_steps([[0.0, 0.0, 0.0]], [1.0, 0.0, 0.0], load, np.concatenate([middle, *rims]))
        moved, _ = solid_deck.solve(deck, work, "cylinder")
        turns = [solid_trials.rigid_fit(mesh.nodes[rim], mesh.nodes[rim] + part)[0]
                 for rim, part in zip(rims, np.split(moved[0][1:], 2))]
        across, _, along = moved[0][0]
        between = turns[1] @ turns[0].T
        found.append((across, along, math.asin(between[0, 2])))
    return found


def bending_stiffness(arm):
    return arm["modulus_pa"] * math.pi * arm["radius_m"] ** 4 / 4


def shear_stiffness(arm):
    """Cowper's for a round section (J. Appl. Mech. 33, 1966)."""
    nu = solid_deck.POISSON
    return 6 * (1 + nu) / (7 + 6 * nu) * arm["modulus_pa"] / (2 * (1 + nu)) * math.pi * arm["radius_m"] ** 2


def cantilever(arm, force_n):
    """Under a small force at the tip: deflection, with shear; and turn between the two sections."""
    length, (low, high) = arm["length_m"], FROM_TO_M
    return (force_n * (length ** 3 / (3 * bending_stiffness(arm)) + length / shear_stiffness(arm)),
            force_n / bending_stiffness(arm) * (length * (high - low) - (high ** 2 - low ** 2) / 2))


def elastica(arm, force_n, steps=400):
    """A cantilever that bends far (Bisshopp and Drucker, Q. Appl. Math. 3, 1945) and shears: its tip across and along, and the
    turn between the two sections. The moment at a section is the force times what of the arm lies beyond, across
    the force; by shooting for the tip's angle."""
    length, ei, ga = arm["length_m"], bending_stiffness(arm), shear_stiffness(arm)

    def from_tip(angle):
        # From the tip to the base: angle of the axis against the undeformed, and its place.
        step, moment, x, y, angles = length / steps, 0.0, 0.0, 0.0, []
        for i in range(steps):
            angles.append(angle)
            middle = angle - step / 2 * moment / ei
            half = moment + force_n * math.cos(middle) * step / 2
            x += step * math.cos(middle)
            y += step * (math.sin(middle) + force_n * math.cos(middle) ** 2 / ga)
            angle -= step * half / ei
            moment += force_n * math.cos(middle) * step
        return angle, x, y, [angles[round((length - at) / step)] for at in FROM_TO_M]

    low, high = 0.0, math.pi / 2
    for _ in range(60):
        guess = (low + high) / 2
        low, high = (guess, high) if from_tip(guess)[0] < 0 else (low, guess)
    _, x, y, (near, far) = from_tip(low)
    return y, x - length, far - near


def refined(plan, work, halvings=0, finer=1, states=((26400.0, 20500.0, 0.0),)):
    """Tip of the arm on its side, loaded, under these pressures: with the section's edges halved, the layers cut."""
    arm = plan["arm"]
    planes = list(plan["planes_m"])
    planes = [a + (b - a) * i / finer for a, b in zip(planes, planes[1:]) for i in range(finer)] + planes[-1:]
    mesh = solid_arm.mesh_of(arm, planes, halvings)
    seen = mesh.plane(len(mesh.heights) - 1)
    deck = solid_deck.Deck(mesh, arm)
    deck.add_steps([list(state) for state in states], plan["attitudes"]["horizontal"], plan["payloads_kg"][-1], seen)
    moved, seconds = solid_deck.solve(deck, work, f"refined_{halvings}_{finer}")
    return len(mesh.bricks), moved.mean(axis=1), seconds


def own_laws(plan, work, alone_pa=(10e3, 20e3, 30e3, 40e3), together_pa=25e3, force_kg=0.006):
    """What the body's bending owes to pressure, of the arm without weight, as the catalogue of effects says it: by how much more
    EI there is at a mean pressure of 50 kPa (pressure_stiffening), and by how much more moment one chamber makes at 50 kPa than
    in proportion (gain_nonlinearity). EI is the moment over the curvature per actual length: pressure lengthens the arm, and a
    longer one gives way more. It shows by a small force at the tip, with all chambers alike and without pressure; the moment by
    that EI and the turn from 50 to 150 mm with one chamber alone, over how long that stretch then is."""
    arm = {**plan["arm"], "density_kg_m3": 1e-3}
    mesh = solid_arm.mesh_of(arm, plan["planes_m"])
    rims = [mesh.plane(mesh.nearest_plane(height))[mesh.section.rim] for height in FROM_TO_M]
    tip = mesh.plane(len(mesh.heights) - 1)

    def solved(name, states, load_kg):
        deck = solid_deck.Deck(mesh, arm)
        deck.add_steps([list(state) for state in states], [1.0, 0.0, 0.0], load_kg, np.concatenate([tip, *rims]))
        return solid_deck.solve(deck, work, name)[0]

    across, length = [], []
    for seen in solved("own_stiffness", [(0.0, 0.0, 0.0), (together_pa,) * 3], force_kg):
        moved = seen[:len(tip)].mean(axis=0)
        across.append(moved[0])
        length.append(arm["length_m"] + moved[2])
    per_50kpa = 5e4 / together_pa * (across[0] / across[1] * (length[1] / length[0]) ** 3 - 1.0)
    moments = []
    for pressure, seen in zip(alone_pa, solved("own_moment", [(p, 0.0, 0.0) for p in alone_pa], 0.0)):
        there = [mesh.nodes[rim] + part for rim, part in zip(rims, np.split(seen[len(tip):], 2))]
        near, far = (solid_trials.rigid_fit(mesh.nodes[rim], marks)[0] for rim, marks in zip(rims, there))
        turn = math.asin((far @ near.T)[0, 2])
        chord = np.linalg.norm(there[1].mean(axis=0) - there[0].mean(axis=0))
        stretch = chord * (turn / 2) / math.sin(turn / 2) / (FROM_TO_M[1] - FROM_TO_M[0])
        moments.append(turn / stretch * (1.0 + per_50kpa * pressure / 3 / 5e4))
    pressures = np.array(alone_pa) / 5e4
    (gain, square), *_ = np.linalg.lstsq(np.stack([pressures, pressures ** 2], axis=1), np.array(moments), rcond=None)
    return {"pressure_stiffening": per_50kpa, "gain_nonlinearity": square / gain}


def show(plan, work):
    """Prints all of them."""
    arm = full_cylinder(plan)
    loads = (0.001, 0.2)
    print("cylinder without chambers, weight at the tip; beam theory with the same EI and GA:")
    for load, found in zip(loads, bent_cylinder(plan, loads, work)):
        force = load * solid_deck.GRAVITY_M_S2
        wanted = elastica(arm, force)
        print(f"  {1e3 * load:g} g: tip {1e3 * found[0]:.4g} mm across (beam {1e3 * wanted[0]:.4g}), {1e3 * found[1]:.3g} mm along "
              f"({1e3 * wanted[1]:.3g}); from 50 to 150 mm it turns by {found[2]:.5g} rad ({wanted[2]:.5g})")
    print("the arm without weight, share at 50 kPa: " + ", ".join(f"{name} {share:.3f}" for name, share in own_laws(plan, work).items()))
    print("the arm on its side with 60 g at 26.4, 20.5, 0 kPa:")
    for halvings, finer in ((0, 1), (0, 2), (1, 1)):
        bricks, tip, seconds = refined(plan, work, halvings, finer)
        print(f"  {bricks} bricks: tip " + ", ".join(f"{1e3 * x:.2f}" for x in tip[0]) + f" mm; {seconds:.0f} s")
