#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Debian's Orthanc with its DICOMweb plugin, in a network of its own that has the loopback address only.

orthanc.py COMMAND...: runs the command while such an archive is at 127.0.0.1:4242 (DICOM) and http://127.0.0.1:8042, empty at first.
Exit 125: Orthanc or such a network is not there."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.request

PLUGIN = "/usr/share/orthanc/plugins/libOrthancDicomWeb.so"
HTTP, DICOM = 8042, 4242
ANSWER = f"http://127.0.0.1:{HTTP}"


def enter_own_network():
    """Begins this program again where no other can be reached."""
    if not shutil.which("Orthanc") or not os.path.exists(PLUGIN):
        print("no Orthanc")
        sys.exit(125)
    if "MAMMORAY_ALONE" in os.environ:
        return
    if subprocess.run(["unshare", "-rn", "ip", "link", "set", "lo", "up"], check=False, capture_output=True).returncode:
        print("no network of its own")
        sys.exit(125)
    os.environ["MAMMORAY_ALONE"] = "1"
    for name in ("http_proxy", "https_proxy", "HTTP_PROXY", "HTTPS_PROXY", "all_proxy", "ALL_PROXY"):
        os.environ.pop(name, None)
    os.execvp("unshare", ["unshare", "-rn", "sh", "-c", 'ip link set lo up; exec "$@"', "sh", sys.executable, *sys.argv])


def ask(path, raw=False):
    with urllib.request.urlopen(ANSWER + path, timeout=30) as answer:
        return answer.read() if raw else json.load(answer)


def start(folder, **more):
    """An empty archive that keeps all in folder/orthanc; more: of Orthanc's configuration."""
    store = folder / "orthanc"
    shutil.rmtree(store, ignore_errors=True)
    store.mkdir()
    (folder / "orthanc.json").write_text(json.dumps({
        "StorageDirectory": str(store), "IndexDirectory": str(store), "Plugins": [PLUGIN],
        "HttpPort": HTTP, "DicomPort": DICOM, "RemoteAccessAllowed": False, "AuthenticationEnabled": False,
        "DicomModalities": {"us": ["MAMMORAY", "127.0.0.1", 1]}, "DicomCheckModalityHost": True, **more}))
    server = subprocess.Popen(["Orthanc", str(folder / "orthanc.json")], stdout=(folder / "log").open("w"),
                              stderr=subprocess.STDOUT)
    for _ in range(300):
        try:
            ask("/system")
            return server
        except OSError:
            time.sleep(0.1)
    server.kill()
    sys.exit("Orthanc does not begin:\n" + (folder / "log").read_text())


def during(server, what):
    """Calls `what`, then ends the server; gives its answer."""
    try:
        return what()
    finally:
        server.terminate()
        server.wait()


if __name__ == "__main__":
    enter_own_network()
    with tempfile.TemporaryDirectory() as name:
        sys.exit(during(start(pathlib.Path(name)), lambda: subprocess.run(sys.argv[1:], check=False).returncode))
