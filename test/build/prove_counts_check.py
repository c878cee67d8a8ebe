#!/usr/bin/python3
"""How many cases the proof has: enough of them in a sample."""
import argparse
import os
import re
import sys
import unittest

ROOT = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else ".")
sys.path.insert(0, os.path.join(ROOT, "scripts"))
import prove_real  # noqa: E402
import prove_rig  # noqa: E402
import prove_solid  # noqa: E402


def campaign(name):
    """As `prove kinds` lists them."""
    with open(os.path.join(ROOT, "config", "campaigns", name + ".yaml"), encoding="utf-8") as text:
        kinds = text.read().split("\nkinds:\n")[1]
    found = re.findall(r"- (?:\{|\n? *)kind: (\w+),?\s+sample: (\d+),?\s+full: (\d+)", kinds)
    assert len(found) == kinds.count("kind: "), name
    return [{"kind": kind, "sample": int(sample), "full": int(full)} for kind, sample, full in found]


class OfCampaign(prove_rig.Source):
    def __init__(self, options, name):
        self.options = options
        self.listed = campaign(name)


def plan(**more):
    """(kind, number) of every case of all worlds."""
    options = argparse.Namespace(**{"root": ROOT, "programs": "/nowhere", "seed": 5, "full": False, "cases": None, "jobs": 1, **more})
    sources = [OfCampaign(options, name) for name in prove_rig.CAMPAIGNS.values()]
    sources += [prove_solid.Source(options), prove_real.Source(options)]
    return [case for source in sources for case in source.plan(source.kinds())]


class Sample(unittest.TestCase):
    def test_it_has_sixty_cases_and_more(self):
        for seed in (5, 1228):  # of the latter all interventions are on two sets of recordings: the fewest controls
            self.assertGreaterEqual(len(plan(seed=seed)), 60)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
