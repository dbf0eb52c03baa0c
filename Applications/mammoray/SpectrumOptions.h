// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SpectrumOptions_h
#define mammoray_SpectrumOptions_h

#include "OptionList.h"
#include "mammoray/IO/SceneIO.h"

#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
void DeclareResponse(const OptionList& add, SceneResponse& response);
void DeclareSpectrum(const OptionList& add, SceneBeam& beam);

/// A second exposure at higher energy, and how the two are recombined.
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
Spectrum ToHighSpectrum(const DualEnergyArguments& arguments, const SceneBeam& low);

/// Throws InputError on options that contradict each other.
void CheckDualEnergy(const DualEnergyArguments& arguments);
}

#endif
