// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ValidateRegistration_h
#define mammoray_ValidateRegistration_h

#include "mammoray/Registration/Registration.h"

namespace mammoray
{
/// Throw InputError unless a search can begin with these, of one mammogram or of several.
void ValidateMammograms(const std::vector<JointMammogram>& mammograms,
  const RegistrationOptions& options);
void ValidateRegistration(const BreastModel& model, const RegistrationOptions& options);
}

#endif
