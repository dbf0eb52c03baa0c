#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints what mammoray-validate measured as Markdown tables; several files are joined.

usage: tables.py FILE.json ... [--runs RUNS.csv] [--curve TRUST.svg]

--runs   a row for each twin
--curve  the share of right results that pass a limit of their tissue correlation against that of wrong ones (a
         receiver operating characteristic); the ending names the format
"""
import argparse
import json
import sys

import numpy as np
import pandas as pd

CONVERGED_MM = 3  # A twin converges when the median error of its points is below this.
RIGHT_MM = 5      # A result is right when it is; a result of another breast is wrong.
MOST_WRONG = 0.02  # Share of wrong results that the limit which is chosen here may let pass.
RIGHT_KINDS = ("plain", "wrong-material", "wrong-start", "every-parameter")
UNITS = {"thickness": "mm", "roll": "deg", "pitch": "deg", "yaw": "deg", "lateral": "mm", "anterior": "mm", "vertical": "mm",
         "tilt": "deg"}
LISTS = ("twins", "landmarks", "mammograms", "studies")


def number(value):
    """The file has null for what is not a number."""
    return np.nan if value is None else value


def numbers(values):
    return np.array([number(value) for value in values], dtype=float)


def load(paths):
    """The runs of all files, by list; and the limits of tissue correlation of "doubtful" and "good"."""
    runs = {name: [] for name in LISTS}
    limits = None
    for path in paths:
        with open(path, encoding="utf-8") as file:
            data = json.load(file)
        for name in LISTS:
            runs[name] += data.get(name, [])
        limits = data.get("tissueCorrelationLimits", limits)
    return runs, limits


def markdown(header, rows):
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines) + "\n\n" if rows else ""


def percent(part, whole=1):
    return "%d %%" % np.floor(100 * part / whole + 0.5) if whole else "0 %"


def spread(values, most=1.0, form="%.2f (%.2f)"):
    """Median (largest, or the value that a part of them stays below); "-" of none."""
    values = np.asarray(values, dtype=float)
    return form % (np.median(values), np.quantile(values, most)) if len(values) else "-"


def spread_text(values):
    return "%.2f mm in the middle, 95 %% below %.2f mm" % (np.median(values), np.quantile(values, 0.95)) if len(values) else "-"


def joined(runs, *keys):
    """All numbers of a list that runs have at nested keys."""
    found = []
    for run in runs:
        for key in keys:
            run = run[key]
        found += run
    return numbers(found)


def landmark_tables(runs):
    text = ""
    for run in runs:
        text += markdown([run["name"] + ", imaged landmarks: median (largest) error, mm", "in 3D", "on the receptor"],
                         [[row["method"]] + ["%.2f (%.2f)" % (row[where]["median"], row[where]["largest"])
                                             for where in ("in3dMm", "onReceptorMm")] for row in run["rows"]])
        if run["glandDice"] is not None:
            text += "Gland overlap (Dice) %.2f, at rest %.2f. " % (run["glandDice"], run["glandDiceAtRest"])
        expected = run["expectedMedianMm"]
        text += "Trust: %s, expected: %s mm. %d iterations, %d equilibria, %.0f s.\n\n" % (
            run["trust"], "-" if expected is None else "%.2f" % expected, run["iterations"], run["equilibria"], run["seconds"])
    return text


def right_twins(twins):
    return [run for run in twins if run["search"] == "register" and run["kind"] in RIGHT_KINDS]


def parameters_of(twins):
    """Free parameters of all runs that found something: error, and whether it is within two standard deviations."""
    rows = []
    for run in twins:
        if run["medianErrorMm"] is not None:
            for name, truth, found, sigma in zip(run["parameters"], run["truth"], run["found"], run["sigma"]):
                if sigma is not None:
                    error = abs(found - truth)
                    rows.append((run["kind"], run["phantom"], name, error, error <= 2 * sigma))
    return pd.DataFrame(rows, columns=["kind", "phantom", "parameter", "error", "within"])


def twin_tables(twins):
    runs = pd.DataFrame(right_twins(twins))
    if runs.empty:
        return ""
    free = parameters_of(right_twins(twins))
    kinds = [kind for kind in RIGHT_KINDS if (runs["kind"] == kind).any()]
    rows = []
    for kind in kinds:
        phantoms = sorted(runs[runs["kind"] == kind]["phantom"].unique())
        for phantom in [*phantoms, "all"]:
            of = runs[(runs["kind"] == kind) & ((runs["phantom"] == phantom) | (phantom == "all"))]
            own = free[(free["kind"] == kind) & ((free["phantom"] == phantom) | (phantom == "all"))]
            found = of[of["medianErrorMm"].notna()]
            rows.append([kind, phantom, "" if phantom == "all" else of["modelCells"].max(), len(of), spread(found["medianErrorMm"]),
                         percent((found["medianErrorMm"] < CONVERGED_MM).sum(), len(of)), spread(found["iterations"], form="%.0f (%.0f)"),
                         "%.0f" % found["equilibria"].median(), "%.0f" % found["seconds"].median(), percent(own["within"].sum(), len(own))])
    text = markdown(["twins", "phantom", "cells", "runs", "3D error: median (largest), mm", "below 3 mm", "iterations, median (most)",
                     "equilibria", "time, s", "true values within 2 sigma"], rows)
    rows = []
    for name in free["parameter"].unique():
        cells = [free[(free["kind"] == kind) & (free["parameter"] == name)] for kind in kinds]
        rows.append([name + (", " + UNITS[name] if name in UNITS else "")] +
                    [spread(cell["error"]) + "; " + percent(cell["within"].mean()) if len(cell) else "-" for cell in cells])
    return text + markdown(["error: median (largest); true value within 2 sigma", *kinds], rows)


def seconds_to(run, cost, begin):
    """Time from `begin` until the cost is as low; NaN where it never is."""
    for seconds, reached in zip(run["iterationSeconds"], run["iterationCosts"]):
        if reached <= cost:
            return seconds - begin
    return np.nan


def search_table(twins):
    runs = {(run["phantom"], run["kind"], run["number"], run["search"]): run for run in twins}
    rows, ratios = [], []
    for exact in twins:
        if exact["search"] != "exact" or not exact["iterationCosts"]:
            continue
        # Equally low, except for terms that the search itself neglects. All searches have the same start.
        cost, begin = exact["iterationCosts"][-1] + 0.125, exact["iterationSeconds"][0]
        for search in ("exact", "central-differences", "annealing"):
            run = runs.get((exact["phantom"], exact["kind"], exact["number"], search))
            if run:
                seconds = seconds_to(run, cost, begin)
                rows.append([search, "%s, %d" % (run["phantom"], run["number"]), run["equilibria"], "%.1f" % run["seconds"],
                             "%.2f" % (run["iterationCosts"] or [np.nan])[-1], "never" if np.isnan(seconds) else "%.1f" % seconds,
                             "%.2f" % number(run["medianErrorMm"])])
                own = seconds_to(exact, cost, begin)
                if search == "central-differences" and own > 0 and not np.isnan(seconds):
                    ratios.append(seconds / own)
    text = markdown(["search", "phantom, twin", "equilibria", "time, s", "cost", "time to the exact search's cost, s (without the start)",
                     "3D error, mm"], rows)
    return text + ("Exact derivatives get there %.1f times as fast as differences (median).\n\n" % np.median(ratios) if ratios else "")


def mammogram_table(runs):
    rows = []
    for run in runs:
        if run["failure"]:
            rows.append([run["name"], "-", "-", "no result: " + run["failure"], "-"])
        else:
            rows.append([run["name"], "%.2f (%.2f)" % (run["meanOutlineDistanceMm"], run["largestOutlineDistanceMm"]),
                         "%.2f, %.2f" % (number(run["correlation"]), number(run["tissueCorrelation"])), run["trust"],
                         "%.0f" % run["seconds"]])
    return markdown(["real mammogram with another breast", "outline: mean (largest), mm", "correlation, of tissue",
                     "trust that the report claims", "time, s"], rows)


def views_of(studies):
    return [view for run in studies for view in run["views"]]


def study_tables(studies):
    if not studies:
        return ""
    rows = []
    for run in studies:
        row = ["%s, %d" % (run["phantom"], run["seed"]), "left" if run["laterality"] == "L" else "right"]
        views = {view["view"]: view for view in run["views"]}
        if run["failure"]:
            rows.append(row + ["no result: " + run["failure"], "", "", "", "", ""])
            continue
        both = [views[name] for name in ("CC", "MLO") if name in views]
        rows.append(row + [spread(views[name]["imaged"]["in3dMm"], 0.95) if name in views else "-" for name in ("CC", "MLO")] +
                    [spread(joined(both, "imaged", "onReceptorMm"), 0.95), spread(joined(both, "behind", "in3dMm"), 0.95),
                     ", ".join(view["trust"] for view in both), "%.0f" % run["seconds"]])
    done = [run for run in studies if not run["failure"]]
    views = views_of(studies)
    imaged, behind = joined(views, "imaged", "in3dMm"), joined(views, "behind", "in3dMm")
    text = markdown(["virtual study", "side", "CC, in 3D: median (95 %), mm", "MLO, in 3D", "on the receptor", "not imaged, in 3D",
                     "trust", "time, s"], rows)
    text += "All %d imaged points of %d studies: in 3D %s; on the receptor %s; those behind the receptor's edge (%d): %s. %s s in the " \
        "middle. %d without a result.\n\n" % (len(imaged), len(done), spread_text(imaged), spread_text(joined(views, "imaged", "onReceptorMm")),
                                             len(behind), spread_text(behind),
                                             "%.0f" % np.median([run["seconds"] for run in done]) if done else "-", len(studies) - len(done))
    known = [view for view in views if view["expectedMedianMm"] is not None and view["imaged"]["in3dMm"]]
    if known:
        ratios = [np.median(view["imaged"]["in3dMm"]) / view["expectedMedianMm"] for view in known]
        below = [np.mean(numbers(view["imaged"]["in3dMm"]) <= number(view["expected95Mm"])) for view in known]
        text += "Median error over what the result expects: %.2f in the middle of %d views (%.2f to %.2f); %.1f %% of the points lie within " \
            "what 95 %% are expected to.\n\n" % (np.median(ratios), len(known), min(ratios), max(ratios), 100 * np.mean(below))
    one = joined(studies, "oneViewMm")
    if len(one):
        text += "From the places of %d shadows back into the MRI: from CC alone (the middle of the tissue behind it) %s; from CC and MLO " \
            "%s.\n\n" % (len(one), spread_text(one), spread_text(joined(studies, "bothViewsMm")))
    return text + projection_table(studies)


def projection_table(studies):
    """Table of what a second mammogram, and projections of one compression, add to a CC."""
    swept = [run for run in studies if run["projections"]]
    rows = []
    for name, key in (("CC alone", "ccAlone"), ("CC with MLO", "views"), ("projections of the CC's compression", "projections")):
        views = [view for run in swept for view in run[key] if view["view"] == "CC"]
        rows.append([name] + [spread(joined(views, "imaged", what), 0.95) for what in ("in3dMm", "alongBeamMm", "onReceptorMm")] +
                    ["%.1f %%" % (100 * np.mean(numbers(view["coordinatesWithin"] for view in views))) if views else "-"])
    return markdown(["imaged points of %d studies' CC: median (95 %%), mm" % len(swept), "in 3D", "along the beam", "on the receptor",
                     "coordinates within 2 sigma"], rows) if swept else ""


def coverage_table(twins, studies):
    """How often the truth lies within two standard deviations, by anatomy."""
    twins = right_twins(twins)
    free = parameters_of(twins)

    def share(values):
        values = numbers(values)
        values = values[~np.isnan(values)]
        return "%.1f %% (%d)" % (100 * values.mean(), len(values)) if len(values) else "-"

    def needed(runs):
        """By what the model's own error must be multiplied for two deviations to hold 95 % of the coordinates."""
        values = joined(views_of(runs), "modelErrorNeeded")
        return "%.2f" % np.quantile(values, 0.95) if len(values) else "-"

    def left_out(phantom):
        """Coverage of an anatomy with the factor that the others need."""
        own, others = (joined(views_of([run for run in studies if (run["phantom"] == phantom) == of]), "modelErrorNeeded")
                       for of in (True, False))
        return share((own <= np.quantile(others, 0.95)).astype(float)) if len(own) and len(others) else "-"

    rows = []
    phantoms = sorted({run["phantom"] for run in twins + [run for run in studies if run["views"]]})
    for phantom in [*phantoms, "all"] if phantoms else []:
        def own(runs):
            return [run for run in runs if phantom in ("all", run["phantom"])]
        parameters = free[(free["phantom"] == phantom) | (phantom == "all")]["within"]
        rows.append([phantom, share(parameters.astype(float)), share(run["coordinatesWithin"] for run in own(twins)),
                     share(view["coordinatesWithin"] for view in views_of(own(studies))), needed(own(studies)), left_out(phantom)])
    text = markdown(["within 2 sigma", "parameters, twins", "points' coordinates, twins", "points' coordinates, studies",
                     "of studies 95 % with the model's own error times", "with what the other anatomies need"], rows)
    halves = [needed([run for run in studies if run["seed"] % 2 == odd]) for odd in (0, 1)]
    if "-" not in halves:
        text += "For 95 %%: the model's own error times %s by studies of even numbers, times %s by those of odd ones.\n\n" % tuple(halves)
    return text


