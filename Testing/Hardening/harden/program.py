# SPDX-License-Identifier: Apache-2.0
"""Runs the program and judges how it answered."""
import os
import re
import resource
import shutil
import signal
import subprocess
import tempfile

SILENT = re.compile(r"^ {2,}")  # the indented lines of the progress


# A registration in 20 s of a processor.
COARSELY = ("--label-spacing", "1.5", "--anatomy-cell-size", "8", "--simulation-cell-size", "16", "--pixel-sizes", "3")


class Answer:
    def __init__(self, status, out, err):
        self.status = status
        self.out = out
        self.err = err
        self.lines = [line for line in err.splitlines() if not SILENT.match(line)]

    def refused(self):
        """In one line of our own, of letters only."""
        return self.status == 1 and self.out == "" and len(self.lines) == 1 and \
            self.lines[0].startswith("mammoray: ") and self.lines[0].isprintable()

    def misused(self):
        """True if refused for wrong usage, with a second line that names the help."""
        return self.status == 2 and self.out == "" and len(self.lines) == 2 and self.lines[0].isprintable()

    def done(self):
        return self.status == 0 and all(line.startswith("mammoray: ") and line.isprintable()
                                        for line in self.lines)

    def told(self):
        how = "without end" if self.status in (None, -signal.SIGXCPU) else \
            "signal %d" % -self.status if self.status < 0 else "exit status %d" % self.status
        return "%s: %s" % (how, (self.err + self.out)[-300:].strip().replace("\n", " | "))


class Program:
    """`binaries`: the folder with mammoray and the test programs."""

    def __init__(self, binaries, data):
        self.binaries = os.path.abspath(binaries)
        self.data = os.path.abspath(data)
        self.mammoray = os.path.join(self.binaries, "mammoray")
        self.folder = tempfile.TemporaryDirectory(prefix="harden-")
        self.scratch = self.folder.name

    def path(self, *names):
        return os.path.join(self.scratch, *names)

    def phantom(self, name):
        return os.path.join(self.data, "victre-phantom-1", name)

    def run(self, *words, seconds=300, environment=None, shell=None, limits=None, program="mammoray"):
        """A program with these words; `shell`: a command line around {}, in place of running it directly. `seconds` of a
        processor, on the clock ten times as many: others may be at work here."""

        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (seconds, resource.RLIM_INFINITY))
            if limits:
                limits()

        words = [os.path.join(self.binaries, program), *map(str, words)]
        env = dict(os.environ, **(environment or {}))
        if shell:
            words = ["bash", "-c", shell.replace("{}", '"$@"'), "bash", *words]
        process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=env, cwd=self.scratch,
                                   start_new_session=True, preexec_fn=limit)
        try:
            out, err = process.communicate(timeout=10 * seconds)
            status = process.returncode
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            out, err = process.communicate()
            status = None
        return Answer(status, out.decode(errors="replace"), err.decode(errors="replace"))

    @staticmethod
    def remove(path):
        shutil.rmtree(path) if os.path.isdir(path) else os.remove(path)

    def start(self, *words):
        return subprocess.Popen([self.mammoray, *map(str, words)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                cwd=self.scratch, start_new_session=True)

    def register(self, output, *rest, **options):
        """To the shipped mammogram unless another is given."""
        options.setdefault("seconds", 900)
        words = list(rest)
        for option, value in (("--labels", self.phantom("labels.nrrd")), ("--materials", "victre"),
                              ("--mammogram", self.phantom("victre1_lcc_processing.dcm")), ("--orientation", "ALS")):
            if option not in words:
                words += [option, value]
        return self.run("register", *words, *COARSELY, "--iterations", 6, "--overwrite", "-o", output, **options)


class Count:
    """Counts the trials of one class, and those that were not survived."""

    def __init__(self, name):
        self.name = name
        self.tried = 0
        self.bad = []
        self.notes = []

    def add(self, good, what, answer=""):
        self.tried += 1
        if not good:
            self.bad.append("%s: %s" % (what, answer))

    def report(self):
        print("%-10s %6d tried, %d bad%s" % (self.name, self.tried, len(self.bad),
                                            "; " + "; ".join(self.notes) if self.notes else ""))
        for line in self.bad[:20]:
            print("    " + line)
