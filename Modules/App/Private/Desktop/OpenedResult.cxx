// SPDX-License-Identifier: Apache-2.0
#include "Private/Desktop/OpenedResult.h"

namespace mammoray
{
OpenedMammogram::OpenedMammogram(const ViewedBreast& viewed, const ProjectorOptions& projector)
  : Viewed(viewed)
  , Live(viewed, projector)
  , Worker(viewed)
  , Pane(viewed, this->Live)
  , Squeezed(this->Live, viewed)
{
  this->Pane.SetBlend(viewed.Real ? 0.5 : 0);
  this->Pane.Overlay().SetTitle((viewed.View.empty() ? "" : viewed.View + ": ") +
    (viewed.Real ? "both mammograms" : "synthetic"));
  this->OnReceptor->SetInputDataObject(this->Pane.Picture()->GetInputDataObject(0, 0));
  this->OnReceptor->SetColorModeToDirectScalars();
  this->OnReceptor->InterpolateOn();
  this->Squeezed.SetPoints(this->Live.Points());
  this->Squeezed.AddLetters(viewed.Axes, this->Live.Points());
  this->Squeezed.SetUnit(this->Live, this->OnReceptor, NearSource);
}

OpenedResult::OpenedResult(const ViewInput& input, const ProjectorOptions& projector,
  const ProgressCallback& progress)
  : Input(input)
{
  ReportProgress(progress, 0, "read the result");
  this->Viewed = ReadViewedBreasts(input);
  for (const ViewedBreast& viewed : this->Viewed)
  {
    ReportProgress(progress,
      0.3 +
        0.5 * static_cast<double>(this->Mammograms.size()) /
          static_cast<double>(this->Viewed.size()),
      "project the breast");
    this->Mammograms.push_back(std::make_unique<OpenedMammogram>(viewed, projector));
  }
  ReportProgress(progress, 0.8, "prepare the views");
  const ViewedBreast& first = this->Viewed.front();
  this->AtRest = std::make_unique<BreastScene>(this->Mammograms.front()->Live, first);
  this->AtRest->SetPoints(first.Anatomy.Points);
  this->AtRest->AddLetters(first.Axes, first.Anatomy.Points);
  if (first.Image || first.Tissue)
  {
    this->Slices = std::make_unique<SlicePanes>(first, this->AtRest->TissueColors());
  }
  this->Mark = std::make_unique<BreastMark>(*this->AtRest);
  for (const auto& mammogram : this->Mammograms)
  {
    const std::string& name = mammogram->Viewed.View;
    this->Mark->Add({ name.empty() ? "" : name + ": ", &mammogram->Live, &mammogram->Squeezed,
      &mammogram->Pane });
    mammogram->LookAt(mammogram->Squeezed);
  }
  this->Mammograms.front()->LookAt(*this->AtRest);
  if (!input.Result.empty())
  {
    const std::vector<ResultFile> files = ReadResultFiles(input.Result);
    for (std::size_t index = 0; index < files.size() && index < this->Mammograms.size(); ++index)
    {
      this->Mammograms[index]->Expected = files[index].Expected;
    }
  }
  ReportProgress(progress, 0.9, "prepare the marks");
  this->Mark->Update(); // finds the breasts that marks are looked for in
}
}