def judged_results(runs):
    """All registrations: group, trust, error (NaN where nothing is known or right), number, tissue correlation (-1: refused)."""
    rows = []
    for run in runs["twins"]:
        if run["search"] == "register":
            rows.append(("twins" if run["kind"] in RIGHT_KINDS else run["kind"], run["trust"], run["medianErrorMm"], run["number"],
                         run["tissueCorrelation"]))
    for run in runs["studies"]:
        for view in run["views"]:
            errors = view["imaged"]["in3dMm"]
            rows.append(("virtual studies", view["trust"], np.median(errors) if errors else np.nan, run["seed"], view["tissueCorrelation"]))
    for index, run in enumerate(runs["mammograms"]):
        refused = bool(run["failure"])
        rows.append(("real mammograms, another breast", "none" if refused else run["trust"], np.nan, index,
                     np.nan if refused else run["tissueCorrelation"]))
    results = pd.DataFrame(rows, columns=["group", "trust", "error", "number", "score"])
    results = results.astype({"error": float, "score": float})
    results["score"] = results["score"].fillna(-1)
    results["right"] = results["error"] < RIGHT_MM
    results["odd"] = results["number"] % 2 == 1
    return results


def passed(results, right, odd, limit):
    """The share of right (wrong) results of the odd (even) numbers whose score reaches the limit."""
    of = results[(results["right"] == right) & (results["odd"] == odd)]["score"]
    return (of >= limit).mean() if len(of) else np.nan


