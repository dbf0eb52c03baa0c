# SPDX-License-Identifier: Apache-2.0
"""Tables of made-up runs, whose figures are counted by hand. Exit 125: no pandas or matplotlib."""
import copy
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import matplotlib  # noqa: F401
    import pandas  # noqa: F401
except ImportError as error:
    print(error)
    sys.exit(125)
SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "Validation" / "tables.py"
sys.path.insert(0, str(SCRIPT.parent))
import tables  # noqa: E402


def twin(phantom="a", kind="plain", search="register", number=0, error=1.0, thickness_error=0.0, **changes):
    """Found thickness and roll with these errors; standard deviations 1, pitch fixed."""
    return dict({
        "phantom": phantom, "kind": kind, "search": search, "number": number, "modelCells": 3000,
        "parameters": ["thickness", "roll", "pitch"], "truth": [50, 10, 0], "start": [52, 0, 0],
        "found": [50 + thickness_error, 10.5, 0], "sigma": [1, 1, None], "medianErrorMm": error,
        "largestErrorMm": None if error is None else 2 * error, "coordinatesWithin": 0.97, "meanOutlineDistanceMm": 0.5, "correlation": 0.95,
        "tissueCorrelation": 0.9, "trust": "good", "iterations": 12, "equilibria": 20, "seconds": 8, "iterationSeconds": [1, 3, 5],
        "iterationCosts": [100, 20, 10], "converged": True}, **changes)


def study(phantom="ball", seed=4, errors=(1, 2, 6), needed=(0, 0.5, 1)):
    """Both views with these errors, on the receptor half of them, and a point of 20 mm that is not imaged."""
    views = [{"view": name, "imaged": {"in3dMm": list(errors), "onReceptorMm": [0.5 * e for e in errors], "alongBeamMm": [0.25 * e for e in errors]},
              "behind": {"in3dMm": [20], "onReceptorMm": [10], "alongBeamMm": [5]}, "coordinatesWithin": 0.94, "modelErrorNeeded": list(needed),
              "tissueCorrelation": 0.8, "expectedMedianMm": 2, "expected95Mm": 5, "trust": "good"} for name in ("CC", "MLO")]
    return {"phantom": phantom, "seed": seed, "laterality": "R", "views": views, "ccAlone": [], "projections": [],
            "oneViewMm": [10, 12, 14], "bothViewsMm": [1, 3, 2], "seconds": 75, "failure": ""}


def failed_study(phantom, seed):
    return {"phantom": phantom, "seed": seed, "laterality": "L", "views": [], "ccAlone": [], "projections": [], "oneViewMm": [], "bothViewsMm": [],
            "seconds": 0, "failure": "no breast"}


def mammogram(name, **changes):
    return dict({"name": name, "meanOutlineDistanceMm": 2.5, "largestOutlineDistanceMm": 7, "correlation": 0.8, "tissueCorrelation": 0.4,
                 "trust": "doubtful", "seconds": 12, "failure": ""}, **changes)


def cells(text, *begin):
    """The further cells of the one row that begins so."""
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("|")]
    [row] = [row[len(begin):] for row in rows if tuple(row[:len(begin)]) == begin]
    return row


