"""Cases of the proof from recordings of real arms with known interventions: the world real. What a source is: prove_sources.py.

A control is a set of recordings, imported as they are. An intervention is the same with one thing changed (real_changes.py),
and is judged beside its control: what both are said to have is the arm's own. What an intervention may be called is decided
here, before anything is diagnosed: the effects that say it outright, and those whose signatures act like it.
"""
import os
import random
import re
import shutil

import prove_files
import prove_score
import real_changes
import real_recordings

SAMPLE, FULL = 14, 66  # interventions
ATTEMPTS = 12
# An intervention is clear where it leaves at least this share of what the constants leave of the untouched recordings (rms).
CLEAR_SHARE = 0.25
CONTROLS = [(name, split) for name, kind in real_recordings.SETS.items() for split in range(len(kind.splits))]


def design(seed, count):
    """What is done to what, for each intervention: every change of every set once before any comes twice."""
    listed = []
    while len(listed) < count:
        every = [(name, change.__name__) for name, changes in real_changes.CHANGES.items() for change in changes]
        random.Random(f"{seed} design {len(listed)}").shuffle(every)
        listed += every
    split = random.Random(f"{seed} splits")
    return [(name, split.randrange(len(real_recordings.SETS[name].splits)), change) for name, change in listed[:count]]


def class_of(effects, ideal, but=()):
    """Ids that an intervention may be called: those that say it, and those whose signatures act like it."""
    return [*effects, *(name for name in prove_score.acting_alike(ideal) if name not in effects and name not in but)]


def with_gravity(text, gravity_m_s2):
    numbers = ", ".join(f"{x:.6f}" for x in gravity_m_s2)
    return re.sub(r"^gravity_m_s2:.*$", f"gravity_m_s2: [{numbers}]", text, flags=re.MULTILINE)


def read(path):
    with open(path, encoding="utf-8") as text:
        return text.read()


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


