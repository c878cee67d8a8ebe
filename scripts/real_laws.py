"""What further laws, another EI and windows make of the recordings of the pouch arm: markdown rows of doc/real_arms.md. Used by
plot_real_arms.py."""
import real_pouch
from softarm_module import softarm

SATURATIONS = ("*.chamber_2.saturation", "*.chambers.saturation")
STIFFER_NM2 = 2.0
WALL = ("    wall:\n      bending: [{{time_s: 1.5, share: {share}}}]\n      axial: [{{time_s: 3, share: {share}}}]\n"
        "    torsional_stiffness_nm2:")
WINDOWS = (("both", 0.5), ("payload", 5), ("payload", 30))


def starts_of(pouch, root):
    """Each folder of trials: the arm file that fits start from, and their options."""
    text = (root / "config/arms/pouch_arm.yaml").read_text()
    two = pouch.work / "start_two.yaml"
    two.write_text(text)
    options = lambda hold, free: ["--hold", hold, "--also-free", free]
    return {"one": (pouch.work / "start.yaml", options(real_pouch.HOLD, real_pouch.FREE_ONE)),
            "two": (two, options(real_pouch.HOLD, real_pouch.FREE)),
            "steps": (two, options(real_pouch.HOLD_STEPS, real_pouch.FREE))}


def print_saturation(pouch, starts):
    print("\nsaturation freed, mm: fitted; each trial by the others; the constants\n")
    print("| | fitted: none | each chamber's | all chambers' | by the others: none | each chamber's | all chambers' |")
    print("|---|---|---|---|---|---|---|")
    sizes = []
    for folder, (arm, options) in starts.items():
        fitted, unseen = [], []
        for k, names in enumerate(("",) + SATURATIONS):
            more = options[:-1] + [f"{options[-1]},{names}"] if names else options
            fit, others, found = pouch.errors(f"{folder}_saturation_{k}", arm, folder, *more)
            fitted.append(f"{fit:.1f}")
            unseen.append(f"{others:.1f}")
            sizes += [f"  {name_of(folder)} {one['name']}: {one['value']:.3g} {one['unit']}" +
                      (", at its limit" if one["at_bound"] else f", sd {100 * one['sd'] / abs(one['value']):.0f} % of it")
                      for one in found["constants"] if one["name"].endswith("saturation")]
        print("| " + " | ".join([f"`{name_of(folder)}`", *fitted, *unseen]) + " |")
    print("\n" + "\n".join(sizes))


def name_of(folder):
    return {"one": "one_segment", "two": "two_segment"}.get(folder, folder)


def scaled(arm, to_nm2):
    """The arm of one segment with another EI, and the gains in proportion."""
    (name, was), = [(name, one.value) for name, one in arm.constants.items() if name.endswith(".bending_stiffness.base")]
    gains = {name: float(f"{one.value * to_nm2 / was:.4g}") for name, one in arm.constants.items() if name.endswith(".moment_gain")}
    return arm.with_constants({name: to_nm2, **gains})


def print_stiffer(pouch, starts):
    arm, options = starts["one"]
    stiffer = pouch.work / "start_stiffer.yaml"
    scaled(softarm.load_arm(arm), STIFFER_NM2).save(stiffer, force=True)
    fit, others, _ = pouch.errors("one_stiffer", stiffer, "one", *options)
    print(f"\none segment, EI held at {STIFFER_NM2:g} N m^2, gains in proportion: fitted {fit:.1f} mm, by the others {others:.1f} mm")


def with_wall(pouch, arm, share):
    path = pouch.work / f"{arm.stem}_wall_{share}.yaml"
    path.write_text(arm.read_text().replace("    torsional_stiffness_nm2:", WALL.format(share=share)))
    return path


