// SPDX-License-Identifier: Apache-2.0
// Registration without VTK: registers the shipped phantom to its mammogram with coarse cells and
// pixels, which takes about twenty seconds. Exit 125: no Vulkan device.
#include <mammoray/Dicom/DicomReader.h>
#include <mammoray/IO/LabelVolumeIO.h>
#include <mammoray/IO/ShippedData.h>
#include <mammoray/Registration/Registration.h>
#include <mammoray/Registration/RegistrationTarget.h>

#include <cmath>
#include <cstdio>

using namespace mammoray;

int main()
{
  if (ListDevices().empty())
  {
    std::puts("skipped: no Vulkan device");
    return 125;
  }
  const std::string folder = DataDirectory() + "/victre-phantom-1/";
  const Mammogram mammogram = ReadMammogram(folder + "victre1_lcc_processing.dcm");
  const MaterialTable materials = FindMaterialTable("victre");

  BreastInput breast;
  breast.Materials = materials;
  breast.Axes = AnatomicalAxes::FromCode("ALS");
  breast.Labels = materials.ToMaterials(ReadLabelFile(folder + "labels.nrrd"), "labels");
  breast.AnatomyCellSizeMm = 6;
  breast.Mechanics.CellSizeMm = 10;
  breast.Mechanics.Predicted = true;
  breast.Projector = MakeProjector({});
  breast.XRays =
    MakeBeam(materials, FindSpectrum("W28kVp_Rh50um_Be1mm"), DetectorResponse::EnergyIntegrating);
  RegistrationProblem problem = MakeProblem(std::move(breast));
  problem.Options.PixelSizesMm = { 3 };
  problem.Options.RollOffsetsDeg.clear();

  BreastPose start = DefaultStart();
  start.ThicknessMm = mammogram.BodyPartThicknessMm.value();
  View view;
  view.Unit.EdgeRadiusMm = SearchedEdgeRadiusMm;
  view.Target = PrepareTarget(mammogram);
  view.Levels = MakeLevels(view.Target, problem.Options.PixelSizesMm);
  view.Parameters = DefaultParameters(start);
  problem.Views = { view };

  const RegistrationResult result = Register(problem);
  const ViewResult& found = result.Views.front();
  std::printf("thickness %.1f +- %.1f mm, outlines %.2f mm apart, the match is %s\n",
    found.Pose.ThicknessMm, found.StandardDeviations[ThicknessParameter],
    found.After.MeanOutlineDistanceMm, NameOf(found.Trust.Level));
  for (const std::string& warning : found.Warnings)
  {
    std::puts(warning.c_str());
  }
  // The phantom was compressed to 49.8 mm. Coarse cells and pixels cost some millimetres.
  return found.Trust.Level != Trust::None && std::abs(found.Pose.ThicknessMm - 49.8) < 5 ? 0 : 1;
}