class Source:
    name = "real"

    def __init__(self, options):
        self.options = options
        self.softarm = os.path.join(options.programs, "softarm")
        self.data = os.path.abspath(os.environ.get("SOFTARM_DATA") or os.path.join(options.root, "..", "shared", "data"))
        count = options.cases if options.cases is not None else FULL if options.full else SAMPLE
        self.design = design(options.seed, count)

    def absent(self):
        missing = [kind.folder for kind in real_recordings.SETS.values() if not os.path.isdir(os.path.join(self.data, kind.folder))]
        return f"{', '.join(missing)} is not in {self.data} (SOFTARM_DATA)" if missing else None

    def kinds(self):
        return ["intervention", "control"]

    def plan(self, kinds):
        used = sorted({CONTROLS.index(one[:2]) for one in self.design})
        return [("intervention", number) for number in range(len(self.design)) if "intervention" in kinds] + [
            ("control", number) for number in used if "control" in kinds]

    # What all cases of a set share: its bags as they are, and its arm file.
    def shared(self, case, name):
        return os.path.join(os.path.dirname(os.path.dirname(case)), "real", name)

    def plain(self, case, name):
        """Folder of all bags of a set as they are; made once."""
        folder = os.path.join(self.shared(case, name), "plain")
        with prove_files.alone(folder):
            if not os.path.isdir(folder):
                shutil.rmtree(folder + ".part", ignore_errors=True)
                real_recordings.import_to(self.softarm, name, real_recordings.recordings(name, self.data), self.data,
                                          folder + ".part")
                os.rename(folder + ".part", folder)
        return folder

    def split_of(self, name, split):
        return real_recordings.SETS[name].splits[split]

    def bags(self, name, split, folder):
        listed = real_recordings.recordings(name, self.data)
        wanted = real_recordings.bags_of(name, self.split_of(name, split), listed)
        return [bag for bag in wanted if os.path.exists(os.path.join(folder, bag))]

    def arm(self, case, name, split):
        """The set's arm file, identified from pieces that are not diagnosed; where there are no other pieces, from those."""
        path = os.path.join(self.shared(case, name), f"arm_{split}.yaml")
        with prove_files.alone(path):
            if not os.path.exists(path):
                kind, folder = real_recordings.SETS[name], self.plain(case, name)
                start = os.path.join(self.shared(case, name), f"start_{split}.yaml")
                write(start, real_recordings.start_arm(name, read(os.path.join(self.options.root, "config/arms", kind.arm + ".yaml"))))
                own = set(self.bags(name, split, folder))
                others = [bag for bag in sorted(os.listdir(folder)) if bag.endswith(".bag") and bag not in own] or sorted(own)
                bags = [os.path.join(folder, bag) for bag in others if "100g" not in bag]
                real_recordings.identify(self.softarm, name, start, bags, path, path + ".log")
        return path

    def other_arm(self, case, name, split):
        """The arm file of another session: of the heaviest load alone, or of the pouch arm's steps."""
        path = os.path.join(self.shared(case, name), f"other_{split}.yaml")
        with prove_files.alone(path):
            if not os.path.exists(path):
                folder = self.plain(case, name)
                if name == "trunk":
                    own = set(self.bags(name, split, folder))
                    bags = [os.path.join(folder, bag) for bag in sorted(os.listdir(folder)) if bag.startswith("300g") and bag not in own]
                else:
                    bags = real_recordings.import_steps(self.softarm, self.data, os.path.join(self.shared(case, name), f"steps_{split}"))
                real_recordings.identify(self.softarm, name, self.arm(case, name, split), bags, path, path + ".log")
        return path

    def draw(self, kind, number, case, truth):
        if kind == "control":
            name, split = CONTROLS[number]
            known = self.untouched(case, name, split)
            hidden = sorted({change for one_name, one_split, change in self.design if (one_name, one_split) == (name, split)})
            self.keep(case, truth, known, {"kind": kind, "set": name, "split": split, "effects": [], "interventions": hidden,
                                           "rejected": []})
            return
        rejected = []
        for attempt in range(ATTEMPTS):
            try:
                self.intervene(number, attempt, case, truth, rejected)
                return
            except (prove_files.NotDrawn, real_changes.NothingChanged) as why:
                rejected.append(str(why))
        raise prove_files.NotDrawn(f"intervention {number}: {ATTEMPTS} draws do not do, the last: {rejected[-1]}", rejected)

    def untouched(self, case, name, split):
        """Fills the folder of a case with a set as it is; returns its case.json."""
        work, folder = case + ".part", self.plain(case, name)
        shutil.rmtree(work, ignore_errors=True)
        os.makedirs(work)
        bags = self.bags(name, split, folder)
        for bag in bags:
            shutil.copyfile(os.path.join(folder, bag), os.path.join(work, bag))
        shutil.copyfile(self.arm(case, name, split), os.path.join(work, "arm.yaml"))
        return {"arm": "arm.yaml", "trials": bags, "options": real_recordings.SETS[name].options}

    def tampered(self, number, attempt, case):
        """Fills the folder of a case with a set that was tampered with; returns its case.json and what was done."""
        name, split, change = self.design[number]
        draw = random.Random(f"{self.options.seed} intervention {number} {attempt}")
        known = self.untouched(case, name, split)
        work = case + ".part"
        listed = real_recordings.recordings(name, self.data)
        changed, done = real_changes.apply(name, real_recordings.SETS[name], listed, change, draw)
        bags = os.path.join(work, "changed")
        real_recordings.import_to(self.softarm, name, changed, self.data, bags)
        known["trials"] = [bag for bag in known["trials"] if os.path.exists(os.path.join(bags, bag))]
        for bag in known["trials"]:
            os.replace(os.path.join(bags, bag), os.path.join(work, bag))
        shutil.rmtree(bags)
        arm = os.path.join(work, "arm.yaml")
        if done["gravity"]:
            write(arm, with_gravity(read(arm), done["gravity"]))
        if done["segment"]:
            other = self.other_arm(case, name, split)
            write(arm, real_recordings.segment_of_another(read(arm), read(other), done["segment"]))
        return known, done

    def intervene(self, number, attempt, case, truth, rejected):
        name, split, _ = self.design[number]
        known, done = self.tampered(number, attempt, case)
        compared = self.compare(self.arm(case, name, split), self.plain(case, name), case + ".part", known)
        self.keep(case, truth, known, self.truth_of(number, done, compared, rejected), compared["displacement"])

    def again(self, kind, number, case, truth):
        if kind == "control":
            known = self.untouched(case, *CONTROLS[number])
        else:
            rejected = prove_files.read_json(os.path.join(truth, "case.json"))["rejected"]
            known, _ = self.tampered(number, len(rejected), case)
        self.keep_trials(case, known)

    def compare(self, arm, plain, work, known):
        """What the change leaves beside the arm's constants, and which effects act like it."""
        out = os.path.join(work, "compared.json")
        real_recordings.run([os.path.join(self.options.programs, "prove"), "compare", "--arm", arm, "--changed-arm",
                             os.path.join(work, "arm.yaml"), *known["options"], *prove_files.jobs(self.options), "--plain",
                             *(os.path.join(plain, bag) for bag in known["trials"]), "--changed",
                             *(os.path.join(work, bag) for bag in known["trials"]), "--out", out],
                            os.path.join(work, "compare.log"))
        compared = prove_files.read_json(out)
        for name in (out, os.path.join(work, "compare.log")):
            os.remove(name)
        if compared["raw_snr"] == 0.0 and read(os.path.join(work, "arm.yaml")) == read(arm):
            raise real_changes.NothingChanged("the trials are what they were")
        return compared

    def truth_of(self, number, done, compared, rejected):
        name, split, change = self.design[number]
        signal = {key: compared[key] for key in ("raw_snr", "leftover_snr", "raw_m", "leftover_m")}
        effect = {"effect": change, "catalogued": False, "values": {}, "form": "", "names": done["effects"],
                  "parameters": done["parameters"], "signal": signal}
        return {"kind": "intervention", "set": name, "split": split, "words": done["words"], "size": done["size"],
                "unit": done["unit"], "effects": [effect], "class": class_of(done["effects"], compared["ideal"], done["not"]),
                "clear": compared["leftover_m"] >= CLEAR_SHARE * compared["unexplained_m"],
                "unexplained_m": compared["unexplained_m"], "ideal": compared["ideal"][:10], "rejected": rejected,
                "control": CONTROLS.index((name, split))}

    def keep_trials(self, case, known):
        prove_files.write_json(os.path.join(case + ".part", "case.json"), known)
        shutil.rmtree(case, ignore_errors=True)
        os.rename(case + ".part", case)

    def keep(self, case, truth, known, hidden, displacement=None):
        """Both folders, or neither. displacement: of what was done."""
        sealed = truth + ".part"
        shutil.rmtree(sealed, ignore_errors=True)
        os.makedirs(sealed)
        prove_files.write_json(os.path.join(sealed, "case.json"),
                               {"distractors": [], "ideal": [], "constants": {}, **hidden})
        if displacement is not None:
            prove_files.write_json(os.path.join(sealed, "displacement.json"), [displacement])
        self.keep_trials(case, known)
        os.rename(sealed, truth)
