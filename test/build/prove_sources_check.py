#!/usr/bin/python3
"""The course of the proof on stand-ins of its programs: cases of several sources are named, drawn, sealed, diagnosed with
their own words, scored and gone on with; what cannot be drawn is said."""
import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import unittest

ROOT = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else ".")
BUILD = os.path.abspath(sys.argv[2] if len(sys.argv) > 2 else os.path.join(ROOT, "build"))
PROGRAMS = os.path.join(BUILD, "devel", "lib", "softarm_estimator")
sys.path.insert(0, os.path.join(ROOT, "scripts"))
import prove_cases  # noqa: E402
import prove_files  # noqa: E402
import prove_record  # noqa: E402
import prove_rig  # noqa: E402

PROVE = """#!/usr/bin/python3
import json, os, sys
words = dict(zip(sys.argv[2::2], sys.argv[3::2]))
if sys.argv[1] == "kinds":
    print(json.dumps([{"kind": "none", "sample": 2, "full": 4}, {"kind": "single_strong", "sample": 1, "full": 3}]))
elif words["--kind"] == "single_strong":
    sys.exit("prove: some, kind single_strong, case 0: 12 draws do not do, the last: it flies away")
else:
    again = "--again" in sys.argv
    for folder, text in ((words["--case"], {"arm": "some_arm", "trials": ["a.bag"], "options": ["--tie", "x"]}),
                         (words["--truth"], {"kind": "none", "effects": [], "distractors": [], "ideal": [], "constants": {}})):
        if again and folder == words["--truth"]:
            assert os.path.exists(folder + "/case.json")
            continue
        os.makedirs(folder)
        open(folder + "/case.json", "w").write(json.dumps(text))
        if folder == words["--truth"]:
            open(folder + "/displacement.json", "w").write("[]")
            open(folder + "/a.truth.yaml", "w").write("of a trial")
        else:
            open(folder + "/a.bag", "w").write("drawn again" if again else "drawn")
"""
SOFTARM = """#!/usr/bin/python3
import json, sys
out = sys.argv[sys.argv.index("--out") + 1]
errors = {"held_out_rms_m": 1e-3}
open(out + "/words", "w").write(" ".join(sys.argv[1:]))
open(out + "/report.json", "w").write(json.dumps({"verdict": "consistent", "effects": [], "ranking": [], "noise_floor_m": 1e-4,
                                                  "baseline": errors, "extended": errors}))
"""


