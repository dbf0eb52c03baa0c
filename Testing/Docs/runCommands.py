# SPDX-License-Identifier: Apache-2.0
"""Runs the commands that a page of the documentation shows: its blocks marked ```sh run, in their order.

runCommands.py PAGE.md BIN DATA: with BIN first on PATH, in an empty folder where Data is DATA. Blocks marked
```sh run display need an X server and get Xvfb. Exit 125: no Vulkan device, or no Xvfb for a block that needs it."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

page, programs, data = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
blocks = re.findall(r"^```sh run( display)?\n(.*?)^```$", page.read_text(), re.MULTILINE | re.DOTALL)
if not blocks:
    sys.exit(f"{page}: expected commands marked 'sh run', found none")
environment = dict(os.environ, PATH=f"{programs}:{os.environ['PATH']}")
devices = subprocess.run([programs / "mammoray", "devices"], capture_output=True, check=False)
if devices.returncode != 0:
    print("no Vulkan device")
    sys.exit(125)

with tempfile.TemporaryDirectory() as folder:
    (pathlib.Path(folder) / "Data").symlink_to(data)
    for display, commands in blocks:
        server = None
        if display:
            if not shutil.which("Xvfb"):
                print("no Xvfb")
                sys.exit(125)
            read, write = os.pipe()
            server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1400x1000x24"],
                                      pass_fds=(write,), stderr=subprocess.DEVNULL)
            os.close(write)
            environment["DISPLAY"] = ":" + os.read(read, 16).decode().strip()
        print(commands, flush=True)
        try:
            status = subprocess.run(["sh", "-e", "-c", commands], cwd=folder, env=environment, check=False).returncode
        finally:
            if server:
                server.terminate()
                server.wait()
        if status != 0:
            sys.exit(f"{page}: exit status {status} of\n{commands}")
