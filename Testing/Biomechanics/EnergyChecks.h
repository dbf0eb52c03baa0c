// SPDX-License-Identifier: Apache-2.0
// The pieces of an energy, and checks of their derivatives.
#ifndef mammoray_Testing_EnergyChecks_h
#define mammoray_Testing_EnergyChecks_h

#include "mammoray/Biomechanics/Private/Energy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace mammoray::test
{
/// PieceTerms with memory of their own.
struct PieceResult
{
  bool Valid = false;
  double Value = 0;
  std::vector<double> Gradient;
  std::vector<double> Hessian;
  PositionMeasures Measures;
};

inline PieceResult EvaluatePiece(const Energy& energy, std::size_t piece,
  const std::vector<double>& x, EnergyOrder order)
{
  const std::size_t size = 3 * energy.NodesOf(piece).size();
  PieceResult result;
  result.Gradient.assign(order >= EnergyOrder::Gradient ? size : 0, 0.0);
  result.Hessian.assign(order >= EnergyOrder::Hessian ? size * size : 0, 0.0);
  PieceTerms terms;
  terms.Gradient = result.Gradient;
  terms.Hessian = result.Hessian;
  result.Valid = energy.Add(piece, x, order, terms);
  result.Value = terms.Value;
  result.Measures = terms.Measures;
  return result;
}

inline double Value(const Energy& energy, const std::vector<double>& x)
{
  double value = 0;
  for (std::size_t piece = 0; piece < energy.NumberOfPieces(); ++piece)
  {
    const PieceResult result = EvaluatePiece(energy, piece, x, EnergyOrder::Value);
    EXPECT_TRUE(result.Valid);
    value += result.Value;
  }
  return value;
}

/// Largest errors of the derivatives of the pieces against central differences over `h` mm, and the
/// largest derivatives.
struct DerivativeErrors
{
  double Gradient = 0;
  double GradientSize = 0;
  double Hessian = 0;
  double HessianSize = 0;
  /// Over all pieces.
  PositionMeasures Measures;
};

inline DerivativeErrors FindDerivativeErrors(const Energy& energy, const std::vector<double>& x,
  double h)
{
  DerivativeErrors errors;
  std::vector<double> moved = x;
  for (std::size_t piece = 0; piece < energy.NumberOfPieces(); ++piece)
  {
    const PieceResult at = EvaluatePiece(energy, piece, x, EnergyOrder::Hessian);
    EXPECT_TRUE(at.Valid);
    errors.Measures.Add(at.Measures);
    const std::size_t size = at.Gradient.size();
    for (std::size_t c = 0; c < size; ++c)
    {
      const std::size_t coordinate =
        3 * static_cast<std::size_t>(energy.NodesOf(piece)[c / 3]) + c % 3;
      moved[coordinate] = x[coordinate] - h;
      const PieceResult low = EvaluatePiece(energy, piece, moved, EnergyOrder::Gradient);
      moved[coordinate] = x[coordinate] + h;
      const PieceResult high = EvaluatePiece(energy, piece, moved, EnergyOrder::Gradient);
      moved[coordinate] = x[coordinate];
      EXPECT_TRUE(low.Valid && high.Valid);
      const double slope = (high.Value - low.Value) / (2 * h);
      errors.Gradient = std::max(errors.Gradient, std::abs(slope - at.Gradient[c]));
      errors.GradientSize = std::max(errors.GradientSize, std::abs(slope));
      for (std::size_t r = 0; r < size; ++r)
      {
        const double curvature = (high.Gradient[r] - low.Gradient[r]) / (2 * h);
        errors.Hessian = std::max(errors.Hessian, std::abs(curvature - at.Hessian[size * c + r]));
        errors.HessianSize = std::max(errors.HessianSize, std::abs(curvature));
      }
    }
    for (std::size_t c = 0; c < size; ++c)
    {
      for (std::size_t r = 0; r < c; ++r)
      {
        EXPECT_NEAR(at.Hessian[size * c + r], at.Hessian[size * r + c],
          1e-14 * errors.HessianSize + 1e-15 * std::abs(at.Hessian[size * c + r]));
      }
    }
  }
  return errors;
}
}

#endif
