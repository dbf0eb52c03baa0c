# SPDX-License-Identifier: Apache-2.0
"""Summarises a cohort: one table (CSV) and one page (HTML), the cases to look at first on top."""
import csv
import html
import json
import statistics

LEVELS = ["none", "doubtful", "good"]


def worst(case):
    """Refused ones first, then by trust, then by error where it is known."""
    trust = min((LEVELS.index(level) for level in case["trust"].values()), default=0)
    error = max((most for _, most in case["errorMm"].values()), default=0)
    return (case["state"] == "done", trust, -error, case["case"])


def quantile(values, share):
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))] if ordered else float("nan")


def rows_of(case):
    for view in case["trust"] or {"": ""}:
        median, most = case["errorMm"].get(view, ("", ""))
        yield [case["case"], case["study"], case["side"], case["state"], view, case["trust"].get(view, ""), median, most,
               case["seconds"], case["cpuSeconds"], case["memoryMiB"],
               "; ".join([case["why"]] * bool(case["why"]) + case.get("notes", []))]


HEADER = ["case", "study", "side", "state", "view", "trust", "error median mm", "error 95 % mm", "s", "CPU s", "MiB", "why, notes"]


def facts(cases):
    done = [c for c in cases if c["state"] == "done"]
    yield "cases", str(len(cases))
    yield "done, refused", f"{len(done)}, {len(cases) - len(done)}"
    levels = [level for c in done for level in c["trust"].values()]
    yield "views: trust good, doubtful, none", ", ".join(str(levels.count(level)) for level in reversed(LEVELS))
    for level in reversed(LEVELS):
        errors = [c["errorMm"][view][0] for c in done for view, found in c["trust"].items() if found == level and view in c["errorMm"]]
        if errors:
            yield (f"median error where trust is {level}, mm: in the middle, 95 %, views",
                   f"{statistics.median(errors):.2f}, {quantile(errors, 0.95):.2f}, {len(errors)}")
    if done:
        times = [c["seconds"] for c in done]
        yield "wall time of a case, s: in the middle, most", f"{statistics.median(times):.0f}, {max(times):.0f}"
        yield "CPU time of all, h", f"{sum(c['cpuSeconds'] for c in cases) / 3600:.2f}"
        yield "most memory, MiB", str(max(c["memoryMiB"] for c in done))


def write(records, table, page):
    cases = []
    for record in records:
        with open(record) as file:
            cases.append(json.load(file))
    cases.sort(key=worst)
    with open(table, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(HEADER)
        for case in cases:
            writer.writerows(rows_of(case))

    def line(cells, tag="td"):
        return "<tr>" + "".join(f"<{tag}>{html.escape(str(cell))}</{tag}>" for cell in cells) + "</tr>\n"

    with open(page, "w") as file:
        file.write("<!DOCTYPE html><html lang=en><meta charset=utf-8><title>Cohort</title><style>body{font:15px sans-serif;margin:2em}"
                   "table{border-collapse:collapse;margin:1em 0}td,th{border-bottom:1px solid #ccc;padding:.2em .7em;text-align:left}"
                   "</style><h1>Cohort</h1><table>\n")
        file.writelines(line(fact) for fact in facts(cases))
        file.write("</table><h2>Cases, those to look at first on top</h2><table>\n" + line(HEADER, "th"))
        for case in cases:
            for row in rows_of(case):
                text = line(row)
                if case["state"] == "done":
                    name = html.escape(case["case"])
                    text = text.replace(f"<td>{name}</td>", f'<td><a href="results/{name}/report.html">{name}</a></td>', 1)
                file.write(text)
        file.write("</table></html>\n")
