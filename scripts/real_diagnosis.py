"""What `softarm diagnose` makes of recordings of real arms; used by plot_real_arms.py and plot_real_trunk.py."""
import json
import os
import pathlib
import subprocess
import sys
import time

STANDS_OUT = 5.0  # z of the screen
TELLING = 0.01    # p of a pattern in what is left


def diagnose(program, arm, bags, out, *options):
    """Runs it, prints what it found in short, and returns report.json with what it cost."""
    out = pathlib.Path(out)
    out.mkdir(parents=True, exist_ok=True)
    call = [str(program), "diagnose", "--arm", str(arm), *map(str, bags), "--out", str(out), "--force", *map(str, options)]
    started = time.monotonic()
    with open(out / "said.txt", "w", encoding="utf-8") as said:
        process = subprocess.Popen(call, stdout=said)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"{' '.join(call)}: failed")
    report = json.loads((out / "report.json").read_text(encoding="utf-8"))
    report["cost"] = {"seconds": time.monotonic() - started, "core_seconds": usage.ru_utime + usage.ru_stime,
                      "mebibytes": usage.ru_maxrss / 1024}
    return report


def size_of(value):
    scale, unit = {"m": (1e3, "mm"), "rad": (57.29578, "deg"), "Pa": (1e-3, "kPa"), "kg": (1e3, "g")}.get(
        value["unit"], (1.0, value["unit"]))
    text = f"{scale * value['value']:.3g}"
    fitted = value.get("fitted", True)
    if fitted and value["high"] > value["low"]:
        text += f" [{scale * value['low']:.3g}, {scale * value['high']:.3g}]"
    return f"{text} {'' if unit == '1' else unit}".strip() + ("" if fitted else " (not fitted)")


def place_of(where):
    parts = []
    if "s_from" in where or "s_to" in where:
        parts.append(f"s {1e3 * where.get('s_from', 0):.0f} to {1e3 * where['s_to']:.0f} mm" if "s_to" in where
                     else f"s from {1e3 * where['s_from']:.0f} mm")
    parts += [where[key].replace("_", " ") for key in ("axis", "when") if key in where]
    if "input" in where:
        parts.append(f"goes with {where['input']}")
    return ", ".join(parts)


def print_report(name, report):
    before, after = report["baseline"], report["extended"]
    cost = report["cost"]
    print(f"\ndiagnose {name}: {report['verdict']}; {cost['seconds']:.0f} s, {cost['core_seconds']:.0f} s of processor, "
          f"{cost['mebibytes']:.0f} MiB")
    print(f"  unseen rms {1e3 * before['held_out_weighted_rms_m']:.2f} -> {1e3 * after['held_out_weighted_rms_m']:.2f} mm, fitted "
          f"{1e3 * before['weighted_rms_m']:.2f} -> {1e3 * after['weighted_rms_m']:.2f} mm; noise {1e3 * report['noise_floor_m']:.3f} mm" +
          (f", ceiling {1e3 * report['ceiling_rms_m']:.2f} mm, {100 * report['explained_share']:.0f} % of what could be explained"
           if "ceiling_rms_m" in report else ""))
    for trial in report["trials"]:
        print(f"    {trial['name']:<12} {1e3 * trial['held_out_rms_before_m']:6.2f} -> {1e3 * trial['held_out_rms_after_m']:6.2f} mm"
              f"   {trial['frames']} frames")
    for effect in report["effects"]:
        sizes = "; ".join(f"{symbol} {size_of(value)}" for symbol, value in effect["parameters"].items())
        print(f"  named: {effect['name']}, p {effect['probability']:.3f}: {sizes}")
        print(f"    {place_of(effect['where'])}; unseen rms lower by {1e3 * effect['held_out_gain']:.2f} mm; mistaken for: "
              f"{', '.join(effect['confusable_with']) or 'none'}")
    named = {effect["name"] for effect in report["effects"]}
    for one in report["ranking"]:
        if one.get("z", 0) >= STANDS_OUT and one["name"] not in named:
            print(f"  stands out: {one['name']}, z {one['z']:.1f}, collinearity {100 * one['collinearity']:.0f} %, "
                  f"p {one['probability']:.3f}, {one['finding']}")
    untold = [one["name"] for one in report["ranking"] if one["finding"] == "cannot_tell"]
    print(f"  cannot tell: {', '.join(untold) or 'none'}")
    left = report["residual_structure"]
    inputs = ", ".join(f"{key} (p {p:.1g})" for key, p in left["by_input_p"].items() if p < TELLING)
    print(f"  left: {place_of(left['where'])}; time p {left['whiteness_p']:.1g}, along s p {left['along_s_p']:.1g}; {inputs}")
    for shift in report["shifts"]:
        if "stiffness.base" in shift["name"] or "gain" in shift["name"]:
            print(f"  {shift['name']}: {shift['before']:.3g} +- {shift['sd_before']:.1g} -> {shift['after']:.3g} +- "
                  f"{shift['sd_after']:.1g} {shift['unit']}")
    for note in report["notes"]:
        print(f"  note: {note}")
    if "next_experiment" in report:
        print(f"  next: {report['next_experiment']['action']}")


def draw(reports, path):
    """Error of each unseen trial before and after, one panel for each arm."""
    import matplotlib.pyplot as plt
    figure, grid = plt.subplots(1, len(reports), figsize=(3.6 * len(reports), 3.6), squeeze=False, sharey=True,
                                gridspec_kw={"width_ratios": [2 + len(r["trials"]) for r in reports.values()]})
    for axes, (name, report) in zip(grid[0], reports.items()):
        trials = report["trials"]
        for shift, key, colour, hatch, label in ((-0.2, "before", "#d9730d", None, "arm file, refitted"),
                                                 (0.2, "after", "#1f6fb4", "//", "with what was found")):
            axes.bar([i + shift for i in range(len(trials))], [1e3 * t[f"held_out_rms_{key}_m"] for t in trials], 0.38,
                     color=colour, hatch=hatch, edgecolor="white", label=label)
        if "ceiling_rms_m" in report:
            axes.axhline(1e3 * report["ceiling_rms_m"], color="k", ls=":", lw=1.3, label="flexible model")
        axes.set_xticks(range(len(trials)))
        axes.set_xticklabels([t["name"] for t in trials], rotation=25, ha="right", fontsize=9)
        axes.set_title(f"{name}:\n{report['verdict'].replace('_', ' ')}", fontsize=10)
        axes.grid(alpha=0.25, axis="y")
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    grid[0][0].set_ylabel("rms error on unseen trials (mm)")
    # Above the bars, whatever their heights.
    grid[0][0].set_ylim(top=1.3 * grid[0][0].get_ylim()[1])
    grid[0][0].legend(fontsize=9, frameon=False, loc="upper left", ncol=1)
    figure.tight_layout()
    figure.savefig(path, dpi=75)
    plt.close(figure)
