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
  CompressionOptions Options;
  EquilibriumSolver Solver;

  Internals(ElasticBody body, const std::vector<bool>& fixed, const CompressionOptions& options)
    : Body(std::move(body))
    , Options(options)
    , Solver(Body, fixed, options.ContactStiffness)
  {
  }
};
}

#endif
