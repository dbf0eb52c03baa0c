// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/LandmarkEvaluation.h"

#include "Private/CsvRows.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/PosedBreast.h"

#include "vtkDataArray.h"
#include "vtkGenericCell.h"
#include "vtkLandmarkTransform.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkStaticCellLocator.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <functional>
#include <limits>

namespace mammoray
{
namespace
{
constexpr const char* HeaderWithFlag = "ux,uy,uz,cx,cy,cz,imaged";
constexpr const char* HeaderWithoutFlag = "ux,uy,uz,cx,cy,cz";

/// The displacement of the body at a point: linear in the cell that holds it or lies nearest.
class DisplacementOfGrid
{
public:
  explicit DisplacementOfGrid(vtkUnstructuredGrid* grid)
    : Displacement(grid->GetPointData()->GetArray("Displacement"))
  {
    if (!this->Displacement || this->Displacement->GetNumberOfComponents() != 3)
    {
      throw InputError("mesh: expected the point array 'Displacement' with 3 components");
    }
    this->Locator->SetDataSet(grid);
    this->Locator->BuildLocator();
  }

  Vector3 At(const Vector3& point)
  {
    double closest[3];
    double distance2 = 0;
    vtkIdType cellId = -1;
    int subId = 0;
    this->Locator->FindClosestPoint(point.data(), closest, this->Cell, cellId, subId, distance2);
    if (cellId < 0)
    {
      throw InputError("mesh: expected cells around the landmarks, found none");
    }
    double parametric[3];
    double weights[10];
    this->Cell->EvaluatePosition(closest, nullptr, subId, parametric, distance2, weights);
    Vector3 displacement{ 0, 0, 0 };
    for (vtkIdType corner = 0; corner < this->Cell->GetNumberOfPoints(); ++corner)
    {
      double value[3];
      this->Displacement->GetTuple(this->Cell->GetPointId(corner), value);
      displacement = displacement + weights[corner] * Vector3{ value[0], value[1], value[2] };
    }
    return displacement;
  }

private:
  vtkDataArray* Displacement;
  vtkNew<vtkStaticCellLocator> Locator;
  vtkNew<vtkGenericCell> Cell;
};

Vector3 OnReceptor(const Vector3& gantry, const MammographyUnit& unit)
{
  const ReceptorPoint shadow = ShadowOf(gantry, unit);
  return { shadow[0], shadow[1], 0 };
}

MammographyUnit TrueUnit(const LandmarkTruth& truth)
{
  MammographyUnit unit;
  unit.SourceToDetectorMm = truth.SourceToDetectorMm;
  return unit;
}

/// The rigid motion that takes the chosen landmarks nearest to the truth in the sense of least
/// squares.
std::function<Vector3(const Vector3&)> BestRigidMotion(const std::vector<Landmark>& landmarks,
  bool imagedOnly)
{
  vtkNew<vtkPoints> from;
  vtkNew<vtkPoints> to;
  from->SetDataTypeToDouble();
  to->SetDataTypeToDouble();
  for (const Landmark& landmark : landmarks)
  {
    if (landmark.Imaged || !imagedOnly)
    {
      from->InsertNextPoint(landmark.Uncompressed.data());
      to->InsertNextPoint(landmark.Compressed.data());
    }
  }
  vtkSmartPointer<vtkLandmarkTransform> transform = vtkSmartPointer<vtkLandmarkTransform>::New();
  transform->SetModeToRigidBody();
  transform->SetSourceLandmarks(from);
  transform->SetTargetLandmarks(to);
  transform->Update();
  return [transform](const Vector3& point)
  {
    Vector3 moved;
    transform->TransformPoint(point.data(), moved.data());
    return moved;
  };
}
}

std::vector<Landmark> ReadLandmarks(const std::string& path)
{
  const CsvRows read = ReadCsvRows(path, { HeaderWithFlag, HeaderWithoutFlag });
  std::vector<Landmark> landmarks;
  for (const CsvRow& row : read.Rows)
  {
    const auto at = [&](std::size_t field)
    {
      return Vector3{ read.Number(row, field), read.Number(row, field + 1),
        read.Number(row, field + 2) };
    };
    landmarks.push_back({ at(0), at(3), read.Header == 1 || read.Number(row, 6) != 0 });
  }
  if (landmarks.size() < 3)
  {
    throw InputError(
      path + ": expected at least 3 landmarks, found " + std::to_string(landmarks.size()));
  }
  return landmarks;
}

double Quantile(std::vector<double> values, double part)
{
  if (values.empty())
  {
    return std::numeric_limits<double>::quiet_NaN();
  }
  std::sort(values.begin(), values.end());
  const double place = part * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

ErrorSummary Summarise(std::vector<double> errors)
{
  ErrorSummary summary;
  summary.Count = static_cast<int>(errors.size());
  if (errors.empty())
  {
    return summary;
  }
  std::sort(errors.begin(), errors.end());
  const std::size_t middle = errors.size() / 2;
  summary.Median =
    errors.size() % 2 == 1 ? errors[middle] : 0.5 * (errors[middle - 1] + errors[middle]);
  for (const double error : errors)
  {
    summary.Mean += error / errors.size();
  }
  summary.Largest = errors.back();
  return summary;
}

ReaderDistances DistancesBetween(const std::vector<Landmark>& first,
  const std::vector<Landmark>& second, const LandmarkTruth& truth)
{
  if (first.size() != second.size())
  {
    throw InputError("landmarks: expected both readers to have marked the same, found " +
      std::to_string(first.size()) + " and " + std::to_string(second.size()));
  }
  const auto shadow = [&](const Landmark& landmark)
  { return OnReceptor(truth.Placed.ToGantry(landmark.Compressed), TrueUnit(truth)); };
  ReaderDistances distances;
  for (std::size_t index = 0; index < first.size(); ++index)
  {
    distances.Uncompressed.push_back(Norm(first[index].Uncompressed - second[index].Uncompressed));
    distances.Compressed.push_back(Norm(first[index].Compressed - second[index].Compressed));
    distances.OnReceptor.push_back(Norm(shadow(first[index]) - shadow(second[index])));
  }
  return distances;
}

LandmarkSummary SummariseImaged(const LandmarkErrors& errors,
  const std::vector<Landmark>& landmarks)
{
  std::vector<double> space;
  std::vector<double> receptor;
  for (std::size_t index = 0; index < landmarks.size(); ++index)
  {
    if (landmarks[index].Imaged)
    {
      space.push_back(errors.InSpace[index]);
      receptor.push_back(errors.OnReceptor[index]);
    }
  }
  return { errors.Method, Summarise(space), Summarise(receptor) };
}

std::vector<Vector3> Displace(const std::vector<Vector3>& points, vtkUnstructuredGrid* body)
{
  DisplacementOfGrid field(body);
  std::vector<Vector3> moved;
  moved.reserve(points.size());
  for (const Vector3& point : points)
  {
    moved.push_back(point + field.At(point));
  }
  return moved;
}

std::vector<LandmarkErrors> EvaluateLandmarks(const std::vector<Landmark>& landmarks,
  const LandmarkTruth& truth, vtkUnstructuredGrid* uncompressed, const VolumeFromGantry& registered,
  const MammographyUnit& registeredUnit)
{
  std::vector<LandmarkErrors> methods;
  // `carry` takes an uncompressed point into the gantry frame.
  const MammographyUnit trueUnit = TrueUnit(truth);
  const auto add = [&](const std::string& name, const MammographyUnit& unit,
                     const std::function<Vector3(const Vector3&)>& carry)
  {
    LandmarkErrors errors;
    errors.Method = name;
    for (const Landmark& landmark : landmarks)
    {
      const Vector3 expected = truth.Placed.ToGantry(landmark.Compressed);
      const Vector3 found = carry(landmark.Uncompressed);
      errors.InSpace.push_back(Norm(found - expected));
      errors.OnReceptor.push_back(Norm(OnReceptor(found, unit) - OnReceptor(expected, trueUnit)));
    }
    methods.push_back(errors);
  };
  add("identity", trueUnit, [&](const Vector3& point) { return truth.Placed.ToGantry(point); });
  for (const bool imagedOnly : { true, false })
  {
    const auto rigid = BestRigidMotion(landmarks, imagedOnly);
    add(imagedOnly ? "rigid, fitted to the imaged truth" : "rigid, fitted to all of the truth",
      trueUnit, [&](const Vector3& point) { return truth.Placed.ToGantry(rigid(point)); });
  }
  DisplacementOfGrid field(uncompressed);
  add("registered", registeredUnit,
    [&](const Vector3& point) { return registered.ToGantry(point + field.At(point)); });
  return methods;
}
}
