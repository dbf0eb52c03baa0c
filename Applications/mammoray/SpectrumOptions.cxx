// SPDX-License-Identifier: Apache-2.0
#include "SpectrumOptions.h"

#include "SharedOptions.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ShippedData.h"

namespace mammoray
{
namespace
{
CLI::Option* DeclareFilters(const OptionList& add, const std::string& name,
  std::vector<std::string>& filters, const std::string& help)
{
  return add(name, filters, help)->type_name("MATERIAL[@DENSITY]:MM")->allow_extra_args(false);
}
}

void DeclareResponse(const OptionList& add, ResponseArguments& arguments)
{
  add.Choice<DetectorResponse>("--response", arguments.Response,
    { { "energy", DetectorResponse::EnergyIntegrating },
      { "counting", DetectorResponse::PhotonCounting } },
    "what the detector adds up: energy, or photons by counting");
  add("--scintillator", arguments.Layer,
    "the same of the photons alone that a layer of the detector absorbs ('CsI@4.51:0.15', "
    "'Se@4.3:0.2')")
    ->type_name("MATERIAL[@DENSITY]:MM");
  add.Input("--response-table", arguments.Table,
    "instead, what it adds up of a photon by its energy: lines of keV, a comma and the signal");
}

DetectorResponse ToResponse(const ResponseArguments& arguments)
{
  if (!arguments.Table.empty())
  {
    if (!arguments.Layer.empty())
    {
      throw InputError("--response-table: expected no --scintillator beside it, found both");
    }
    return ReadDetectorResponse(arguments.Table);
  }
  DetectorResponse response = arguments.Response;
  if (!arguments.Layer.empty())
  {
    response = AbsorbingDetector(XRayFilter::FromText(arguments.Layer));
    response.ByEnergy = arguments.Response.ByEnergy;
  }
  return response;
}

void DeclareSpectrum(const OptionList& add, SpectrumArguments& arguments)
{
  AddSpectrumOption(add, arguments.Spectrum);
  add("--kev", arguments.EnergyKeV, Positive("keV"),
    "a single photon energy instead of a spectrum");
  add.Word("--tube", arguments.Anode, { "W", "Mo", "Rh" },
    "instead, the spectrum of a tube with this anode and a beryllium window, 18 to 42 kV (Boone, "
    "Fewell and Jennings 1997)");
  add("--kvp", arguments.Tube.KilovoltagePeak, Between(18, 42, "kV"), "voltage of --tube");
  DeclareFilters(add, "--filter", arguments.Filters,
    "a layer that all photons pass, an element, a formula or a NIST compound ('Air, Dry (near sea "
    "level):600'); may be given for several");
}

Spectrum ToSpectrum(const SpectrumArguments& arguments)
{
  std::vector<XRayFilter> filters;
  for (const std::string& text : arguments.Filters)
  {
    filters.push_back(XRayFilter::FromText(text));
  }
  if (!arguments.Anode.empty() && arguments.EnergyKeV)
  {
    throw InputError("--tube: expected no --kev beside it, found both");
  }
  if (!arguments.Anode.empty())
  {
    XRayTube tube = arguments.Tube;
    tube.Anode = arguments.Anode;
    tube.Filters = filters;
    return TubeSpectrum(tube);
  }
  Spectrum spectrum = arguments.EnergyKeV ? Spectrum::Monochromatic(*arguments.EnergyKeV)
                                          : FindSpectrum(arguments.Spectrum);
  for (const XRayFilter& filter : filters)
  {
    spectrum = FilterSpectrum(spectrum, filter);
  }
  return spectrum;
}

void DeclareDualEnergy(const OptionList& add, DualEnergyArguments& arguments)
{
  const OptionList dual = add.Group("Dual energy");
  dual("--iodine", arguments.Iodine,
    "iodine that a material of the table has taken up besides, for contrast-enhanced pictures")
    ->type_name("MATERIAL=MG_PER_ML")
    ->allow_extra_args(false);
  dual.Input("--high-spectrum", arguments.Spectrum,
    "a second exposure with this spectrum: --output becomes its -ln I/I0 less a multiple of the "
    "first's by which --cancel look the same; NAME_low and NAME_high beside it are the two "
    "exposures");
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

Spectrum ToHighSpectrum(const DualEnergyArguments& arguments, const SpectrumArguments& low)
{
  SpectrumArguments high;
  high.Spectrum = arguments.Spectrum;
  high.EnergyKeV = arguments.EnergyKeV;
  high.Filters = arguments.Filters;
  if (arguments.KilovoltagePeak)
  {
    high.Anode = low.Anode;
    high.Tube = low.Tube;
    high.Tube.KilovoltagePeak = *arguments.KilovoltagePeak;
    if (high.Anode.empty())
    {
      throw InputError("--high-kvp: expected --tube beside it, found none");
    }
  }
  return ToSpectrum(high);
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
