#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints what a release is made of, as SPDX 2.3 in JSON: the release's files with their checksums, the packages that its
Debian packages depend on, and those that it was built with (quickstart's list), with their versions here.

usage: sbom.py VERSION FOLDER-OF-THE-RELEASE

SOURCE_DATE_EPOCH: its time, of the release's commit."""
import datetime
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys

top = pathlib.Path(__file__).resolve().parents[1]
if len(sys.argv) != 3:
    sys.exit(__doc__)
version, folder = sys.argv[1], pathlib.Path(sys.argv[2])
PURL = "pkg:deb/debian/{}@{}"


def identifier(name):
    return "SPDXRef-" + re.sub(r"[^A-Za-z0-9.-]", "-", name)


def package(name, its_version, **more):
    return {"name": name, "SPDXID": identifier(name), "versionInfo": its_version, "downloadLocation": "NOASSERTION",
            "filesAnalyzed": False, "licenseConcluded": "NOASSERTION", "licenseDeclared": "NOASSERTION",
            "copyrightText": "NOASSERTION", **more}


def of_debian(name):
    """A package of Debian in the version that is installed here."""
    done = subprocess.run(["dpkg-query", "-W", "-f", "${Version}", name], capture_output=True, text=True)
    its_version = done.stdout or "NOASSERTION"
    return package(name, its_version, externalRefs=[] if not done.stdout else [{
        "referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": PURL.format(name, its_version)}])


def depends_of(deb):
    """Names that a Debian package depends on; of alternatives the first."""
    text = subprocess.run(["dpkg-deb", "--field", deb, "Depends"], capture_output=True, text=True, check=True).stdout
    return [re.split(r"[ (|:]", part.strip())[0] for part in text.split(",") if part.strip()]


own = package("mammoray", version, licenseDeclared="Apache-2.0", copyrightText="2026 The MammoRay authors")
packages, links = {own["SPDXID"]: own}, []


def link(one, relation, other):
    entry = {"spdxElementId": one, "relationshipType": relation, "relatedSpdxElement": other}
    if one != other and entry not in links:
        links.append(entry)


for path in sorted(folder.rglob("*")):
    if not path.is_file() or path.name == "SHA256SUMS" or path.name.endswith(".spdx.json"):
        continue
    made = package(path.relative_to(folder).as_posix(), version, packageFileName=path.name, checksums=[
        {"algorithm": "SHA256", "checksumValue": hashlib.sha256(path.read_bytes()).hexdigest()}])
    packages[made["SPDXID"]] = made
    link(made["SPDXID"], "GENERATED_FROM", own["SPDXID"])
    if path.suffix == ".deb":
        for name in depends_of(path):
            if "mammoray" not in name:
                packages.setdefault(identifier(name), of_debian(name))
                link(made["SPDXID"], "DEPENDS_ON", identifier(name))
listed = re.search(r"^program_packages=\((.*?)^\)", (top / "quickstart").read_text(), re.MULTILINE | re.DOTALL).group(1)
for name in listed.split():
    packages.setdefault(identifier(name), of_debian(name))
    link(identifier(name), "BUILD_DEPENDENCY_OF", own["SPDXID"])
time = datetime.datetime.fromtimestamp(int(os.environ.get("SOURCE_DATE_EPOCH", "0")), datetime.timezone.utc)
contents = hashlib.sha256(json.dumps([list(packages.values()), links]).encode()).hexdigest()
json.dump({
    "spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": f"mammoray-{version}",
    "documentNamespace": f"https://mammoray.example/spdx/{version}-{contents[:16]}",
    "creationInfo": {"created": time.strftime("%Y-%m-%dT%H:%M:%SZ"), "creators": ["Tool: mammoray-sbom.py"]},
    "packages": list(packages.values()),
    "relationships": [{"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": own["SPDXID"]}, *links],
}, sys.stdout, indent=1)
print()
