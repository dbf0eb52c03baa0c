#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints what benchmarkProjection measured as Markdown tables.

usage: projectionTables.py REPORT.json [--plot RATES.svg]

--plot   draws frames per second against pixels and triangles; needs matplotlib, the tables do not
"""
import argparse
import html
import json

# Published with the examples (Maul et al. 2021, RTX 2070 Super): milliseconds per image with set-up and transfer, and
# rendering only.
PUBLISHED = {"test": (310, 0.9), "boxes": (310, 1.4), "veins": (860, 4.1), "breast": (760, 25)}


def cell(row, path, form):
    """A measured value at a path of keys; "-" if it was not measured."""
    for key in path.split("/"):
        if key not in row:
            return "-"
        row = row[key]
    return form % row


def begin(row):
    return [row["example"], row["method"]]


def pixels(row):
    return "%dx%d" % (row["columns"], row["rows"])


def case_table(report):
    columns = {
        "frame, ms": ("frame/medianMs", "%.1f"), "Embree, ms": ("embreeFrame/medianMs", "%.1f"), "ratio": ("embreeRatio", "%.2f"),
        "largest difference, mm": ("embreeLargestDifferenceMm", "%.0e"), "process to disk, ms": ("coldStartMs", "%.0f"),
        "refit / build": ("refitRatio", "%.2f"), "bytes / triangle (with image)": ("bytesPerTriangle", "%.0f"),
        "3 materials / 1": ("threeMaterialsRatio", "%.2f"), "100 energies / 1": ("hundredEnergiesRatio", "%.2f"),
        "the same on the device": ("hundredEnergiesOnDeviceRatio", "%.2f"), "8 derivatives / none": ("eightDerivativesRatio", "%.2f"),
        "gradient of all points / frame": ("gradientRatio", "%.2f"),
        "holes seen": ("inconsistent", "%.0f")}
    rows = [begin(row) + [row["triangles"], pixels(row)] +
            ([row["error"]] if "error" in row else [cell(row, *column) for column in columns.values()]) for row in report["results"]]
    return "The four examples", ["example", "method", "triangles", "pixels", *columns], rows


def unit_table(report):
    columns = {"heel's field": "openField", "scatter and grid": "scatterAndGrid", "noise and blur": "noiseAndBlur", "all of these": "unit",
               "refraction, geometric": "refractionGeometric", "near field": "refractionNearField"}
    rows = [begin(row) + [pixels(row), cell(row, "unit/plain/medianMs", "%.0f")] +
            ["%s (%s)" % (cell(row, "unit/" + work + "/medianMs", "%.0f"), cell(row, "unit/" + work + "/ratio", "%.2f"))
             for work in columns.values()] for row in report["results"] if "unit" in row]
    return "What a unit adds to a picture, and refraction", ["example", "method", "pixels", "plain, ms", *columns], rows


def published_table(report):
    rows = []
    for row in report["results"]:
        if row["example"] in PUBLISHED and "error" not in row:
            set_up, render = PUBLISHED[row["example"]]
            rows.append(begin(row) + ["%.0f" % set_up, cell(row, "coldStartMs", "%.0f"), "%.1f" % render] +
                        [cell(row, work + "/medianMs", "%.1f") for work in ("render", "picture", "frame")])
    return ("The paper's table 1 (RTX 2070 Super) beside this machine",
            ["example", "method", "published, with set-up, ms", "here, process to disk, ms", "published, rendering only, ms",
             "here, rendering only, ms", "and one picture on the host, ms", "or all path lengths, ms"], rows)


def rates(point):
    """Frames per second with set-up, and rendering only."""
    return 1e3 / point["setUpAndFrameMs"], 1e3 / point["frame"]["medianMs"]


def rate_table(report):
    rows = [[sweep["method"], point["triangles"], pixels(point)] + ["%.1f" % rate for rate in rates(point)]
            for sweep in report["rates"] for kind in ("resolution", "triangles") for point in sweep[kind]]
    return ("Frames per second (the paper's figure 5)",
            ["method", "triangles", "pixels", "frames per second, with set-up", "rendering only"], rows)


def markdown(table):
    _, header, rows = table
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines) + "\n\n" if rows else ""


def page_table(table):
    """The table in HTML; the last cell of a shorter row spans the rest."""
    caption, header, rows = table
    text = "<h2>%s</h2>\n<table>\n<tr>%s</tr>\n" % (html.escape(caption), "".join("<th>%s</th>" % html.escape(name) for name in header))
    for row in rows:
        spans = [""] * (len(row) - 1) + [" colspan='%d'" % (len(header) - len(row) + 1) if len(row) < len(header) else ""]
        text += "<tr>" + "".join("<td%s>%s</td>" % (span, html.escape(str(value))) for span, value in zip(spans, row)) + "</tr>\n"
    return text + "</table>\n"


def draw_rates(report, file, form=None):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(1, 2, figsize=(10, 4), sharey=True, layout="tight")
    for sweep in report["rates"]:
        for panel, kind in zip(axes, ("resolution", "triangles")):
            sizes = [point["columns"] * point["rows"] if kind == "resolution" else point["triangles"] for point in sweep[kind]]
            for index, style in ((1, "o-"), (0, "o--")):
                line, = panel.plot(sizes, [rates(point)[index] for point in sweep[kind]], style, markersize=3,
                                   color=None if index else line.get_color(),
                                   label=sweep["method"] + (", rendering only" if index else ", with set-up"))
    for panel, label in zip(axes, ("pixels", "triangles")):
        panel.set(xscale="log", yscale="log", xlabel=label)
        panel.grid(True, color="0.9")
    axes[0].set_ylabel("frames per second")
    axes[0].legend(fontsize="small")
    figure.savefig(file, format=form)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("report", metavar="REPORT.json")
    parser.add_argument("--plot", metavar="RATES.svg")
    arguments = parser.parse_args()
    with open(arguments.report, encoding="utf-8") as file:
        report = json.load(file)
    print("".join(markdown(table(report)) for table in (case_table, unit_table, published_table, rate_table)), end="")
    if arguments.plot:
        draw_rates(report, arguments.plot)


if __name__ == "__main__":
    main()
