#!/usr/bin/python3
"""Completion in bash and zsh, by typing and pressing Tab; what needs zsh is skipped by name where there is none."""
import os
import pty
import re
import select
import shutil
import subprocess
import tempfile
import time
import unittest

import tree

source, build = tree.directories()
FOLDER = os.path.join(build, "devel", "lib", "softarm_estimator")
PROGRAM = os.path.join(FOLDER, "softarm")
if not os.path.exists(PROGRAM):
    tree.lacks("no program softarm in this build")
NEEDS_ZSH = tree.skip_unless_there(shutil.which("zsh"), "no zsh (Debian package zsh)")


def script(shell):
    return subprocess.run([PROGRAM, "completion", shell], check=True, stdout=subprocess.PIPE, text=True).stdout


class Completion(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(dir=build, prefix="completion_check_")
        for name in ("my_trial.bag", "my_arm.yaml"):
            open(os.path.join(cls.folder, name), "w").close()
        cls.script = os.path.join(cls.folder, "completion.bash")
        with open(cls.script, "w", encoding="utf-8") as file:
            file.write(script("bash"))

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder, ignore_errors=True)

    def typed(self, line, first="", shell=("/bin/bash", "--norc", "--noprofile", "-i"), script=None):
        """The line after Tab, as the shell would run it: echo in the place of softarm prints its arguments."""
        pid, terminal = pty.fork()
        if pid == 0:
            os.chdir(self.folder)
            os.environ.update(TERM="dumb", PS1="> ", INPUTRC="/dev/null")
            os.execv(shell[0], shell)
        said = b""

        def until(mark, seconds=60.0):
            nonlocal said
            end = time.monotonic() + seconds
            while mark not in said and time.monotonic() < end:
                if select.select([terminal], [], [], 0.1)[0]:
                    said += os.read(terminal, 4096)

        os.write(terminal, f"{first}softarm() {{ echo \"<$*>\"; }}; . {script or self.script}; echo read''y\n".encode())
        until(b"ready\r\n")
        os.write(terminal, line.encode() + b"\t\n")
        until(b">\r\n")
        os.close(terminal)
        os.waitpid(pid, 0)
        found = re.findall(r"\n<(.*)>\r", said.decode(errors="replace"))
        return found[-1].strip() if found else said

    def test_commands_options_values_and_files(self):
        for line, whole in (("softarm estim", "estimate"), ("softarm estimate --arm onl", "estimate --arm online_200mm"),
                            ("softarm estimate --arm my_a", "estimate --arm my_arm.yaml"),
                            ("softarm estimate --prior of", "estimate --prior off"),
                            ("softarm estimate --prior=of", "estimate --prior=off"),
                            ("softarm estimate --arm=my_a", "estimate --arm=my_arm.yaml"), ("softarm estimate --prior=", "estimate --prior=o"),
                            ("softarm estimate --arm=my_arm.yaml my_t", "estimate --arm=my_arm.yaml my_trial.bag"),
                            ("softarm estimate my_t", "estimate my_trial.bag"),
                            ("softarm simulate --tru", "simulate --truth"),
                            ("softarm batch estim", "batch estimate"), ("softarm batch --eng", "batch --engine"),
                            ("softarm batch check my_t", "batch check my_trial.bag"),
                            ("softarm batch estimate --prior of", "batch estimate --prior off"), ("softarm simulate dem", "simulate demo"),
                            ("softarm completion z", "completion zsh")):
            self.assertEqual(self.typed(line), whole)

    def test_an_option_with_its_value_is_one_word_where_the_user_says_so(self):
        for line, whole in (("softarm estimate --prior=of", "estimate --prior=off"), ("softarm estimate --arm=my_a", "estimate --arm=my_arm.yaml")):
            self.assertEqual(self.typed(line, "COMP_WORDBREAKS=${COMP_WORDBREAKS//=}; "), whole)

    def test_what_zsh_is_told(self):
        text = script("zsh")
        self.assertIn("'*--arm=[", text)
        self.assertIn("'*--force[", text)
        self.assertIn(r'{_alternative "names\:name\:(cable_235mm', text)  # a bare colon would end the action

    @NEEDS_ZSH
    def test_values_in_zsh(self):
        path = os.path.join(self.folder, "_softarm")
        with open(path, "w", encoding="utf-8") as file:
            file.write(script("zsh"))
        for line, whole in (("softarm estim", "estimate"), ("softarm estimate --arm onl", "estimate --arm online_200mm"),
                            ("softarm estimate --arm=onl", "estimate --arm=online_200mm"), ("softarm estimate --prior=of", "estimate --prior=off"),
                            ("softarm estimate --arm=my_arm.yaml my_t", "estimate --arm=my_arm.yaml my_trial.bag")):
            self.assertEqual(self.typed(line, "autoload -Uz compinit; compinit -u -D; bindkey '^I' complete-word; ",
                                        (shutil.which("zsh"), "-f", "-i"), path), whole)

    def test_every_command_and_option_is_there(self):
        names = re.findall(r"^  ([a-z][a-z-]+) +[A-Z]", subprocess.run([PROGRAM, "--help"], stdout=subprocess.PIPE, text=True,
                                                                check=True).stdout, re.M)
        self.assertIn("diagnose", names)
        for text in (script("bash"), script("zsh")):
            for name in names:
                self.assertIn(f"{name})", text)
                usage = subprocess.run([PROGRAM, name, "--help"], stdout=subprocess.PIPE, text=True, check=True).stdout
                for option in re.findall(r"^  (?:-\w,)?(--[a-z-]+)", usage, re.M):
                    self.assertIn(option, text)

    def read_by(self, shell):
        done = subprocess.run([shell, "-n"], input=script(shell), text=True, stderr=subprocess.PIPE, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_bash_can_read_it(self):
        self.read_by("bash")

    @NEEDS_ZSH
    def test_zsh_can_read_it(self):
        self.read_by("zsh")


if __name__ == "__main__":
    unittest.main(argv=[__file__], verbosity=2)
