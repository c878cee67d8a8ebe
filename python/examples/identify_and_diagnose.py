#!/usr/bin/python3
"""Finds the constants of an arm's laws and what its file leaves out; prints a table of each, and what to record next.

    scripts/python python/examples/identify_and_diagnose.py --arm my_arm.yaml trials/*.bag --out results

It writes results/my_arm_identified.yaml and results/report/ (report.html, report.json, arm_extended.yaml). It takes minutes; Ctrl-C ends it.
"""
import argparse
import os
import sys

import softarm


def bar(share, what):
    print(f"\r\033[K[{'#' * int(30 * share):.<30}] {100 * share:3.0f} %  {what}", end="", file=sys.stderr, flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bags", nargs="+", help="three or more trials")
    parser.add_argument("--arm", default="online_200mm", help="arm file, or the name of one that ships (default: %(default)s)")
    parser.add_argument("--out", required=True, help="folder of the results")
    parser.add_argument("--force", action="store_true", help="replace earlier results")
    arguments = parser.parse_args()

    arm = softarm.load_arm(arguments.arm)
    trials = softarm.read_bags(arm, arguments.bags, progress=bar)
    result = softarm.identify(arm, trials, progress=bar)
    print("\r\033[K" + result.verdict)
    for constant in result.constants:
        print(f"  {constant.name:<45} {constant.value:12.4g} ± {constant.sd:<10.2g} {constant.unit:<12}"
              f"{'' if constant.determined else 'not determined'}")
    os.makedirs(arguments.out, exist_ok=True)
    name = os.path.splitext(os.path.basename(arm.source))[0]
    result.arm.save(os.path.join(arguments.out, name + "_identified.yaml"), force=arguments.force)

    diagnosis = softarm.diagnose(arm, trials, progress=bar)
    found = diagnosis.to_dict()
    print(f"\r\033[K\n{diagnosis.verdict}: rms error on unseen trials {1e3 * found['baseline']['held_out_rms_m']:.2f} mm before, "
          f"{1e3 * found['extended']['held_out_rms_m']:.2f} mm after")
    for effect in diagnosis.effects:
        print(f"  {effect['name']} ({100 * effect['probability']:.0f} %): {effect['sentence']}")
    if found.get("next_experiment"):
        print("record next:", found["next_experiment"]["action"])
    print("written:", *diagnosis.save(os.path.join(arguments.out, "report"), force=arguments.force))


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit("\nidentify_and_diagnose: ended")
    except (softarm.Error, ValueError, OSError) as why:
        sys.exit(f"identify_and_diagnose: {why}")
