"""Input decks of the finite-element arm for CalculiX, and what it printed; used by solid_arm.py. SI throughout."""
import hashlib
import os
import re
import subprocess
import time

import numpy as np

GRAVITY_M_S2 = 9.80665
POISSON = 0.48          # of rubber nearer to 0.5 bricks say too stiff
HOOP_N_PER_M = 5e4      # of a thread between neighbouring nodes: it gives 2 % at the highest pressure
BRICK = "C3D20R"
PAD_M = 0.004           # of a padded wall: from there on it is as hard as it gets
PLATE_PA = 5e6          # tip plate: ten times the rubber; a stiffer one makes the iterations slower and bends as little


class NotSolved(RuntimeError):
    pass


def lines_of(numbers, per_line=12):
    """Node and element numbers, which CalculiX counts from 1."""
    numbers = [str(n + 1) for n in numbers]
    return "".join(", ".join(numbers[i:i + per_line]) + ",\n" for i in range(0, len(numbers), per_line))


def yeoh(modulus_pa, stiffening):
    """C10, C20, C30, D1, D2, D3 of a rubber of this modulus at rest; stiffening is C20 over C10. What is left out CalculiX
    takes for 1e-12 and 1e-18: a rubber that resists the fourth power of a change of volume so much that nothing converges."""
    shear = modulus_pa / (2 * (1 + POISSON))
    bulk = modulus_pa / (3 * (1 - 2 * POISSON))
    return f"{shear / 2:.8g}, {stiffening * shear / 2:.8g}, 0., {2 / bulk:.8g}, {2 / bulk:.8g}, {2 / bulk:.8g}"


def shared_load(points, at):
    """Shares of a force on the nodes of a stiff plate whose resultant acts at this point: linear over the plate."""
    mean = points.mean(axis=0)
    spread = (points - mean).T @ (points - mean)
    return 1 / len(points) + (points - mean) @ np.linalg.solve(spread, np.asarray(at) - mean)


