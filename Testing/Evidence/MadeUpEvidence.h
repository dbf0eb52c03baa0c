// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Testing_MadeUpEvidence_h
#define mammoray_Testing_MadeUpEvidence_h

#include "mammoray/Evidence/RegistrationEvidence.h"

#include <limits>
#include <string>
#include <vector>

namespace mammoray::test
{
inline constexpr double Nothing = std::numeric_limits<double>::quiet_NaN();

/// A run that found thickness and roll with these errors; sigma 1 each, pitch fixed.
inline TwinRun MadeUpRun(const std::string& phantom, TwinKind kind, TwinSearch search, int number,
  double medianErrorMm, double thicknessErrorMm)
{
  TwinRun run;
  run.Phantom = phantom;
  run.Kind = NameOf(kind);
  run.Search = NameOf(search);
  run.Number = number;
  run.ModelCells = 3000;
  run.TargetCells = 20000;
  run.Names = { "thickness", "roll", "pitch" };
  run.Truth = { 50, 10, 0 };
  run.Start = { 52, 0, 0 };
  run.Found = { 50 + thicknessErrorMm, 10.5, 0 };
  run.Sigma = { 1, 1, Nothing };
  run.MedianErrorMm = medianErrorMm;
  run.LargestErrorMm = 2 * medianErrorMm;
  run.MeanOutlineMm = 0.5;
  run.Correlation = 0.95;
  run.TissueCorrelation = 0.9;
  run.CoordinatesWithin = 0.97;
  run.Trust = "good";
  run.Iterations = 12;
  run.Equilibria = 20;
  run.Seconds = 8;
  run.IterationSeconds = { 1, 3, 5 };
  run.IterationCosts = { 100, 20, 10 };
  run.Converged = true;
  run.StopReason = "converged";
  return run;
}

/// Of both views, each with these errors, on the receptor half of them, and a point of 20 mm that
/// is not imaged.
inline StudyRun MadeUpStudyRun(const std::string& phantom, std::uint32_t seed,
  const std::vector<double>& errorsMm)
{
  StudyRun run;
  run.Phantom = phantom;
  run.Seed = seed;
  run.Laterality = 'R';
  for (const char* view : { "CC", "MLO" })
  {
    StudyViewErrors& errors = run.Views.emplace_back();
    errors.View = view;
    errors.Imaged.InSpaceMm = errorsMm;
    for (const double error : errorsMm)
    {
      errors.Imaged.OnReceptorMm.push_back(0.5 * error);
      errors.Imaged.AlongBeamMm.push_back(0.25 * error);
    }
    errors.Behind = { { 20 }, { 10 }, { 5 } };
    errors.MeanOutlineMm = 0.5;
    errors.Correlation = 0.97;
    errors.TissueCorrelation = 0.8;
    errors.CoordinatesWithin = 0.94;
    errors.ModelErrorNeeded = { 0, 0.5, 1 };
    errors.ExpectedMedianMm = 2;
    errors.Expected95Mm = 5;
    errors.Trust = "good";
  }
  run.Together = { { 10, 12, 14 }, { 1, 3, 2 } };
  run.Seconds = 75;
  return run;
}
}

#endif
