// SPDX-License-Identifier: Apache-2.0
// The tissue of a study, by labels that somebody corrected.
#include "mammoray/Study/StudyCase.h"

#include "Private/StudyTissues.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Study/LabelSource.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace mammoray
{
namespace
{
/// Least part of the labels' tissue in the MRI.
constexpr double LeastWithin = 0.98;
/// Least part of the labels' skin behind which the MRI is so many times as bright as before it, and
/// brighter by this part of fat: far from the coil tissue is dark, but air is darker.
constexpr double LeastSkinSeen = 0.75;
constexpr double LeastRatio = 1.5;
constexpr double LeastStep = 0.05;
/// A breast's middle may lie so far beyond the middle of an MRI of both, mm.
constexpr double MiddleMm = 20;

[[noreturn]] void RefuseLabels(const std::string& path, const std::string& message)
{
  throw InputError(path + ": expected " + message, { "Labels", path, { "AcceptUnusual" } });
}

std::string Percent(double part)
{
  return NumberText(100 * part, 0) + " %";
}

/// Keeps one of two breasts.
void KeepSide(LabelVolume& materials, const std::vector<bool>& fixed, char laterality)
{
  const AnatomicalAxes axes;
  const std::optional<double> midline = MidlineBetweenBreasts(materials, fixed, axes);
  if (!midline || laterality == '?')
  {
    return;
  }
  const double side = laterality == 'L' ? 1 : -1;
  materials.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      if (side * (Dot(materials.PointAt(i, j, k), axes.Left) - *midline) < 0)
      {
        materials.Voxels[voxel] = 0;
      }
    });
}

/// The MRI at the voxels of `materials`, 0 outside it, over `level`, the middle of what is neither
/// thin, fixed nor gland: fat. Throws InputError if the tissue lies beside the MRI.
IntensityVolume SampleAt(const LabelVolume& materials, const IntensityVolume& image,
  const MaterialTable& table, const LabelSource& source, float& level)
{
  IntensityVolume sampled;
  static_cast<VolumeGrid&>(sampled) = materials;
  sampled.Voxels.assign(materials.Voxels.size(), 0);
  std::vector<bool> isFat(table.Materials.size(), true);
  isFat[0] = false;
  for (std::size_t index = 0; index < isFat.size(); ++index)
  {
    const Material& material = table.Materials[index];
    isFat[index] = isFat[index] && !material.Fixed && !material.Thin;
  }
  for (const int gland : table.Glandular())
  {
    isFat[static_cast<std::size_t>(gland)] = false;
  }
  std::vector<float> fat;
  std::size_t tissue = 0;
  std::size_t within = 0;
  materials.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const std::optional<float> value = image.ValueAt(materials.PointAt(i, j, k));
      sampled.Voxels[voxel] = value.value_or(0.0F);
      const std::uint16_t material = materials.Voxels[voxel];
      tissue += material != 0 ? 1 : 0;
      within += material != 0 && value ? 1 : 0;
      if (isFat[material])
      {
        fat.push_back(sampled.Voxels[voxel]);
      }
    });
  if (static_cast<double>(within) < LeastWithin * static_cast<double>(tissue) &&
    !source.AcceptUnusual)
  {
    RefuseLabels(source.Path,
      "tissue in the study's MRI, found " +
        Percent(1 - static_cast<double>(within) / static_cast<double>(tissue)) +
        " of it outside: labels in the frame of another volume, or on other axes");
  }
  level = fat.empty() ? 0.0F : QuantileElement(std::move(fat), 0.5);
  if (level > 0)
  {
    std::for_each(sampled.Voxels.begin(), sampled.Voxels.end(),
      [level](float& value) { value /= level; });
  }
  return sampled;
}

