# SPDX-License-Identifier: Apache-2.0
"""The check of a machine on reports of made-up programs. Exit 125: no matplotlib."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import matplotlib  # noqa: F401
except ImportError as error:
    print(error)
    sys.exit(125)
FOLDER = pathlib.Path(__file__).resolve().parents[2] / "Validation"
sys.path[:0] = [str(FOLDER / "Hardware"), str(FOLDER / "Benchmarks")]
import checkHardware  # noqa: E402
import projectionTables as tables  # noqa: E402

# Output in GoogleTest's form: one test that holds, one that fails, one that is skipped.
PROOFS = {"time": "2.5s", "testsuites": [{"name": "Beam", "testsuite": [
    {"name": "Holds", "result": "COMPLETED"},
    {"name": "Fails", "result": "COMPLETED", "failures": [{"failure": "expected 1 < 0"}]},
    {"name": "Waits", "result": "SKIPPED", "skipped": [{"message": "no device that traces rays"}]}]}]}


def point(triangles, edge, set_up, frame):
    return {"triangles": triangles, "columns": edge, "rows": edge, "setUpAndFrameMs": set_up, "frame": {"medianMs": frame}}


BENCHMARK = {
    "results": [
        {"example": "test", "method": "ray-tracing", "triangles": 15626, "columns": 150, "rows": 200, "coldStartMs": 120.4,
         "frame": {"medianMs": 0.52}, "render": {"medianMs": 0.31}, "picture": {"medianMs": 0.4}, "inconsistent": 0},
        {"example": "veins", "method": "rasterisation", "triangles": 215728, "columns": 1681, "rows": 2071, "error": "the device is lost"}],
    "rates": [{"method": "ray-tracing", "resolution": [point(1000, 100, 100, 1), point(1000, 1000, 200, 10)],
               "triangles": [point(100000, 600, 300, 4)]}]}
# Stands for every program: lists devices, writes a report, and ends as its name says.
PROGRAM = """#!/usr/bin/env python3
import json, os, sys
words = sys.argv[1:]
if words == ["--devices"]:
    print(json.dumps([{"version": "0.1", "name": "A&B 3000", "driver": "1", "type": "CPU", "rayTracing": True}]))
elif "-o" in words:
    assert os.environ["MAMMORAY_DEVICE"] == "A&B 3000"
    open(words[words.index("-o") + 1], "w").write(%r)
elif "Peers" in sys.argv[0]:
    os.kill(os.getpid(), 11)
else:
    open(words[0].split("json:")[1], "w").write(%r)
    sys.exit(1)
""" % (json.dumps(BENCHMARK), json.dumps(PROOFS))


def report():
    return {"version": "0.1.0", "date": "2026-11-23 15:00 UTC", "host": "a <host>",
            "device": {"name": "A&B 3000", "driver": "1.2", "type": "discrete GPU", "rayTracing": True},
            "proofs": [checkHardware.summarise_proofs("TestXRay", PROOFS)], "benchmark": BENCHMARK}


class Hardware(unittest.TestCase):
    def test_proofs_are_counted_and_reasons_kept(self):
        proofs = report()["proofs"][0]
        self.assertEqual([proofs[key] for key in ("passed", "failed", "skipped", "seconds")], [1, 1, 1, 2.5])
        self.assertEqual(proofs["failures"], [{"test": "Beam.Fails", "reason": "expected 1 < 0"}])
        self.assertEqual(proofs["skips"][0]["reason"], "no device that traces rays")

    def test_the_verdict_counts_dead_programs_too(self):
        of = report()
        self.assertEqual(checkHardware.verdict(of), ("1 proofs hold, 1 do not (1 skipped)", False))
        of["proofs"][0]["failed"] = 0
        self.assertEqual(checkHardware.verdict(of), ("all 1 proofs hold (1 skipped)", True))
        of["proofs"].append({"program": "TestXRayPeers", "error": "signal 11"})
        self.assertEqual(checkHardware.verdict(of), ("1 proofs hold, 0 do not (1 skipped); TestXRayPeers: signal 11", False))

    def test_the_page_has_all_of_it_with_names_escaped(self):
        page = checkHardware.page(report())
        for text in ("A&amp;B 3000", "Beam.Fails", "the device is lost", "no device that traces rays", "<svg"):
            self.assertIn(text, page)
        self.assertNotIn("<host>", page)

    def test_programs_end_in_every_way(self):
        with tempfile.TemporaryDirectory() as name:
            log = pathlib.Path(name) / "log"
            self.assertEqual(checkHardware.run(["/bin/sh", "-c", "echo here; echo there >&2"], log, 30), "")
            self.assertEqual(log.read_text(), "here\nthere\n")
            self.assertEqual(checkHardware.run(["/bin/sh", "-c", "exit 3"], log, 0), "exit code 3")
            self.assertEqual(checkHardware.run(["/bin/sh", "-c", "kill -11 $$"], log, 0), "signal 11")
            self.assertEqual(checkHardware.run(["/no/such/program"], log, 0), "cannot be started")
            self.assertEqual(checkHardware.run(["/bin/sleep", "1000"], log, 1), "killed after 1 s")

    def test_the_check_runs_all_programs_and_fails_where_one_does(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            for program in ("benchmarkProjection", "TestXRay", "TestXRayPeers"):
                (folder / program).write_text(PROGRAM)
                (folder / program).chmod(0o755)
            done = subprocess.run([sys.executable, FOLDER / "Hardware" / "checkHardware.py", folder, "-o", "out", "--device", "B 3"], cwd=folder,
                                  capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn("1 proofs hold, 1 do not (1 skipped); TestXRayPeers: signal 11", done.stdout)
            of = json.loads((folder / "out" / "hardware.json").read_text())
            self.assertEqual(of["benchmark"], BENCHMARK)
            self.assertIn("<svg", (folder / "out" / "hardware.html").read_text())
            done = subprocess.run([sys.executable, FOLDER / "Hardware" / "checkHardware.py", folder, "--device", "C"], cwd=folder,
                                  capture_output=True, text=True, check=False)
            self.assertIn("A&B 3000", done.stderr)


class ProjectionTables(unittest.TestCase):
    def test_published_times_stand_beside_ours(self):
        rows = tables.published_table(BENCHMARK)[2]
        self.assertEqual(rows, [["test", "ray-tracing", "310", "120", "0.9", "0.3", "0.4", "0.5"]])  # none of the case that failed

    def test_a_failed_case_has_its_reason(self):
        text = tables.markdown(tables.case_table(BENCHMARK))
        self.assertIn("| veins | rasterisation | 215728 | 1681x2071 | the device is lost |", text)
        self.assertIn("| test | ray-tracing | 15626 | 150x200 | 0.5 | - | - | - | 120 |", text)  # "-": not measured
        self.assertIn("<td colspan='13'>the device is lost</td>", tables.page_table(tables.case_table(BENCHMARK)).replace('"', "'"))

    def test_rates_are_frames_per_second(self):
        rows = tables.rate_table(BENCHMARK)[2]
        self.assertEqual(len(rows), 3)
        self.assertEqual(rows[1], ["ray-tracing", 1000, "1000x1000", "5.0", "100.0"])


if __name__ == "__main__":
    unittest.main()
