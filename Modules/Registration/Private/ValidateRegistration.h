// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ValidateRegistration_h
#define mammoray_ValidateRegistration_h

#include "mammoray/Registration/RegistrationProblem.h"

namespace mammoray
{
/// Throws InputError unless a search can begin with this problem.
void ValidateProblem(const RegistrationProblem& problem);
}

#endif
