#!/usr/bin/python3
"""Draws, seals, diagnoses and scores the cases of the proof; scripts/prove builds and runs it."""
import argparse
import hashlib
import json
import os
import random
import shlex
import shutil
import subprocess
import sys
import threading
import time

import prove_figures
import prove_pages
import prove_record
import prove_report
import prove_score
import prove_slurm
import prove_sources
from prove_files import NotDrawn, each, jobs, last_line, lines_of, read_json, run, say, write_json, write_text

RECORD_EVERY_S = 300.0  # what an interruption costs at most; writing it takes seconds


def engine(root):
    """Commit of the checkout, with a mark where files differ from it."""
    def git(*arguments):
        return subprocess.run(["git", "-C", root, *arguments], capture_output=True, text=True, check=False).stdout.strip()

    commit = git("rev-parse", "HEAD") or "unknown"
    return commit + (" with changes" if git("status", "--porcelain", "--", "src", "include", "config", "scripts") else "")


def engines_of(results, sealed):
    """The engines that diagnosed, each once; the sealed one stands for those that left no word."""
    return ", ".join(dict.fromkeys((result["cost"] or {}).get("engine", sealed) for result in results if result["report"])) or sealed


def seed_from_outside(root):
    """Of the engine's commit, the day and chance: nobody chooses it."""
    chance = os.urandom(16).hex()
    return int(hashlib.sha256(f"{engine(root)} {time.strftime('%Y-%m-%d')} {chance}".encode()).hexdigest()[:7], 16)


