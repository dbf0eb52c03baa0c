# SPDX-License-Identifier: Apache-2.0
"""Runs what a page of the documentation shows, in its order, in an empty folder where Applications and Data are the project's.

runCommands.py PAGE.md BIN [RESULT]: with a copy of a registration there as demo-result; blocks marked
  ```sh run           commands, with BIN, this interpreter (python3) and mammoray-validate (MAMMORAY_VALIDATE), which is not installed, first on PATH
  ```sh run display   the same, with an X server (Xvfb)
  ```sh run archive   the same, while an empty archive is at 127.0.0.1:4242 (Orthanc); left out where there is none
  ```sh run long      the same, where MAMMORAY_LONG_TESTS is set
  ```python run       a program of this interpreter
  ```LANGUAGE of FILE an excerpt, whose lines must stand in FILE (from the project's root) in a row, indented or not; other tests run FILE
Exit 125: no Vulkan device, or no Xvfb for a block that needs it."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

page, programs, *results = (pathlib.Path(argument).resolve() for argument in sys.argv[1:])
root = pathlib.Path(__file__).resolve().parents[2]


def check_excerpt(text, path):
    def lines(of):
        return [line.strip().removeprefix("% ").strip() for line in of.splitlines() if line.strip()]
    wanted, there = lines(text), lines((root / path).read_text())
    if not any(there[at:at + len(wanted)] == wanted for at in range(len(there))):
        sys.exit(f"{page}: expected these lines in {path}:\n{text}")


def start_display():
    """An X server and its name."""
    if not shutil.which("Xvfb"):
        print("no Xvfb")
        sys.exit(125)
    read, write = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1400x1000x24"],
                              pass_fds=(write,), stderr=subprocess.DEVNULL)
    os.close(write)
    return server, ":" + os.read(read, 16).decode().strip()


def run(command, display, folder, environment):
    server = None
    if display:
        server, environment["DISPLAY"] = start_display()
    try:
        return subprocess.run(command, cwd=folder, env=environment, check=False).returncode
    finally:
        if server:
            server.terminate()
            server.wait()


blocks = re.findall(r"^```(\w+) (run|run display|run archive|run long|of (\S+))\n(.*?)^```$", page.read_text(), re.MULTILINE | re.DOTALL)
if not blocks:
    sys.exit(f"{page}: expected blocks marked 'run' or 'of', found none")
devices = subprocess.run([programs / "mammoray", "devices"], capture_output=True, check=False)
if devices.returncode != 0:
    print("no Vulkan device")
    sys.exit(125)

with tempfile.TemporaryDirectory() as name:
    own = pathlib.Path(name) / "bin"
    own.mkdir()
    (own / "python3").symlink_to(sys.executable)
    if "MAMMORAY_VALIDATE" in os.environ:
        (own / "mammoray-validate").symlink_to(os.environ["MAMMORAY_VALIDATE"])
    folder = pathlib.Path(name) / "work"
    folder.mkdir()
    for shipped in ("Applications", "Data"):
        (folder / shipped).symlink_to(root / shipped)
    for result in results:
        shutil.copytree(result, folder / "demo-result")
    skipped = 0
    environment = dict(os.environ, PATH=f"{programs}:{own}:{os.environ['PATH']}")
    for language, how, path, text in blocks:
        if path:
            check_excerpt(text, path)
            continue
        if how.endswith("long") and not os.environ.get("MAMMORAY_LONG_TESTS"):
            skipped += 1
            continue
        print(text, flush=True)
        command = ["sh", "-e", "-c", text] if language == "sh" else [sys.executable, "-c", text]
        if how.endswith("archive"):
            command = ["/usr/bin/python3", str(root / "Testing" / "Dicom" / "orthanc.py"), *command]
        status = run(command, how.endswith("display"), folder, environment)
        if how.endswith("archive") and status == 125:
            skipped += 1
            continue
        if status != 0:
            sys.exit(f"{page}: exit status {status} of\n{text}")
if skipped == len(blocks):
    sys.exit(125)
