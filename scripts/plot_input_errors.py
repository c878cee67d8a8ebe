#!/usr/bin/env python3
"""Draw doc/images/identify_input_noise.png: what noisy pressure sensors do to identified gains, on the virtual rig.

    scripts/python scripts/plot_input_errors.py --work work --out doc/images/identify_input_noise.png

The script simulates trials of config/scenarios/demo.yaml with noisy pressure sensors. It identifies the gains of the arm with inputs
as recorded (`--exact-inputs`), and with errors in variables.
"""
import argparse
import pathlib
import subprocess

from plotting import die, one_line, plt, save
from softarm_module import softarm

ROOT = pathlib.Path(__file__).resolve().parent.parent
NOISE_PA = (0, 1000, 2000, 4000, 6000)
TRIALS = 8
TRUTH = {1: 6.1e-6, 2: 7.8e-6, 3: 6.5e-6}  # N m/Pa, of demo.yaml
EXACT, WITH = "#d9730d", "#1f6fb4"


def run(program, *arguments):
    call = [program, *map(str, arguments), "--force"]  # the folder is the script's own
    try:
        failed = subprocess.run(call, stdout=subprocess.DEVNULL).returncode != 0
    except OSError as why:
        die(f"{program}: {why.strerror}")
    if failed:
        die(f"{' '.join(call)}: failed")


def trials(program, work, noise_pa):
    scenario = work / f"noise_{noise_pa}.yaml"
    hidden = "".join(f"  - {{effect: sensor_noise, form: pressure, number: {k}, sd_pa: {noise_pa}}}\n" for k in TRUTH)
    text = (ROOT / "config/scenarios/demo.yaml").read_text(encoding="utf-8")
    scenario.write_text(text + (f"hidden:\n{hidden}" if noise_pa else ""), encoding="utf-8")
    bags = []
    for seed in range(1, TRIALS + 1):
        bags.append(work / f"noise_{noise_pa}_{seed}.bag")
        if not bags[-1].exists():
            run(program, "simulate", scenario, "--seconds", 30, "--seed", seed, "--out", bags[-1])
    return bags


def gains(arm, trials, **options):
    """Gain over truth and its sd, by chamber; the result."""
    result = softarm.identify(arm, trials, moving=True, held=["*.bending_stiffness.*", "*.elongation"], held_out_share=0.0, **options)
    fitted = {constant.name: constant for constant in result.constants}
    found = {chamber: (fitted[f"segment_1.chamber_{chamber}.moment_gain"], truth) for chamber, truth in TRUTH.items()}
    return {chamber: (one.value / truth, one.sd / truth) for chamber, (one, truth) in found.items()}, result.to_dict()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for bags and results")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="the picture")
    parser.add_argument("--program", default=str(ROOT / "scripts" / "softarm"), help="default: scripts/softarm")
    arguments = parser.parse_args()
    try:
        arguments.work.mkdir(parents=True, exist_ok=True)
    except OSError as why:
        die(f"{arguments.work}: cannot be made: {why.strerror}")

    arm = softarm.load_arm("online_200mm")
    figure, grid = plt.subplots(1, 3, figsize=(9.5, 3.4), sharey=True)
    for noise_pa in NOISE_PA:
        recorded = softarm.read_bags(arm, trials(arguments.program, arguments.work, noise_pa))
        for colour, shift, label, exact in ((EXACT, -0.08, "inputs as recorded", True), (WITH, 0.08, "errors in variables", False)):
            found, result = gains(arm, recorded, exact_inputs=exact)
            measured = ", ".join(f"{one['noise_sd']:.0f} Pa" for one in result.get("inputs", []))
            print(f"noise {noise_pa} Pa, {label}: " + ", ".join(f"{v:.3f} +- {sd:.3f}" for v, sd in found.values())
                  + f"; misfit {result['fit']['misfit']:.2f}" + (f"; measured {measured}" if measured else ""))
            for axes, (value, sd) in zip(grid, found.values()):
                axes.errorbar(1e-3 * noise_pa + shift, value, 1.96 * sd, fmt="o", ms=4, color=colour, capsize=2, lw=1.2,
                              label=label if noise_pa == NOISE_PA[0] else None)
    for chamber, axes in zip(TRUTH, grid):
        axes.axhline(1, color="0.4", lw=0.8)
        axes.set_title(f"chamber {chamber}", fontsize=10)
        axes.set_xlabel("noise of the pressures (kPa)")
        axes.grid(alpha=0.25)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    grid[0].set_ylabel("identified gain over the true one, 95 %")
    grid[0].legend(fontsize=8, frameon=False, loc="lower left")
    figure.tight_layout()
    save(figure, arguments.out, dpi=75)


if __name__ == "__main__":
    with one_line():
        main()
