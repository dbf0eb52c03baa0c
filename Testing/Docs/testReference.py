# SPDX-License-Identifier: Apache-2.0
"""Manual pages, completion and tables of a program with two commands."""
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "Applications/mammoray"))
import writeReference

OVERWRITE = {"type": "boolean", "description": "replace", "group": "Of every command", "shown": "--help"}
SCHEMA = {"$defs": {
    "program": {"description": "Presses.\nLengths in mm.", "properties": {"overwrite": OVERWRITE}},
    "press": {"description": "Press a body\n.5 mm at a time", "example": "Example: mammoray press --mesh a.vtu", "properties": {
        "$schema": {"type": "string"},
        "mesh": {"type": "string", "description": "to press", "value": "PATH", "mandatory": True, "shown": "--help"},
        "thickness": {"type": "number", "exclusiveMinimum": 0, "description": "distance of the plates [mm]", "default": 50,
                      "value": "mm", "shown": "--help"},
        "side": {"type": "string", "enum": ["left", "right"], "description": "the patient's own", "value": "TEXT", "short": "s",
                 "group": "Patient", "shown": "--help-all"},
        "friction": {"type": "number", "minimum": 0, "description": "of the plates", "default": 0, "value": "FLOAT", "shown": "case file"},
        "overwrite": {"$ref": "#/$defs/program/properties/overwrite"}}},
    "lift": {"description": "Lift a body", "example": "Example: mammoray lift", "properties": {
        "sizes": {"anyOf": [{"type": "number", "exclusiveMinimum": 0}, {"type": "array"}], "description": "coarse to fine [mm]",
                  "default": [3.0, 1.5], "value": "mm", "shown": "--help"},
        "thickness": {"type": "number", "exclusiveMinimum": 0, "description": "distance of the plates [mm]", "default": 20,
                      "value": "mm", "shown": "--help"}}}}}


def expect(part, text):
    assert part in text, f"expected {part!r} in:\n{text}"


page = writeReference.command_page(SCHEMA, "press", "MammoRay 1")
for part in ("mammoray\\-press \\- Press a body\n", "\\fB\\-\\-mesh\\fR \\fIPATH\\fR (required)\nto press\n",
             "\\fB\\-\\-thickness\\fR \\fImm\\fR (greater than 0; default 50)\ndistance of the plates\n",
             ".SH PATIENT\n.TP\n\\fB\\-s\\fR, \\fB\\-\\-side\\fR \\fIleft|right\\fR\n",
             ".SH SETTINGS OF THE CASE FILE (\\-\\-CONFIG)\n.TP\n\\fBfriction\\fR", "\n\\&.5 mm at a time",
             ".SH OF EVERY COMMAND\n.TP\n\\fB\\-\\-overwrite\\fR\nreplace\n"):
    expect(part, page)
page = writeReference.program_page(SCHEMA, "MammoRay 1")
expect("\\fBpress\\fR\nPress a body\n", page)
expect("\\fBmammoray\\-press\\fR(1)", page)

with tempfile.TemporaryDirectory() as folder:
    script = pathlib.Path(folder) / "completion"
    script.write_text(writeReference.completion(SCHEMA))

    def complete(words):
        command = f'source {script}; COMP_WORDS=(mammoray {words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); _mammoray; echo "${{COMPREPLY[*]}}"'
        return subprocess.run(["bash", "-c", command], check=True, capture_output=True, text=True).stdout.strip()

    assert complete("pr") == "press"
    assert complete("press --th") == "--thickness"
    assert complete("press --ov") == "--overwrite"
    assert complete("press --side ri") == "right"
    assert complete("press --fr") == ""  # of the case file
    assert complete("press --mesh pr") == ""  # files are left to the shell

RESULTS = {"$defs": {"mammogram": {"properties": {
    "level": {"enum": ["good", "none"]}, "seconds": {"type": ["number", "null"], "description": "wall time"},
    "grid": {"type": "object", "properties": {"originMm": {"type": "array", "minItems": 2, "frame": "gantry"}}},
    "views": {"type": "array", "items": {"properties": {"name": {"type": "string"}}}},
    "versions": {"type": "object", "additionalProperties": {"type": "string"}}}}}}
pages = writeReference.reference_pages(SCHEMA, RESULTS)
assert sorted(pages) == ["index.md", "lift.md", "press.md", "result-keys.md", "scene-keys.md"], sorted(pages)
for part in ("## One mammogram\n\n| field | type | meaning |\n|---|---|---|\n| `level` | good, none |  |\n| `seconds` | number or null | wall time |\n",
             "| `grid` | object |  |\n| `grid.originMm` | 2 numbers | gantry frame |\n", "| `views[].name` | text |  |\n", "| `versions.NAME` | text | |\n"):
    expect(part, pages["result-keys.md"])
for part in ("# mammoray press\n", "mammoray press --mesh a.vtu", "\n## Of every command\n", "| `--overwrite` |  |  | replace |\n",
             "| `--thickness` | mm, greater than 0 | 50 | distance of the plates |\n", "| `--mesh` | PATH |  | to press (required) |\n",
             "\n## Patient, shown by --help-all\n", "| `-s, --side` | left, right |  | the patient's own |\n",
             "\n## Settings of the case file\n", "| `friction` | FLOAT, not less than 0 | 0 | of the plates |\n"):
    expect(part, pages["press.md"])
expect("| `--sizes` | mm, greater than 0 | [3.0,1.5] | coarse to fine |\n", pages["lift.md"])
expect("| [press](press.md) | Press a body |\n", pages["index.md"])
