"""What the tests of the module share. They are run as `<test>.py SOURCE_DIR BUILD_DIR`, by Debian's python3."""
import functools
import os
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
SOURCE, BUILD = (os.path.realpath(path) for path in sys.argv[1:3])
DEVEL = os.path.join(BUILD, "devel")
PROGRAM = os.path.join(DEVEL, "lib", "softarm_estimator", "softarm")
sys.path.insert(0, os.path.join(DEVEL, "lib", "python3", "dist-packages"))
if not os.path.exists(os.path.join(sys.path[0], "softarm")):
    print("the module was not built: no pybind11 (Debian packages pybind11-dev python3-dev)")
    sys.exit(SKIPPED)

FOLDER = tempfile.mkdtemp(prefix="python_test_", dir=BUILD)


def path(name):
    return os.path.join(FOLDER, name)


def softarm(*arguments):
    """What the program prints. It must be there: results are held against it."""
    return subprocess.run([PROGRAM, *arguments], check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                          cwd=FOLDER).stdout


@functools.lru_cache(maxsize=None)
def bag(scenario="trial_10s", seconds="4", name="trial", seed="3"):
    softarm("simulate", scenario, "--seconds", seconds, "--seed", seed, "--out", path(name + ".bag"))
    return path(name + ".bag")


def one_line(case, wrong, call, *words):
    """The exception of this kind with one line that has the words."""
    with case.assertRaises(wrong) as raised:
        call()
    text = str(raised.exception)
    case.assertNotIn("\n", text)
    case.assertTrue(text)
    for word in words:
        case.assertIn(word, text)


def main():
    import unittest
    try:
        unittest.main(argv=sys.argv[:1])
    finally:
        shutil.rmtree(FOLDER)
