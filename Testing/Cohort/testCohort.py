#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A cohort with failures, by Snakemake, on this machine or on a Slurm of its own.

testCohort.py MAMMORAY local|slurm [CASES [SEEDS]]: CASES (6) cases of SEEDS (1) tiny virtual studies; of every ten, one's program is
killed at its first try, one's job is killed at its first try, and one is refused (no study there); so are they of fewer.
SEEDS 0: one study, which is registered once; each case takes a copy of that result (what many cases ask of the workflow, without
the hours of their registrations).
Exit 125: no Snakemake, no Slurm, no network of its own."""
import csv
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

program, mode = sys.argv[1:3]
count, seeds = (int(text) for text in (sys.argv[3:] + ["6", "1"][len(sys.argv) - 3:]))
cohort = pathlib.Path(__file__).resolve().parents[2] / "Applications" / "Cohort"
if not shutil.which("snakemake") or (mode == "slurm" and not (shutil.which("slurmctld") and shutil.which("slurmd"))):
    sys.exit(125)
# Slurm's daemons want to be root, a host whose name is known, and get a network that has the loopback address only.
if mode == "slurm" and "MAMMORAY_ALONE" not in os.environ:
    if subprocess.run(["unshare", "-nu", "ip", "link", "set", "lo", "up"], check=False, capture_output=True).returncode:
        sys.exit(125)
    os.environ["MAMMORAY_ALONE"] = "1"
    os.execvp("unshare", ["unshare", "-nu", "sh", "-c", 'hostname localhost; ip link set lo up; ip addr add 192.0.2.1/32 dev lo; exec "$@"', "sh", sys.executable, *sys.argv])

# These are as small as they can be, because nobody looks at their results.
STUDY = ("--mri-pixel 3 --mri-slice 4 --mammogram-pixel 0.3 --label-spacing 2 --anatomy-cell 14 --gravity-fineness 3 "
         "--compression-fineness 4").split()
OPTIONS = ("--anatomy-cell-size 14 --simulation-cell-size 25 --pixel-sizes 8 --free thickness --iterations 1 --chest-wall held "
           "--mri-position none")

# Between Snakemake and the program: kills, at the first try of a case, the program itself or the job around it.
SABOTEUR = """#!/bin/sh
case "$*" in
  register*killed-program*) if mkdir "{folder}/tried-program-$(echo "$*" | sed 's/.*results.//; s/ .*//')" 2>/dev/null; then kill -9 $$; fi ;;
  register*killed-job*) if mkdir "{folder}/tried-job-$(echo "$*" | sed 's/.*results.//; s/ .*//')" 2>/dev/null; then kill -9 $PPID; sleep 5; exit 1; fi ;;
esac
echo "$*" >> "{folder}/calls"
if [ "$1" = register ] && [ -d "{folder}/recorded" ] && [ -d "$3" ]; then
  cp -r "{folder}/recorded" "$7.partial" && mv "$7.partial" "$7"
  exit
fi
exec "{program}" "$@"
"""


def kind(number):
    return {1: "killed-program", 2: "killed-job", 3: "refused"}.get(number % 10, "plain")


def start_slurm(folder):
    import socket
    name = socket.gethostname().split(".")[0]
    cores = os.cpu_count()
    (folder / "slurm.conf").write_text(f"""ClusterName=test
