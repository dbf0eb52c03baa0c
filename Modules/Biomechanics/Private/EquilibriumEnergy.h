// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_EquilibriumEnergy_h
#define mammoray_EquilibriumEnergy_h

#include "Private/AttachmentEnergy.h"
#include "Private/ContactEnergy.h"
#include "Private/ElasticEnergy.h"
#include "Private/FrictionEnergy.h"
#include "Private/LoadEnergy.h"
#include "Private/MovingPart.h"
#include "Private/Objective.h"
#include "mammorayBiomechanicsModule.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace mammoray
{
/// The potential energy of a body: the sum of its elastic energy, contact and friction with two
/// plates, the attachment to the chest wall and the work of dead loads. Sums are formed in the
/// order of the elements, so they do not depend on the number of threads.
class MAMMORAYBIOMECHANICS_EXPORT EquilibriumEnergy : public Objective
{
public:
  /// For `fixed` and `rigid` see MovingPart. `contactStiffness` is in kPa / mm^2 and positive. The
  /// body must outlive the energy.
  EquilibriumEnergy(const ElasticBody& body, const std::vector<bool>& fixed,
    double contactStiffness, const std::vector<bool>& rigid = {});
  EquilibriumEnergy(const EquilibriumEnergy&) = delete;
  EquilibriumEnergy& operator=(const EquilibriumEnergy&) = delete;

  /// Call this after the body's materials or its undeformed shape have changed.
  void BodyChanged();
  void SetDomain(ElasticEnergy::Domain domain);
  /// Null removes the plates, and with them contact and friction.
  void SetPlates(const PlatePair* plates);
  void SetContactStiffness(double stiffness);
  void SetFriction(FrictionPoints points);
  /// Sets the attachment to the chest wall, of the same body; null for none. It must outlive its
  /// use.
  void SetAttachment(const AttachmentEnergy* attachment);
  /// Sets the dead loads, 3 x nodeCount, kPa mm^2; empty for none. Throws InputError on another
  /// size.
  void SetLoads(std::vector<double> loads);

  const MovingPart& Part() const { return this->Moving; }
  const ElasticEnergy& Elastic() const { return this->BodyTerm; }
  const ContactEnergy& Contact() const { return this->ContactTerm; }
  const FrictionEnergy& Friction() const { return this->FrictionTerm; }
  const AttachmentEnergy* Attachment() const { return this->WallTerm; }
  /// Undeformed volume, mm^3.
  double RestVolume() const { return this->VolumeAtRest; }

  const std::vector<std::int32_t>& Coordinates() const override
  {
    return this->Moving.Coordinates();
  }
  const SparsePattern& Pattern() const override { return this->HessianPattern; }
  void Evaluate(const std::vector<double>& x, EnergyOrder order, Evaluation& result) override;
  double Noise() const override { return this->EnergyNoise; }
  std::uint64_t Version() const override { return this->Changes; }
  std::unique_ptr<Objective> WorstPart(const std::vector<double>& gradient) const override;

private:
  /// Terms of one element: those of the body, and those of contact and friction.
  struct ElementWork
  {
    double Value = 0;
    PositionMeasures Measures;
    std::vector<double> BodyGradient;
    std::vector<double> ContactGradient;
    /// Lower half of the sum's Hessian, column by column; half the memory traffic of the whole.
    std::vector<double> LowerHalf;
    bool Valid = false;
  };
  struct NodeWork
  {
    PieceTerms Terms;
    std::array<double, 3> Gradient{};
    std::array<double, 9> Hessian{};
  };
  /// Norms of the kinds of force that the residual is compared with.
  struct ForceNorms
  {
    double Contact = 0;
    double Wall = 0;
    double Loads = 0;
  };

  std::span<const std::int32_t> NodesOf(std::size_t moving) const
  {
    return this->Moving.Body().NodesOf(this->Moving.Elements()[moving]);
  }
  /// Coordinate that belongs to a row of a moving element's matrix.
  std::size_t CoordinateOf(std::size_t moving, std::size_t row) const
  {
    return 3 * static_cast<std::size_t>(this->NodesOf(moving)[row / 3]) + row % 3;
  }
  void MakePattern();
  void MakeScatter();
  void MeasureScales();
  void EvaluateElement(std::size_t moving, const std::vector<double>& x, EnergyOrder order);
  void SumElements(EnergyOrder order, Evaluation& result, ForceNorms& norms) const;
  void AddLoads(const std::vector<double>& x, EnergyOrder order, Evaluation& result,
    ForceNorms& norms) const;
  void AddAttachment(const std::vector<double>& x, EnergyOrder order, Evaluation& result,
    ForceNorms& norms);
  void MeasureForces(const ForceNorms& norms, Evaluation& result) const;
  void ScatterHessians(Evaluation& result) const;
  std::vector<bool> FixedAroundWorst(const std::vector<double>& gradient) const;

  const MovingPart Moving;
  ElasticEnergy BodyTerm;
  ContactEnergy ContactTerm;
  FrictionEnergy FrictionTerm;
  LoadEnergy LoadTerm;
  const AttachmentEnergy* WallTerm = nullptr;
  bool HasPlates = false;
  std::uint64_t Changes = 1;

  SparsePattern HessianPattern;
  /// Position in the pattern of each entry of the lower half of an element's matrix; -1 if it has
  /// none. The entries of moving element m begin at ScatterStarts[m].
  std::vector<std::int32_t> Scatter;
  std::vector<std::size_t> ScatterStarts;
  /// Lower bound of the force scale, so that convergence is defined while nothing touches.
  double SmallestForce = 0;
  double VolumeAtRest = 0;
  double EnergyNoise = 0;

  std::vector<ElementWork> Elements;
  std::vector<NodeWork> WallNodes;
};
}

#endif