class Proof:
    def __init__(self, options, sources):
        self.options = options
        self.sources = {}  # by kind
        present = []
        for source in sources:
            if source.absent():
                say(f"skipped: {source.name}: {source.absent()}")
                continue
            present.append(source)
            self.sources.update({kind: source for kind in source.kinds()})
        if not present:
            sys.exit("prove: nothing to draw cases from")
        self.name = ", ".join(source.name for source in present)
        size = "full" if options.full else "sample"
        self.folder = options.out or os.path.join(options.work, "_".join([*(os.path.basename(source.name) for source in present),
                                                                          str(options.seed), size]))
        self.cases = os.path.join(self.folder, "cases")
        self.truth = os.path.join(self.folder, "truth")
        self.reports = os.path.join(self.folder, "reports")
        for path in (self.cases, self.truth, self.reports):
            os.makedirs(path, exist_ok=True)
        self.recording, self.recorded_at = threading.Lock(), time.monotonic()
        self.plan = self.planned(present)
        prove_record.unpack(options.recorded, self.folder)

    def program(self, name):
        return os.path.join(self.options.programs, name)

    def planned(self, sources):
        """Case names to kinds and numbers, in an order that says nothing of them."""
        wanted = self.options.kinds.split(",") if self.options.kinds else list(self.sources)
        unknown = set(wanted) - set(self.sources)
        if unknown:
            sys.exit(f"prove: --kinds: no kind {', '.join(sorted(unknown))}")
        plan = [case for source in sources for case in source.plan([kind for kind in source.kinds() if kind in wanted])]
        random.Random(self.options.seed).shuffle(plan)
        named = {f"case_{i + 1:03}": case for i, case in enumerate(plan)}
        path = os.path.join(self.truth, "plan.json")
        stated = json.loads(json.dumps({"campaign": self.name, "seed": self.options.seed, "cases": named}))
        if self.options.recorded and prove_record.plan_of(self.options.recorded) != stated:
            sys.exit(f"prove: {self.options.record}: the record of a proof of other worlds, kinds or numbers than these")
        if os.path.exists(path) and read_json(path) != stated:
            sys.exit(f"prove: {self.folder} holds another proof; give another --out or remove it")
        if not self.options.only:
            write_json(path, stated)
        return named

    def is_drawn(self, case):
        return os.path.exists(os.path.join(self.truth, case, "case.json")) or os.path.exists(os.path.join(self.truth, case + ".failed"))

    def is_decided(self, case):
        files = ["cost.json"] + (["baselines.json"] if self.options.baselines else [])
        return all(os.path.exists(os.path.join(self.reports, case, name)) for name in files)

    def record(self, least_s=RECORD_EVERY_S):
        """Writes it where one is asked for and the last is so old. Tasks of Slurm leave it to who waits for them."""
        with self.recording:
            if self.options.record and not self.options.only and time.monotonic() - self.recorded_at >= least_s:
                prove_record.write(self.folder, [case for case in self.plan if self.is_decided(case)], self.options.record)
                self.recorded_at = time.monotonic()

    def each(self, what, todo, action):
        """Here, one on each core, or as tasks of Slurm, which come back here with `only` the case that they are to do."""
        if self.options.only:
            step, case = self.options.only.split(":")
            if step == what and case in todo:
                action(case)
        elif self.options.engine == "slurm" and todo:
            is_done = self.is_drawn if what == "drawing" else self.is_decided
            more = [f"--cpus-per-task={self.options.jobs or 1}", *shlex.split(self.options.slurm_options)]
            prove_slurm.each(what, todo, [sys.executable, *self.options.words], self.folder, more,
                             lambda: [case for case in todo if not is_done(case)])
        else:
            each(what, todo, action, self.options.at_once)

    def draw(self):
        def one(case):
            kind, number = self.plan[case]
            try:
                self.sources[kind].draw(kind, number, os.path.join(self.cases, case), os.path.join(self.truth, case))
            except NotDrawn as why:
                path = os.path.join(self.truth, case + ".failed")
                with open(path + ".part", "w", encoding="utf-8") as text:  # the reasons of its draws, and last its own
                    text.writelines(" ".join(str(reason).split()) + "\n" for reason in (*why.rejected, why))
                os.replace(path + ".part", path)
            self.record()

        missing = [case for case in self.plan if not self.is_drawn(case)]
        if missing and os.path.exists(self.seal_path()):
            sys.exit(f"prove: {self.seal_path()} seals cases that are not there any more")
        self.each("drawing", missing, one)

    def seal_path(self):
        return os.path.join(self.folder, "seal.json")

    def seal(self):
        listed = os.path.join(self.truth, "SHA256SUMS")
        sums = prove_record.sums(self.truth)
        if os.path.exists(self.seal_path()):
            sealed = read_json(self.seal_path())
            text = prove_record.read(listed) if os.path.exists(listed) else b""
            if hashlib.sha256(text).hexdigest() != sealed["truth_sha256"] or not prove_record.matches(sums, text.decode()):
                sys.exit(f"prove: the truth in {self.truth} is not what was sealed")
            if sealed["engine"] != engine(self.options.root):
                say(f"The engine has changed since the seal ({sealed['engine']}): what was diagnosed before stays as it is.")
        else:
            text = "".join(f"{digest}  {path}\n" for path, digest in sums.items())
            write_text(listed, text)
            sealed = {"truth_sha256": hashlib.sha256(text.encode()).hexdigest(), "engine": engine(self.options.root)}
            write_json(self.seal_path(), sealed)
        print(f"truth_sha256: {sealed['truth_sha256']} (of {listed})", flush=True)
        return sealed

    def decide(self):
        def one(case):
            folder, own = os.path.join(self.reports, case), os.path.join(self.cases, case)
            known, bags = self.trials(case)
            arm = os.path.join(own, known["arm"]) if known["arm"].endswith(".yaml") else known["arm"]
            more = [*known.get("options", []), *jobs(self.options)]
            if not os.path.exists(os.path.join(folder, "cost.json")):
                shutil.rmtree(folder, ignore_errors=True)  # of one that was interrupted
                os.makedirs(folder)
                log = os.path.join(folder, "diagnose.log")
                status, cost = run([self.program("softarm"), "diagnose", "--arm", arm, *bags, "--out", folder, *more], log)
                if status != 0:
                    cost["message"] = last_line(log)
                write_json(os.path.join(folder, "cost.json"), {**cost, "engine": engine(self.options.root)})
            self.displace(folder, bags)
            if self.options.baselines and not os.path.exists(os.path.join(folder, "baselines.json")):
                log = os.path.join(folder, "baselines.log")
                status, _ = run([self.program("prove"), "decide", "--arm", arm, "--out",
                                 os.path.join(folder, "baselines.json"), *bags, *more], log)
                if status != 0:
                    write_json(os.path.join(folder, "baselines.json"), {"failed": last_line(log)})
            if self.options.full:
                for bag in bags:  # tens of gigabytes; their truth makes them again
                    os.remove(bag)
                if os.path.exists(os.path.join(folder, "report.html")):
                    os.remove(os.path.join(folder, "report.html"))
            self.record()

        drawn = [case for case in self.plan if os.path.exists(os.path.join(self.truth, case, "case.json"))]
        self.each("diagnosing", [case for case in drawn if not self.is_decided(case)], one)

    def trials(self, case):
        """case.json and the paths of the bags of a case; made again where they are not there, as after a record."""
        own = os.path.join(self.cases, case)

        def found():
            path = os.path.join(own, "case.json")
            known = read_json(path) if os.path.exists(path) else {"trials": []}
            return known, [os.path.join(own, bag) for bag in known["trials"]]

        known, bags = found()
        if not bags or not all(os.path.exists(bag) for bag in bags):
            kind, number = self.plan[case]
            self.sources[kind].again(kind, number, own, os.path.join(self.truth, case))
            known, bags = found()
        return known, bags

    def displace(self, folder, bags):
        """By how much what was found moves the bodies; nothing where nothing was."""
        extended, out = os.path.join(folder, "arm_extended.yaml"), os.path.join(folder, "displacement.json")
        report = os.path.join(folder, "report.json")
        if os.path.exists(out) or not os.path.exists(extended) or not prove_score.named_in(read_json(report)):
            return
        run([self.program("prove"), "displacement", "--arm", extended, "--out", out, *bags, *jobs(self.options)],
            os.path.join(folder, "displacement.log"))

    def results(self):
        """One per case: truth, report, cost, decisions of the baselines; what is missing is None."""
        results = []
        for case, (kind, number) in self.plan.items():
            def found(*parts):
                path = os.path.join(self.folder, *parts)
                return read_json(path) if os.path.exists(path) else None

            failed = os.path.join(self.truth, case + ".failed")
            results.append({
                "case": case, "kind": kind, "number": number,
                "not_drawn": last_line(failed) if os.path.exists(failed) else None,
                "rejected": lines_of(failed)[:-1] if os.path.exists(failed) else [],
                "truth": found("truth", case, "case.json"), "report": found("reports", case, "report.json"),
                "hidden_moves": found("truth", case, "displacement.json"),
                "found_moves": found("reports", case, "displacement.json"),
                "cost": found("reports", case, "cost.json"), "baselines": found("reports", case, "baselines.json")})
        return results


