#!/usr/bin/python3
"""The proof with its cases as tasks of Slurm, on stand-ins of its programs: the figures of the engine local, also where who
watches died and where a case is lost."""
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import prove_sources_check as course
import slurm_cluster


class Slurm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="softarm_slurm_")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        try:
            cls.cluster = slurm_cluster.Cluster(os.path.join(cls.folder, "slurm"))
        except slurm_cluster.NoSlurm as why:
            print(f"skipped: {why}", flush=True)
            shutil.rmtree(cls.folder, ignore_errors=True)
            os._exit(77)
        cls.addClassCleanup(cls.cluster.end)

    def setUp(self):
        self.out = tempfile.mkdtemp(dir=self.folder)
        for name, text in (("prove", course.PROVE), ("softarm", course.SOFTARM)):
            self.program(name, text)

    def program(self, name, text):
        path = os.path.join(self.out, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        os.chmod(path, 0o755)

    def start(self, engine, *more):
        return subprocess.Popen(
            [sys.executable, os.path.join(course.ROOT, "scripts/prove_cases.py"), "--root", course.ROOT, "--work", self.out,
             "--programs", self.out, "--seed", "7", "--campaign", "some", "--no-baselines", "--out",
             os.path.join(self.out, engine), "--json", os.path.join(self.out, engine + ".json"), "--engine", engine, *more],
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8", env=self.cluster.environment)

    def finish(self, process):
        said, _ = process.communicate(timeout=120)
        return process.returncode, said

    def figures(self, engine):
        """All but what it cost."""
        def told(value):
            if isinstance(value, dict):
                return {key: told(one) for key, one in value.items() if "seconds" not in key and "memory" not in key}
            return [told(one) for one in value] if isinstance(value, list) else value

        with open(os.path.join(self.out, engine + ".json"), encoding="utf-8") as text:
            return told(json.load(text))

    def test_the_figures_of_local(self):
        status, said = self.finish(self.start("local"))
        self.assertEqual(status, 0, said)
        status, said = self.finish(self.start("slurm"))
        self.assertEqual(status, 0, said)
        self.assertIn("drawing: 3 cases are array ", said)
        self.assertIn("diagnosing: 2 cases are array ", said)
        self.assertEqual(self.figures("slurm"), self.figures("local"))
        status, said = self.finish(self.start("slurm"))
        self.assertNotIn("are array", said)

    def test_who_watches_may_die(self):
        for node in ("n1", "n2"):
            self.cluster.drain(node)
        process = self.start("slurm")
        end = time.monotonic() + 60.0
        while len(self.cluster.queue()) != 3:
            self.assertLess(time.monotonic(), end)
            time.sleep(0.1)
        process.send_signal(signal.SIGKILL)
        process.communicate()
        again = self.start("slurm")
        time.sleep(1.0)
        self.assertEqual(len(self.cluster.queue()), 3)
        for node in ("n1", "n2"):
            self.cluster.resume(node)
        status, said = self.finish(again)
        self.assertEqual(status, 0, said)
        self.assertIn("drawing: cases of an earlier run are still in Slurm's queue", said)

    def test_a_case_that_is_lost_is_said_and_done_again(self):
        self.program("softarm", "#!/bin/sh\nkill -9 $PPID\n")
        status, said = self.finish(self.start("slurm"))
        self.assertEqual(status, 1, said)
        self.assertIn("diagnosing: Slurm has ended 2 of 2 cases before they were done", said)
        self.program("softarm", course.SOFTARM)
        status, said = self.finish(self.start("slurm"))
        self.assertEqual(status, 0, said)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
