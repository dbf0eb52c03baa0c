// SPDX-License-Identifier: Apache-2.0
#include "Private/AskedPlaces.h"

#include "mammoray/Case/BreastInUnit.h"
#include "mammoray/Case/LesionShadow.h"
#include "mammoray/Case/RegisteredBreast.h"
#include "mammoray/Case/RegistrationCaseWriter.h"
#include "mammoray/Case/StudyCase.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/SurfaceMesh.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/Report/BreastPicture.h"
#include "mammoray/Report/SlicePicture.h"

#include "vtkDoubleArray.h"
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
/// Share of a lesion's voxels that must lie in tissue; as much as ProjectLesion wants.
constexpr double LeastShareInside = 0.5;

VolumeAxes AxesOf(const RegistrationCase& input)
{
  return input.Labels.AxesAsGiven ? VolumeAxes::AsGiven : VolumeAxes::Patient;
}

/// Sums over the voxels of a lesion.
struct LesionSums
{
  double Voxels = 0;
  double Inside = 0;
  Vector3 Places{ 0, 0, 0 };
};

/// By label.
std::map<int, LesionSums> SumsOf(const LabelVolume& lesions, const LabelVolume& tissue)
{
  std::map<int, LesionSums> sums;
  lesions.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      if (lesions.Voxels[voxel] != 0)
      {
        LesionSums& lesion = sums[lesions.Voxels[voxel]];
        const Vector3 point = lesions.PointAt(i, j, k);
        lesion.Voxels += 1;
        lesion.Inside += tissue.LabelAt(point) != 0 ? 1 : 0;
        lesion.Places = lesion.Places + point;
      }
    });
  return sums;
}

LayeredPicture SlicesThrough(const RegistrationCaseResult& result, const Vector3& point, int lesion)
{
  PointSlices slices;
  slices.Image = result.Tissue ? &result.Tissue->Mri : result.Image.get();
  slices.Labels = result.Volume.get();
  slices.Axes = result.Axes;
  slices.Names = result.Materials.Names();
  slices.Point = point;
  slices.Lesions = lesion != 0 ? result.Lesions.get() : nullptr;
  slices.LesionLabel = lesion;
  return DrawPointSlices(slices);
}

/// The registered breast as its folder will hold it.
BreastInUnit InMemory(const RegistrationCaseResult& result, const RegisteredView& registered,
  const ResultFile& file)
{
  BreastInUnit breast;
  breast.Uncompressed = UncompressedGrid(result, registered);
  breast.Compressed = vtkSmartPointer<vtkUnstructuredGrid>::New();
  breast.Compressed->ShallowCopy(breast.Uncompressed);
  vtkNew<vtkDoubleArray> values;
  values->SetNumberOfComponents(3);
  values->SetNumberOfTuples(breast.Uncompressed->GetNumberOfPoints());
  std::copy(registered.CompressedPoints.begin(), registered.CompressedPoints.end(),
    values->GetPointer(0));
  vtkNew<vtkPoints> points;
  points->SetData(values);
  breast.Compressed->SetPoints(points);
  DescribeUnit(file, breast);
  return breast;
}

PlaceInMammogram PlaceOf(const ImagedPoint& imaged, const RegistrationTarget& grid)
{
  PlaceInMammogram place;
  place.Material = imaged.Material;
  place.ReceptorMm = imaged.ReceptorMm;
  place.Column = imaged.Column;
  place.Row = imaged.Row;
  place.InImage = imaged.InImage;
  if (imaged.Uncertainty)
  {
    place.HalfAxesMm = { Deviations95 * imaged.Uncertainty->MajorMm,
      Deviations95 * imaged.Uncertainty->MinorMm };
    place.Ellipse = EllipsePoints(*imaged.Uncertainty, imaged.ReceptorMm, grid, Deviations95);
  }
  return place;
}

void AddOutlines(const LesionShadow& shadow, const RegistrationTarget& grid,
  PlaceInMammogram& place)
{
  for (const auto& outline : shadow.Outlines)
  {
    auto& receptor = place.Outlines.emplace_back();
    for (const auto& [column, row] : outline)
    {
      receptor.push_back({ grid.Origin[0] + column * grid.ColumnStep[0] + row * grid.RowStep[0],
        grid.Origin[1] + column * grid.ColumnStep[1] + row * grid.RowStep[1] });
    }
  }
}

/// The labels of the lesions, in the order of AskedOf.
std::vector<int> LabelsOf(const LabelVolume& lesions)
{
  std::vector<int> labels;
  for (const auto& [label, count] : lesions.CountLabels())
  {
    if (label != 0)
    {
      labels.push_back(label);
    }
  }
  return labels;
}
}

