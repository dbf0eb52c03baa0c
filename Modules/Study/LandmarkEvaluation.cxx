// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/LandmarkEvaluation.h"

#include "Private/CellFinder.h"
#include "Private/CsvRows.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/PosedBreast.h"

#include "vtkDataArray.h"
#include "vtkLandmarkTransform.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mammoray
{
namespace
{
constexpr const char* HeaderWithFlag = "ux,uy,uz,cx,cy,cz,imaged";
constexpr const char* HeaderWithoutFlag = "ux,uy,uz,cx,cy,cz";

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

/// The landmarks moved by the rigid motion that takes the chosen ones nearest to the truth in the
/// sense of least squares.
std::vector<Vector3> MoveRigidly(const std::vector<Landmark>& landmarks, bool imagedOnly)
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
  vtkNew<vtkLandmarkTransform> transform;
  transform->SetModeToRigidBody();
  transform->SetSourceLandmarks(from);
  transform->SetTargetLandmarks(to);
  transform->Update();
  std::vector<Vector3> moved(landmarks.size());
  for (std::size_t index = 0; index < moved.size(); ++index)
  {
    transform->TransformPoint(landmarks[index].Uncompressed.data(), moved[index].data());
  }
  return moved;
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

void PointErrors::Add(const Vector3& error, double onReceptorMm)
{
  this->InSpaceMm.push_back(Norm(error));
  this->OnReceptorMm.push_back(onReceptorMm);
  this->AlongBeamMm.push_back(std::abs(error[2]));
}

std::vector<Vector3> Displace(const std::vector<Vector3>& points, vtkUnstructuredGrid* body)
{
  vtkDataArray* displacement = body->GetPointData()->GetArray("Displacement");
  if (!displacement || displacement->GetNumberOfComponents() != 3)
  {
    throw InputError("mesh: expected the point array 'Displacement' with 3 components");
  }
  CellFinder finder(body);
  std::vector<Vector3> moved;
  moved.reserve(points.size());
  for (const Vector3& point : points)
  {
    moved.push_back(
      point + finder.Find(point, std::numeric_limits<double>::max()).Interpolate(displacement));
  }
  return moved;
}

std::vector<LandmarkErrors> EvaluateLandmarks(const std::vector<Landmark>& landmarks,
  const LandmarkTruth& truth, vtkUnstructuredGrid* uncompressed, const VolumeFromGantry& registered,
  const MammographyUnit& registeredUnit)
{
  std::vector<LandmarkErrors> methods;
  const MammographyUnit trueUnit = TrueUnit(truth);
  // `found`: the compressed landmarks by a method, in the frame of `placed`.
  const auto add = [&](const std::string& name, const std::vector<Vector3>& found,
                     const VolumeFromGantry& placed, const MammographyUnit& unit)
  {
    LandmarkErrors errors;
    errors.Method = name;
    for (std::size_t index = 0; index < landmarks.size(); ++index)
    {
      const Vector3 expected = truth.Placed.ToGantry(landmarks[index].Compressed);
      const Vector3 at = placed.ToGantry(found[index]);
      const double onReceptorMm = Norm(OnReceptor(at, unit) - OnReceptor(expected, trueUnit));
      errors.All.Add(at - expected, onReceptorMm);
      if (landmarks[index].Imaged)
      {
        errors.Imaged.Add(at - expected, onReceptorMm);
      }
    }
    methods.push_back(errors);
  };
  std::vector<Vector3> points;
  points.reserve(landmarks.size());
  for (const Landmark& landmark : landmarks)
  {
    points.push_back(landmark.Uncompressed);
  }
  add("identity", points, truth.Placed, trueUnit);
  add("rigid, fitted to the imaged truth", MoveRigidly(landmarks, true), truth.Placed, trueUnit);
  add("rigid, fitted to all of the truth", MoveRigidly(landmarks, false), truth.Placed, trueUnit);
  add("registered", Displace(points, uncompressed), registered, registeredUnit);
  return methods;
}
}
