# SPDX-License-Identifier: Apache-2.0
"""One case of a cohort: registers, evaluates where the truth is known, and keeps what came of it."""
import ctypes
import json
import os
import pathlib
import re
import resource
import shlex
import signal
import subprocess
import time


def end_with_parent():
    """A job that is killed takes the program along, which would stand in the way of the next try."""
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG


def call(log, *words):
    """Exit status, output and the last line of errors."""
    child = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=end_with_parent)
    output, errors = child.communicate()
    log.write(f"$ {shlex.join(words)}\n{output}{errors}")
    lines = [line for line in errors.splitlines() if line.startswith("mammoray: ")]
    return child.returncode, output, lines[-1].removeprefix("mammoray: ") if lines else ""


def figures(result):
    """Level by view, the seconds of the search, and what readers noted of the files."""
    told = json.loads((result / "result.json").read_text())
    if told["format"] == "mammoray-joint-registration-result":
        _, _, notes = figures(result / told["mammograms"][0]["folder"])
        return {m["view"]: m["trust"] for m in told["mammograms"]}, told["seconds"], notes
    return {told["mammogram"]["view"]: told["trust"]["level"]}, told["seconds"], told.get("notes", [])


def errors_of(text):
    """Median and 95 % in 3D by view, mm, of the points that the mammogram shows."""
    return {view: [float(median), float(most)] for view, median, most in re.findall(
        r"^(\w+)\s+imaged\s+\d+\s+([\d.]+)\s+([\d.]+)", text, re.MULTILINE)}


def run(program, name, row, base, record):
    """Raises where another try may help: the program was killed, or there was no memory."""
    result = pathlib.Path("results") / name
    pathlib.Path("results").mkdir(exist_ok=True)
    begin = time.time()
    kept = {"case": name, "study": row["study"], "side": row["side"], "state": "done", "why": "", "trust": {}, "errorMm": {}, "notes": []}
    with open(f"logs/{name}.log", "a") as log:
        if not (result / "result.json").exists():
            words = [program, "register", "--study", str(base / row["study"]), "--side", row["side"], "--output", str(result)]
            status, _, why = call(log, *words, *shlex.split(row.get("options") or ""))
            if status not in (0, 1) or "memory" in why:
                raise RuntimeError(f"{name}: exit status {status}, see logs/{name}.log")
            if status == 1:
                kept.update(state="refused", why=why)
        if kept["state"] == "done":
            kept["trust"], kept["searchSeconds"], kept["notes"] = figures(result)
            if row.get("truth"):
                status, output, why = call(log, program, "evaluate", "--truth", str(base / row["truth"]), "--result", str(result))
                if status != 0:
                    raise RuntimeError(f"{name}: evaluate: {why}")
                kept["errorMm"] = errors_of(output)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    kept.update(seconds=round(time.time() - begin, 1), cpuSeconds=round(used.ru_utime + used.ru_stime, 1),
                memoryMiB=used.ru_maxrss // 1024)
    aside = f"{record}.partial"
    with open(aside, "w") as file:
        json.dump(kept, file, indent=1)
    os.replace(aside, record)
