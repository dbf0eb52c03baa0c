// SPDX-License-Identifier: Apache-2.0
#include "Private/AskedPlaces.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/Study/Intake.h"
#include "mammoray/Study/LesionShadow.h"
#include "mammoray/Study/RegisteredBreast.h"
#include "mammoray/Study/RegistrationCase.h"
#include "mammoray/Study/StudyCase.h"
#include "mammoray/Study/StudyPictures.h"

#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cstdio>
#include <map>

namespace mammoray
{
namespace
{
/// Shares of each lesion's voxels that lie outside the tissue, by label.
std::map<int, double> SharesOutside(const LabelVolume& lesions, const LabelVolume& tissue)
{
  std::map<int, std::pair<double, double>> counts;
  lesions.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      if (lesions.Voxels[voxel] != 0)
      {
        auto& [all, outside] = counts[lesions.Voxels[voxel]];
        all += 1;
        outside += tissue.LabelAt(lesions.PointAt(i, j, k)) == 0 ? 1 : 0;
      }
    });
  std::map<int, double> shares;
  for (const auto& [label, count] : counts)
  {
    shares[label] = count.second / count.first;
  }
  return shares;
}

LayeredPicture SlicesThrough(const RegistrationCaseResult& result, const AskedPlace& place)
{
  PointSlices slices;
  slices.Image = result.Tissue ? &result.Tissue->Mri : result.Image.get();
  slices.Labels = result.Volume.get();
  slices.Axes = result.Axes;
  slices.Names = result.Materials.Names();
  slices.Point = place.Point;
  slices.Lesions = place.Label != 0 ? result.Lesions.get() : nullptr;
  slices.LesionLabel = place.Label;
  return DrawPointSlices(slices);
}
}

void ReadAsked(const RegistrationCase& input, RegistrationCaseResult& result)
{
  if (!input.Lesions.empty())
  {
    result.Lesions = std::make_shared<const LabelVolume>(
      ReadLesions(input.Lesions, AxesOf(input.Labels.AxesAsGiven)));
  }
  if (!input.Image.empty())
  {
    result.Image =
      std::make_shared<const IntensityVolume>(ReadMri(input.Image, AxesOf(input.Labels.AxesAsGiven),
        input.Series.empty() ? std::nullopt : std::optional(input.Series.front())));
  }
}

void CheckAsked(const RegistrationCase& input, const LabelVolume& tissue,
  RegistrationCaseResult& result)
{
  char text[200];
  if (input.Point && tissue.LabelAt(*input.Point) == 0)
  {
    std::snprintf(text, sizeof text,
      "point (%.2f, %.2f, %.2f): expected a place in the tissue that is registered, found none",
      (*input.Point)[0], (*input.Point)[1], (*input.Point)[2]);
    throw InputError(text);
  }
  if (result.Lesions)
  {
    for (const auto& [label, outside] : SharesOutside(*result.Lesions, tissue))
    {
      if (outside > LargestShareOutside)
      {
        std::snprintf(text, sizeof text,
          ": expected lesion %d in the tissue that is registered, found %.0f %% of it there; is it "
          "in the frame of that volume?",
          label, 100 * (1 - outside));
        throw InputError(input.Lesions + text);
      }
    }
  }
  if (input.Point || result.Lesions)
  {
    result.Volume = std::make_shared<const LabelVolume>(tissue);
  }
}

std::vector<AskedPlace> AskedOf(const RegistrationCase& input, const RegistrationCaseResult& result)
{
  std::vector<AskedPlace> asked;
  if (input.Point)
  {
    asked.push_back({ "The point", "point", *input.Point, 0, {}, 0 });
  }
  for (const Lesion& lesion : result.Lesions ? FindLesions(*result.Lesions) : std::vector<Lesion>())
  {
    const std::string number = std::to_string(lesion.Label);
    asked.push_back(
      { "Lesion " + number, number, lesion.Centre, lesion.VolumeMm3, {}, lesion.Label });
  }
  for (AskedPlace& place : asked)
  {
    place.Slices = SlicesThrough(result, place);
  }
  return asked;
}

