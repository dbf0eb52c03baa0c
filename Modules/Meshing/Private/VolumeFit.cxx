// SPDX-License-Identifier: Apache-2.0
#include "Private/EditableMesh.h"

#include <Eigen/Dense>

#include <algorithm>
#include <numbers>

namespace mammoray
{
namespace
{
/// Gradient of a material's volume with respect to the position of a point: a third of its outward
/// area normals.
struct Gradient
{
  std::int32_t Point;
  std::size_t Material;
  Vector3 Normal;
};

class VolumeFitter
{
public:
  VolumeFitter(EditableMesh& mesh, const std::map<std::int32_t, double>& volumes, double shiftMm,
    double leastDeg)
    : Mesh(mesh)
    , ShiftMm(shiftMm)
    , LeastQuality(std::sin(leastDeg * std::numbers::pi / 180))
    , Anchors(mesh.Points)
  {
    for (const auto& [material, volume] : volumes)
    {
      this->Place[material] = this->Targets.size();
      this->Targets.push_back(volume);
    }
    for (std::size_t n = 0; n < mesh.Points.size(); ++n)
    {
      const auto point = static_cast<std::int32_t>(n);
      if (!mesh.Arcs(point).empty())
      {
        this->Interface.push_back(point);
      }
    }
  }

  /// Takes one Newton step; returns false when all volumes are reached.
  bool Step()
  {
    const Eigen::VectorXd wanted = this->Differences();
    if (wanted.cwiseAbs().maxCoeff() == 0)
    {
      return false;
    }
    const std::vector<Gradient> gradients = this->Gradients();
    // Displacements are W G o with W = 1 / (area around the point): solve G^T W G o = wanted.
    const auto count = static_cast<Eigen::Index>(this->Targets.size());
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(count, count);
    for (std::size_t begin = 0, end = 0; begin < gradients.size(); begin = end)
    {
      end = this->EndOfPoint(gradients, begin);
      const double weight = Weight(gradients, begin, end);
      for (std::size_t a = begin; a < end; ++a)
      {
        for (std::size_t b = begin; b < end; ++b)
        {
          normal(static_cast<Eigen::Index>(gradients[a].Material),
            static_cast<Eigen::Index>(gradients[b].Material)) +=
            weight * Dot(gradients[a].Normal, gradients[b].Normal);
        }
      }
    }
    // A material without a movable interface would make the matrix singular.
    normal.diagonal().array() += 1e-12 * normal.trace() + 1e-300;
    const Eigen::VectorXd offsets = normal.ldlt().solve(wanted);
    for (std::size_t begin = 0, end = 0; begin < gradients.size(); begin = end)
    {
      end = this->EndOfPoint(gradients, begin);
      const double weight = Weight(gradients, begin, end);
      Vector3 shift{ 0, 0, 0 };
      for (std::size_t a = begin; a < end; ++a)
      {
        shift = shift +
          weight * offsets[static_cast<Eigen::Index>(gradients[a].Material)] * gradients[a].Normal;
      }
      this->Move(gradients[begin].Point, shift);
    }
    return true;
  }

private:
  Eigen::VectorXd Differences() const
  {
    Eigen::VectorXd wanted =
      Eigen::Map<const Eigen::VectorXd>(this->Targets.data(), this->Targets.size());
    const Eigen::VectorXd targets = wanted;
    for (std::size_t n = 0; n < this->Mesh.NumberOfCells(); ++n)
    {
      const auto cell = static_cast<std::int32_t>(n);
      const auto place = this->Place.find(this->Mesh[cell].Material);
      if (this->Mesh.IsAlive(cell) && place != this->Place.end())
      {
        wanted[static_cast<Eigen::Index>(place->second)] -= this->Mesh.Volume(this->Mesh[cell].Ids);
      }
    }
    // 1e-3 is accurate enough; small materials with few cells may never reach it.
    for (Eigen::Index n = 0; n < wanted.size(); ++n)
    {
      wanted[n] = std::abs(wanted[n]) <= 1e-3 * targets[n] ? 0 : wanted[n];
    }
    return wanted;
  }

