// SPDX-License-Identifier: Apache-2.0
// Places that a case asks for, from the input files to the report.
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

/// Keeps the registered volume in the result if the case asks for places. Throws InputError if the
/// point, or half of a lesion, lies outside of its tissue: hours before the search could tell.
void CheckAsked(const RegistrationCase& input, const LabelVolume& tissue,
  RegistrationCaseResult& result);

/// The places that the case asks for, the point first, with slices through each.
std::vector<AskedPlace> AskedOf(const RegistrationCase& input,
  const RegistrationCaseResult& result);

/// The breast of one mammogram. `file`: the contents of its result file.
RegisteredBreast BreastOf(const RegistrationCaseResult& result, const RegisteredView& registered,
  const ResultFile& file);

/// Where one mammogram shows the places; `breast`: its BreastOf. A place that is not found says
/// why. Throws DeviceError.
std::vector<PlaceInMammogram> PlacesIn(const RegistrationCase& input,
  const RegistrationCaseResult& result, const std::vector<AskedPlace>& asked,
  const RegisteredBreast& breast);

/// Picture of the breast between the plates, with the places.
LayeredPicture PictureBetweenPlates(const RegistrationCaseResult& result,
  const RegisteredView& registered, const std::vector<AskedPlace>& asked,
  const RegisteredBreast& registeredBreast);
}

#endif