def trust_tables(results, limits):
    rows = []
    for group in results["group"].unique():
        of = results[results["group"] == group]
        good = of[of["trust"] == "good"]
        rows.append([group, len(of), len(good), (of["trust"] == "doubtful").sum(), (~of["trust"].isin(["good", "doubtful"])).sum(),
                     spread(good["error"].dropna())])
    text = markdown(["trust", "results", "good", "doubtful", "none, or refused", "3D error of the good: median (largest), mm"], rows)
    if limits is None or not results["right"].any() or results["right"].all():
        return text

    def shares(limit, odd):
        text = [("%d %%" % np.floor(100 * share + 0.5)) if share == share else "-"
                for share in (passed(results, right, odd, limit) for right in (False, True))]
        return "%s of the wrong and %s of the right ones" % tuple(text)

    # The lowest limit, in hundredths, that lets few wrong ones of the even numbers pass.
    chosen = next((0.01 * step for step in range(100) if not passed(results, False, False, 0.01 * step) > MOST_WRONG), 1.0)
    return text + "Tissue correlation, %d right results (3D error below %d mm in the middle) and %d wrong ones (above, of another breast, " \
        "or refused). Limit of %.2f, chosen on even numbers: %s pass; of odd numbers %s. Limit of the report, %.2f: of even numbers %s, " \
        "of odd ones %s.\n\n" % (results["right"].sum(), RIGHT_MM, (~results["right"]).sum(), chosen, shares(chosen, False),
                                 shares(chosen, True), limits[1], shares(limits[1], False), shares(limits[1], True))


