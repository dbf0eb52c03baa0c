// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_AntiscatterGrid_h
#define mammoray_AntiscatterGrid_h

#include "mammoray/XRay/Scatter/PhotonMaterial.h"
#include "mammorayXRayModule.h"

#include <array>
#include <string>

namespace mammoray
{
/// A linear anti-scatter grid that is focused on the source: septa, and what is between them.
struct MAMMORAYXRAY_EXPORT AntiscatterGridOptions
{
  /// Height of the septa over their distance; 1 to 30. Mammography: 4 to 6.
  double Ratio = 5;
  /// 0.5 to 20.
  double LinesPerMm = 3.1;
  /// Thickness of a septum, mm; more than 0 and less than the period.
  double SeptumMm = 0.065;
  /// See FindComposition, with densities, g/cm^3. Defaults: lead, fibre.
  std::string Septa = "Pb";
  double SeptaDensityGPerCm3 = 11.35;
  std::string Interspace = "Polystyrene";
  double InterspaceDensityGPerCm3 = 1.06;
  /// Septa run along the detector's rows of constant column (a unit's: along the chest wall), or
  /// along the columns' direction.
  bool AlongChestWall = true;

  /// A grid of lead by the numbers it is sold by: ratio, lines per cm, thickness of a septum in
  /// micrometres; between the septa "fibre", "air" or "aluminium". Throws InputError on another.
  static AntiscatterGridOptions OfLead(const std::array<double, 3>& numbers,
    const std::string& interspace = "fibre");
};

/**
 * What a grid lets through, averaged over where photons meet it: the mean of
 * exp(-mu_s l_s - mu_i l_i) over one period, l_s and l_i being the ways in septa and between them;
 * closed form, the way across septa being a sum of whole periods and a trapezoid (as in Day and
 * Dance, Phys. Med. Biol. 28, 1983). What interacts in the grid is lost. No covers.
 */
class MAMMORAYXRAY_EXPORT AntiscatterGrid
{
public:
  /// Throws InputError on options out of range.
  explicit AntiscatterGrid(const AntiscatterGridOptions& options);

  /// Of a photon that leans from the direction of the focus by these slopes (tangents) along the
  /// detector's columns and rows.
  double Transmission(double energyKeV, double columnSlope, double rowSlope) const;
  /// Of a photon that comes from the focus.
  double PrimaryTransmission(double energyKeV) const;
  /// Mean over all sides of Transmission, for photons that lean by this angle, radians below pi/2.
  double TransmissionAt(double energyKeV, double angle) const;

private:
  AntiscatterGridOptions Options;
  PhotonMaterial Septa;
  PhotonMaterial Interspace;
  /// mm.
  double Gap = 0;
  double Height = 0;
};
}

#endif
