// SPDX-License-Identifier: Apache-2.0
// Registers the shipped phantom, coarsely: trust and expected error. usage: registration FOLDER
#include <mammoray/Dicom/DicomReader.h>
#include <mammoray/IO/LabelVolumeIO.h>
#include <mammoray/IO/ShippedData.h>
#include <mammoray/Registration/Registration.h>
#include <mammoray/Registration/RegistrationTarget.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
using namespace mammoray;

int main(int, char** arguments)
{
  if (ListDevices().empty())
  {
    return 125; // no Vulkan device
  }
  const std::string folder = DataDirectory() + "/victre-phantom-1/";
  const Mammogram mammogram = ReadMammogram(folder + "victre1_lcc_processing.dcm");
  BreastInput input;
  input.Materials = FindMaterialTable("victre");
  input.Axes = AnatomicalAxes::FromCode("ALS");
  input.Labels = input.Materials.ToMaterials(ReadLabelFile(folder + "labels.nrrd"), "labels");
  input.AnatomyCellSizeMm = 6;
  input.Mechanics.CellSizeMm = 10;
  input.Mechanics.Predicted = true;
  input.Projector = MakeProjector();
  input.XRays = MakeBeam(input.Materials, FindSpectrum("W28kVp_Rh50um_Be1mm"),
    DetectorResponse::EnergyIntegrating);
  RegistrationProblem problem = MakeProblem(std::move(input));
  problem.Options.PixelSizesMm = { 3 };
  problem.Options.RollOffsetsDeg.clear();
  View view;
  view.Unit.EdgeRadiusMm = SearchedEdgeRadiusMm;
  view.Target = PrepareTarget(mammogram);
  view.Levels = MakeLevels(view.Target, problem.Options.PixelSizesMm);
  BreastPose start = DefaultStart();
  start.ThicknessMm = mammogram.BodyPartThicknessMm.value();
  view.Parameters = DefaultParameters(start);
  problem.Views = { view };
  const ViewResult found = Register(problem).Views.front();
  const ExpectedError expected = found.Expected.value();
  std::printf("%s\nhalf of the tissue within %.1f mm, 95 %% within %.1f mm\n",
    VerdictOf(found.Trust.Level), expected.MedianMm, expected.Most95Mm);
  const std::size_t columns = view.Target.Grid.Columns, pixels = view.Target.Grid.NumberOfPixels();
  std::ofstream picture(std::string(arguments[1]) + "/registration.pgm", std::ios::binary);
  picture << "P5 " << 2 * columns << ' ' << view.Target.Grid.Rows << " 255\n"; // target, synthetic
  for (std::size_t pixel = 0; pixel < 2 * pixels; ++pixel)
  {
    const std::vector<float>& values =
      pixel / columns % 2 ? found.Synthetic.LogAttenuation : view.Target.LogAttenuation;
    const float value = values[pixel / columns / 2 * columns + pixel % columns];
    picture.put(static_cast<char>(std::lround(std::clamp(60 * value, 0.0F, 255.0F))));
  }
  return found.Trust.Level != Trust::None && expected.MedianMm < 3 ? 0 : 1;
}
