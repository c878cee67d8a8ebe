"""Cases of the proof from campaigns of the virtual rig: the worlds tidy and untidy. What a source is: prove_sources.py."""
import json
import os
import re
import subprocess
import sys

import prove_files

CAMPAIGNS = {"tidy": "proof_final", "untidy": "untidy_final"}


def rejected_of(lines):
    """Why each draw did not do, from what `prove draw` says where none did: their number and the last reason, in its last line;
    what it says before are reasons, too. Those that it does not say count all the same."""
    found = re.search(r"(\d+) draws do not do, the last: (.*)", lines[-1]) if lines else None
    if not found:
        return []
    told = (lines[:-1] or [found[2]])[-int(found[1]):]
    return ["not told"] * (int(found[1]) - len(told)) + told


class Source:
    def __init__(self, options, campaign):
        self.options = options
        self.name = campaign
        listing = subprocess.run([self.program(), "kinds", campaign], capture_output=True, text=True, check=False)
        if listing.returncode != 0:
            sys.exit(listing.stderr.strip())
        self.listed = json.loads(listing.stdout)

    def program(self):
        return os.path.join(self.options.programs, "prove")

    def absent(self):
        return None

    def kinds(self):
        return [kind["kind"] for kind in self.listed]

    def plan(self, kinds):
        size = "full" if self.options.full else "sample"
        return [(kind["kind"], number) for kind in self.listed if kind["kind"] in kinds
                for number in range(kind[size] if self.options.cases is None else self.options.cases)]

    def run(self, kind, number, case, truth, *more):
        """Runs `prove draw`; returns its status and what it said."""
        log = truth + ".log"
        command = [self.program(), "draw", "--campaign", self.name, "--kind", kind, "--number", number, "--seed",
                   self.options.seed, "--case", case, "--truth", truth, *prove_files.jobs(self.options), *more]
        status, _ = prove_files.run(command, log)
        said = prove_files.lines_of(log)
        os.remove(log)
        return status, said or ["no message"]

    def draw(self, kind, number, case, truth):
        status, said = self.run(kind, number, case, truth)
        if status != 0:
            raise prove_files.NotDrawn(said[-1], rejected_of(said))

    def again(self, kind, number, case, truth):
        status, said = self.run(kind, number, case, truth, "--again")
        if status != 0:
            sys.exit(said[-1])