SlurmctldHost={name}(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
CredType=cred/none
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
ReturnToService=2
NodeName={name} NodeAddr=127.0.0.1 CPUs={cores} RealMemory=8000 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
""")
    os.environ["SLURM_CONF"] = str(folder / "slurm.conf")
    (folder / "state").mkdir()
    (folder / "spool").mkdir()
    daemons = [subprocess.Popen(["slurmctld", "-D"]), subprocess.Popen(["slurmd", "-D", "-N", name])]
    for _ in range(120):
        told = subprocess.run(["sinfo", "-h", "-o", "%T"], capture_output=True, text=True, check=False).stdout
        if told.startswith("idle"):
            return daemons
        time.sleep(0.5)
    stop(daemons)
    sys.exit("Slurm does not begin: " + (folder / "slurmctld.log").read_text()[-2000:] + (folder / "slurmd.log").read_text()[-2000:])


def stop(daemons):
    for daemon in daemons:
        daemon.terminate()
        daemon.wait()


def expect(what, expected, found):
    if expected != found:
        sys.exit(f"{what}: expected {expected}, found {found}")


def run_cohort(folder):
    words = ["snakemake", "-s", str(cohort / "Snakefile"), "--config", "cases=cases.csv", f"mammoray={folder}/mammoray"]
    words += ["--profile", str(cohort / "slurm")] if mode == "slurm" else ["--cores", "2", "--keep-going", "--rerun-incomplete"]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    (folder / "snakemake.log").write_text(done.stdout + done.stderr)
    return done


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    recorded, seeds = seeds == 0, max(seeds, 1)
    for seed in range(1, seeds + 1):
        subprocess.run([program + "-validate", "study", *STUDY, "--seed", str(seed), "-o", folder / f"study-{seed}"], check=True,
                       stdout=subprocess.DEVNULL)
    if recorded:
        subprocess.run([program, "register", "--study", folder / "study-1" / "export", "--side", "left", "--output", folder / "recorded",
                        *OPTIONS.split()], check=True, stdout=subprocess.DEVNULL)
    (folder / "mammoray").write_text(SABOTEUR.format(folder=folder, program=program))
    (folder / "mammoray").chmod(0o755)
    with (folder / "cases.csv").open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["case", "study", "side", "options", "truth"])
        for number in range(count):
            seed = 1 + number % seeds
            there = kind(number) != "refused"
            table.writerow([f"{kind(number)}-{number}", f"study-{seed}/export" if there else "nowhere", "left", OPTIONS,
                            f"study-{seed}/truth.json"])
    daemons = start_slurm(folder) if mode == "slurm" else []
    try:
        begin = time.time()
        done = run_cohort(folder)
        seconds = time.time() - begin
        if done.returncode and mode == "local":
            done = run_cohort(folder)  # a job of this machine that is killed takes its Snakemake along: called again, it goes on
        if done.returncode:
            sys.exit(done.stdout + done.stderr)
        calls = (folder / "calls").read_text().splitlines()
        again = run_cohort(folder)
        expect("called again, nothing is done", calls, (folder / "calls").read_text().splitlines())
        expect("and it says so", True, "Nothing to be done" in again.stdout + again.stderr)
    finally:
        stop(daemons)
    for number in range(count):
        case = f"{kind(number)}-{number}"
        record = json.loads((folder / "cases" / f"{case}.json").read_text())
        expect(f"{case} is", "refused" if kind(number) == "refused" else "done", record["state"])
        finished = sum(1 for call in calls if call.startswith("register") and f"results/{case} " in call + " ")
        expect(f"{case} was registered so many times", 1, finished)
        if record["state"] == "done":
            expect(f"{case} has views", {"CC", "MLO"}, set(record["trust"]))
            expect(f"{case} has errors", {"CC", "MLO"}, set(record["errorMm"]))
    rows = list(csv.DictReader((folder / "cohort.csv").open()))
    expect("first is what was refused", "refused" if count > 3 else rows[0]["state"], rows[0]["state"])
    expect("rows", {f"{kind(n)}-{n}" for n in range(count)}, {row["case"] for row in rows})
    page = (folder / "cohort.html").read_text()
    expect("page links to reports", True, 'href="results/plain-0/report.html"' in page)
    records = [json.loads(path.read_text()) for path in (folder / "cases").glob("*.json")]
    print(f"{count} cases in {seconds:.0f} s, CPU s of one: "
          f"{sorted(r['cpuSeconds'] for r in records)[len(records) // 2]}, most memory {max(r['memoryMiB'] for r in records)} MiB")
    if "MAMMORAY_KEEP_COHORT" in os.environ:
        shutil.copytree(folder, os.environ["MAMMORAY_KEEP_COHORT"], dirs_exist_ok=True)
