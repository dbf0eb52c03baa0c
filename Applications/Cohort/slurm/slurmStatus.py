#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the state of a Slurm job for Snakemake: running, success or failed. Needs no accounting database."""
import re
import subprocess
import sys

job = sys.argv[1]
told = subprocess.run(["scontrol", "--oneliner", "show", "job", job], capture_output=True, text=True, check=False)
found = re.search(r"JobState=(\w+)", told.stdout)
if found:
    state = found.group(1)
elif "Invalid job id" in told.stderr:
    # Forgotten after MinJobAge: the accounting knows, where there is one.
    asked = subprocess.run(["sacct", "-X", "-n", "-P", "-o", "State", "-j", job], capture_output=True, text=True, check=False)
    state = asked.stdout.split()[0] if asked.stdout.split() else "COMPLETED"  # its output tells whether it was
else:
    state = "PENDING"  # the controller is busy
if state == "COMPLETED":
    print("success")
elif state in ("PENDING", "CONFIGURING", "RUNNING", "COMPLETING", "SUSPENDED", "REQUEUED", "REQUEUE_HOLD", "RESIZING", "STAGE_OUT"):
    print("running")
else:
    print("failed")
