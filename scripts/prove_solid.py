"""Cases of the proof from the finite-element arm: the world solid. What a source is: prove_sources.py; what is computed, and
what each case hides: test/data/solid/cases.json and doc/solid_arm.md."""
import os
import shutil
import subprocess

import prove_files

# What is right to name of each case, decided before any diagnosis: the effect, its numbers where they are the catalogue's, and
# which other effects no recording of this arm at rest can tell from it.
HIDDEN = {
    "soft_ring": {"effect": "soft_spot", "parameters": {"share": 0.5, "centre_m": 0.085, "width_m": 0.03}},
    # The springs' own is 0.1; they stand under the bricks' corners, and the rubber gives between them. What the states show at
    # rest on its side, over the base's moment, is 0.17 to 0.19.
    "elastic_clamp": {"effect": "base_compliance", "parameters": {"compliance_rad_per_nm": 0.18}},
    "payload_aside": {"effect": "payload_offset", "parameters": {"x_m": 0.013, "y_m": 0.0075}},
    "log_offset": {"effect": "pressure_offset", "parameters": {"offset_2_pa": 2500.0}, "class": ["rest_curvature"]},
    "log_dead_zone": {"effect": "pressure_dead_zone", "parameters": {"lost_pa": 4000.0}},
    "wall": {"effect": "contact", "parameters": {"stiffness_n_per_m": 300.0, "place_m": 0.15, "distance_m": 0.012}},
    "small_chamber": {"effect": "chamber_mismatch", "parameters": {}},
}
# A chamber's gain is a constant of the arm file: it takes all of a smaller chamber, so that only "cannot tell" or the name of
# the effect itself can be asked.
CASES = {"solid_none": ["nothing"], "solid_compensated": ["small_chamber"],
         "solid_single": ["soft_ring", "elastic_clamp", "payload_aside", "log_offset", "log_dead_zone", "wall"]}
# Not in the arm file and there all the same. By the drawing: solid caps of 8 mm, of which the tip's has a plate of 4 mm. By what
# the finite elements do without weight (solid_checks.own_laws; test/build/solid_check.py): a chamber's moment grows more than in
# proportion to its pressure.
OF_NATURE = [{"effect": effect, "form": "solid", "catalogued": True, "values": {}, "parameters": parameters,
              "signal": {"leftover_m": 0.0, "leftover_snr": 0.0}}
             for effect, parameters in (("rigid_ends", {}), ("gain_nonlinearity", {"share": 0.16}))]
DRAWS = {"sample": 1, "full": 5}  # of the noise: the states are what they are


class Source:
    name = "solid"

    def __init__(self, options):
        self.options = options
        self.data = os.path.join(options.root, "test", "data", "solid")

    def absent(self):
        try:
            import numpy  # noqa: F401
        except ImportError:
            return "solid: python3-numpy is not installed (scripts/packages.txt, group solid)"
        return None

    def kinds(self):
        return list(CASES)

    def plan(self, kinds):
        draws = DRAWS["full" if self.options.full else "sample"] if self.options.cases is None else self.options.cases
        return [(kind, number) for kind in CASES if kind in kinds for number in range(draws * len(CASES[kind]))]

    def trials(self, kind, number, folder):
        """What a laboratory would have; returns what is hidden, the plan of the states, the noise's seed and the bags."""
        import solid_arm
        import solid_trials
        name = CASES[kind][number % len(CASES[kind])]
        shutil.rmtree(folder, ignore_errors=True)
        os.makedirs(folder)
        plan = solid_arm.read_plan(os.path.join(self.data, "cases.json"))
        seed = [self.options.seed, number // len(CASES[kind])]  # the same noise for the arm with nothing hidden, see signal()
        try:
            bags = solid_trials.write_trials(plan, self.data, name, folder, seed, os.path.join(self.options.programs, "softarm"))
        except (OSError, subprocess.CalledProcessError) as failed:
            raise prove_files.NotDrawn(f"solid: {failed}") from failed
        os.remove(os.path.join(folder, "layout.yaml"))
        shutil.copy(os.path.join(self.data, "solid_arm_identified.yaml"), os.path.join(folder, "arm.yaml"))
        prove_files.write_json(os.path.join(folder, "case.json"),
                               {"arm": "arm.yaml", "trials": [os.path.basename(bag) for bag in bags], "options": []})
        return name, plan, seed, bags

    def again(self, kind, number, case, truth):
        self.trials(kind, number, case + ".part")
        shutil.rmtree(case, ignore_errors=True)
        os.rename(case + ".part", case)

    def draw(self, kind, number, case, truth):
        work, sealed = case + ".part", truth + ".part"
        name, plan, seed, bags = self.trials(kind, number, work)
        shutil.rmtree(sealed, ignore_errors=True)
        os.makedirs(sealed)
        effects, ideal = [], []
        if name in HIDDEN:
            compared = self.signal(plan, seed, name, bags, os.path.join(work, "arm.yaml"), sealed)
            effects = [{**HIDDEN[name], "form": "solid", "catalogued": True, "values": {},
                        "signal": {key: compared[key] for key in ("raw_snr", "leftover_snr", "raw_m", "leftover_m")}}]
            ideal = compared["ideal"][:10]
            prove_files.write_json(os.path.join(sealed, "displacement.json"), [compared["displacement"]])
        prove_files.write_json(os.path.join(sealed, "case.json"),
                               {"kind": kind, "solid": name, "effects": effects, "distractors": OF_NATURE, "ideal": ideal,
                                "class": HIDDEN.get(name, {}).get("class", []), "constants": {}, "rejected": []})
        for part, whole in ((work, case), (sealed, truth)):
            shutil.rmtree(whole, ignore_errors=True)
            os.rename(part, whole)

    def signal(self, plan, seed, name, bags, arm, folder):
        """What is hidden leaves beside the arm's constants: against the same trials with nothing hidden and the same noise."""
        import solid_trials
        plain = os.path.join(folder, "plain")
        out, log = os.path.join(folder, "compared.json"), os.path.join(folder, "compare.log")
        same = solid_trials.write_trials(plan, self.data, "nothing", plain, seed, os.path.join(self.options.programs, "softarm"), name)
        status, _ = prove_files.run([os.path.join(self.options.programs, "prove"), "compare", "--arm", arm, "--changed-arm", arm,
                                     *prove_files.jobs(self.options), "--plain", *same, "--changed", *bags, "--out", out], log)
        if status != 0:
            raise prove_files.NotDrawn("solid: " + prove_files.last_line(log))
        compared = prove_files.read_json(out)
        shutil.rmtree(plain)
        os.remove(out)
        os.remove(log)
        return compared