class Course(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        for name, text in (("prove", PROVE), ("softarm", SOFTARM)):
            path = os.path.join(self.folder, name)
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
            os.chmod(path, 0o755)

    def path(self, *parts):
        return os.path.join(self.folder, *parts)

    def prove(self, *more):
        return subprocess.run([sys.executable, os.path.join(ROOT, "scripts/prove_cases.py"), "--root", ROOT, "--work", self.folder,
                               "--programs", self.folder, "--seed", "7", "--out", self.path("out"), "--no-baselines", *more],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8", check=False)

    def test_from_draw_to_score(self):
        done = self.prove("--campaign", "some", "--json", self.path("figures.json"))
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.path("figures.json"), encoding="utf-8") as text:
            figures = json.load(text)
        self.assertEqual((figures["campaign"], figures["draws"], figures["not_drawn"]), ("some", 3, 1))
        self.assertEqual(figures["worlds"]["tidy"]["none"]["false_alarm"], 0.0)
        with open(self.path("out/proof.md"), encoding="utf-8") as text:
            story = text.read()
        with open(self.path("out/proof_trials.md"), encoding="utf-8") as text:
            self.assertIn("12 draws do not do, the last: it flies away", text.read())
        for page in ("(proof_trials.md)", "(proof_misses.md)"):
            self.assertIn(page, story)
        self.assertIn("12 draws were rejected before the seal (not told, 11 times; it flies away, once). 1 case could not be drawn. 0 diagnoses failed.", story)
        self.assertEqual(figures["rejected_draws"], 12)
        failed, = (name for name in os.listdir(self.path("out/truth")) if name.endswith(".failed"))
        with open(self.path("out/truth", failed), encoding="utf-8") as text:
            self.assertEqual(text.read().splitlines()[:-1], ["not told"] * 11 + ["it flies away"])
        with open(self.path("out/truth/SHA256SUMS"), encoding="utf-8") as text:
            self.assertIn(failed, text.read())
        words = [self.path("out/reports", case, "words") for case in os.listdir(self.path("out/reports"))]
        self.assertEqual(len(words), 2)
        for path in words:
            with open(path, encoding="utf-8") as text:
                self.assertRegex(text.read(), r"^diagnose --arm some_arm .*/a\.bag --out \S+ --tie x --jobs 1$")

    def test_goes_on_and_holds_to_the_seal(self):
        self.assertEqual(self.prove("--campaign", "some").returncode, 0)
        again = self.prove("--campaign", "some")
        self.assertEqual(again.returncode, 0)
        self.assertNotIn("diagnosing", again.stderr)
        other = self.prove("--campaign", "some", "--kinds", "none")
        self.assertIn("holds another proof", other.stderr)
        case = next(name for name in sorted(os.listdir(self.path("out/cases"))))
        with open(self.path("out/truth", case, "case.json"), "a", encoding="utf-8") as text:
            text.write(" ")
        changed = self.prove("--campaign", "some")
        self.assertNotEqual(changed.returncode, 0)
        self.assertIn("is not what was sealed", changed.stderr)

    def test_a_record_goes_on_elsewhere(self):
        record, figures = self.path("record.tar.xz"), self.path("figures.json")
        whole = self.prove("--campaign", "some", "--record", record, "--json", figures)
        self.assertEqual(whole.returncode, 0, whole.stderr)
        decided = sorted(os.listdir(self.path("out/reports")))
        prove_record.write(self.path("out"), decided[:1], record)  # as if it had been interrupted before the second
        with open(figures, encoding="utf-8") as text:
            first = json.load(text)
        with open(self.path("out/seal.json"), encoding="utf-8") as text:
            seal = json.load(text)["truth_sha256"]
        os.rename(self.path("out"), self.path("lost"))
        part = self.prove("--campaign", "some", "--record", record, "--so-far", "--json", self.path("part.json"))
        self.assertEqual(part.returncode, 0, part.stderr)
        self.assertNotIn("diagnosing", part.stderr)
        with open(self.path("part.json"), encoding="utf-8") as text:
            so_far = json.load(text)
        self.assertEqual((so_far["none"]["trials"], so_far["draws"], so_far["so_far"], so_far["full"]), (1, 2, 3, False))
        with open(self.path("out/proof.md"), encoding="utf-8") as text:
            self.assertIn("the 2 cases that were decided so far, in random order, out of 3", text.read())
        rest = subprocess.run([sys.executable, os.path.join(ROOT, "scripts/prove_cases.py"), "--root", ROOT, "--work", self.folder,
                               "--programs", self.folder, "--out", self.path("out"), "--no-baselines", "--campaign", "some",
                               "--record", record, "--json", figures],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8", check=False)  # the seed is in the record
        self.assertEqual(rest.returncode, 0, rest.stderr)
        self.assertNotIn("drawing", rest.stderr)
        self.assertIn(f"diagnosing {decided[1]} (1 of 1", rest.stderr)
        self.assertIn(seal, rest.stdout)
        with open(self.path("out/cases", decided[1], "a.bag"), encoding="utf-8") as text:
            self.assertEqual(text.read(), "drawn again")
        self.assertFalse(os.path.exists(self.path("out/cases", decided[0])))
        with open(figures, encoding="utf-8") as text:
            again = json.load(text)
        timed = ("seconds_median", "seconds_most", "core_seconds_median", "core_seconds_most", "memory_bytes_most")
        self.assertEqual({key: value for key, value in again.items() if key not in timed},
                         {key: value for key, value in first.items() if key not in timed})
        # It holds to its seal: nothing is missing, nothing is another.
        moves = self.path("out/truth", decided[0], "displacement.json")
        os.rename(moves, self.path("moves"))
        self.assertIn("is not what was sealed", self.prove("--campaign", "some").stderr)
        os.rename(self.path("moves"), moves)
        self.assertEqual(self.prove("--campaign", "some").returncode, 0)
        with open(self.path("out/truth", decided[0], "case.json"), "a", encoding="utf-8") as text:
            text.write(" ")
        self.assertIn("is not what was sealed", self.prove("--campaign", "some").stderr)

    def test_a_record_is_one_or_is_refused(self):
        record = self.path("record.tar.xz")
        self.assertEqual(self.prove("--campaign", "some", "--record", record).returncode, 0)
        whole = prove_record.read(record)
        shutil.rmtree(self.path("out"))
        self.assertIn("of other worlds, kinds or numbers", self.prove("--campaign", "some", "--kinds", "none", "--record", record).stderr)
        shutil.rmtree(self.path("out"))
        for data, words in ((b"nothing", ()), (b"", ()), (whole[:len(whole) // 2], ()), (whole[:len(whole) // 2], ("--seed", "7"))):
            with open(record, "wb") as file:
                file.write(data)
            refused = subprocess.run([sys.executable, os.path.join(ROOT, "scripts/prove_cases.py"), "--root", ROOT, "--work", self.folder,
                                      "--programs", self.folder, "--campaign", "some", "--record", self.path("record.tar.xz"), *words],
                                     stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8", check=False)
            self.assertNotEqual(refused.returncode, 0)
            self.assertIn("not the record of a proof", refused.stderr.splitlines()[-1])
            self.assertFalse(os.path.exists(self.path("out")))

    def test_a_diagnosis_that_was_interrupted_is_made_again(self):
        self.assertEqual(self.prove("--campaign", "some").returncode, 0)
        case = sorted(os.listdir(self.path("out/reports")))[0]
        os.remove(self.path("out/reports", case, "cost.json"))
        os.remove(self.path("out/reports", case, "words"))
        self.assertIn(f"diagnosing {case} (1 of 1", self.prove("--campaign", "some").stderr)
        self.assertTrue(os.path.exists(self.path("out/reports", case, "words")))

    def test_a_report_is_kept_as_far_as_it_is_scored(self):
        named = {"name": "creep", "probability": 0.9, "words": "long", "parameters": {"share": {"value": 1, "low": 0, "high": 2}}}
        error = {"held_out_rms_m": 1e-3, "trials": [1]}
        kept = prove_record.of_report({"verdict": "explained", "noise_floor_m": 1e-4, "effects": [named], "baseline": error, "page": "x",
                                       "discovered_law": {"share": 0.7, "share_of_flexible": 0.9, "sentence": "long"},
                                       "extended": error, "ranking": [{"name": "creep", "finding": "named", "curve": [1]}]})
        del named["words"]
        self.assertEqual(kept, {"verdict": "explained", "noise_floor_m": 1e-4, "effects": [named], "baseline": {"held_out_rms_m": 1e-3},
                                "discovered_law": {"share": 0.7, "share_of_flexible": 0.9}, "extended": {"held_out_rms_m": 1e-3}, "ranking": [{"name": "creep", "finding": "named"}]})

    def test_so_far_there_is_nothing_before_the_seal(self):
        nothing = self.prove("--campaign", "some", "--so-far")
        self.assertEqual(nothing.returncode, 1)
        self.assertIn("not all cases are drawn and sealed yet", nothing.stderr)

    def test_words_that_mean_nothing_are_refused(self):
        for words, named in ((("--worlds", "tidy,flat"), "flat"), (("--campaign", "some", "--kinds", "odd"), "odd"),
                             (("--worlds", "tidy", "--jobs", "-1"), "--jobs must be 1 or more")):
            refused = self.prove(*words)
            self.assertNotEqual(refused.returncode, 0)
            self.assertIn(named, refused.stderr)
        self.assertEqual(self.prove("--worlds", "tidy", "--kinds", "none", "--cases", "0").returncode, 0)

    def test_a_whole_without_its_cases_does_not_pass(self):
        whole = self.prove("--worlds", "tidy", "--kinds", "none", "--cases", "0", "--full")
        self.assertEqual(whole.returncode, 1)
        self.assertIn("a target is not met", whole.stderr)
        self.assertRegex(whole.stdout, r"single_strong: top1 +0 +- +>= 0.85 +NOT MET")


class Again(unittest.TestCase):
    @unittest.skipUnless(os.path.exists(os.path.join(PROGRAMS, "prove")), "prove is not built")
    def test_trials_are_made_again_by_their_truth_bit_for_bit(self):
        with tempfile.TemporaryDirectory(dir=BUILD, prefix="prove_again_") as folder:
            options = argparse.Namespace(programs=PROGRAMS, seed=3, full=False, cases=None, threads=2)
            source = prove_rig.Source(options, "proof_final")
            case, again, truth = (os.path.join(folder, name) for name in ("case", "again", "truth"))
            source.draw("none", 0, case, truth)
            self.assertTrue(prove_files.read_json(os.path.join(truth, "case.json"))["distractors"])  # there is something to make again
            sealed = prove_record.sums(truth)
            source.again("none", 0, again, truth)
            self.assertEqual(prove_record.sums(again), prove_record.sums(case))
            self.assertIn("trial_09.bag", prove_record.sums(again))
            self.assertEqual(prove_record.sums(truth), sealed)
            os.remove(os.path.join(truth, "case.json"))
            with self.assertRaisesRegex(SystemExit, "case.json: cannot be read"):
                source.again("none", 0, again, truth)


class Together(unittest.TestCase):
    def test_as_many_cases_at_once_as_are_allowed(self):
        met, done = threading.Barrier(2, timeout=30), []

        def meet(case):
            met.wait()
            done.append(case)

        prove_files.each("meeting", ["a", "b", "c", "d"], meet, 2)
        self.assertEqual(sorted(done), ["a", "b", "c", "d"])

    def test_after_one_that_fails_no_other_begins(self):
        begun = []

        def fail(case):
            begun.append(case)
            if len(begun) == 1:
                raise ValueError(case)
            time.sleep(0.05)

        with self.assertRaises(ValueError):
            prove_files.each("failing", [f"case_{i}" for i in range(100)], fail, 1)
        self.assertLess(len(begun), 100)

    def test_what_cases_share_is_made_once(self):
        made = []

        def share(_):
            with prove_files.alone(os.path.join(folder, "shared")):
                if not made:
                    time.sleep(0.1)
                    made.append("once")

        with tempfile.TemporaryDirectory() as folder:
            prove_files.each("sharing", range(4), share, 4)
        self.assertEqual(made, ["once"])


class Rejected(unittest.TestCase):
    def test_every_draw_of_the_rig_counts(self):
        last = "prove: some, kind pair, case 3: 3 draws do not do, the last: c"
        self.assertEqual(prove_rig.rejected_of([last]), ["not told", "not told", "c"])
        self.assertEqual(prove_rig.rejected_of(["a", "b", "c", last]), ["a", "b", "c"])
        for lines in (["prove: no such campaign"], []):  # not a draw
            self.assertEqual(prove_rig.rejected_of(lines), [])


class Engine(unittest.TestCase):
    def test_what_is_not_committed_marks_the_engine(self):
        with tempfile.TemporaryDirectory() as root:
            def git(*words):
                subprocess.run(["git", "-C", root, "-c", "user.name=a", "-c", "user.email=a@b", *words], check=True,
                               stdout=subprocess.DEVNULL)

            git("init", "-q")
            folders = ("src", "include", "config", "scripts", "doc")
            for folder in folders:
                os.mkdir(os.path.join(root, folder))
                with open(os.path.join(root, folder, "file"), "w", encoding="utf-8") as text:
                    text.write("as committed")
            git("add", ".")
            git("commit", "-q", "-m", "all")
            plain = prove_cases.engine(root)
            self.assertRegex(plain, "^[0-9a-f]{40}$")
            for folder in folders:
                with open(os.path.join(root, folder, "file"), "w", encoding="utf-8") as text:
                    text.write("changed")
                self.assertEqual(prove_cases.engine(root), plain + ("" if folder == "doc" else " with changes"), folder)
                git("checkout", "-q", ".")

    def test_who_diagnosed_is_told_also_where_another_engine_sealed(self):
        def by(engine):
            return {"report": {"verdict": "unknown"}, "cost": {"seconds": 1, "engine": engine}}

        left_no_word, failed = {"report": {"verdict": "unknown"}, "cost": {"seconds": 1}}, {"report": None, "cost": None}
        self.assertEqual(prove_cases.engines_of([], "sealed"), "sealed")
        self.assertEqual(prove_cases.engines_of([failed, left_no_word], "sealed"), "sealed")
        self.assertEqual(prove_cases.engines_of([by("b"), failed, by("a"), by("b")], "sealed"), "b, a")
        self.assertEqual(prove_cases.engines_of([by("b"), left_no_word], "sealed"), "b, sealed")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
