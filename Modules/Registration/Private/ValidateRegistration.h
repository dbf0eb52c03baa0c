// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ValidateRegistration_h
#define mammoray_ValidateRegistration_h

#include "RegistrationModel.h"
#include "RegistrationResiduals.h"

namespace mammoray
{
/// Throws InputError unless a search can begin with these.
void ValidateRegistration(const RegistrationModel& model, const RegistrationOptions& options);
}

#endif
