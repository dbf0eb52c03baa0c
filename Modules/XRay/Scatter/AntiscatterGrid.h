// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_AntiscatterGrid_h
#define mammoray_AntiscatterGrid_h

#include "mammoray/XRay/Scatter/PhotonMaterial.h"
#include "mammorayXRayModule.h"

#include <array>
#include <string>

namespace mammoray
{
/// A linear anti-scatter grid focused on the source: septa, and the material between them.
struct MAMMORAYXRAY_EXPORT AntiscatterGridOptions
{
  /// Height of the septa divided by their distance; 1 to 30. Mammography has 4 to 6.
  double Ratio = 5;
  /// 0.5 to 20.
  double LinesPerMm = 3.1;
  /// Thickness of a septum, mm; more than 0 and less than the period.
  double SeptumMm = 0.065;
  /// Compositions (see FindComposition), with densities, g/cm^3. Defaults: lead, fibre.
  std::string Septa = "Pb";
  double SeptaDensityGPerCm3 = 11.35;
  std::string Interspace = "Polystyrene";
  double InterspaceDensityGPerCm3 = 1.06;
  /// True: septa run along the detector's row direction, in a mammography unit along the chest
  /// wall. False: along the column direction.
  bool AlongChestWall = true;

  /// A lead grid from its usual numbers: ratio, lines per cm, thickness of a septum in micrometres.
  /// `interspace` is "fibre", "air" or "aluminium"; throws InputError on another word.
  static AntiscatterGridOptions OfLead(const std::array<double, 3>& numbers,
    const std::string& interspace = "fibre");
  bool operator==(const AntiscatterGridOptions&) const = default;
};

/**
 * Transmission of a grid, averaged over the points where photons meet it: the mean over one period
 * of exp(-mu_s l_s - mu_i l_i), with the path lengths l_s in septa and l_i between them. In closed
 * form: the path across septa is a sum of whole periods and a trapezoid (as in Day and Dance, Phys.
 * Med. Biol. 28, 1983). Photons that interact in the grid are lost. There are no covers.
 */
class MAMMORAYXRAY_EXPORT AntiscatterGrid
{
public:
  /// Throws InputError on options out of range.
  explicit AntiscatterGrid(const AntiscatterGridOptions& options);

  /// Transmission of a photon that deviates from the direction of the focus by these slopes
  /// (tangents) along the detector's columns and rows.
  double Transmission(double energyKeV, double columnSlope, double rowSlope) const;
  /// Transmission of a photon from the focus.
  double PrimaryTransmission(double energyKeV) const;
  /// Mean of Transmission over the azimuth, for a deviation by this angle, radians below pi/2.
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
