# SPDX-License-Identifier: Apache-2.0
"""testOptions.py SCHEMA: every option of `mammoray project`, and every key of scene files, has its like in Python."""
import inspect
import json
import sys

import mammoray as mr

PARTS = {"source": mr.Source, "detector": mr.Detector, "beam": mr.Beam, "scatter": mr.Scatter, "refraction": mr.Refraction}
#: Options that are no key of scene files: a callable, and its parameter.
LIKE = {
    "surface": (mr.Sample, "material"), "unit": (mr.read_mesh, "unit"), "scene": (mr.load_scene, "path"), "print-scene": (mr.Scene.save, "path"),
    "set": (mr.Scene, "fields"), "output": (mr.Exposure.save, "path"), "path-lengths": (mr.Exposure.save, "what"),
    "deflection": (mr.Exposure.save, "what"), "display": (mr.Exposure.display, "self"),
    "turn": (mr.turn, "count"), "tomosynthesis": (mr.tomosynthesis, "count"), "span": (mr.turn, "span"), "axis": (mr.turn, "axis"),
    "axis-point": (mr.turn, "axis_point"), "pivot-height": (mr.tomosynthesis, "pivot_height"),
    "flat-fields": (mr.Series.flat_fields, "count"), "high": (mr.dual_energy, "high"), "cancel": (mr.dual_energy, "cancel"),
    "cancel-thickness": (mr.dual_energy, "thickness"), "device": (mr.Projector, "device"), "projector": (mr.Projector, "method"),
    "make-kernels": (mr.Scatter, "kernels"),
    **{name.replace("_", "-"): (mr.Exposure.save, name) for name in ("side", "view", "for_processing", "patient_name", "patient_id")},
    **{name.replace("_", "-"): (mr.Scene.place_unit, name)
       for name in ("orientation", "thickness", "roll", "pitch", "yaw", "lateral", "anterior", "vertical", "tilt", "source_to_detector",
                    "support_height", "anchor")}}
#: Keys that Python has in another form.
KEYS = {"mesh": (mr.read_mesh, "source"), "mesh-unit": (mr.read_mesh, "unit"), "unit": (mr.read_mesh, "unit"), "samples": (mr.Scene, "samples"),
        "materials": (mr.Scene, "materials")}
#: What Python leaves to the program: of every command, what files may be overwritten and taken.
LEFT = ("overwrite", "axes-as-given", "accept-unusual", "$schema")

with open(sys.argv[1], encoding="utf-8") as file:
    declared = json.load(file)["$defs"]


def keys_of(schema, prefix=""):
    for name, value in schema["properties"].items():
        if "properties" in value:
            yield from keys_of(value, f"{prefix}{name}.")
        else:
            yield prefix + name, value


def has(place):
    call, parameter = place
    return parameter in inspect.signature(call).parameters


missing = [option for option, place in {**LIKE, **KEYS}.items() if not has(place)]
assert not missing, f"gone from Python: {missing}"
options, fields = {}, {name: set() for name in PARTS}
for key, value in keys_of(declared["scene"]):
    options[value.get("option", "").lstrip("-")] = key
    part, _, rest = key.partition(".")
    field = {"filter": "filters"}.get(rest, rest).replace("-", "_").replace(".", "_")
    if part in PARTS and rest:
        fields[part].add(field)
        assert field in inspect.signature(PARTS[part]).parameters, f"{key}: no field of {PARTS[part].__name__}"
        assert f"{field}: " in PARTS[part].__doc__, f"{key}: not in the docstring"
    elif key not in KEYS:
        setattr(mr.Scene(), key.replace("-", "_"), None)
for part, kind in PARTS.items():
    extra = set(inspect.signature(kind).parameters) - fields[part]
    assert not extra, f"{kind.__name__}: no keys of scene files: {extra}"
for option in declared["project"]["properties"]:
    known = option in options or option in LIKE or option in LEFT
    assert known, f"--{option}: Python has nothing like it"
print(f"{len(list(keys_of(declared['scene'])))} keys and {len(declared['project']['properties'])} options")
