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


def softarm(*arguments, status=0):
    """What the program prints. It must be there: results are held against it. ``status``: how it ends; None: anyhow."""
    return subprocess.run([PROGRAM, *arguments], check=status == 0, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                          cwd=FOLDER).stdout


@functools.lru_cache(maxsize=None)
def bag(scenario="trial_10s", seconds="4", name="trial", seed="3"):
    softarm("simulate", scenario, "--seconds", seconds, "--seed", seed, "--out", path(name + ".bag"))
    return path(name + ".bag")


@functools.lru_cache(maxsize=None)
def slipping_bag():
    """Twelve seconds, the third ring 4 mm aside from the eighth on: slip.bag and its truth, made from Python."""
    import softarm as module
    with open(os.path.join(SOURCE, "config", "scenarios", "trial_10s.yaml"), encoding="utf-8") as file:
        scenario = module._softarm.keys_of_yaml(file.read())
    scenario["hidden"] = [{"effect": "marker_slip", "body": 3, "sideways_m": 0.004, "from_s": 8.0}]
    scenario["payload"]["schedule"] = scenario["payload"]["schedule"][:1]
    return module.simulate(scenario, path("slip.bag"), seconds=12, seed=5)


def one_line(case, wrong, call, *words):
    """The exception of this kind with one line that has the words."""
    with case.assertRaises(wrong) as raised:
        call()
    text = str(raised.exception)
    case.assertNotIn("\n", text)
    case.assertTrue(text)
    for word in words:
        case.assertIn(word, text)


def skip(why):
    print(why)
    shutil.rmtree(FOLDER)
    sys.exit(SKIPPED)


def main():
    import unittest
    try:
        unittest.main(argv=sys.argv[:1])
    finally:
        shutil.rmtree(FOLDER)
