#!/usr/bin/python3
"""Estimates from bags: a table per bag, and a picture of bending stiffness, payload and shapes.

    scripts/python python/examples/estimate_trial.py trial.bag --out estimates.png
    scripts/python python/examples/estimate_trial.py --arm my_arm.yaml trials/*.bag --unknown payload --csv payloads.csv
"""
import argparse
import sys

import numpy as np

import softarm


def draw(found, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, grid = plt.subplots(len(found), 2, figsize=(10.0, 3.4 * len(found)), squeeze=False,
                                gridspec_kw={"width_ratios": [2, 1]})
    for (values, shape), one in zip(grid, found):
        time_s = one.stamp_s - one.stamp_s[0]
        for k in range(one.EI_nm2.shape[1]):
            good = one.identifiable_EI[:, k]
            values.plot(time_s[good], one.EI_nm2[good, k], ".", ms=3, label=f"EI of segment {k + 1} (N m²)")
        if one.identifiable_payload.any():
            values.plot(time_s[one.identifiable_payload], one.payload_kg[one.identifiable_payload], ".", ms=3, label="payload (kg)")
        values.set(xlabel="time (s)", title=f"{one.name}: where identifiable", ylim=(0.0, None))
        values.legend(fontsize=8)
        for i in np.flatnonzero(one.ok)[:: max(1, int(one.ok.sum()) // 25)]:
            p = 1e3 * one.backbone_p_base_m[i]
            shape.plot(np.hypot(p[:, 0], p[:, 1]), p[:, 2], lw=0.8, color="C0", alpha=0.5)
        shape.set(xlabel="off the axis of the base (mm)", ylabel="along it (mm)", title="25 of its shapes", aspect="equal")
    figure.tight_layout()
    figure.savefig(path, dpi=90)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bags", nargs="+")
    parser.add_argument("--arm", default="online_200mm", help="arm file, or the name of one that ships (default: %(default)s)")
    parser.add_argument("--unknown", choices=["stiffness", "payload", "both"], help="default: the arm's")
    parser.add_argument("--prior", action="store_true", default=None, help="the arm's laws as a prior; both needs it")
    parser.add_argument("--out", help="the picture, .png or .pdf")
    parser.add_argument("--csv", help="all estimates in one table; wants python3-pandas")
    arguments = parser.parse_args()

    arm = softarm.load_arm(arguments.arm)
    found = softarm.estimate_bags(arm, arguments.bags, unknown=arguments.unknown, prior=arguments.prior,
                                  progress=lambda share, what: print(f"\r{100 * share:3.0f} %", end="", file=sys.stderr))
    print("\r     \r", end="", file=sys.stderr)
    for one in found:
        print(f"{one.name}: {int(one.ok.sum())} of {len(one)} frames estimated, rms residual {1e3 * np.nanmean(one.rms_residual_m):.2f} mm")
        for k, segment in enumerate(arm.segments):
            good = one.identifiable_EI[:, k]
            if good.any():
                print(f"  {segment.name}: EI {np.median(one.EI_nm2[good, k]):.4g} N m² (median of {int(good.sum())} frames)")
        if one.identifiable_payload.any():
            print(f"  payload: {1e3 * np.median(one.payload_kg[one.identifiable_payload]):.1f} g")
        for alarm in one.alarms:
            print(f"  alarm, {alarm.onset_s:.1f} to {alarm.seen_s:.1f} s: {alarm.description}")
    if arguments.out:
        draw(found, arguments.out)
    if arguments.csv:
        import pandas
        pandas.concat([one.to_pandas().assign(trial=one.name) for one in found]).to_csv(arguments.csv, index=False)


if __name__ == "__main__":
    try:
        main()
    except (softarm.Error, ValueError) as why:
        sys.exit(f"estimate_trial: {why}")
