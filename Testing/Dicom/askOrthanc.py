#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A result goes to a real Orthanc and comes back.

askOrthanc.py MAMMORAY FOLDER: FOLDER holds a result, mammogram.dcm, mri-series/ and lesion.nrrd (see ArchivedFiles.h).
Exit 125: no Orthanc (orthanc.py). MAMMORAY_KEEP_PREVIEWS: a folder for the pictures that Orthanc makes."""
import os
import pathlib
import subprocess
import sys
import urllib.request

from orthanc import ANSWER, DICOM, ask, during, enter_own_network, start

program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
enter_own_network()


def run(*words, status=0):
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False)
    if status is not None and done.returncode != status:
        sys.exit(f"{words}: expected exit status {status}, found {done.returncode}: {done.stdout}{done.stderr}")
    if status == 1 and done.stderr.count("\n") != 1:
        sys.exit(f"{words}: expected one line, found {done.stderr}")
    return done.stdout + done.stderr


def expect(what, expected, found):
    if expected != found:
        sys.exit(f"{what}: expected {expected}, found {found}")


def openssl(*words):
    subprocess.run(["openssl", *map(str, words)], check=True, capture_output=True)


def certify(name, *extensions):
    """name.key and name.pem, of the authority ca.pem, or that itself."""
    key, request = folder / f"{name}.key", folder / f"{name}.csr"
    openssl("req", "-newkey", "rsa:2048", "-nodes", "-keyout", key, "-out", request, "-subj", f"/CN={name}")
    (folder / "extensions").write_text("\n".join(extensions))
    by = ["-signkey", key] if name.startswith("ca") else ["-CA", folder / "ca.pem", "-CAkey", folder / "ca.key", "-CAcreateserial"]
    openssl("x509", "-req", "-in", request, "-days", 2, "-out", folder / f"{name}.pem", "-extfile", folder / "extensions", *by)


def previews():
    """One picture of each series that has pixels."""
    kept = os.environ.get("MAMMORAY_KEEP_PREVIEWS")
    for series in ask("/series?expand"):
        modality = series["MainDicomTags"]["Modality"]
        if modality in ("MG", "MR"):
            instances = sorted(series["Instances"], key=lambda i: int(ask(f"/instances/{i}")["MainDicomTags"]["InstanceNumber"]))
            picture = ask(f"/instances/{instances[len(instances) // 2]}/preview", raw=True)
            expect(f"preview of {modality}", b"\x89PNG", picture[:4])
            if kept:
                name = f"{modality}-{series['MainDicomTags'].get('SeriesDescription', '')}.png".replace("/", "_")
                (pathlib.Path(kept) / name).write_bytes(picture)


def check():
    node = f"127.0.0.1:{DICOM}"
    mammogram, mri = folder / "mammogram.dcm", folder / "mri-series"
    run("dicom", "--result", folder, "--mammogram", mammogram, "--same-patient", "--point", 8, 20, 0, "--lesion",
        folder / "lesion.nrrd", "--mri", mri)
    objects = sorted(p.name for p in (folder / "dicom").glob("*.dcm"))
    expect("objects", ["lesions.dcm", "presentation.dcm", "registration.dcm", "report.dcm", "synthetic.dcm"], objects)
    slices = len(list((folder / "dicom" / "mri").iterdir()))

    # By both ways; what is there already is stored again.
    run("send", "--files", mammogram, mri, "--pacs", node)
    said = run("send", "--result", folder, "--pacs", node)
    expect("lines", slices + 5 + 1, said.count("stored "))
    expect("instances", 1 + 30 + 5 + slices, ask("/statistics")["CountInstances"])
    expect("patients", 1, ask("/statistics")["CountPatients"])
    for instance in ask("/instances"):
        urllib.request.urlopen(urllib.request.Request(f"{ANSWER}/instances/{instance}", method="DELETE"), timeout=30)
    expect("instances after removal", 0, ask("/statistics")["CountInstances"])
    run("send", "--files", mammogram, mri, "--web", ANSWER + "/dicom-web")
    run("send", "--result", folder, "--web", ANSWER + "/dicom-web")
    expect("instances", 1 + 30 + 5 + slices, ask("/statistics")["CountInstances"])

    # In the patient's studies: the mammogram's holds all that is new.
    studies = {s["MainDicomTags"]["AccessionNumber"]: s for s in ask("/studies?expand")}
    expect("studies", {"A-100", "A-200"}, set(studies))
    modalities = sorted(ask(f"/series/{s}")["MainDicomTags"]["Modality"] for s in studies["A-100"]["Series"])
    expect("modalities", ["MG", "MG", "MR", "PR", "REG", "SEG", "SR"], modalities)
    for instance in ask("/instances"):
        tags = ask(f"/instances/{instance}/simplified-tags")
        expect("patient", ("P-17", "Doe^Jane"), (tags["PatientID"], tags["PatientName"]))
        if tags["Modality"] == "MG":
            expect("KVP", 28 if "Synthetic" in tags["SeriesDescription"] else 29, float(tags["KVP"]))
    previews()

    # And back: each file as it was, wherever the archive keeps it.
    run("fetch", "--pacs", node, "--accession", "A-100", "--accession", "A-200", "-o", folder / "export")
    fetched = [p for p in (folder / "export").rglob("*") if p.is_file()]
    expect("fetched", 1 + 30 + 5 + slices, len(fetched))
    seen = run("intake", folder / "export", status=None)  # a box is no breast, which it may say
    expect("intake leaves out what is between the plates", 1, seen.count("left out: reformat of another series"))
    expect("intake sees MRI and mammograms", True, "MRI: 2 volumes" in seen and "mammograms: 2" in seen)
    refused = run("fetch", "--pacs", node, "--accession", "A-300", "-o", folder / "none", status=1)
    expect("no such study", True, "found none" in refused)
    run("fetch", "--pacs", node, "--accession", "A-1*", "-o", folder / "none", status=1)
    run("fetch", "--pacs", node, "--accession", "A-100", "--calling-title", "STRANGER", "-o", folder / "none", status=1)
    run("fetch", "--pacs", node, "--accession", "A-100", "-o", folder / "export", status=1)
    run("fetch", "--pacs", f"127.0.0.1:{DICOM + 1}", "--accession", "A-100", "-o", folder / "none", status=1)
    run("send", "--result", folder, "--web", ANSWER + "/nowhere", status=1)
    expect("nothing half written", False, (folder / "none").exists())


def check_encrypted():
    """The archive asks for our certificate, we for its name."""
    node, mammogram = f"127.0.0.1:{DICOM}", folder / "mammogram.dcm"
    ours = ["--certificate", folder / "client.pem", "--key", folder / "client.key"]
    theirs = ["--authorities", folder / "ca.pem"]
    run("send", "--files", mammogram, "--pacs", node, "--tls", *theirs, *ours)
    expect("instances by TLS", 1, ask("/statistics")["CountInstances"])
    run("fetch", "--pacs", node, "--tls", *theirs, *ours, "--accession", "A-100", "-o", folder / "encrypted")
    expect("fetched by TLS", 1, len(list((folder / "encrypted").rglob("*.dcm"))))
    for case, options, expected in (
            ("an authority that is not known", ["--tls", *ours], "certificate verify failed"),
            ("an authority of another", ["--tls", "--authorities", folder / "ca2.pem", *ours], "certificate verify failed"),
            ("no certificate of ours", ["--tls", *theirs], "found"),
            ("another's key", ["--tls", *theirs, "--certificate", folder / "client.pem", "--key", folder / "server.key"],
             "the key of"),
            ("no TLS", [], "found none"),
            ("no authorities", ["--tls", "--authorities", folder / "nowhere.pem", *ours], "no such file"),
            ("certificates that are none", ["--tls", "--authorities", folder / "mammogram.dcm", *ours], "certificates (PEM)"),
            ("authorities without TLS", theirs, "expected TLS")):
        said = run("send", "--files", mammogram, "--pacs", node, "--timeout", 5, *options, status=1)
        expect(f"{case}: {said}", True, expected in said)
    # The certificate is for 127.0.0.1.
    said = run("send", "--files", mammogram, "--pacs", f"127.0.0.2:{DICOM}", "--tls", *theirs, *ours, status=1)
    expect(f"another name: {said}", True, "certificate verify failed" in said)
    run("send", "--files", mammogram, "--web", ANSWER + "/dicom-web", "--tls", status=2)
    expect("instances are as they were", 1, ask("/statistics")["CountInstances"])


during(start(folder), check)
for authority in ("ca", "ca2"):
    certify(authority, "basicConstraints=critical,CA:TRUE")
certify("server", "subjectAltName=IP:127.0.0.1")
certify("client")
during(start(folder, DicomTlsEnabled=True, DicomTlsCertificate=str(folder / "server.pem"), DicomTlsPrivateKey=str(folder / "server.key"),
             DicomTlsTrustedCertificates=str(folder / "ca.pem"), DicomTlsRemoteCertificateRequired=True), check_encrypted)