  std::vector<Gradient> Gradients() const
  {
    std::vector<Gradient> gradients;
    for (const std::int32_t point : this->Interface)
    {
      // The gradient of a cell's volume is a third of the area normal of the face opposite to the
      // point; faces inside a material cancel.
      std::map<std::size_t, Vector3> sums;
      for (const std::int32_t cell : this->Mesh.Star(point))
      {
        const auto place = this->Place.find(this->Mesh[cell].Material);
        if (place != this->Place.end())
        {
          Vector3& sum = sums.try_emplace(place->second, Vector3{ 0, 0, 0 }).first->second;
          sum = sum + this->VolumeGradient(this->Mesh[cell].Ids, point);
        }
      }
      for (const auto& [material, sum] : sums)
      {
        gradients.push_back({ point, material, sum });
      }
    }
    return gradients;
  }

  Vector3 VolumeGradient(const std::array<std::int32_t, 4>& ids, std::int32_t point) const
  {
    // Corners of the face opposite to each corner, oriented so that the gradient points inwards.
    constexpr int faces[4][3] = { { 1, 3, 2 }, { 0, 2, 3 }, { 0, 3, 1 }, { 0, 1, 2 } };
    const auto corner =
      static_cast<std::size_t>(std::find(ids.begin(), ids.end(), point) - ids.begin());
    const Vector3& a = this->Mesh.Point(ids[static_cast<std::size_t>(faces[corner][0])]);
    const Vector3& b = this->Mesh.Point(ids[static_cast<std::size_t>(faces[corner][1])]);
    const Vector3& c = this->Mesh.Point(ids[static_cast<std::size_t>(faces[corner][2])]);
    return (1.0 / 6) * Cross(b - a, c - a);
  }

  static std::size_t EndOfPoint(const std::vector<Gradient>& gradients, std::size_t begin)
  {
    std::size_t end = begin;
    while (end < gradients.size() && gradients[end].Point == gradients[begin].Point)
    {
      ++end;
    }
    return end;
  }

  static double Weight(const std::vector<Gradient>& gradients, std::size_t begin, std::size_t end)
  {
    double largest = 0;
    for (std::size_t n = begin; n < end; ++n)
    {
      largest = std::max(largest, Norm(gradients[n].Normal));
    }
    return largest > 0 ? 1 / largest : 0;
  }

  /// Moves a point by as much of the shift as the limit and the cells allow.
  void Move(std::int32_t point, Vector3 shift)
  {
    Vector3& place = this->Mesh.Points[static_cast<std::size_t>(point)];
    const Vector3 old = place;
    const Vector3& anchor = this->Anchors[static_cast<std::size_t>(point)];
    const double length = Norm(old + shift - anchor);
    if (length > this->ShiftMm)
    {
      shift = anchor + (this->ShiftMm / length) * (old + shift - anchor) - old;
    }
    const double before = std::min(this->LeastQuality, this->WorstAround(point));
    const int halvings = 3;
    for (int halving = 0; halving < halvings; ++halving, shift = 0.5 * shift)
    {
      place = old + shift;
      if (this->WorstAround(point) >= before)
      {
        return;
      }
    }
    place = old;
  }

  double WorstAround(std::int32_t point) const
  {
    return this->Mesh.WorstOf(this->Mesh.Star(point));
  }

  EditableMesh& Mesh;
  double ShiftMm;
  double LeastQuality;
  std::vector<Vector3> Anchors;
  /// Index in Targets of each material.
  std::map<std::int32_t, std::size_t> Place;
  std::vector<double> Targets;
  /// Points where materials meet; moves do not change them.
  std::vector<std::int32_t> Interface;
};
}

void FitVolumes(EditableMesh& mesh, const std::map<std::int32_t, double>& volumesMm3,
  double shiftMm, double leastDeg, const ProgressCallback& progress)
{
  constexpr const char* stage = "fitting volumes";
  ReportProgress(progress, 0.0, stage);
  VolumeFitter fitter(mesh, volumesMm3, shiftMm, leastDeg);
  const int steps = 8;
  for (int step = 0; step < steps && fitter.Step(); ++step)
  {
    ReportProgress(progress, (step + 1.0) / steps, stage);
  }
}
}