class Deck:
    """A deck in its parts: the arm as it is, then a step for each state."""

    def __init__(self, mesh, arm):
        self.mesh, self.arm, self.text = mesh, arm, []
        self.springs = len(mesh.bricks)
        self.write_mesh()
        self.write_rubber()
        if len(mesh.hoops):
            self.add_springs("HOOPS", mesh.hoops, f"{HOOP_N_PER_M:.1f}")
        self.write_clamp()
        if arm.get("wall"):
            self.write_wall(arm["wall"])

    def add(self, text):
        self.text.append(text if text.endswith("\n") else text + "\n")

    def write_mesh(self):
        mesh = self.mesh
        used = np.unique(mesh.bricks)
        self.add("*NODE, NSET=NALL")
        self.add("".join(f"{n + 1}, {mesh.nodes[n][0]:.9g}, {mesh.nodes[n][1]:.9g}, {mesh.nodes[n][2]:.9g}\n" for n in used))
        self.add(f"*ELEMENT, TYPE={BRICK}, ELSET=BRICKS")
        for number, brick in enumerate(mesh.bricks):
            self.add(f"{number + 1},\n" + lines_of(brick, 10).rstrip(",\n"))
        for which, faces in enumerate(mesh.faces):
            for side in range(1, 7):
                bricks = [brick for brick, face in faces if face == side]
                if bricks:
                    self.add(f"*ELSET, ELSET=CHAMBER{which + 1}_{side}\n" + lines_of(bricks))

    def write_rubber(self):
        """One rubber, a softer one in the soft ring, a stiff plate at the tip."""
        arm, mesh = self.arm, self.mesh
        middle = (mesh.heights[mesh.layer] + mesh.heights[mesh.layer + 1]) / 2
        plate = middle > arm["length_m"] - arm["plate_m"]
        soft = np.zeros(len(middle), bool)
        if arm.get("soft_ring"):
            ring = arm["soft_ring"]
            soft = (middle > ring["from_m"]) & (middle < ring["to_m"])
        parts = [("RUBBER", ~plate & ~soft, arm["modulus_pa"])]
        if soft.any():
            parts.append(("SOFT", soft, arm["modulus_pa"] * arm["soft_ring"]["factor"]))
        for name, which, modulus in parts:
            self.add(f"*ELSET, ELSET={name}\n" + lines_of(np.flatnonzero(which)))
            self.add(f"*MATERIAL, NAME={name}\n*HYPERELASTIC, YEOH\n{yeoh(modulus, arm['stiffening'])}")
            self.add(f"*DENSITY\n{arm['density_kg_m3']}\n*SOLID SECTION, ELSET={name}, MATERIAL={name}")
        if not plate.any():
            return
        self.add("*ELSET, ELSET=PLATE\n" + lines_of(np.flatnonzero(plate)))
        self.add(f"*MATERIAL, NAME=PLATE\n*ELASTIC\n{PLATE_PA}, 0.3\n*DENSITY\n{arm['density_kg_m3']}")
        self.add("*SOLID SECTION, ELSET=PLATE, MATERIAL=PLATE")

    def add_springs(self, name, pairs, stiffness):
        self.add(f"*ELEMENT, TYPE=SPRINGA, ELSET={name}")
        self.add("".join(f"{self.springs + i + 1}, {a + 1}, {b + 1}\n" for i, (a, b) in enumerate(pairs)))
        self.add(f"*SPRING, ELSET={name}\n{stiffness}")
        self.springs += len(pairs)

    def add_grounded(self, name, nodes, direction, law):
        """Springs from nodes to the ground along one direction (1 to 3), each with a law of its own."""
        for i, (node, one) in enumerate(zip(nodes, law)):
            self.add(f"*ELEMENT, TYPE=SPRING1, ELSET={name}{i}\n{self.springs + 1}, {node + 1}")
            kind = ", NONLINEAR" if one.count("\n") else ""
            self.add(f"*SPRING, ELSET={name}{i}{kind}\n{direction}\n{one}")
            self.springs += 1

    def write_clamp(self):
        """Held at the base; an elastic clamp holds it by springs along the axis, which together turn under a moment."""
        base = self.mesh.plane(0)
        self.add("*NSET, NSET=BASE\n" + lines_of(base))
        turn = self.arm.get("clamp_nm_per_rad")
        self.add(f"*BOUNDARY\nBASE, 1, {2 if turn else 3}")
        if turn:
            section = self.mesh.section
            share = np.zeros(len(base))
            for quad in section.quads:
                x, y = section.points[quad].T
                share[quad] += abs((x * np.roll(y, -1) - np.roll(x, -1) * y).sum()) / 8
            about = (share * section.points[:, 1] ** 2).sum()
            self.add_grounded("CLAMP", base, 3, [f"{turn * one / about:.6f}" for one in share])

    def write_wall(self, wall):
        """A padded edge across x, seen by the skin's nodes at one height: no friction, nothing before they touch, and a pad that
        takes 4 mm to grow hard: at a kink the iterations go to and fro."""
        plane = self.mesh.nearest_plane(wall["height_m"])
        nodes = [n for n in self.mesh.plane(plane)[self.mesh.section.rim]
                 if wall["side"] * self.mesh.nodes[n][0] > 0.5 * self.arm["radius_m"]]
        laws = []
        for n in nodes:
            gap = wall["distance_m"] - wall["side"] * self.mesh.nodes[n][0]
            stiffness = wall["stiffness_n_per_m"] / len(nodes)
            at = [(0.0, -1.0), (0.0, gap)]
            at += [(stiffness * PAD_M / 2 * (i / 8) ** 2, gap + PAD_M * i / 8) for i in range(1, 9)]
            at += [(stiffness * (PAD_M / 2 + 1.0), gap + PAD_M + 1.0)]
            if wall["side"] < 0:
                at = [(-force, -way) for force, way in reversed(at)]
            laws.append("\n".join(f"{force:.6f}, {way:.8f}" for force, way in at))
        self.add_grounded("WALL", nodes, 1, laws)

    def add_steps(self, states, gravity, payload_kg, print_nodes, first_increment=0.5, every_node=False):
        """states: pressures of the chambers in Pa; gravity in the arm's frame, unit vector."""
        mesh, arm = self.mesh, self.arm
        top = mesh.plane(len(mesh.heights) - 1)
        load = payload_kg * GRAVITY_M_S2 * np.asarray(gravity)
        at = np.array([*arm.get("payload_offset_m", (0.0, 0.0)), arm["length_m"]])[:2]
        shares = shared_load(mesh.nodes[top][:, :2], at)
        self.add("*NSET, NSET=SEEN\n" + lines_of(print_nodes))
        elements = sorted({(which, face) for which, faces in enumerate(mesh.faces) for _, face in faces})
        for number, pressures in enumerate(states):
            self.add(f"*STEP, NLGEOM, INC=400\n*STATIC\n{first_increment if number == 0 else 1.0}, 1., 1e-4, 1.")
            self.add("*CONTROLS, PARAMETERS=TIME INCREMENTATION\n30, 30, 12, 45, 30, 20, , 5, ,")
            self.add("*CONTROLS, PARAMETERS=FIELD\n0.005, 0.0015")
            self.add("*DLOAD")
            if number == 0:
                self.add(f"BRICKS, GRAV, {GRAVITY_M_S2}, " + ", ".join(f"{g:.9g}" for g in gravity))
            for which, face in elements:
                self.add(f"CHAMBER{which + 1}_{face}, P{face}, {pressures[which]:.6g}")
            if number == 0 and payload_kg > 0:
                self.add("*CLOAD")
                self.add("".join(f"{n + 1}, {axis + 1}, {share * load[axis]:.9g}\n" for n, share in zip(top, shares)
                                 for axis in range(3) if load[axis] != 0))
            if every_node:
                self.add("*NODE FILE, FREQUENCY=1000\nU")
            self.add("*NODE PRINT, NSET=SEEN, FREQUENCY=1000\nU\n*END STEP")


