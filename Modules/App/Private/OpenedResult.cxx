// SPDX-License-Identifier: Apache-2.0
#include "Private/OpenedResult.h"

#include "vtkTexture.h"

#include <utility>

namespace mammoray
{
OpenedMammogram::OpenedMammogram(const ViewedBreast& viewed, const ProjectorOptions& projector)
  : Viewed(viewed)
  , Live(viewed, projector)
  , Worker(viewed)
  , Pane(viewed, this->Live)
  , Squeezed(this->Live, viewed)
  , OnReceptor(this->Pane.NewTexture())
{
  this->Pane.SetBlend(0.5);
  this->Pane.Overlay().SetTitle(
    this->Prefix() + (viewed.Real ? "synthetic and real" : "synthetic"));
  this->Squeezed.SetPoints(this->Live.Points());
  this->Squeezed.AddLetters(viewed.Axes, this->Live.Points());
  this->Squeezed.SetUnit(this->Live, this->OnReceptor);
}

void OpenedMammogram::Update(int divisor)
{
  this->Pane.Update(this->Live, divisor);
  this->Squeezed.SetUnit(this->Live, this->OnReceptor);
}

void OpenedMammogram::SetPoints(const std::vector<double>& points)
{
  this->Live.SetPoints(points);
  this->Squeezed.SetPoints(points);
}

std::optional<CompressedAnatomy> OpenedMammogram::Compress()
{
  const BreastPose& pose = this->Live.Pose();
  this->Worker.Ask(pose);
  std::optional<CompressedAnatomy> reduced = this->Worker.Reduced(pose);
  if (reduced)
  {
    this->SetPoints(reduced->Points);
  }
  return reduced;
}

std::optional<CompressedAnatomy> OpenedMammogram::TakeEquilibrium()
{
  std::optional<CompressedAnatomy> answer = this->Worker.Take();
  if (!answer || !answer->Error.empty())
  {
    return answer;
  }
  const BreastPose& pose = this->Live.Pose();
  if (answer->Pose.ThicknessMm != pose.ThicknessMm || answer->Pose.RollDeg != pose.RollDeg)
  {
    if (std::optional<CompressedAnatomy> reduced = this->Worker.Reduced(pose))
    {
      answer = std::move(reduced);
    }
  }
  this->SetPoints(answer->Points);
  return answer;
}

OpenedResult::OpenedResult(std::vector<ViewedBreast> viewed, const ProjectorOptions& projector,
  const ProgressCallback& progress)
  : Viewed(std::move(viewed))
{
  const auto count = static_cast<double>(this->Viewed.size());
  for (const ViewedBreast& one : this->Viewed)
  {
    ReportProgress(progress, 0.6 * static_cast<double>(this->Mammograms.size()) / count,
      "project the breast");
    this->Mammograms.push_back(std::make_unique<OpenedMammogram>(one, projector));
    this->Mammograms.back()->LookAt(this->Mammograms.back()->Squeezed);
  }
  ReportProgress(progress, 0.6, "prepare the views");
  const ViewedBreast& first = this->Viewed.front();
  this->AtRest = std::make_unique<BreastScene>(this->Mammograms.front()->Live, first);
  this->AtRest->SetPoints(first.Anatomy.Points);
  this->AtRest->AddLetters(first.Axes, first.Anatomy.Points);
  this->Mammograms.front()->LookAt(*this->AtRest);
  if (first.Image || first.Tissue)
  {
    this->Slices = std::make_unique<SlicePanes>(first, this->AtRest->TissueColors());
  }
  ReportProgress(progress, 0.8, "prepare the marks");
  this->Mark = std::make_unique<BreastMark>(*this->AtRest, this->Mammograms);
}
}