def print_wall(pouch, starts):
    print("\na viscoelastic wall, mean error, mm\n")
    print("| | fitted: none | wall | each by the others: none | wall |\n|---|---|---|---|---|")
    hold = "*.wall.*"
    rows = (("one", 0.7, [hold], [], "wall held at shares of 0.7"),
            ("one", 0.7, ["*.wall.*.time"], [], "shares fitted from 0.7"),
            ("one", 0.7, [], ["--moving"], "times and shares fitted, `--moving`"),
            ("two", 0.4, [], [], "times and shares fitted"),
            ("steps", 0.4, [], [], "times and shares fitted"))
    found = []
    for k, (folder, share, held, more, title) in enumerate(rows):
        arm, options = starts[folder]
        none = pouch.errors(f"{folder}_no_wall_{k}", arm, folder, *options, *more)
        options = [options[0], ",".join([options[1], *held]), *options[2:]]
        wall = pouch.errors(f"{folder}_wall_{k}", with_wall(pouch, arm, share), folder, *options, *more)
        print(f"| `{name_of(folder)}`, {title} | {none[0]:.1f} mm | {wall[0]:.1f} mm | {none[1]:.1f} mm | {wall[1]:.1f} mm |",
              flush=True)
        found.append((f"{name_of(folder)}, {title}", wall[2]))
    for title, result in found:
        constants = [f"{one['name']} {one['value']:.3g} ± {one['sd']:.2g}{' at its limit' if one['at_bound'] else ''}"
                     for one in result["constants"] if ".wall." in one["name"]]
        starts_text = [f"{one['trial']} {one['element']} {one['value']:.2g} {one['unit']}" for one in result["starts"]]
        print(f"  {title}: {', '.join(constants) or 'held'}\n    trials begin: {', '.join(starts_text)}")


def print_laws(pouch, root):
    starts = starts_of(pouch, root)
    print_saturation(pouch, starts)
    print_stiffer(pouch, starts)
    print_wall(pouch, starts)


def claims(rows, hand):
    """Of the frames whose payload is known: told, and within two standard deviations of it."""
    told, within, count = 0, 0, 0
    for row in rows:
        t = real_pouch.time_of(row)
        if row["status"] != "ok" or hand and hand[0] <= t <= hand[1]:
            continue
        count += 1
        told += row["identifiable_payload"] == 1
        truth = real_pouch.LOAD_KG if hand and t > hand[1] else 0.0
        within += row["sd_payload"] is not None and abs(row["payload"] - truth) <= 2 * row["sd_payload"]
    return 100 * told / count, 100 * within / count


def span_of(shares):
    low, high = (f"{f(shares):.0f}" for f in (min, max))
    return f"{low} %" if low == high else f"{low} to {high} %"


def print_windows(pouch):
    """Laws from one unloaded trial, the others estimated with frames that share."""
    print("\nframes that share, laws from one unloaded trial\n")
    print("| laws from | option | told a payload | within 2 sd of it | median, `no_load` of the other trial |\n|---|---|---|---|---|")
    for trial, other in (("no_load_1", "no_load_3"), ("no_load_3", "no_load_1")):
        laws = pouch.work / f"laws_{trial}.yaml"
        pouch.run("identify", "--arm", pouch.work / "start.yaml", pouch.work / f"one/{trial}.bag", "--hold", real_pouch.HOLD,
                  "--also-free", real_pouch.FREE, "--not-robust", "--out", laws)
        for unknown, window in WINDOWS:
            names, folder = (other, "load_1", "load_3"), f"window_{trial}_{unknown}_{window}"
            pouch.run("estimate", "--arm", laws, *pouch.whole(names), "--prior", "on", "--unknown", unknown, "--window", window,
                      "--out", pouch.work / folder)
            found = [claims(pouch.estimates(folder, name), real_pouch.HAND_S.get(name)) for name in names]
            median = real_pouch.median_and_sd(pouch.estimates(folder, other), "payload", 0, 100)
            print(f"| {f'`{trial}`' if window == WINDOWS[0][1] else ''} | `--unknown {unknown} --window {window}` | "
                  f"{span_of([told for told, _ in found])} | {span_of([within for _, within in found])} | {median} kg |", flush=True)
