// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SpectrumOptions_h
#define mammoray_SpectrumOptions_h

#include "OptionList.h"
#include "mammoray/XRay/Tube.h"

#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// The X-rays of 'mammoray project'.
struct SpectrumArguments
{
  std::string Spectrum = "W28kVp_Rh50um_Be1mm";
  /// In place of the spectrum.
  std::optional<double> EnergyKeV;
  std::string Anode;
  XRayTube Tube;
  std::vector<std::string> Filters;
};

/// What the detector makes of photons.
struct ResponseArguments
{
  DetectorResponse Response = DetectorResponse::EnergyIntegrating;
  std::string Table;
  std::string Layer;
};

void DeclareResponse(const OptionList& add, ResponseArguments& arguments);
DetectorResponse ToResponse(const ResponseArguments& arguments);

void DeclareSpectrum(const OptionList& add, SpectrumArguments& arguments);

/// The spectrum that the options ask for, behind its filters.
Spectrum ToSpectrum(const SpectrumArguments& arguments);

/// A second exposure at higher energy, and what the two are recombined to.
struct DualEnergyArguments
{
  std::string Spectrum;
  std::optional<double> EnergyKeV;
  std::optional<double> KilovoltagePeak;
  std::vector<std::string> Filters;
  std::vector<std::string> Cancel;
  double ThicknessMm = 50;
  /// MATERIAL=MG_PER_ML each.
  std::vector<std::string> Iodine;

  bool IsAsked() const
  {
    return !this->Spectrum.empty() || this->EnergyKeV || this->KilovoltagePeak;
  }
};

void DeclareDualEnergy(const OptionList& add, DualEnergyArguments& arguments);

/// The spectrum of higher energy; `low` has the anode.
Spectrum ToHighSpectrum(const DualEnergyArguments& arguments, const SpectrumArguments& low);

/// Refuses what does not go together.
void CheckDualEnergy(const DualEnergyArguments& arguments);
}

#endif