void ReadAsked(const RegistrationCase& input, RegistrationCaseResult& result)
{
  if (!input.Lesions.empty())
  {
    result.Lesions =
      std::make_shared<const LabelVolume>(ReadLabelVolume(input.Lesions, AxesOf(input)));
    if (LabelsOf(*result.Lesions).empty())
    {
      throw InputError(input.Lesions + ": expected voxels that are not 0, found none");
    }
  }
  if (!input.Image.empty())
  {
    result.Image =
      std::make_shared<const IntensityVolume>(ReadIntensityVolume(input.Image, AxesOf(input)));
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
    for (const auto& [label, lesion] : SumsOf(*result.Lesions, tissue))
    {
      if (lesion.Inside < LeastShareInside * lesion.Voxels)
      {
        std::snprintf(text, sizeof text,
          ": expected lesion %d in the tissue that is registered, found %.0f %% of it there; is it "
          "in the frame of that volume?",
          label, 100 * lesion.Inside / lesion.Voxels);
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
    asked.push_back(
      { "The point", "point", *input.Point, 0, SlicesThrough(result, *input.Point, 0) });
  }
  if (result.Lesions)
  {
    for (const auto& [label, lesion] : SumsOf(*result.Lesions, *result.Volume))
    {
      const Vector3 centre = (1 / lesion.Voxels) * lesion.Places;
      const std::string number = std::to_string(label);
      asked.push_back({ "Lesion " + number, number, centre,
        lesion.Voxels * result.Lesions->VoxelVolume(), SlicesThrough(result, centre, label) });
    }
  }
  return asked;
}

std::vector<PlaceInMammogram> PlacesIn(const RegistrationCase& input,
  const RegistrationCaseResult& result, const RegisteredView& registered, const ResultFile& file,
  const std::vector<AskedPlace>& asked)
{
  std::vector<PlaceInMammogram> places;
  if (asked.empty())
  {
    return places;
  }
  const RegisteredBreast breast(InMemory(result, registered, file));
  std::vector<int> labels = result.Lesions ? LabelsOf(*result.Lesions) : std::vector<int>{};
  labels.insert(labels.begin(), asked.size() - labels.size(), 0);
  const auto projector = result.Lesions
    ? MakeProjector({ .Projection = MethodFromName(input.Projector), .Device = input.Device })
    : nullptr;
  for (std::size_t index = 0; index < asked.size(); ++index)
  {
    try
    {
      if (labels[index] == 0)
      {
        places.push_back(PlaceOf(breast.ToMammogram(asked[index].Point), registered.Target));
        continue;
      }
      const LesionShadow shadow = ProjectLesion(breast, *result.Lesions, labels[index], *projector);
      PlaceInMammogram place = PlaceOf(shadow.ImagedCentre, registered.Target);
      AddOutlines(shadow, registered.Target, place);
      places.push_back(std::move(place));
    }
    catch (const InputError& error) // the rest of the result is not lost for that
    {
      places.emplace_back().Problem = error.what();
    }
  }
  return places;
}

LayeredPicture PictureBetweenPlates(const RegistrationCaseResult& result,
  const RegisteredView& registered, const ResultFile& file, const std::vector<AskedPlace>& asked)
{
  std::vector<std::int32_t> ids;
  SurfaceMesh surface = ExtractInterfaces(result.Anatomy, &ids);
  for (std::size_t id = 0; id < ids.size(); ++id)
  {
    std::copy_n(&registered.CompressedPoints[3 * static_cast<std::size_t>(ids[id])], 3,
      &surface.Points[3 * id]);
  }
  const VolumeFromGantry& placed = registered.Placed;
  BreastInSpace breast;
  breast.Surface = &surface;
  breast.Materials = &result.Materials;
  const double side = registered.Mammogram.Laterality == 'R' ? -1 : 1;
  const Vector3 eye = placed.Direction({ 0.75 * side, 0.62, 0.30 });
  breast.ToEye = (1 / Norm(eye)) * eye;
  breast.Up = placed.Z;
  double low[2] = { 1e30, 0 };
  double high[2] = { -1e30, 0 };
  for (std::size_t id = 0; id < surface.NumberOfPoints(); ++id)
  {
    const Vector3 at = placed.ToGantry(
      { surface.Points[3 * id], surface.Points[3 * id + 1], surface.Points[3 * id + 2] });
    for (int axis = 0; axis < 2; ++axis)
    {
      low[axis] = std::min(low[axis], at[axis]);
      high[axis] = std::max(high[axis], at[axis]);
    }
  }
  const PlatePair plates = PlatesOf(placed, registered.Unit,
    registered.Registration.Pose.ThicknessMm, registered.Registration.Pose.TiltDeg);
  constexpr double PlateMarginMm = 10;
  for (const Plate& plate : { plates.Support, plates.Paddle })
  {
    const auto corner = [&](double x, double depth)
    { return plate.Edge + x * placed.X + depth * plate.Inward; };
    const double depth = high[1] + PlateMarginMm;
    breast.Plates.push_back({ corner(low[0] - PlateMarginMm, 0), corner(high[0] + PlateMarginMm, 0),
      corner(high[0] + PlateMarginMm, depth), corner(low[0] - PlateMarginMm, depth) });
  }
  if (!asked.empty())
  {
    const RegisteredBreast moved(InMemory(result, registered, file));
    for (const AskedPlace& place : asked)
    {
      breast.Marks.emplace_back(place.ShortName,
        place.Point + moved.Carry(place.Point).Displacement);
    }
  }
  return DrawBreast(breast);
}
}
