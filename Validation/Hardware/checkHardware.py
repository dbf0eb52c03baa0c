# SPDX-License-Identifier: Apache-2.0
"""Runs the X-ray proofs, then the benchmark (the paper's table 1 and figure 5), on a Vulkan device of this machine, and
writes hardware.json and hardware.html. Needs nothing beyond Python; the figure needs matplotlib."""
import argparse
import datetime
import html
import io
import json
import os
import pathlib
import platform
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "Benchmarks")]
import projectionTables as tables  # noqa: E402  (found beside this file in the bundle)

STYLE = """body{font:15px/1.4 sans-serif;margin:2em auto;max-width:1200px;padding:0 1em}
table{border-collapse:collapse;font-size:13px}td,th{border:1px solid #ccc;padding:3px 6px;text-align:right}
td:first-child,th:first-child,td:nth-child(2){text-align:left}td{white-space:pre-line}"""


def run(command, log, limit):
    """"" if the program answers 0, otherwise what became of it."""
    with open(log, "w", encoding="utf-8") as output:
        try:
            status = subprocess.run(list(map(str, command)), stdout=output, stderr=output, timeout=limit or None, check=False).returncode
        except subprocess.TimeoutExpired:
            return "killed after %d s" % limit
        except OSError:
            return "cannot be started"
    return "" if status == 0 else "exit code %d" % status if status > 0 else "signal %d" % -status


def choose_device(programs, wanted):
    """The most capable device whose name contains `wanted`."""
    listed = subprocess.run([programs / "benchmarkProjection", "--devices"], capture_output=True, text=True, check=False)
    if listed.returncode != 0:
        sys.exit(listed.stderr.strip() or "no Vulkan device")
    devices = json.loads(listed.stdout)
    for device in devices:
        if wanted in device["name"]:
            return device
    sys.exit("--device: expected a part of one of %s, found %s" % (", ".join(device["name"] for device in devices), wanted))


def summarise_proofs(program, report):
    """GoogleTest's report, shortened."""
    summary = {"program": program, "passed": 0, "failed": 0, "skipped": 0, "seconds": float(report.get("time", "0s").rstrip("s")),
               "failures": [], "skips": []}
    for suite in report["testsuites"]:
        for test in suite["testsuite"]:
            name = suite["name"] + "." + test["name"]
            if "failures" in test:
                summary["failed"] += 1
                summary["failures"].append({"test": name, "reason": test["failures"][0].get("failure", "")})
            elif test.get("result") == "SKIPPED":
                summary["skipped"] += 1
                reasons = test.get("skipped") or [{}]
                summary["skips"].append({"test": name, "reason": reasons[0].get("message", "")})
            else:
                summary["passed"] += 1
    return summary


def run_proofs(path, folder, arguments):
    result, log = folder / (path.name + ".json"), folder / (path.name + ".log")
    result.unlink(missing_ok=True)
    failure = run([path, "--gtest_output=json:%s" % result, "--gtest_filter=" + arguments.filter], log, arguments.limit)
    # A program whose tests fail reports this by its exit code, and which ones in its file.
    if not result.exists():
        return {"program": path.name, "error": "%s; see %s" % (failure, log.name)}
    summary = summarise_proofs(path.name, json.loads(result.read_text()))
    result.unlink()
    return summary


def run_benchmark(programs, folder, arguments):
    result = folder / "benchmark.json"
    failure = run([programs / "benchmarkProjection", "--rates", "--seconds", arguments.seconds, "-o", result], folder / "benchmark.log",
                  arguments.limit)
    if failure:
        return {"error": failure + "; see benchmark.log"}
    report = json.loads(result.read_text())
    result.unlink()
    return report


def verdict(report):
    """"all 120 proofs hold (7 skipped)", or what does not; and whether all is well."""
    done = [proofs for proofs in report["proofs"] if "error" not in proofs]
    passed, failed, skipped = (sum(proofs[key] for proofs in done) for key in ("passed", "failed", "skipped"))
    broken = "".join("; %s: %s" % (proofs["program"], proofs["error"]) for proofs in report["proofs"] if "error" in proofs)
    holds = failed == 0 and not broken
    return ("all %d proofs hold (%d skipped)" % (passed, skipped) if holds else
            "%d proofs hold, %d do not (%d skipped)%s" % (passed, failed, skipped, broken)), holds and "error" not in report["benchmark"]


