// SPDX-License-Identifier: Apache-2.0
// Compresses half a ball of fat with a lump of gland, and X-rays it. usage: breast FOLDER
#include <mammoray/IO/ShippedData.h>
#include <mammoray/Registration/RegistrationProblem.h>
#include <mammoray/Registration/RegistrationResult.h>

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
  // Voxels of 2 mm: +x left, +y anterior, +z superior. Labels of `segment`: fat 1, gland 2, wall 4.
  LabelVolume labels;
  labels.Size = { 48, 26, 48 };
  labels.Spacing = { 2, 2, 2 };
  labels.Origin = { -47, -3, -47 };
  labels.ForEachVoxel(
    [&labels](int i, int j, int k, std::size_t)
    {
      const Vector3 p = labels.PointAt(i, j, k);
      const bool inside = p[1] > 0 && std::hypot(p[0], p[1], p[2]) < 44;
      const int tissue = std::hypot(p[0] - 8, p[1] - 22, p[2]) < 12 ? 2 : 1;
      labels.Voxels.push_back(static_cast<std::uint16_t>(inside ? (p[1] < 6 ? 4 : tissue) : 0));
    });
  BreastInput input;
  input.Materials = FindMaterialTable("segment");
  input.Axes = AnatomicalAxes::FromCode("LAS");
  input.Labels = input.Materials.ToMaterials(labels, "labels");
  input.Mechanics.CellSizeMm = 12;
  input.Projector = MakeProjector();
  input.XRays = MakeBeam(input.Materials, FindSpectrum("W28kVp_Rh50um_Be1mm"),
    DetectorResponse::EnergyIntegrating);
  const RegistrationProblem problem = MakeProblem(std::move(input));
  BreastModel& model = *problem.Model;
  const UnitPlacement placement{ problem.Frame, MammographyUnit{} };
  BreastPose pose;
  pose.ThicknessMm = 55;
  pose.AnteriorMm = 5; // in front of the chest wall, which does not move
  const CompressionState state = model.Body().Compress(placement, pose);
  std::printf("the paddle presses with %.1f N\n", state.PaddleForceN);

  PosedBreast posed(model, model.Body(), placement, pose, state);
  const ReceptorGrid grid{ 160, 280, { 69.75, 0.25 }, { 0, 0.5 }, { -0.5, 0 } };
  std::ofstream picture(std::string(arguments[1]) + "/breast.pgm", std::ios::binary);
  picture << "P5 160 280 255\n";
  for (const float value : posed.PictureOn(grid, 1).LogAttenuation)
  {
    picture.put(static_cast<char>(std::lround(60 * std::min(value, 4.0F))));
  }
  return state.PaddleForceN > 1 && std::abs(state.VolumeRatio - 1) < 0.05 ? 0 : 1;
}
