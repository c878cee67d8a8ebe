#!/usr/bin/python3
"""`softarm batch --engine slurm` on a Slurm of its own: the table of the engine local, also when nodes are drained and
resumed midway; jobs that Slurm ends; who watches may die or be interrupted. Arguments: source, build."""
import csv
import glob
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import slurm_cluster

source, build = (os.path.abspath(a) for a in sys.argv[1:3])
PROGRAM = os.path.join(build, "devel", "lib", "softarm_estimator", "softarm")
if not os.path.exists(PROGRAM):
    print("no program softarm in this build")
    sys.exit(77)
TRIALS = 6


class Slurm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="softarm_slurm_")  # short: sockets have short names
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        try:
            cls.cluster = slurm_cluster.Cluster(os.path.join(cls.folder, "slurm"))
        except slurm_cluster.NoSlurm as why:
            print(f"skipped: {why}")
            sys.stdout.flush()
            shutil.rmtree(cls.folder, ignore_errors=True)
            os._exit(77)
        cls.addClassCleanup(cls.cluster.end)
        cls.trials = os.path.join(cls.folder, "trials")
        os.mkdir(cls.trials)
        for i in range(TRIALS):
            subprocess.run([PROGRAM, "simulate", "trial_10s", "--seconds", "6", "--seed", str(i + 1), "--out",
                            os.path.join(cls.trials, f"t{i}.bag")], check=True, stdout=subprocess.DEVNULL,
                           stderr=subprocess.DEVNULL)
        with open(os.path.join(cls.trials, "broken.bag"), "wb") as file:
            file.write(b"#ROSBAG V2.0\nand no more")

    def setUp(self):
        self.out = tempfile.mkdtemp(dir=self.folder, prefix="out_")

    def words(self, engine, *more):
        return [PROGRAM, "batch", "--engine", engine, "estimate", "--arm", "online_200mm", self.trials, "--out", self.out,
                *more]

    def start(self, engine, *more):
        return subprocess.Popen(self.words(engine, *more), env=self.cluster.environment, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8")

    def run_to_end(self, engine, *more):
        process = self.start(engine, *more)
        said, _ = process.communicate(timeout=240)
        return process.returncode, said

    def table(self):
        with open(os.path.join(self.out, "batch.csv"), "rb") as file:
            return file.read()

    def rows(self):
        with open(os.path.join(self.out, "batch.csv"), encoding="utf-8", newline="") as file:
            return {row["job"]: row for row in csv.DictReader(file)}

    def outcomes(self):
        return glob.glob(os.path.join(self.out, "jobs/*/outcome.json"))

    def until(self, what, condition, seconds=120.0):
        end = time.monotonic() + seconds
        while not condition():
            self.assertLess(time.monotonic(), end, what)
            time.sleep(0.05)

    def test_the_table_of_local_though_nodes_are_drained_midway(self):
        status, said = self.run_to_end("local")
        self.assertEqual(status, 1, said)  # the broken bag
        local = self.table()
        self.assertIn("EI_where_identifiable_nm2", local.decode())
        self.setUp()
        process = self.start("slurm")
        self.until("no job has ended", self.outcomes)
        for node in ("n1", "n2"):
            self.cluster.drain(node)
        self.until("the nodes are not drained", lambda: set(self.cluster.states().values()) == {"drained"})
        ended = len(self.outcomes())
        self.assertLess(ended, TRIALS + 1, "all was done before the nodes were drained: nothing is tested")
        time.sleep(2.0)
        self.assertEqual(len(self.outcomes()), ended)
        self.assertIsNone(process.poll())
        for node in ("n1", "n2"):
            self.cluster.resume(node)
        said, _ = process.communicate(timeout=240)
        self.assertEqual(process.returncode, 1, said)
        self.assertEqual(self.table(), local, said)
        self.assertIn("failed trials_broken: ", said)
        status, said = self.run_to_end("slurm")  # nothing is left to be done
        self.assertIn("0 to do, 6 done before, 1 failed before", said)
        self.assertEqual(self.table(), local)

    def test_who_watches_may_die(self):
        for node in ("n1", "n2"):
            self.cluster.drain(node)
        self.addCleanup(lambda: [self.cluster.resume(node) for node in ("n1", "n2")])
        process = self.start("slurm")
        self.until("nothing was submitted", lambda: len(self.cluster.queue()) == TRIALS + 1)
        process.kill()
        process.communicate()
        status, said = self.run_to_end("local")
        self.assertEqual(status, 1)
        self.assertIn("7 of its jobs are still in Slurm's queue", said)
        again = self.start("slurm")
        time.sleep(1.0)
        self.assertEqual(len(self.cluster.queue()), TRIALS + 1)  # taken over, not submitted again
        for node in ("n1", "n2"):
            self.cluster.resume(node)
        said, _ = again.communicate(timeout=240)
        self.assertIn("7 jobs of an earlier run are still in Slurm's queue", said)
        self.assertIn("7 jobs: 6 done, 1 failed", said)

    def test_an_interrupt_takes_the_jobs_back(self):
        for node in ("n1", "n2"):
            self.cluster.drain(node)
        self.addCleanup(lambda: [self.cluster.resume(node) for node in ("n1", "n2")])
        process = self.start("slurm")
        self.until("nothing was submitted", lambda: len(self.cluster.queue()) == TRIALS + 1)
        process.send_signal(signal.SIGINT)
        said, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, said)
        self.until("jobs stay in the queue", lambda: not self.cluster.queue())
        for node in ("n1", "n2"):
            self.cluster.resume(node)
        _, said = self.run_to_end("slurm", "--jobs", "1")
        self.assertIn("7 jobs: 6 done, 1 failed", said)

    def test_what_slurm_ends_is_a_failure_with_its_reason(self):
        for node in ("n1", "n2"):
            self.cluster.drain(node)
        process = self.start("slurm")
        self.until("nothing was submitted", lambda: len(self.cluster.queue()) == TRIALS + 1)
        array = self.cluster.queue()[0].split("_")[0]
        self.cluster.ask("scancel", f"{array}_2")
        for node in ("n1", "n2"):
            self.cluster.resume(node)
        said, _ = process.communicate(timeout=240)
        self.assertIn("7 jobs: 5 done, 2 failed", said)
        reasons = [row["reason"] for row in self.rows().values() if row["state"] == "failed"]
        self.assertIn("Slurm never started it: it was cancelled", reasons)
        _, said = self.run_to_end("slurm", "--retry-failed")
        self.assertIn("7 jobs: 6 done, 1 failed", said)

    def test_what_slurm_ends_while_it_runs(self):
        long = os.path.join(self.folder, "long.bag")
        subprocess.run([PROGRAM, "simulate", "trial_10s", "--seconds", "120", "--out", long], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        process = subprocess.Popen(
            [PROGRAM, "batch", "--engine", "slurm", "estimate", "--arm", "online_200mm", long, "--out", self.out],
            env=self.cluster.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8")
        self.until("it does not run", lambda: glob.glob(os.path.join(self.out, "jobs/*/log.txt")))
        self.cluster.ask("scancel", self.cluster.queue()[0].split("_")[0])
        said, _ = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 1, said)
        self.assertIn("Slurm: CANCELLED", said)

    def test_what_sbatch_refuses_is_one_line(self):
        status, said = self.run_to_end("slurm", "--slurm-options", "--partition=nowhere")
        self.assertEqual(status, 1, said)
        self.assertIn("softarm: --engine slurm: sbatch accepted no job: ", said)
        self.assertIn("nvalid partition", said)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