/// Throws InputError if the breast lies on the other side of an MRI of both.
void CheckSideOf(const StudyTissue& tissue, const IntensityVolume& image, const StudyChoice& choice,
  const std::vector<bool>& fixed, const std::string& path)
{
  Vector3 sum{ 0, 0, 0 };
  double count = 0;
  tissue.Breast.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      if (const std::uint16_t material = tissue.Breast.Voxels[voxel];
          material != 0 && !fixed[material])
      {
        sum = sum + tissue.Breast.PointAt(i, j, k);
        count += 1;
      }
    });
  const Vector3 middle =
    image.PointAt(0.5 * (image.Size[0] - 1), 0.5 * (image.Size[1] - 1), 0.5 * (image.Size[2] - 1));
  const double toLeft = Dot((1 / std::max(count, 1.0)) * sum - middle, AnatomicalAxes().Left);
  const double side = choice.Laterality == 'L' ? 1 : -1;
  if (choice.Mri()->Side == 'B' && choice.Laterality != '?' && side * toLeft < -MiddleMm)
  {
    RefuseLabels(path,
      "the " + SideName(choice.Laterality) + " breast, which the mammograms show, found tissue " +
        NumberText(std::abs(toLeft), 0) + " mm to the " + SideName(toLeft > 0 ? 'L' : 'R') +
        " of the MRI's middle");
  }
}

/// Throws InputError unless the MRI is brighter behind the skin of the labels than before it.
/// `fat`: its brightness.
void CheckSkin(const StudyTissue& tissue, const IntensityVolume& image, double fat,
  const std::vector<bool>& fixed, const std::string& path)
{
  const LabelVolume& breast = tissue.Breast;
  const Vector3 front = AnatomicalAxes().Anterior;
  const double step = *std::max_element(breast.Spacing.begin(), breast.Spacing.end());
  const auto isSoftAt = [&](const Vector3& at)
  {
    const std::uint16_t material = breast.LabelAt(at);
    return material != 0 && !fixed[material];
  };
  std::size_t count = 0;
  std::size_t seen = 0;
  breast.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const Vector3 skin = breast.PointAt(i, j, k);
      if (breast.Voxels[voxel] == 0 || tissue.Labels.LabelAt(skin + step * front) != 0)
      {
        return;
      }
      double before = 0;
      double behind = 0;
      for (const double depth : { 4.0, 6.0, 8.0 })
      {
        const std::optional<float> outside = image.ValueAt(skin + depth * front);
        const std::optional<float> inside = image.ValueAt(skin - depth * front);
        if (!outside || !inside || tissue.Labels.LabelAt(skin + depth * front) != 0 ||
          !isSoftAt(skin - depth * front))
        {
          return;
        }
        before += *outside / 3;
        behind += *inside / 3;
      }
      ++count;
      seen += behind > LeastRatio * before && behind > before + LeastStep * fat ? 1 : 0;
    });
  constexpr std::size_t few = 50;
  if (count >= few && static_cast<double>(seen) < LeastSkinSeen * static_cast<double>(count))
  {
    RefuseLabels(path,
      "the skin where the study's MRI shows it, found " +
        Percent(1 - static_cast<double>(seen) / static_cast<double>(count)) +
        " of it with nothing brighter behind: labels of another volume, or on other axes");
  }
}
}

StudyTissue LabelStudy(const StudyChoice& choice, const LabelSource& labels,
  const MaterialTable& table, const ProgressCallback& progress)
{
  choice.Require();
  const std::vector<bool> fixed = table.Fixed();
  LabelVolume materials = ReadMaterials(labels, table);
  const IntensityVolume image =
    ReadIntensitySlices(choice.Mri()->Slices, PartOf(progress, 0, 1, "read the MRI"));
  KeepSide(materials, fixed, choice.Laterality);
  float fat = 0;
  IntensityVolume mri = SampleAt(materials, image, table, labels, fat);
  StudyTissue tissue = MakeStudyTissue(std::move(materials), std::move(mri), table);
  if (!labels.AcceptUnusual)
  {
    CheckSideOf(tissue, image, choice, fixed, labels.Path);
    CheckSkin(tissue, image, fat, fixed, labels.Path);
  }
  return tissue;
}
}
