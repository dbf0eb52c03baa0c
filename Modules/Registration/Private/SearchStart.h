// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SearchStart_h
#define mammoray_SearchStart_h

#include "Private/SearchState.h"

#include <memory>
#include <vector>

namespace mammoray
{
/// Opens a start of less than LeastShareOfHeight of the breast's height, with a warning: a breast
/// is compressed to about a half, and less belongs to another breast and costs minutes to fail.
void OpenToLeastHeight(ViewSearch& search);
inline constexpr double LeastShareOfHeight = 0.4;

/// Equilibrium at the result's values, counted and timed; from `near` (null: cold) where that is
/// not too far. Throws ConvergenceError and Interrupted.
std::shared_ptr<PosedBreast> CompressForStart(const SearchedBreast& breast,
  const std::vector<double>& values, const PosedBreast* near, ViewResult& result,
  const ProgressCallback& progress);

/// The breast itself where the predictor's Current stands for it, into Current; counted, timed and
/// thrown as above. A cold start may find another equilibrium than the one that was searched with.
void AdoptPredicted(ViewSearch& search, const ProgressCallback& progress);

/// Compresses `breast` cold where Current, an equilibrium of it, is: of the two the one whose
/// picture matches `target` better goes into Current, and how far they are apart into the result.
void ChooseEquilibrium(const SearchedBreast& breast, const RegistrationTarget& target,
  const RegistrationOptions& options, ViewSearch& search, const ProgressCallback& progress);

/// The equilibrium at the result's values into Current; opened, with a warning, where there is
/// none.
void CompressStart(ViewSearch& search, const ProgressCallback& progress);

/**
 * Moves Current, an equilibrium of `breast`, to the best beginning of a search: of the start and
 * others with the roll beside it, the one whose picture matches `target` best where the outlines
 * meet. A picture changes little with the roll and has more than one valley. To compare them, the
 * compressed breast is moved to its outline as it is; only the best is compressed again there.
 */
void ChooseStart(const SearchedBreast& breast, const RegistrationTarget& target,
  const RegistrationOptions& options, ViewSearch& search, const ProgressCallback& progress);
}

#endif
