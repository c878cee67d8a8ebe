"""Recordings of real arms as tables that can be changed before they are imported; used by real_changes.py and prove_real.py.

What the columns mean stands in config/layouts; here is which of them are poses, inputs and time, and what was hung on when.
"""
import copy
import math
import os
import re

import prove_files

# Of the pouch arm.
HOLD = "*.bending_stiffness.*,*.chamber_3.*,*.chamber_1.*"
HOLD_STEPS = HOLD.replace("*.chamber_1.*", "*.chamber_1.elongation")
FREE = "length,*.rest_curvature.*"
FREE_ONE = FREE + ",axial_stiffness"  # two of its four trials have a load

# recording, trial, what is known of its payload
ONE = [
    ("no_load/data_collect_1", "no_load_1", ["--payload", "0"]),
    ("no_load/data_collect_3", "no_load_3", ["--payload", "0"]),
    ("load_400g/data_collect_1", "load_1", "--payload 0 --payload 10.3:0.4 --leave-out 7.0:10.3".split()),
    ("load_400g/data_collect_3", "load_3", "--payload 0 --payload 10.5:0.4 --leave-out 5.7:10.5".split()),
]
TWO = [
    ("no_load/data_collect_1", "no_load", ["--payload", "0"]),
    ("load_400g/data_collect_1", "load", "--payload 0 --payload 12:0.4 --leave-out 5.6:12".split()),
]


class Recording:
    """One file: rows of numbers, and what is known of its payload. Columns count from 0."""

    def __init__(self, path, name, header, separator, payload, leave_out):
        self.name, self.separator, self.payload, self.leave_out = name, separator, payload, leave_out
        with open(path, encoding="utf-8") as text:
            lines = [line for line in text.read().splitlines() if line.strip()]
        self.header = lines[0] if header else None
        self.rows = [[float(cell) for cell in line.split(separator)] for line in lines[1 if header else 0:]]

    def changed(self):
        """A copy whose rows may be changed."""
        other = copy.copy(self)
        other.rows = [list(row) for row in self.rows]
        other.payload = list(self.payload)
        return other

    def write(self, path):
        with open(path, "w", encoding="utf-8") as text:
            if self.header:
                text.write(self.header + "\n")
            for row in self.rows:
                text.write(self.separator.join(f"{cell:.10g}" for cell in row) + "\n")


class Set:
    """Recordings of one arm that are diagnosed together. Directions are those of the file's own axes."""

    def __init__(self, **facts):
        self.__dict__.update(facts)

    def time_of(self, recording, number):
        return number * self.period_s if self.period_s else recording.rows[number][0]


TRUNK_LOADS_KG = {"0g": 0.0, "100g": 0.1, "300g": 0.3}
TRUNK_DOWN, TRUNK_ACROSS = (0.0, -1.0, 0.0), (1.0, 0.0, 0.0)  # OptiTrack's y is up
POUCH_DOWN, POUCH_ACROSS = (0.0, 0.0, -1.0), (-1.0, 0.0, 0.0)  # the rod's x is -x of the cameras

SETS = {
    "trunk": Set(layout="tendon_trunk_controlled", folder="tendon_trunk", period_s=0.01, header=True,
                 bodies={"disc_1": (1, None), "disc_2": (4, None), "disc_3": (7, None)}, base=None,
                 base_m=(0.1008, 0.0026, 0.1045), down=TRUNK_DOWN, across=TRUNK_ACROSS, inputs=[10, 11, 12, 13, 14, 15],
                 zeros=[0.0] * 6, input_unit="deg", arm="tendon_trunk", every_s=15, options=["--tie", "*.bending_stiffness.base"],
                 segments=["segment_1", "segment_2", "segment_3"], splits=[(1, 4, 6), (2, 5, 8), (0, 3, 7)]),
    "pouch_one": Set(layout="pouch_arm_one_segment", folder="pouch_arm/one_segment", period_s=None, header=False,
                     bodies={"tip": (31, 34)}, base=(24, 27), base_m=None, down=POUCH_DOWN, across=POUCH_ACROSS,
                     inputs=[10, 11], zeros=[-0.01, -0.75], input_unit="psi", arm="pouch_arm_one_segment", every_s=None,
                     options=["--hold", HOLD], segments=["segment_2"], splits=[None]),
    "pouch_two": Set(layout="pouch_arm", folder="pouch_arm/two_segment", period_s=None, header=False,
                     bodies={"mid": (24, 27), "tip": (31, 34)}, base=(17, 20), base_m=None, down=POUCH_DOWN,
                     across=POUCH_ACROSS, inputs=[4, 5, 10, 11], zeros=[0.6, 0.8, -0.45, -1.25], input_unit="psi",
                     arm="pouch_arm", every_s=14, options=["--hold", HOLD], segments=["segment_1", "segment_2"],
                     splits=[None]),
}


