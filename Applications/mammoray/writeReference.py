#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes manual pages, completion and reference pages from the declared options (mammoray --print-schema).

usage: writeReference.py MAMMORAY FOLDER          FOLDER/man1, manual pages of the program and each command; FOLDER/completion, for bash
       writeReference.py MAMMORAY --update ROOT   Data/case.schema.json and docs/reference/commands (the keys of results by Data/result.schema.json)
"""
import gzip
import json
import pathlib
import re
import subprocess
import sys


class Option:
    def __init__(self, name, setting):
        self.name, self.setting = name, setting
        one = setting["anyOf"][0] if "anyOf" in setting else setting.get("items", setting)
        self.words = one.get("enum", [])
        self.only_in_file = setting["shown"] == "case file"
        self.range = ""
        if "maximum" in one:
            self.range = f"from {one['minimum']:g} to {one['maximum']:g}"
        elif "exclusiveMinimum" in one:
            self.range = f"greater than {one['exclusiveMinimum']:g}"
        elif "minimum" in one:
            self.range = f"not less than {one['minimum']:g}"
        self.value = setting.get("value", "")
        self.help = setting["description"].removesuffix(f" [{self.value}]")
        default = setting.get("default", "")
        self.default = json.dumps(default, separators=(",", ":")) if isinstance(default, list) else str(default)

    def spellings(self):
        """["-o", "--output"], or the bare name of what has no dashes."""
        if self.only_in_file or "positional" in self.setting:
            return [self.name]
        return ["-" + letter for letter in [self.setting.get("short")] if letter] + ["--" + self.name]

    def remark(self):
        """" (greater than 0; default 50)", or nothing."""
        remarks = [self.range, self.default and "default " + self.default, "mandatory" in self.setting and "required"]
        return f" ({'; '.join(filter(None, remarks))})" if any(remarks) else ""


def commands_of(schema):
    """Name and definition of each."""
    return [(name, definition) for name, definition in schema["$defs"].items() if name not in ("program", "scene")]


def options_of(definition):
    return [Option(name, setting) for name, setting in definition["properties"].items() if "shown" in setting]


def all_options(schema, definition):
    return options_of(definition) + options_of(schema["$defs"]["program"])


def purpose(definition):
    return definition["description"].split("\n")[0].rstrip(".:")


def roff(text):
    """Text as roff takes it: no hyphen that breaks an option, no line that is a request."""
    return re.sub(r"^([.'])", r"\\&\1", text.replace("\\", "\\e").replace("-", "\\-"), flags=re.MULTILINE)


def head(name, what, version):
    return f'.TH {roff(name).upper()} 1 "" "{version}" "User Commands"\n.SH NAME\n{roff(name)} \\- {roff(what)}\n'


def command_page(schema, name, version):
    definition = schema["$defs"][name]
    page = (head("mammoray-" + name, purpose(definition), version) + f".SH SYNOPSIS\n\\fBmammoray {roff(name)}\\fR [\\fIOPTIONS\\fR]\n"
            f".SH DESCRIPTION\n{roff(definition['description'])}\n")
    sections = {}
    for option in all_options(schema, definition):
        heading = "Settings of the case file (--config)" if option.only_in_file else option.setting.get("group", "Options")
        value = "|".join(option.words) or option.value
        entry = (", ".join(f"\\fB{roff(spelling)}\\fR" for spelling in option.spellings()) + (f" \\fI{roff(value)}\\fR" if value else "")
                 + f"{roff(option.remark())}\n{roff(option.help)}\n")
        sections[heading] = sections.get(heading, "") + ".TP\n" + entry
    for heading, text in sections.items():
        page += f".SH {roff(heading.upper())}\n{text}"
    return page + f".SH EXAMPLE\n{roff(definition['example'].removeprefix('Example: '))}\n.SH SEE ALSO\n\\fBmammoray\\fR(1)\n"


def program_page(schema, version):
    commands = commands_of(schema)
    listed = "".join(f".TP\n\\fB{roff(name)}\\fR\n{roff(purpose(definition))}\n" for name, definition in commands)
    return (head("mammoray", "synthetic X-rays of meshes, registration of breast MRI with mammograms", version)
            + ".SH SYNOPSIS\n\\fBmammoray\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR]\n.SH DESCRIPTION\n"
            + f"{roff(schema['$defs']['program']['description'])}\n.SH COMMANDS\n{listed}"
            ".SH EXIT STATUS\n0: done; 1: refused or failed, with one line that says why; 2: wrong usage.\n"
            ".SH ENVIRONMENT\n.TP\n\\fBMAMMORAY_DEVICE\\fR\npart of the name of the Vulkan device to use\n"
            ".TP\n\\fBMAMMORAY_DATA\\fR\nfolder of attenuation tables, spectra and material tables in place of the shipped one\n"
            ".SH SEE ALSO\n" + ", ".join(f"\\fBmammoray\\-{name}\\fR(1)" for name, _ in commands) + "\n")


COMPLETION = r"""# bash completion for mammoray
_mammoray() {
  local current=${COMP_WORDS[COMP_CWORD]} words='' options=''
  if [ "$COMP_CWORD" -eq 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W '@commands@ --help --version' -- "$current")
    return
  fi
  case "${COMP_WORDS[1]} ${COMP_WORDS[COMP_CWORD-1]}" in
@words@  esac
  case "${COMP_WORDS[1]}" in
@options@  esac
  if [ -n "$words" ]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  elif [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$current")
  fi
} && complete -o default -F _mammoray mammoray
"""


def completion(schema):
    words = options = ""
    for name, definition in commands_of(schema):
        shown = [option for option in all_options(schema, definition) if not option.only_in_file]
        for option in shown:
            for spelling in option.spellings() if option.words else []:
                words += f"    '{name} {spelling}') words='{' '.join(option.words)}' ;;\n"
        names = ["--help", "--help-all"] + [spelling for option in shown for spelling in option.spellings()]
        options += f"    {name}) options='{' '.join(names)}' ;;\n"
    return (COMPLETION.replace("@commands@", " ".join(name for name, _ in commands_of(schema)))
            .replace("@words@", words).replace("@options@", options))


def cell(text):
    """A text as Markdown shows it in a table."""
    return re.sub(r"([|*_<])", r"\\\1", text)


def row(option):
    values = ", ".join(filter(None, [", ".join(option.words) or option.value, option.range]))
    meaning = option.help + (" (required)" if "mandatory" in option.setting else "")
    return f"| `{', '.join(option.spellings())}` | {cell(values)} | {cell(option.default)} | {cell(meaning)} |\n"


def scene_rows(definition, prefix=""):
    """A row for each key of scene files."""
    rows = []
    for name, entry in definition["properties"].items():
        if "properties" in entry:
            rows += scene_rows(entry, f"{prefix}{name}.")
            continue
        one = entry.get("items") or entry.get("additionalProperties") or entry
        limits = f"from {one['minimum']:g} to {one['maximum']:g}" if "minimum" in one else ""
        values = ", ".join(filter(None, [", ".join(entry.get("enum", [])) or entry.get("value", ""), limits]))
        option = f"`{entry['option']}`" if "option" in entry else ""
        rows.append(f"| `{prefix}{name}` | {cell(values)} | {cell(entry.get('default', ''))} | {cell(entry['description'])} | {option} |\n")
    return rows


def kind_of(entry):
    """The type of a JSON schema's entry in words."""
    if "const" in entry or "enum" in entry:
        return ", ".join(map(str, entry.get("enum") or [entry["const"]]))
    types = entry["type"] if isinstance(entry["type"], list) else [entry["type"]]
    words = {"string": "text", "array": "list", "boolean": "true or false"}
    kind = " or ".join(words.get(one, one) for one in types)
    return f"{entry['minItems']} numbers" if "minItems" in entry else kind


def result_rows(definition, prefix=""):
    """A row for each field of result files."""
    rows = []
    for name, entry in definition["properties"].items():
        meaning = ", ".join(filter(None, [entry.get("description", ""), entry.get("frame", "") and entry["frame"] + " frame"]))
        rows.append(f"| `{prefix}{name}` | {cell(kind_of(entry))} | {cell(meaning)} |\n")
        inner, mark = (entry["items"], "[].") if "properties" in entry.get("items", {}) else (entry, ".")
        if "properties" in inner:
            rows += result_rows(inner, f"{prefix}{name}{mark}")
        if isinstance(entry.get("additionalProperties"), dict):
            rows.append(f"| `{prefix}{name}.NAME` | {kind_of(entry['additionalProperties'])} | |\n")
    return rows


def command_tables(schema, name):
    """The page of a command: its options by heading, daily ones first."""
    definition = schema["$defs"][name]
    first, _, rest = definition["description"].partition("\n")
    described = f"{first}\n\n```text\n{rest}\n```" if "   " in rest else cell(definition["description"])
    page = f"# mammoray {name}\n\n{described}\n\n```\n{definition['example'].removeprefix('Example: ')}\n```\n"
    sections = {}
    for option in all_options(schema, definition):
        heading = option.setting.get("group", "Options")
        if option.only_in_file:
            heading = "Settings of the case file"
        elif option.setting["shown"] == "--help-all":
            heading += ", shown by --help-all"
        sections.setdefault(heading, []).append(row(option))
    for heading, rows in sections.items():
        page += f"\n## {heading}\n\n| option | value | default | meaning |\n|---|---|---|---|\n" + "".join(rows)
    return page


def reference_pages(schema, results):
    """Text by name of the pages of the documentation, from the schemas of case files and of result files."""
    commands = commands_of(schema)
    pages = {f"{name}.md": command_tables(schema, name) for name, _ in commands}
    pages["index.md"] = (
        "# Commands\n\n`mammoray COMMAND --help` prints the options that are used daily, `--help-all` all of them. Exit code 0: done;\n"
        "1: refused or failed, with one line that says why; 2: wrong usage. Options may stand in a\n[case file](../case-files.md).\n\n"
        "| command | does |\n|---|---|\n"
        + "".join(f"| [{name}]({name}.md) | {cell(purpose(definition))} |\n" for name, definition in commands)
        + "\nKeys of scene files: [scene keys](scene-keys.md).\n\n```{toctree}\n:hidden:\n\n"
        + "".join(f"{name}\n" for name, _ in commands) + "scene-keys\nresult-keys\n```\n")
    pages["scene-keys.md"] = (
        "# Scene keys\n\nKeys of [scene files](../scene-files.md) and of `--set KEY=VALUE`. Limits of lengths are mm.\n\n"
        "| key | value | default | meaning | option of project |\n|---|---|---|---|---|\n"
        + "".join(scene_rows(schema["$defs"].get("scene", {"properties": {}}))))
    pages["result-keys.md"] = "# Result keys\n\nFields of [result files](../result-file.md). Lengths are mm, angles degrees.\n" + "".join(
        f"\n## {heading}\n\n| field | type | meaning |\n|---|---|---|\n" + "".join(result_rows(results["$defs"].get(name, {"properties": {}})))
        for heading, name in (("One mammogram", "mammogram"), ("Several mammograms", "joint")))
    return {name: "<!-- Made by Applications/mammoray/writeReference.py from the schemas in Data. -->\n\n" + text for name, text in pages.items()}


def main():
    program, *words = sys.argv[1:]

    def printed(option):
        return subprocess.run([program, option], check=True, capture_output=True, text=True).stdout

    text = printed("--print-schema")
    schema = json.loads(text)
    if words[0] == "--update":
        root = pathlib.Path(words[1])
        (root / "Data/case.schema.json").write_text(text)
        folder = root / "docs/reference/commands"
        folder.mkdir(parents=True, exist_ok=True)
        pages = reference_pages(schema, json.loads((root / "Data/result.schema.json").read_text()))
        for path in folder.glob("*.md"):
            if path.name not in pages:
                path.unlink()
        for name, page in pages.items():
            (folder / name).write_text(page)
        return
    folder = pathlib.Path(words[0])
    pages = folder / "man1"
    pages.mkdir(parents=True, exist_ok=True)
    version = printed("--version").strip().replace("mammoray", "MammoRay")

    def write(name, page):
        (pages / f"{name}.1.gz").write_bytes(gzip.compress(page.encode(), mtime=0))

    write("mammoray", program_page(schema, version))
    for name, _ in commands_of(schema):
        write(f"mammoray-{name}", command_page(schema, name, version))
    (folder / "completion").write_text(completion(schema))


if __name__ == "__main__":
    main()