RegisteredBreast BreastOf(const RegistrationCaseResult& result, const RegisteredView& registered,
  const ResultFile& file)
{
  BreastInUnit breast;
  breast.Uncompressed = UncompressedGrid(result, registered);
  breast.Compressed = vtkSmartPointer<vtkUnstructuredGrid>::New();
  breast.Compressed->ShallowCopy(breast.Uncompressed);
  const std::vector<double>& moved = registered.Registration.Points;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (std::size_t place = 0; place < moved.size(); place += 3)
  {
    points->InsertNextPoint(&moved[place]);
  }
  breast.Compressed->SetPoints(points);
  DescribeUnit(file, breast);
  return RegisteredBreast(breast);
}

std::vector<PlaceInMammogram> PlacesIn(const RegistrationCase& input,
  const RegistrationCaseResult& result, const std::vector<AskedPlace>& asked,
  const RegisteredBreast& breast)
{
  std::vector<PlaceInMammogram> places;
  const auto projector = result.Lesions ? MakeProjector(input.Projector) : nullptr;
  for (const AskedPlace& place : asked)
  {
    try
    {
      if (place.Label == 0)
      {
        places.push_back({ {}, breast.ToMammogram(place.Point), {} });
        continue;
      }
      const LesionShadow shadow = ProjectLesion(breast, *result.Lesions, place.Label, *projector);
      places.push_back({ {}, shadow.ImagedCentre, shadow.Outlines });
    }
    catch (const InputError& error) // the rest of the result is not lost for that
    {
      places.emplace_back().Problem = error.what();
    }
  }
  return places;
}

LayeredPicture PictureBetweenPlates(const RegistrationCaseResult& result,
  const RegisteredView& registered, const std::vector<AskedPlace>& asked,
  const RegisteredBreast& registeredBreast)
{
  std::vector<std::int32_t> ids;
  SurfaceMesh surface = ExtractInterfaces(result.Anatomy, &ids);
  for (std::size_t id = 0; id < ids.size(); ++id)
  {
    std::copy_n(&registered.Registration.Points[3 * static_cast<std::size_t>(ids[id])], 3,
      &surface.Points[3 * id]);
  }
  const VolumeFromGantry& placed = registered.Registration.Placed;
  BreastInSpace breast;
  breast.Surface = &surface;
  breast.Materials = &result.Materials;
  const double side = registered.Mammogram.Laterality == 'R' ? -1 : 1;
  const Vector3 eye = placed.Direction({ 0.75 * side, 0.62, 0.30 });
  breast.ToEye = (1 / Norm(eye)) * eye;
  breast.Up = placed.Z;
  std::array<Extent, 2> reach;
  reach[1].Add(0); // from the chest wall on
  for (std::size_t id = 0; id < surface.NumberOfPoints(); ++id)
  {
    const Vector3 at = placed.ToGantry(
      { surface.Points[3 * id], surface.Points[3 * id + 1], surface.Points[3 * id + 2] });
    reach[0].Add(at[0]);
    reach[1].Add(at[1]);
  }
  const PlatePair plates = PlatesOf(placed, registered.View.Unit,
    registered.Registration.Pose.ThicknessMm, registered.Registration.Pose.TiltDeg);
  constexpr double PlateMarginMm = 10;
  for (const Plate& plate : { plates.Support, plates.Paddle })
  {
    const auto corner = [&](double x, double depth)
    { return plate.Edge + x * placed.X + depth * plate.Inward; };
    const double depth = reach[1].High + PlateMarginMm;
    const double from = reach[0].Low - PlateMarginMm;
    const double to = reach[0].High + PlateMarginMm;
    breast.Plates.push_back(
      { corner(from, 0), corner(to, 0), corner(to, depth), corner(from, depth) });
  }
  for (const AskedPlace& place : asked)
  {
    breast.Marks.emplace_back(place.ShortName,
      place.Point + registeredBreast.Carry(place.Point).Displacement);
  }
  return DrawBreast(breast);
}
}
