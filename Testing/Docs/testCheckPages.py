# SPDX-License-Identifier: Apache-2.0
"""Each fault that checkPages.py looks for is found in a folder that has it, and none in one without."""
import pathlib
import shutil
import subprocess
import sys
import tempfile

CHECK = pathlib.Path(__file__).resolve().parent / "checkPages.py"
PAGE = "# A page\n\n## Two words\n\nSee [the other](other.md#first-part) and [above](#two-words).\n"
OTHER = "# Other\n\n## First part\n\nA line. `[no](link.md)`\n"
FAULTS = {
    "there is no none.md": "[x](none.md)\n",
    "there is no heading other.md#second": "[x](other.md#second)\n",
    "there is no heading #nowhere": "[x](#nowhere)\n",
    "there is no none.png": "![x](none.png)\n",
    "expected at most 15000 words": "word " * 15001 + "\n",
    "does not list it": "```sh run\ntrue\n```\n",
}
MESSAGES = "# Troubleshooting\n\n| message | cause |\n|---|---|\n| `expected a mesh, found ...` | x |\n"
if shutil.which("aspell"):
    FAULTS["unknown words: speling"] = "The speling is wrong.\n"


def run(fault, messages="", changes="", code=""):
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        for folder in ("docs/how-to", "Testing/Docs", "Modules"):
            (root / folder).mkdir(parents=True)
        (root / "docs/page.md").write_text(PAGE + fault)
        (root / "docs/other.md").write_text(OTHER)
        (root / "README.md").write_text("# A page\n")
        (root / "Testing/Docs/CMakeLists.txt").write_text("set(pages other)\n")
        (root / "Modules/Read.cxx").write_text('throw Error("expected a " +\n  "mesh, found " + what);\n')
        (root / "docs/how-to/troubleshooting.md").write_text(messages)
        (root / "CHANGELOG.md").write_text(changes)
        (root / "docs/draw.py").write_text(code)
        (root / "words.txt").write_text("mammoray\n")
        done = subprocess.run([sys.executable, CHECK, root, root / "words.txt"], capture_output=True, text=True)
        return done.returncode, done.stdout


status, output = run("")
assert status == 0, output
for expected, fault in FAULTS.items():
    status, output = run(fault)
    assert status == 1 and expected in output, f"expected {expected!r} in:\n{output}"
assert run("", MESSAGES)[0] == 0, run("", MESSAGES)
status, output = run("", MESSAGES.replace("a mesh", "a message"))
assert status == 1 and "no source says" in output, output
ten = "# Changelog\n\n## 1.1.0 (today)\n\n" + 10 * "- a point\n"
assert run("", changes=ten + "\n## 1.0.0\n\n- a point\n")[0] == 0
status, output = run("", changes=ten + "- one more\n")
assert status == 1 and "1.1.0: expected at most 10 points, found 11" in output, output
assert run("", code='def draw():\n    """Draws it."""  # By hand.\n')[0] == 0
for fault in ('    """What is drawn."""', "x = 1  # Of all.", "# Whether it is drawn"):
    status, output = run("", code=fault + "\n")
    assert status == 1 and "draw.py: expected a subject: " + fault.strip() in output, output