class Tables(unittest.TestCase):
    def text(self, **lists):
        return tables.all_tables({name: lists.get(name, []) for name in tables.LISTS}, [0.35, 0.6])

    def test_nothing_gathered(self):
        self.assertEqual(self.text(), "")

    def test_twins_by_kind_and_phantom(self):
        text = self.text(twins=[twin("a", number=0, error=1, thickness_error=0.5), twin("a", number=1, error=2, thickness_error=-1.5),
                                twin("b", number=0, error=4, thickness_error=3)])
        # Thickness is within two deviations in both runs of a and not in that of b, roll is in all.
        self.assertEqual(cells(text, "plain", "a"), ["3000", "2", "1.50 (2.00)", "100 %", "12 (12)", "20", "8", "100 %"])
        self.assertEqual(cells(text, "plain", "b"), ["3000", "1", "4.00 (4.00)", "0 %", "12 (12)", "20", "8", "50 %"])
        self.assertEqual(cells(text, "plain", "all"), ["", "3", "2.00 (4.00)", "67 %", "12 (12)", "20", "8", "83 %"])
        self.assertEqual(cells(text, "thickness, mm"), ["1.50 (3.00); 67 %"])
        self.assertEqual(cells(text, "roll, deg"), ["0.50 (0.50); 100 %"])
        self.assertNotIn("pitch", text)  # fixed
        self.assertNotIn("wrong-start", text)

    def test_a_run_that_found_nothing_did_not_converge(self):
        failed = twin("a", number=1, error=None, parameters=[], truth=[], start=[], found=[], sigma=[], modelCells=0, iterationCosts=[])
        self.assertEqual(cells(self.text(twins=[twin("a"), failed]), "plain", "a")[:4], ["3000", "2", "1.00 (1.00)", "50 %"])

    def test_searches_to_the_cost_of_the_exact_one(self):
        text = self.text(twins=[twin(search="exact"), twin(search="central-differences", iterationSeconds=[1, 21, 41]),
                                twin(search="annealing", error=6, iterationCosts=[100, 50, 30])])
        # Cost 10 is reached 4 s after the start by the one, after 40 s by the next, never by the last.
        self.assertEqual(cells(text, "exact"), ["a, 0", "20", "8.0", "10.00", "4.0", "1.00"])
        self.assertEqual(cells(text, "central-differences"), ["a, 0", "20", "8.0", "10.00", "40.0", "1.00"])
        self.assertEqual(cells(text, "annealing"), ["a, 0", "20", "8.0", "30.00", "never", "6.00"])
        self.assertIn("10.0 times as fast", text)

    def test_landmarks_and_mammograms(self):
        def landmarks(name, in_3d, on_receptor, dice, trust, expected):
            return {"name": name, "rows": [{"method": "registered", "in3dMm": dict(zip(("median", "largest"), in_3d)),
                                            "onReceptorMm": dict(zip(("median", "largest"), on_receptor))}], "glandDice": dice,
                    "glandDiceAtRest": 0.25, "trust": trust, "expectedMedianMm": expected, "iterations": 14, "equilibria": 25, "seconds": 30}
        text = self.text(landmarks=[landmarks("ball, CC", (1.06, 2.5), (0.74, 1.42), 0.61, "good", 1.5)])
        self.assertEqual(cells(text, "registered"), ["1.06 (2.50)", "0.74 (1.42)"])
        self.assertIn("(Dice) 0.61, at rest 0.25. Trust: good, expected: 1.50 mm. 14 iterations, 25 equilibria, 30 s.", text)
        text = self.text(landmarks=[landmarks("ball, MLO", (2.06, 3.5), (1.74, 2.42), None, "none", None)])
        self.assertIn("\nTrust: none, expected: - mm. 14", text)
        text = self.text(mammograms=[mammogram("real"), mammogram("other", failure="no equilibrium")])
        self.assertEqual(cells(text, "real"), ["2.50 (7.00)", "0.80, 0.40", "doubtful", "12"])
        self.assertEqual(cells(text, "other"), ["-", "-", "no result: no equilibrium", "-"])
        # They are wrong pairs, whether registered or refused.
        self.assertEqual(cells(text, "real mammograms, another breast"), ["2", "0", "1", "1", "-"])

    def test_studies(self):
        text = self.text(studies=[study(), failed_study("cube", 5)])
        # 95 %: nine tenths of the way from the second of three to the last.
        self.assertEqual(cells(text, "ball, 4"), ["right", "2.00 (5.60)", "2.00 (5.60)", "1.00 (3.00)", "20.00 (20.00)", "good, good", "75"])
        self.assertEqual(cells(text, "cube, 5")[:2], ["left", "no result: no breast"])
        self.assertIn("6 imaged points of 1 studies: in 3D 2.00 mm", text)
        self.assertIn("edge (2): 20.00 mm", text)
        self.assertIn("1 without a result", text)
        self.assertIn("3 shadows", text)
        self.assertIn("12.00 mm in the middle, 95 % below 13.80 mm; from CC and MLO 2.00 mm", text)

    def test_trust_by_what_is_right_and_wrong(self):
        def pair(kind, number, tissue, trust):
            return twin(kind=kind, number=number, error=None, tissueCorrelation=tissue, trust=trust)
        twins = [twin(number=number, error=1 + number) for number in range(4)]
        twins[3].update(tissueCorrelation=0.5, trust="doubtful")
        twins += [pair("other-breast", 0, 0.45, "doubtful"), pair("other-breast", 1, 0.65, "good"), pair("half-picture", 0, None, "none")]
        text = self.text(twins=twins)
        self.assertEqual(cells(text, "twins", "4"), ["3", "1", "0", "2.00 (3.00)"])
        self.assertEqual(cells(text, "other-breast"), ["2", "1", "1", "0", "-"])
        self.assertEqual(cells(text, "half-picture"), ["1", "0", "0", "1", "-"])
        # 0.46 keeps the wrong ones of even numbers out, not that of number 1; of number 3 it is passed.
        self.assertIn("4 right results (3D error below 5 mm in the middle) and 3 wrong", text)
        self.assertIn("Limit of 0.46, chosen on even numbers: 0 % of the wrong and 100 % of the right ones pass; of odd numbers 100 % of the "
                      "wrong and 100 %", text)
        self.assertIn("of odd ones 100 % of the wrong and 50 % of the right ones.", text)
        # One of one is wrong and one of two right among odd numbers: the middle of the right edge.
        results = tables.judged_results({"twins": twins, "studies": [], "mammograms": []})
        self.assertEqual(tables.curve_points(results, True, [0.6]), [[1.0], [0.5]])
        [wrong, right] = tables.curve_points(results, False)
        self.assertEqual((wrong[0], right[0], wrong[-1], right[-1]), (0, 0, 1, 1))

    def test_how_often_the_truth_is_within_two_deviations(self):
        twins = [twin("a", thickness_error=0.5), twin("b", thickness_error=3, coordinatesWithin=0.87)]
        text = self.text(twins=twins, studies=[study("b")])
        self.assertEqual(cells(text, "a", "100.0 % (2)"), ["97.0 % (1)", "-", "-", "-"])
        self.assertEqual(cells(text, "b", "50.0 % (2)"), ["87.0 % (1)", "94.0 % (2)", "1.00", "-"])
        self.assertEqual(cells(text, "all", "75.0 % (4)"), ["92.0 % (2)", "94.0 % (2)", "1.00", "-"])
        self.assertNotIn("For 95 %", text)
        # 2 mm expected and found; two of three within the 5 mm of 95 %.
        self.assertIn("expects: 1.00 in the middle of 2 views (1.00 to 1.00); 66.7 % of", text)
        # An anatomy with what the other one needs: 1 holds one of its two coordinates, 2 both of the other's.
        text = self.text(studies=[study("a", needed=[0.5, 1]), study("b", needed=[0.8, 2])])
        self.assertEqual(cells(text, "a", "-")[-1], "100.0 % (4)")
        self.assertEqual(cells(text, "b", "-")[-1], "50.0 % (4)")
        # The other half of the numbers.
        text = self.text(twins=twins, studies=[study("b"), study("b", seed=5, needed=[2])])
        self.assertIn("times 1.00 by studies of even numbers, times 2.00", text)

    def test_what_projections_add_to_a_cc(self):
        run = study()
        self.assertNotIn("along the beam", self.text(studies=[run]))
        run["ccAlone"] = study(errors=(4, 8, 12))["views"][:1]
        run["projections"] = study(errors=(1, 1, 1))["views"][:1]
        text = self.text(studies=[run])
        self.assertEqual(cells(text, "CC alone"), ["8.00 (11.60)", "2.00 (2.90)", "4.00 (5.80)", "94.0 %"])
        self.assertEqual(cells(text, "CC with MLO")[:2], ["2.00 (5.60)", "0.50 (1.40)"])
        self.assertEqual(cells(text, "projections of the CC's compression")[:2], ["1.00 (1.00)", "0.25 (0.25)"])

    def test_the_script_joins_files_and_writes_runs_and_curve(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            wrong = twin(kind="other-side", number=1, error=None, sigma=[None] * 3)
            for file, run in (("a.json", twin(error=1.25, thickness_error=0.5)), ("b.json", wrong)):
                (folder / file).write_text(json.dumps({"twins": [run], "tissueCorrelationLimits": [0.35, 0.6]}))
            done = subprocess.run([sys.executable, SCRIPT, "a.json", "b.json", "--runs", "runs.csv", "--curve", "trust.svg"], cwd=folder,
                                  check=True, capture_output=True, text=True)
            self.assertEqual(cells(done.stdout, "other-side")[0], "1")
            runs = pandas.read_csv(folder / "runs.csv")
            self.assertEqual(len(runs), 2)
            self.assertEqual(list(runs.columns[:5]), ["phantom", "kind", "search", "number", "median_error_mm"])
            self.assertEqual(list(runs.loc[0, ["median_error_mm", "thickness_truth", "thickness_start", "thickness_found", "thickness_sigma"]]),
                             [1.25, 50, 52, 50.5, 1])
            self.assertIn("<svg", (folder / "trust.svg").read_text())


if __name__ == "__main__":
    unittest.main()