def payload_words(words):
    """What --payload and --leave-out say: [(from_s, kg)], [(from, to)]."""
    payload, leave_out = [], []
    for option, value in zip(words[::2], words[1::2]):
        if option == "--payload":
            start, kg = value.split(":") if ":" in value else ("0", value)
            payload.append((float(start), float(kg)))
        else:
            leave_out.append(tuple(float(part) for part in value.split(":")))
    return payload, leave_out


def recordings(name, data):
    """The files of a set, in the order in which their trials are given to the program."""
    kind = SETS[name]
    folder = os.path.join(data, kind.folder)
    if name == "trunk":
        files = {"0g": "observations_controlled_1", "100g": "observations_controlled_1_100g",
                 "300g": "observations_controlled_1_300g"}
        return [Recording(os.path.join(folder, f"{files[load]}.csv"), load, True, ",", [(0.0, kg)], [(150.0, 151.0)])
                for load, kg in TRUNK_LOADS_KG.items()]
    listed = ONE if name == "pouch_one" else TWO
    return [Recording(os.path.join(folder, f"{file}.txt"), trial, False, ",", *payload_words(words))
            for file, trial, words in listed]


def run(command, log):
    status, _ = prove_files.run(command, log)
    if status != 0:
        raise prove_files.NotDrawn(f"{os.path.basename(str(command[0]))} {command[1]}: {prove_files.last_line(log)}")


def bags_of(name, split, listed):
    """Names of the bags that a split of a set has."""
    if SETS[name].every_s is None:
        return [f"{recording.name}.bag" for recording in listed]
    if split is None:  # all pieces
        return [f"{recording.name}_{piece}.bag" for recording in listed
                for piece in range(math.ceil(recording.rows[-1][0] / SETS[name].every_s))]
    return [f"{recording.name}_{piece}.bag" for recording in listed for piece in split]


def import_to(softarm, name, listed, data, folder):
    """Bags of recordings, changed or not, in a folder; the CSV files that they come from are removed."""
    kind = SETS[name]
    os.makedirs(folder, exist_ok=True)
    for recording in listed:
        table = os.path.join(folder, f"{recording.name}.csv")
        recording.write(table)
        words = [softarm, "import", kind.layout, table, "--force"]
        if kind.header:
            words += ["--inputs", os.path.join(data, kind.folder, "control_inputs_controlled_1.csv")]
        for start, kg in recording.payload:
            words += ["--payload", f"{start:.6g}:{kg:.6g}"]
        for start, end in recording.leave_out:
            words += ["--leave-out", f"{start:.6g}:{end:.6g}"]
        if kind.every_s:
            words += ["--split-every", str(kind.every_s)]
        run([*words, "--out", f"{folder}/" if kind.every_s else os.path.join(folder, f"{recording.name}.bag")],
            os.path.join(folder, "import.log"))
        os.remove(table)


def start_arm(name, text):
    """The shipped arm file as what identify starts from, and with an attitude of the base that gravity does not turn."""
    if name == "pouch_one":  # two of its trials have a load
        return text.replace("axial_stiffness_n: rigid", "axial_stiffness_n: 190")
    return text.replace("attitude: hanging ", "quaternion_xyzw: [1, 0, 0, 0] ")


def identify(softarm, name, arm, bags, out, log):
    """An arm file from trials, as the scripts of doc/real_arms.md do it."""
    if name == "trunk":
        # What these trials do not identify runs to a bound.
        more = [*SETS[name].options, "--also-free", "*.rest_curvature.*", "--frames", "100", "--hold",
                "segment_3.cable_3.curvature_gain,segment_3.cable_5.curvature_gain"]
    else:
        more = [*SETS[name].options, "--also-free", FREE_ONE if name == "pouch_one" else FREE]
    run([softarm, "identify", "--arm", arm, *bags, *more, "--not-robust", "--hold-out-share", "0", "--force", "--out", out], log)


def import_steps(softarm, data, folder):
    """Bags of another session of the pouch arm with both segments."""
    os.makedirs(folder, exist_ok=True)
    bags = [os.path.join(folder, f"set_{number}.bag") for number in (2, 3)]
    for number, bag in zip((2, 3), bags):
        run([softarm, "import", "pouch_arm_steps", os.path.join(data, f"pouch_arm/steps/set_{number}/data_collect_1.txt"), "--force",
             "--out", bag], os.path.join(folder, "import.log"))
    return bags


def segment_of_another(text, other, segment):
    """An arm file with the constants (length, rest curvature, gains, stiffness) that another one has for a segment."""
    def span(of):
        first = re.search(rf"^  - name: {segment}$", of, flags=re.MULTILINE)
        end = re.search(r"^(  - name: |\S)", of[first.end() + 1:], flags=re.MULTILINE)
        return first.start(), first.end() + 1 + end.start()

    (a, b), (c, d) = span(text), span(other)
    return text[:a] + other[c:d] + text[b:]


