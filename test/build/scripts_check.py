#!/usr/bin/python3
"""What scripts/lib.sh takes for up to date, on a small project: quiet and without the lock where nothing changed, and a
build after every kind of change. How scripts/demo ends, on a graph of stand-ins."""
import fcntl
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import tree

source, build = tree.directories()
CMAKE = """cmake_minimum_required(VERSION 3.16)
project(small NONE)
option(EXTRA "" OFF)
add_custom_command(OUTPUT program DEPENDS src/a.txt
  COMMAND ${CMAKE_COMMAND} -E copy ${CMAKE_SOURCE_DIR}/src/a.txt program)
add_custom_target(programs DEPENDS program)
add_custom_command(OUTPUT tests DEPENDS test/t.txt
  COMMAND ${CMAKE_COMMAND} -E copy ${CMAKE_SOURCE_DIR}/test/t.txt tests)
add_custom_target(both ALL DEPENDS program tests)
install(FILES ${CMAKE_BINARY_DIR}/program DESTINATION bin)
"""


class UpToDate(unittest.TestCase):
    def setUp(self):
        self.root = tempfile.mkdtemp(dir=build, prefix="scripts_check_")
        self.addCleanup(shutil.rmtree, self.root)
        for name in "cmake config include launch msg python rviz src srv third_party bench test scripts".split():
            os.mkdir(os.path.join(self.root, name))
        shutil.copy(os.path.join(source, "scripts/lib.sh"), os.path.join(self.root, "scripts"))
        self.write("CMakeLists.txt", CMAKE)
        for name in ("package.xml", "src/a.txt", "src/b.txt", "test/t.txt"):
            self.write(name, "first")
        for target in ("programs", "all"):
            self.call(target)
        self.age()

    def path(self, name):
        return os.path.join(self.root, name)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)

    def age(self):
        """Makes everything as old as if the builds had been a while ago: stamps bear a time two seconds before theirs."""
        past = time.time() - 60.0
        for name in ("CMakeLists.txt", "package.xml", *"cmake config include launch msg python rviz src srv third_party bench test".split()):
            for folder, _, files in os.walk(self.path(name)):
                for path in (folder, *(os.path.join(folder, file) for file in files)):
                    os.utime(path, (past, past))
            os.utime(self.path(name), (past, past))

    def call(self, target, *arguments):
        """Runs build() of lib.sh; returns what it printed and whether it got as far as the lock."""
        log = self.path("build/build.log")
        if os.path.exists(log):
            os.remove(log)
        done = subprocess.run(["bash", "-c", 'source "$0/scripts/lib.sh"; build "$@"', self.root, target, *arguments],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8", check=False,
                              env={**os.environ, "SOFTARM_BUILD_DIR": self.path("build")}, timeout=120)
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout, os.path.exists(log)

    def assert_builds(self, target, *arguments):
        self.assertTrue(self.call(target, *arguments)[1], "taken for up to date")

    def assert_up_to_date(self, target, *arguments):
        printed, built = self.call(target, *arguments)
        self.assertEqual((printed, built), ("", False))

    def test_nothing_changed(self):
        self.assert_up_to_date("programs")
        self.assert_up_to_date("all")
        # Somebody builds something else meanwhile and has the lock.
        with open(self.path("build/.lock"), "w", encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            self.assert_up_to_date("programs")

    def test_a_source_changed(self):
        time.sleep(1.1)  # what is younger by less than a second is not installed again by CMake
        self.write("src/a.txt", "second")
        self.assert_builds("programs")
        with open(self.path("build/install/bin/program"), encoding="utf-8") as file:
            self.assertEqual(file.read(), "second")
        self.assert_builds("all")

    def test_a_file_came_or_went_or_was_renamed(self):
        self.write("src/c.txt", "")
        self.assert_builds("programs")
        self.age()
        self.assert_up_to_date("programs")
        os.remove(self.path("src/c.txt"))
        self.assert_builds("programs")
        self.age()
        os.rename(self.path("src/b.txt"), self.path("src/d.txt"))
        self.assert_builds("programs")

    def test_what_only_tests_need(self):
        self.write("test/t.txt", "second")
        self.assert_up_to_date("programs")
        self.assert_builds("all")

    def test_configuration(self):
        self.assert_builds("programs", "-DEXTRA=ON")
        self.assert_up_to_date("programs", "-DEXTRA=ON")
        self.assert_up_to_date("programs")
        self.assert_builds("all")
        subprocess.run(["cmake", "-DEXTRA=OFF", self.path("build")], stdout=subprocess.DEVNULL, check=True)
        self.assert_builds("programs")

    def test_what_was_installed_is_gone(self):
        os.remove(self.path("build/install/bin/program"))
        self.assert_builds("programs")
        self.assertTrue(os.path.exists(self.path("build/install/bin/program")))

    def test_a_build_that_failed_leaves_no_stamp(self):
        os.remove(self.path("src/a.txt"))
        with self.assertRaises(AssertionError):
            self.call("programs")
        with self.assertRaises(AssertionError):
            self.call("programs")

TICK_S = 0.1
# Of a graph that works; each test replaces what fails in its case. What shows the table ticks while it is kept waiting: a clock that a
# busy machine slows as it does the demo. DIES notes its time.
DIES = 'cp "${0%/*}/ticks" "${0%/*}/died" 2>/dev/null; '
STAND_INS = {"roscore": "exec sleep 60", "rosparam": "exit 0", "roslaunch": "exec sleep 60",
             "rosrun": "trap 'echo the table; exit 0' INT\n"
                       f"for i in $(seq 600); do echo >>\"${{0%/*}}/ticks\"; sleep {TICK_S}; done"}


class Demo(unittest.TestCase):
    def run_demo(self, *arguments, interrupt_after=None, cwd=None, **stand_ins):
        """(exit status, what it said, seconds that it waited for its end after a death) of scripts/demo."""
        root = tempfile.mkdtemp(dir=build, prefix="demo_check_")
        self.addCleanup(shutil.rmtree, root)
        for name in ("scripts", "bin", "build"):
            os.mkdir(os.path.join(root, name))
        shutil.copy(os.path.join(source, "scripts/demo"), os.path.join(root, "scripts"))
        with open(os.path.join(root, "scripts/lib.sh"), "w", encoding="utf-8") as file:
            file.write(f"source '{source}/scripts/lib.sh'\ninstall_packages() {{ :; }}\nbuild() {{ :; }}\n"
                       f"enter_install_space() {{ PATH='{root}/bin':$PATH; }}\n")
        for name, body in {**STAND_INS, **stand_ins}.items():
            path = os.path.join(root, "bin", name)
            with open(path, "w", encoding="utf-8") as file:
                file.write(f"#!/bin/bash\n{body}\n")
            os.chmod(path, 0o755)
        demo = subprocess.Popen([os.path.join(root, "scripts/demo"), "--headless", "--seconds", "30", *arguments],
                                encoding="utf-8", stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True,
                                cwd=cwd, env={**os.environ, "SOFTARM_BUILD_DIR": os.path.join(root, "build")})
        if interrupt_after:
            time.sleep(interrupt_after)
            os.killpg(demo.pid, signal.SIGINT)  # as a terminal does
        said, _ = demo.communicate(timeout=60)
        clocks = [os.path.join(root, "bin", name) for name in ("ticks", "died")]
        ticks, died = (os.path.getsize(clock) if os.path.exists(clock) else 0 for clock in clocks)
        return demo.returncode, said, TICK_S * (ticks - died)

    def assert_ends_at_once(self, reason, **stand_ins):
        status, said, seconds = self.run_demo(**stand_ins)
        self.assertEqual(status, 1, said)
        self.assertIn(reason, said)
        self.assertLessEqual(seconds, 1.0, said)  # usually 0.3; it would take half a minute

    def test_what_died_ends_it_within_a_second_with_the_reason(self):
        self.assert_ends_at_once("RLException: no such file", roslaunch="echo 'RLException: no such file'; exit 1")
        self.assert_ends_at_once("roslaunch ended", roslaunch="sleep 1; " + DIES)
        self.assert_ends_at_once("roscore ended", roscore="sleep 1; " + DIES)
        self.assert_ends_at_once("rosbag play ended", roslaunch="sleep 1; echo 'BagException: cut off'; " + DIES +
                                 "echo '[softarm_bag-2] process has died [pid 1, exit code 1]'; exec sleep 60")

    def test_a_path_that_roslaunch_would_not_take_is_one_line_before_anything_starts(self):
        folder = tempfile.mkdtemp(dir=build, prefix="demo_check_")
        self.addCleanup(shutil.rmtree, folder)
        for option, ending in (("--bag", ".bag"), ("--arm", ".yaml")):
            for name in ("a'b", "a$(touch came_about)b", "a`touch came_about`b", 'a"b', "a b", "a\\b"):
                path = os.path.join(folder, name + ending)
                open(path, "w", encoding="utf-8").close()
                status, said, _ = self.run_demo(option, path, roscore="touch started", rosrun="touch started", cwd=folder)
                self.assertEqual((status, said.count("\n")), (1, 1), said)
                self.assertIn(f"{option} {path}: roslaunch does not accept this path", said)
                self.assertFalse({"came_about", "started"} & set(os.listdir(folder)), said)

    def test_a_recording_that_is_over_is_no_death(self):
        status, said, _ = self.run_demo(roslaunch="echo '[softarm_bag-2] process has finished cleanly'; exec sleep 60",
                                        rosrun="sleep 1; echo the table")
        self.assertEqual(status, 0, said)
        self.assertIn("the table", said)

    def test_an_interrupt_ends_it_with_the_table(self):
        status, said, seconds = self.run_demo(interrupt_after=2.0)
        self.assertEqual(status, 130, said)
        self.assertIn("the table", said)
        self.assertTrue(0.0 < seconds < 6.0, seconds)

    def test_a_report_that_fails_is_a_failure(self):
        status, said, _ = self.run_demo(rosrun="exit 1")
        self.assertEqual(status, 1, said)
        self.assertIn("did not fully succeed", said)


class Test(unittest.TestCase):
    def test_an_unknown_sanitizer_is_refused(self):
        for arguments in (["--sanitize", "memory"], ["--sanitize=memory"], ["--sanitize"]):
            done = subprocess.run([os.path.join(source, "scripts/test"), *arguments], encoding="utf-8", check=False,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=60)
            self.assertEqual(done.returncode, 1)
            self.assertIn("must be address or thread", done.stdout)

    def test_an_unknown_release_is_refused(self):
        for arguments in (["--debian", "10"], ["--debian=sid"], ["--debian"]):
            done = subprocess.run([os.path.join(source, "scripts/test"), *arguments], encoding="utf-8", check=False,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=60)
            self.assertEqual(done.returncode, 1)
            self.assertIn("must be 11 or 13", done.stdout)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
