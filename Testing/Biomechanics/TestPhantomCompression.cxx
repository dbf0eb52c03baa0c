// SPDX-License-Identifier: Apache-2.0
// The FDA's VICTRE phantom 1 against the FDA's own compression of it (FEBio on another mesh):
// points known in both states. Nothing here is fitted to them.
#include "CompressionSimulation.h"
#include "LabelVolumeIO.h"
#include "SimulationMesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

namespace
{
using namespace mammoray;

TEST(PhantomCompression, MovesLandmarksAsTheFdasSimulationDid)
{
  const std::filesystem::path folder =
    std::filesystem::path(MAMMORAY_SHARED_DATA_DIR) / "victre-pipeline-phantom-1";
  if (!std::filesystem::exists(folder / "landmarks.csv"))
  {
    GTEST_SKIP() << "no " << folder;
  }
  // 1 fat, skin and nipple; 2 the rest of the breast; 3 muscle. Constants of the FDA's simulation.
  LabelVolume volume = ReadLabelVolume((folder / "p_1.nhdr").string(), VolumeAxes::AsGiven);
  for (std::uint16_t& voxel : volume.Voxels)
  {
    voxel = voxel == 0 ? 0 : voxel == 1 || voxel == 2 || voxel == 33 ? 1 : voxel == 40 ? 3 : 2;
  }
  const std::vector<bool> held{ false, false, false, true };
  const MeshingResult mesh = MeshForSimulation(volume, held, 8);
  const CompressionSimulation simulation(mesh.Mesh, { {}, { 5, 0.49 }, { 15, 0.49 }, { 5, 0.49 } },
    held, [&](const Vector3& point) { return static_cast<int>(volume.LabelAt(point)); });

  // Its plates, from the folder's README; x anterior, z up.
  PlatePair plates;
  plates.Support.Edge = { 8, 0, -25.32 };
  plates.Support.Inward = { 1, 0, 0 };
  plates.Paddle = plates.Support;
  plates.Paddle.Edge = { 9, 0, 24.48 };
  plates.Paddle.Normal = { 0, 0, -1 };
  const CompressionState state = simulation.Compress(plates);
  EXPECT_GT(state.SmallestJ, 0.1);
  EXPECT_NEAR(state.VolumeRatio, 1, 0.01);
  EXPECT_LT(state.LargestPenetrationMm, 0.05);

  std::ifstream file(folder / "landmarks.csv");
  std::string line;
  std::getline(file, line);
  std::vector<double> before, after;
  std::vector<int> imaged;
  while (std::getline(file, line))
  {
    double c[6];
    int flag;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%d", c, c + 1, c + 2, c + 3, c + 4,
                c + 5, &flag),
      7);
    before.insert(before.end(), c, c + 3);
    after.insert(after.end(), c + 3, c + 6);
    imaged.push_back(flag);
  }
  const std::vector<double> found = Embedding(simulation, before).Map(state.Positions);
  std::vector<double> errors, all;
  for (std::size_t p = 0; p < imaged.size(); ++p)
  {
    const double error = std::hypot(found[3 * p] - after[3 * p],
      found[3 * p + 1] - after[3 * p + 1], found[3 * p + 2] - after[3 * p + 2]);
    all.push_back(error);
    if (imaged[p])
    {
      errors.push_back(error);
    }
  }
  ASSERT_GE(errors.size(), 10u);
  std::sort(errors.begin(), errors.end());
  std::sort(all.begin(), all.end());
  const double median = errors[errors.size() / 2];
  std::printf("imaged: median %.2f mm, largest %.2f mm; all: median %.2f mm, largest %.2f mm; "
              "paddle %.2f N; %zu cells; %d Newton steps, %.1f s\n",
    median, errors.back(), all[all.size() / 2], all.back(), state.PaddleForceN,
    mesh.Mesh.NumberOfCells(), state.NewtonSteps, state.Seconds);
  RecordProperty("MedianErrorMm", std::to_string(median));
  // No motion at all leaves 9.2 mm at these points; 0.9 was measured.
  EXPECT_LT(median, 1.5);
  EXPECT_LT(errors.back(), 3.0);
}
}
