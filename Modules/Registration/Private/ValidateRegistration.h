// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ValidateRegistration_h
#define mammoray_ValidateRegistration_h

#include "mammoray/Registration/Registration.h"

namespace mammoray
{
/// Throw InputError unless a search can begin with these, of one mammogram or of several.
void ValidateViews(const std::vector<RegistrationView>& views, const RegistrationOptions& options);
void ValidateRegistration(const RegistrationModel& model, const RegistrationOptions& options);
}

#endif
