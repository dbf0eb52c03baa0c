#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A result has the fields and types of its JSON schema, and no others.

usage: checkResult.py SCHEMA RESULT
"""
import json
import sys

KINDS = {"string": str, "number": (int, float), "integer": int, "boolean": bool, "object": dict, "array": list, "null": type(None)}


def faults(entry, value, name):
    if "const" in entry or "enum" in entry:
        return [] if value in entry.get("enum", [entry.get("const")]) else [f"{name}: {value!r}"]
    kinds = entry["type"] if isinstance(entry["type"], list) else [entry["type"]]
    if not any(isinstance(value, KINDS[kind]) and (kind == "boolean" or not isinstance(value, bool)) for kind in kinds):
        return [f"{name}: expected {' or '.join(kinds)}, found {value!r}"]
    found = []
    if isinstance(value, list):
        if not entry.get("minItems", 0) <= len(value) <= entry.get("maxItems", len(value)):
            found.append(f"{name}: {len(value)} items")
        for number, item in enumerate(value):
            found += faults(entry["items"], item, f"{name}[{number}]")
    if isinstance(value, dict):
        known, others = entry.get("properties", {}), entry.get("additionalProperties")
        found += [f"{name}: expected {key}" for key in entry.get("required", []) if key not in value]
        for key, item in value.items():
            inner = known.get(key, others)
            found += faults(inner, item, f"{name}.{key}") if inner else [f"{name}.{key}: not in the schema"]
    return found


schema, result = (json.load(open(path)) for path in sys.argv[1:3])
wrong = faults(schema["$defs"]["joint" if "mammograms" in result else "mammogram"], result, "result")
wrong += [] if faults(schema["$defs"]["mammogram"], {**result, "seconds": "1"}, "result") else ["a wrong type is not found"]
for line in wrong:
    print(line)
sys.exit(1 if wrong else 0)