def solve(deck, folder, name, ccx="ccx", time_limit_s=3600):
    """Runs CalculiX on one core; returns displacements of the printed nodes (state x node x 3) and the seconds that it took.
    A deck that was solved in this folder before is not solved again."""
    os.makedirs(folder, exist_ok=True)
    text = "".join(deck.text)
    name = f"{name}_{hashlib.sha256(text.encode()).hexdigest()[:10]}"
    base = os.path.join(folder, name)
    if os.path.exists(base + ".solved"):
        return read_dat(base + ".dat"), 0.0
    with open(base + ".inp", "w", encoding="ascii") as file:
        file.write(text)
    started = time.monotonic()
    with open(base + ".log", "w", encoding="utf-8") as log:
        done = subprocess.run(["nice", "-n", "3", ccx, name], cwd=folder, stdout=log, stderr=subprocess.STDOUT, check=False,
                              timeout=time_limit_s, env={**os.environ, "OMP_NUM_THREADS": "1"})
    seconds = time.monotonic() - started
    with open(base + ".log", encoding="utf-8", errors="replace") as log:
        said = log.read()
    if done.returncode != 0 or "*ERROR" in said or "Job finished" not in said:
        errors = [line.strip() for line in said.splitlines() if "ERROR" in line]
        raise NotSolved(f"{base}.log: CalculiX did not finish ({errors[0] if errors else said.strip().splitlines()[-1]})")
    moved = read_dat(base + ".dat")
    with open(base + ".solved", "w", encoding="ascii") as file:
        file.write(f"{seconds:.0f} s\n")
    return moved, seconds


def read_dat(path):
    """Displacements of the printed nodes at the end of each step, in the order of the set that was printed."""
    states = []
    with open(path, encoding="ascii") as text:
        for line in text:
            if line.strip().startswith("displacements"):
                states.append([])
            elif states and re.match(r"\s*\d+\s", line):
                states[-1].append([float(cell) for cell in line.split()[1:4]])
    return np.array(states)
