// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CompressionInternals_h
#define mammoray_CompressionInternals_h

#include "CompressionSimulation.h"
#include "EquilibriumSolver.h"

namespace mammoray
{
struct CompressionSimulation::Internals
{
  ElasticBody Body;
  std::vector<bool> Fixed;
  CompressionOptions Options;
  EquilibriumSolver Solver;
  /// Goes most of the way for a cold start at a small part of the price; empty: none.
  std::unique_ptr<CompressionSimulation> Coarse;
  /// The nodes of the body in `Coarse`.
  std::unique_ptr<Embedding> InCoarse;

  Internals(ElasticBody body, const std::vector<bool>& fixed, const CompressionOptions& options)
    : Body(std::move(body))
    , Fixed(fixed)
    , Options(options)
    , Solver(Body, fixed, options.ContactStiffness)
  {
  }
};
}

#endif
