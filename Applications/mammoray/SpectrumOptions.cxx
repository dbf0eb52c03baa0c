// SPDX-License-Identifier: Apache-2.0
#include "SpectrumOptions.h"

#include "SharedOptions.h"
#include "mammoray/Foundation/Error.h"

namespace mammoray
{
namespace
{
CLI::Option* DeclareFilters(const OptionList& add, const std::string& name,
  std::vector<std::string>& filters, const std::string& help)
{
  return add(name, filters, help)->type_name("MATERIAL:MM")->allow_extra_args(false);
}
}

void DeclareResponse(const OptionList& add, SceneResponse& response)
{
  add.Choice<bool>("--response", response.ByEnergy, { { "energy", true }, { "counting", false } },
    "what the detector adds up: energy, or photons by counting");
  add("--scintillator", response.Scintillator,
    "the same of the photons alone that a layer of the detector absorbs\n('CsI@4.51:0.15', "
    "'Se@4.3:0.2')")
    ->type_name("MATERIAL[@DENSITY]:MM");
  add.Input("--response-table", response.Table,
    "instead, what it adds up of a photon by its energy: lines of keV,signal");
}

void DeclareSpectrum(const OptionList& add, SceneBeam& beam)
{
  const OptionList beamOptions = add.Group("Beam");
  beamOptions(Shared::Spectrum, beam.Spectrum);
  beamOptions(Shared::Energy, beam.EnergyKeV);
  beamOptions.Word("--tube", beam.Anode, { "W", "Mo", "Rh" },
    "instead, a tube with this anode\n(and a beryllium window, 18 to 42 kV; Boone, Fewell and "
    "Jennings 1997)");
  beamOptions("--kvp", beam.KilovoltagePeak, Between(18, 42, "kV"), "voltage of --tube");
  DeclareFilters(beamOptions, "--filter", beam.Filters,
    "a layer that all photons pass, once for each\n(MATERIAL[@DENSITY]:MM of an element, a formula "
    "or a NIST compound, 'Air, Dry (near sea level):600')");
}

void DeclareDualEnergy(const OptionList& add, DualEnergyArguments& arguments)
{
  const OptionList dual = add.Group("Dual energy").Expert();
  dual("--iodine", arguments.Iodine,
    "iodine that a material has taken up, for contrast-enhanced pictures")
    ->type_name("MATERIAL=MG_PER_ML")
    ->allow_extra_args(false);
  dual.Input("--high-spectrum", arguments.Spectrum,
    "a second exposure with this spectrum\n(--output becomes its -ln I/I0 less a multiple of the "
    "first's by which --cancel look the same; NAME_low and NAME_high beside it are the two "
    "exposures)");
  dual("--high-kev", arguments.EnergyKeV, Positive("keV"), "the same with a single photon energy");
  dual("--high-kvp", arguments.KilovoltagePeak, Between(18, 42, "kV"),
    "the same with the anode of --tube at this voltage");
  DeclareFilters(dual, "--high-filter", arguments.Filters,
    "of the second exposure, in place of --filter");
  dual("--cancel", arguments.Cancel, "the two materials (default: fat gland)")
    ->type_name("MATERIAL MATERIAL")
    ->expected(2);
  dual("--cancel-thickness", arguments.ThicknessMm, Positive("mm"),
    "slabs of them as thick as this look the same");
}

Spectrum ToHighSpectrum(const DualEnergyArguments& arguments, const SceneBeam& low)
{
  SceneBeam high{ .EnergyKeV = arguments.EnergyKeV,
    .Spectrum = arguments.Spectrum,
    .Filters = arguments.Filters };
  if (arguments.KilovoltagePeak)
  {
    high.Anode = low.Anode;
    high.KilovoltagePeak = *arguments.KilovoltagePeak;
    if (high.Anode.empty())
    {
      throw InputError("--high-kvp: expected --tube beside it, found none");
    }
  }
  return FindSpectrum(high);
}

void CheckDualEnergy(const DualEnergyArguments& arguments)
{
  const int ways = (arguments.Spectrum.empty() ? 0 : 1) + (arguments.EnergyKeV ? 1 : 0) +
    (arguments.KilovoltagePeak ? 1 : 0);
  if (ways > 1)
  {
    throw InputError("dual energy: expected one of --high-spectrum, --high-kev and --high-kvp, "
                     "found several");
  }
  if (ways == 0 && (!arguments.Cancel.empty() || !arguments.Filters.empty()))
  {
    throw InputError("dual energy: expected --high-spectrum, --high-kev or --high-kvp beside "
                     "--cancel and --high-filter, found none");
  }
}
}
