// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SearchStart_h
#define mammoray_SearchStart_h

#include "Private/SearchState.h"

#include <memory>
#include <vector>

namespace mammoray
{
/// Raises a start below LeastShareOfHeight of the breast's height, with a warning. Breasts are
/// compressed to about a half; a thinner start belongs to another breast and takes minutes to fail.
void OpenToLeastHeight(ViewSearch& search);
inline constexpr double LeastShareOfHeight = 0.4;

/// Solves for the equilibrium at the result's values, counted and timed, starting from `near`
/// unless that is null or too far away. Throws ConvergenceError and Interrupted.
std::shared_ptr<PosedBreast> CompressForStart(const SearchedBreast& breast,
  const std::vector<double>& values, const PosedBreast* near, ViewResult& result,
  const ProgressCallback& progress);

/// Replaces Current, a state of the predictor, by the corresponding equilibrium of the breast
/// itself; counted and timed, and throws as above. A cold start might find another equilibrium.
void AdoptPredicted(ViewSearch& search, const ProgressCallback& progress);

/// Solves for the equilibrium at the pose of Current from the undeformed shape. Of the two, Current
/// becomes the one whose picture matches `target` better; their distance goes into the result.
void ChooseEquilibrium(const SearchedBreast& breast, const RegistrationTarget& target,
  const RegistrationOptions& options, ViewSearch& search, const ProgressCallback& progress);

/// Sets Current to the equilibrium at the result's values; opens the plates, with a warning, if
/// there is none.
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
