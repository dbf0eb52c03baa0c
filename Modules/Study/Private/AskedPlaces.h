// SPDX-License-Identifier: Apache-2.0
// What a case is asked to find, from the question to what the report tells of it.
#ifndef mammoray_AskedPlaces_h
#define mammoray_AskedPlaces_h

#include "mammoray/Study/RegisteredBreast.h"
#include "mammoray/Study/RegistrationCase.h"
#include "mammoray/Study/RegistrationReport.h"

#include <vector>

namespace mammoray
{
/// Reads the case's lesions and image into its result. Throws InputError that names the file.
void ReadAsked(const RegistrationCase& input, RegistrationCaseResult& result);

/// Keeps the volume that is registered where something was asked for. Throws InputError where the
/// point, or half of a lesion, lies outside its tissue: hours before the search could tell.
void CheckAsked(const RegistrationCase& input, const LabelVolume& tissue,
  RegistrationCaseResult& result);

/// What was asked for, the point first, with slices through each.
std::vector<AskedPlace> AskedOf(const RegistrationCase& input,
  const RegistrationCaseResult& result);

/// The breast of one mammogram, whose result file is `file`, as its folder will hold it.
RegisteredBreast BreastOf(const RegistrationCaseResult& result, const RegisteredView& registered,
  const ResultFile& file);

/// Where one mammogram, whose breast is BreastOf, shows each of them. What cannot be found
/// there says so. Throws DeviceError.
std::vector<PlaceInMammogram> PlacesIn(const RegistrationCase& input,
  const RegistrationCaseResult& result, const std::vector<AskedPlace>& asked,
  const RegisteredBreast& breast);

/// The breast between the plates, with what was asked for.
LayeredPicture PictureBetweenPlates(const RegistrationCaseResult& result,
  const RegisteredView& registered, const std::vector<AskedPlace>& asked,
  const RegisteredBreast& registeredBreast);
}

#endif