def curve_points(results, odd, limits=np.arange(1.01, -1.015, -0.01)):
    """Shares of wrong and of right results that pass each limit."""
    return [[passed(results, right, odd, limit) for limit in limits] for right in (False, True)]


def draw_curve(results, limits, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(figsize=(5, 5), layout="tight")
    for odd, colour, label in ((False, "0.6", "even numbers, by which limits are chosen"), (True, "tab:blue", "odd numbers")):
        axes.plot(*curve_points(results, odd), color=colour, label=label)
    for limit in limits or ():
        [x], [y] = curve_points(results, True, [limit])
        axes.plot(x, y, "o", color="tab:blue")
        axes.annotate("%.2f" % limit, (x, y), xytext=(8, -14), textcoords="offset points")
    axes.set(xlim=(0, 1), ylim=(0, 1), aspect="equal", xlabel="share of wrong results that pass", ylabel="share of right results that pass")
    axes.legend(loc="lower right", fontsize="small")
    figure.savefig(path)


def write_runs(twins, path):
    rows = []
    for run in twins:
        row = {name: run[name] for name in ("phantom", "kind", "search", "number")}
        row |= {"median_error_mm": run["medianErrorMm"], "largest_error_mm": run["largestErrorMm"], "outline_mm": run["meanOutlineDistanceMm"],
                "correlation": run["correlation"], "iterations": run["iterations"], "equilibria": run["equilibria"],
                "seconds": run["seconds"], "converged": int(run["converged"])}
        for name, *values in zip(run["parameters"], run["truth"], run["start"], run["found"], run["sigma"]):
            row |= {name + "_" + what: value for what, value in zip(("truth", "start", "found", "sigma"), values)}
        rows.append(row)
    pd.DataFrame(rows).to_csv(path, index=False, float_format="%.5f")


def all_tables(runs, limits):
    results = judged_results(runs)
    return (landmark_tables(runs["landmarks"]) + twin_tables(runs["twins"]) + search_table(runs["twins"]) +
            mammogram_table(runs["mammograms"]) + study_tables(runs["studies"]) + coverage_table(runs["twins"], runs["studies"]) +
            trust_tables(results, limits))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", metavar="FILE.json")
    parser.add_argument("--runs", metavar="RUNS.csv")
    parser.add_argument("--curve", metavar="TRUST.svg")
    arguments = parser.parse_args()
    runs, limits = load(arguments.files)
    sys.stdout.write(all_tables(runs, limits))
    if arguments.runs:
        write_runs(runs["twins"], arguments.runs)
    if arguments.curve:
        draw_curve(judged_results(runs), limits, arguments.curve)


if __name__ == "__main__":
    main()