def main():
    parser = argparse.ArgumentParser(prog="prove", description=__doc__.splitlines()[0])
    parser.add_argument("--root", required=True)
    parser.add_argument("--work", required=True)
    parser.add_argument("--programs", required=True)
    parser.add_argument("--full", action="store_true")
    parser.add_argument("--json", metavar="FILE")
    parser.add_argument("--seed", type=int)
    parser.add_argument("--worlds")
    parser.add_argument("--campaign")
    parser.add_argument("--cases", type=int)
    parser.add_argument("--kinds")
    parser.add_argument("--report", metavar="FILE")
    parser.add_argument("--out", metavar="DIR")
    parser.add_argument("--jobs", type=int)
    parser.add_argument("--no-baselines", dest="baselines", action="store_false")
    parser.add_argument("--engine", choices=("local", "slurm"), default="local")
    parser.add_argument("--slurm-options", default="")
    parser.add_argument("--record", metavar="FILE")
    parser.add_argument("--so-far", action="store_true")
    parser.add_argument("--only", help=argparse.SUPPRESS)  # STEP:CASE, in a task of Slurm
    options = parser.parse_args()
    for path in (options.json, options.report, options.record):
        if path and not os.path.isdir(os.path.dirname(os.path.abspath(path))):
            parser.error(f"{path}: no such folder")
    options.recorded = []
    if options.record and os.path.exists(options.record) and not options.only:
        try:
            options.recorded = prove_record.entries(options.record)
        except ValueError as failed:
            parser.error(str(failed))
        seed = prove_record.plan_of(options.recorded)["seed"]
        options.seed = seed if options.seed is None else options.seed
        if options.seed != seed:
            parser.error(f"{options.record}: the record of another proof, of --seed {seed}")
    if options.seed is None:
        options.seed = seed_from_outside(options.root)
        say(f"--seed {options.seed}: goes on with this proof after an interruption")
    if options.seed < 0 or (options.cases is not None and options.cases < 0):
        parser.error("--seed and --cases must not be negative")
    if options.jobs is not None and options.jobs < 1:
        parser.error("--jobs must be 1 or more")
    # Here a case per core, each on one; a task of Slurm has its cores for its one case.
    given = int(os.environ.get("SLURM_CPUS_PER_TASK", "1")) if options.only else len(os.sched_getaffinity(0))
    options.at_once, options.threads = (1, options.jobs or given) if options.only else (options.jobs or given, 1)
    # What a task of Slurm runs: this command with its seed, said last, and one case.
    options.words = [os.path.abspath(sys.argv[0]), *sys.argv[1:], f"--seed={options.seed}"]
    if shutil.which("git") is None:
        say("No git: the engine's commit is not recorded.")

    started = time.monotonic()
    proof = Proof(options, prove_sources.chosen(options))
    say(f"{len(proof.plan)} cases of {proof.name}, seed {options.seed}, in {proof.folder}")
    if options.only:
        return proof.draw() if options.only.startswith("drawing:") else proof.decide()
    if not options.so_far:
        proof.draw()
    elif not os.path.exists(proof.seal_path()):
        sys.exit("prove: --so-far: not all cases are drawn and sealed yet; none is decided")
    sealed = proof.seal()
    proof.record(0.0)
    if not options.so_far:
        proof.decide()
        proof.record(0.0)
    tell(options, proof, sealed)
    say(f"{(time.monotonic() - started) / 60:.1f} min")


def tell(options, proof, sealed):
    """Figures, pages and the exit status."""
    results = proof.results()
    if options.so_far:
        results = [result for result in results if proof.is_decided(result["case"]) or not result["truth"]]
    figures = prove_figures.figures(results)
    figures.update({"campaign": proof.name, "seed": options.seed, "full": options.full and not options.so_far, **sealed,
                    "engine": engines_of(results, sealed["engine"])})
    if options.so_far:
        figures["so_far"] = len(proof.plan)
    print(prove_report.table(figures))
    whole = not options.campaign and not options.worlds and not options.kinds and not options.so_far
    story = options.report or os.path.join(*([options.root, "doc"] if whole else [proof.folder]), "proof.md")
    if options.json:
        write_json(options.json, figures)
    prove_pages.write(results, figures, story)
    if not prove_report.passes(figures):
        sys.exit("prove: " + ("a target is not met" if figures["full"] else "a target is contradicted") + " (table above)")


if __name__ == "__main__":
    main()
