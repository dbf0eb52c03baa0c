// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DetectedPicture_h
#define mammoray_DetectedPicture_h

#include "mammoray/Registration/BreastModel.h"

#include <vector>

namespace mammoray
{
/// -ln(I / I0) of each pixel, I being what comes through and, where the model has a scatter model,
/// what scatters. Negative beside the breast where it scatters.
std::vector<float> DetectedAttenuation(const BreastModel& model, const XRaySource& source,
  const XRayDetector& detector, const PathLengthImage& lengths);

/**
 * Its derivative with each field of `derivatives`, for the rays of source and detector, by pixel.
 * `lengths`, `attenuation`: the picture it is taken at. Exact where path lengths and
 * ScatterModel::Differentiate are.
 */
std::vector<std::vector<double>> DetectedRates(const BreastModel& model, const XRaySource& source,
  const XRayDetector& detector, const PathLengthImage& lengths,
  const std::vector<float>& attenuation, const PathLengthDerivatives& derivatives);
}

#endif
