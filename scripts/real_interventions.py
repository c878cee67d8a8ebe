#!/usr/bin/python3
"""Diagnoses recordings of a real arm with known interventions: what `softarm diagnose` says about each, and without one.

The program gets the trunk's recordings with a known fault: late poses, payloads stated at half their size, a disc at another place
than in the arm file, a tilted frame. Prints the table of doc/real_arms.md. The folder --work is that of plot_real_trunk.py, which
makes the pieces and the arm file.
"""
import argparse
import math
import pathlib
import re
import shutil
import subprocess
import sys

import real_diagnosis

LATE_S = (0.2, 1.0, -1.5)
PAYLOAD_SHARE, TILT_DEG, ALONG_M = 0.5, 6.0, 0.015
GRAMS = (0, 100, 300)
PIECES = (1, 4, 6)
TIE = ("--tie", "*.bending_stiffness.base")


def pieces(program, work, data, folder, layout, share):
    """The trunk's recordings again, by another layout or with other payloads."""
    path = work / f"{folder}.yaml"
    path.write_text(layout, encoding="utf-8")
    for grams in GRAMS:
        subprocess.run([program, "import", str(path), str(work / f"{grams}g.csv"), "--inputs",
                        str(data / "control_inputs_controlled_1.csv"), "--payload", f"{share * grams / 1000:g}", "--split-every",
                        "15", "--leave-out", "150:151", "--force", "--out", f"{work / folder}/"], check=True, stdout=subprocess.DEVNULL)


def arm_files(work):
    """The arm file with a tilted frame, and with a disc elsewhere."""
    text = (work / "both.yaml").read_text(encoding="utf-8")
    down, sideways = 9.80665 * math.cos(math.radians(TILT_DEG)), 9.80665 * math.sin(math.radians(TILT_DEG))
    tilted = re.sub(r"^gravity_m_s2:.*$", f"gravity_m_s2: [{sideways:.6f}, 0, {-down:.6f}]", text, flags=re.MULTILINE)
    place = re.search(r"- name: disc_2\s*\n(?:.*\n)*?\s*arclength_m: ([0-9.]+)", text)
    moved = f"{text[:place.start(1)]}{float(place.group(1)) - ALONG_M:.6f}{text[place.end(1):]}"
    for name, changed in (("tilted", tilted), ("moved", moved)):
        (work / f"{name}.yaml").write_text(changed, encoding="utf-8")


def named(report):
    """What is named, with its probability; what is not small is in front."""
    found = []
    for effect in report["effects"]:
        if effect["probability"] < 0.5:
            continue
        sizes = ", ".join(f"{symbol} {real_diagnosis.size_of(value)}" for symbol, value in effect["parameters"].items()
                          if symbol not in ("input", "chamber") or value["value"] > 0)  # 0: all of them
        percent = "over 99" if effect["probability"] > 0.99 else f"{100 * effect['probability']:.0f}"
        found.append(f"`{effect['name']}` ({percent} %): {sizes}")
    small = [f"`{effect['name']}`" for effect in report["small_departures"]]
    return ("; ".join(found) or "nothing") + (f"; small departures: {', '.join(small)}" if small else "")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=pathlib.Path, required=True, help="folder that contains tendon_trunk/")
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder that plot_real_trunk.py has filled")
    root = pathlib.Path(__file__).resolve().parent.parent
    parser.add_argument("--program", default=str(root / "scripts" / "softarm"), help="default: scripts/softarm")
    arguments = parser.parse_args()
    work, program = arguments.work, arguments.program
    if not (work / "both.yaml").is_file():
        sys.exit(f"--work {work}: there is no both.yaml; run scripts/plot_real_trunk.py with this folder first")
    if shutil.which(program) is None:
        sys.exit(f"--program {program}: cannot be run")
    layout = (root / "config/layouts/tendon_trunk_controlled.yaml").read_text(encoding="utf-8")
    data = arguments.data / "tendon_trunk"
    for late_s in LATE_S:
        pieces(program, work, data, f"late_{late_s}", layout.replace("mocap:\n", f"mocap:\n  ahead_s: {-late_s}\n", 1), 1.0)
    pieces(program, work, data, "half", layout, PAYLOAD_SHARE)
    arm_files(work)
    print("| intervention | verdict | named, size with 90 % interval | unseen rms before, after |\n|---|---|---|---|")
    for what, arm, folder in (("none", "both", "pieces"),
                              *((f"poses {'late' if late_s > 0 else 'early'} by {abs(late_s):g} s", "both", f"late_{late_s}")
                                for late_s in LATE_S),
                              (f"the second disc {1e3 * ALONG_M:.0f} mm further along the arm than the file has it", "moved", "pieces"),
                              (f"the frame tilted by {TILT_DEG:.0f}°", "tilted", "pieces"),
                              ("payloads told at half", "both", "half")):
        print(f"{what} ...", file=sys.stderr, flush=True)
        bags = [work / folder / f"{grams}g_{i}.bag" for grams in GRAMS for i in PIECES]
        report = real_diagnosis.diagnose(program, work / f"{arm}.yaml", bags, work / f"report_{folder}_{arm}", *TIE)
        print(f"| {what} | {report['verdict'].replace('_', ' ')} | {named(report)} | "
              f"{1e3 * report['baseline']['held_out_rms_m']:.2f}, {1e3 * report['extended']['held_out_rms_m']:.2f} mm |", flush=True)


if __name__ == "__main__":
    main()