def picture(report):
    try:
        text = io.StringIO()
        tables.draw_rates(report["benchmark"], text, "svg")
        return text.getvalue()[text.getvalue().index("<svg"):]
    except ImportError:
        return tables.page_table(tables.rate_table(report["benchmark"]))


def page(report):
    device = report["device"]
    proofs = ("The proofs", ["program", "hold", "fail", "skipped", "seconds"],
              [[of["program"], of["error"]] if "error" in of else
               [of["program"], of["passed"], of["failed"], of["skipped"], "%.0f" % of["seconds"]] for of in report["proofs"]])

    def reasons(caption, key):
        rows = [[entry["test"], entry["reason"]] for of in report["proofs"] for entry in of.get(key, [])]
        return tables.page_table((caption, ["test", "reason"], rows)) if rows else ""

    title = "MammoRay %s on %s" % (report["version"], device["name"])
    text = "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'>\n<title>%s</title>\n<style>%s</style></head><body>\n" \
        "<h1>%s</h1>\n<p>%s; %s; %s. Host: %s. %s.</p>\n<p><b>%s.</b></p>\n" % (
            *map(html.escape, (title, STYLE, title, device["driver"], device["type"])),
            "traces rays" if device["rayTracing"] else "no ray tracing", html.escape(report["host"]), report["date"],
            html.escape(verdict(report)[0]))
    text += tables.page_table(proofs) + reasons("What does not hold", "failures")
    if "error" in report["benchmark"]:
        text += "<p>benchmark: %s</p>\n" % html.escape(report["benchmark"]["error"])
    else:
        text += tables.page_table(tables.published_table(report["benchmark"])) + tables.page_table(tables.case_table(report["benchmark"]))
        text += "<h2>Frames per second (the paper's figure 5)</h2>\n" + picture(report)
    return text + reasons("Skipped", "skips") + "</body></html>\n"


def host():
    """"AMD EPYC 9654, 16 threads, Linux 6.1.0 x86_64"."""
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        models = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    system = platform.uname()
    return "%s, %d threads, %s %s %s" % (models[0] if models else "unknown processor", os.cpu_count(), system.system, system.release,
                                         system.machine)


def main():
    parser = argparse.ArgumentParser(prog="check", description=__doc__)
    parser.add_argument("programs", type=pathlib.Path, help=argparse.SUPPRESS)
    parser.add_argument("-o", "--output", default="hardware", help="folder for hardware.json and hardware.html (%(default)s)")
    parser.add_argument("--device", default="", help="part of the device's name; the most capable one without it")
    parser.add_argument("--filter", default="*", help="which proofs, as --gtest_filter")
    parser.add_argument("--seconds", type=float, default=4, help="no further round of a measurement after this time (%(default)s)")
    parser.add_argument("--limit", type=float, default=1200, help="a program is killed after this time, s (%(default)s)")
    arguments = parser.parse_args()
    if "MAMMORAY_LIBRARY_PATH" in os.environ:
        os.environ["LD_LIBRARY_PATH"] = os.environ["MAMMORAY_LIBRARY_PATH"]
    device = choose_device(arguments.programs, arguments.device)
    print("%s (%s)" % (device["name"], device["driver"]), flush=True)
    os.environ["MAMMORAY_DEVICE"] = device["name"]
    folder = pathlib.Path(arguments.output)
    folder.mkdir(parents=True, exist_ok=True)
    report = {"version": device.pop("version"), "date": datetime.datetime.utcnow().strftime("%F %H:%M UTC"), "host": host(), "device": device,
              "proofs": []}
    for path in (arguments.programs / "TestXRay", arguments.programs / "TestXRayPeers"):
        if path.exists():  # built without its library otherwise
            print(path.name + " ...", file=sys.stderr, flush=True)
            report["proofs"].append(run_proofs(path, folder, arguments))
    print("benchmarkProjection ...", file=sys.stderr, flush=True)
    report["benchmark"] = run_benchmark(arguments.programs, folder, arguments)
    (folder / "hardware.json").write_text(json.dumps(report, indent=2) + "\n")
    (folder / "hardware.html").write_text(page(report))
    if "error" not in report["benchmark"]:
        print(tables.markdown(tables.published_table(report["benchmark"])) + tables.markdown(tables.case_table(report["benchmark"])), end="")
    text, good = verdict(report)
    print("%s; %s/hardware.html" % (text, arguments.output))
    if not good:
        sys.exit("check: " + text + ("; benchmark: " + report["benchmark"]["error"] if "error" in report["benchmark"] else ""))


if __name__ == "__main__":
    main()
