// SPDX-License-Identifier: Apache-2.0
#include "mammoray/App/Pictures.h"

#include "Private/LiveProjection.h"
#include "Private/OpenedResult.h"
#include "Private/ProjectionPane.h"
#include "Private/RequireDisplay.h"
#include "Private/SampleScene.h"
#include "Private/SceneShapes.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ProjectionImage.h"
#include "mammoray/Registration/RegistrationResult.h"

#include "vtkCoordinate.h"
#include "vtkNew.h"
#include "vtkRenderWindow.h"
#include "vtkTextActor.h"
#include "vtkTextProperty.h"
#include "vtkWindowToImageFilter.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <thread>
#include <utility>

namespace mammoray
{
namespace
{
// Pixels.
constexpr int Border = 10;
constexpr int LegendHeight = 26;
constexpr int LineHeight = 17;
constexpr Color WarningColor{ 1.0, 0.65, 0.25 };
/// Shares of the width that the samples have, and the breast without and with slices.
constexpr double SceneShare = 0.46;
constexpr double NarrowShare = 0.29;
constexpr double SlicesEnd = 0.52;
/// Share of the height that the breast between the plates has.
constexpr double SqueezedShare = 0.62;

/// Views side by side, over the materials' names on their colours and lines of text.
class Sheet
{
public:
  /// `warnings` follow the lines, in a colour of their own. A colour for each material.
  Sheet(const PictureOptions& options, const std::vector<std::string>& lines,
    const std::vector<std::string>& warnings, const MaterialTable& materials,
    const std::vector<Color>& colors);

  /// Shares of the sheet, and of its height above the text.
  void Place(vtkRenderer* view, double left, double bottom, double right, double top);
  void Write(const std::string& path);

private:
  vtkTextActor* Add(const std::string& text, int size, double x, double y);

  vtkNew<vtkRenderWindow> Window;
  vtkNew<vtkRenderer> Strip;
  double Bottom = 0;
};

Sheet::Sheet(const PictureOptions& options, const std::vector<std::string>& lines,
  const std::vector<std::string>& warnings, const MaterialTable& materials,
  const std::vector<Color>& colors)
{
  this->Window->SetOffScreenRendering(1);
  this->Window->SetSize(options.Width, options.Height);
  this->Window->SetMultiSamples(4);
  this->Window->SetNumberOfLayers(2);
  this->Window->AddRenderer(this->Strip);
  this->Strip->SetBackground(0.16, 0.17, 0.20);
  const auto count = static_cast<int>(lines.size() + warnings.size());
  const int height = std::min(LegendHeight + count * LineHeight + Border, options.Height / 2);
  this->Bottom = static_cast<double>(height) / options.Height;
  this->Strip->SetViewport(0, 0, 1, this->Bottom);
  double x = Border;
  double y = height - 0.25 * LegendHeight;
  for (std::size_t material = 1; material < colors.size(); ++material)
  {
    const Color& color = colors[material];
    vtkTextActor* name = this->Add(" " + materials.Materials[material].Name + " ", 13, x, y);
    name->GetTextProperty()->SetBackgroundColor(color[0], color[1], color[2]);
    name->GetTextProperty()->SetBackgroundOpacity(1);
    // Black or white, whichever is told from it.
    const double ink = 0.3 * color[0] + 0.6 * color[1] + 0.1 * color[2] > 0.45 ? 0 : 1;
    name->GetTextProperty()->SetColor(ink, ink, ink);
    double box[4];
    name->GetBoundingBox(this->Strip, box);
    x += box[1] - box[0] + Border;
  }
  y = height - LegendHeight;
  for (const std::string& line : lines)
  {
    this->Add(line, 12, Border, y);
    y -= LineHeight;
  }
  for (const std::string& warning : warnings)
  {
    this->Add(warning, 12, Border, y)
      ->GetTextProperty()
      ->SetColor(WarningColor[0], WarningColor[1], WarningColor[2]);
    y -= LineHeight;
  }
}

vtkTextActor* Sheet::Add(const std::string& text, int size, double x, double y)
{
  const auto actor = AddText(this->Strip, text, 0, 0, size);
  actor->GetPositionCoordinate()->SetCoordinateSystemToViewport();
  actor->GetPositionCoordinate()->SetValue(x, y);
  return actor;
}

void Sheet::Place(vtkRenderer* view, double left, double bottom, double right, double top)
{
  const double height = 1 - this->Bottom;
  view->SetViewport(left, this->Bottom + bottom * height, right, this->Bottom + top * height);
  this->Window->AddRenderer(view);
}

void Sheet::Write(const std::string& path)
{
  this->Window->Render();
  vtkNew<vtkWindowToImageFilter> capture;
  capture->SetInput(this->Window);
  capture->ReadFrontBufferOff();
  capture->ShouldRerenderOff();
  capture->Update();
  WritePicture(capture->GetOutput(), path);
  this->Window->Finalize(); // before the views, which have their parts on the graphics device
}

std::vector<std::string> LinesOf(const std::string& text)
{
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
  {
    lines.push_back(line);
  }
  return lines;
}

std::string SourceText(const Vector3& offset)
{
  char text[100];
  std::snprintf(text, sizeof text, "source %+.4g %+.4g %+.4g mm", offset[0], offset[1], offset[2]);
  return text;
}

/// Brings the breast between the plates where it is not; returns what came of it.
std::string Settle(OpenedMammogram& mammogram, const ProgressCallback& progress)
{
  if (!mammogram.Viewed.PoseDiffers)
  {
    return "";
  }
  mammogram.Compress();
  std::optional<CompressedAnatomy> answer;
  while (!(answer = mammogram.TakeEquilibrium()))
  {
    ReportProgress(progress, 0, ("compress: " + mammogram.Worker.Stage()).c_str());
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  if (!answer->Error.empty())
  {
    throw Error(answer->Error);
  }
  ReportProgress(progress, 1, "compress");
  char text[100];
  std::snprintf(text, sizeof text, "%s%.1f mm, %.1f N, compressed in %.1f s",
    mammogram.Prefix().c_str(), answer->Pose.ThicknessMm, answer->PaddleForceN, answer->Seconds);
  return text;
}

std::string UnitText(const OpenedMammogram& mammogram)
{
  const LiveMammogram& live = mammogram.Live;
  char text[100];
  // Not "-0.0".
  const double roll = std::round(10 * live.Pose().RollDeg) / 10 + 0.0;
  std::snprintf(text, sizeof text, "%.1f mm, roll %.1f deg, %.1f kV, ", live.Pose().ThicknessMm,
    roll, live.Kilovoltage());
  return mammogram.Prefix() + text + SourceText(live.SourceOffset());
}

void DrawMark(OpenedResult& opened, const PictureOptions& options)
{
  if (options.Point)
  {
    opened.Mark->Set(*options.Point);
  }
  else if (options.Pixel)
  {
    opened.Mark->Set(*options.Pixel, 0);
  }
  opened.Mark->Update();
  if (opened.Slices)
  {
    opened.Slices->SetMark(opened.Mark->Middle(), opened.Mark->RestLines());
  }
}

/// Scenes at the left, then the slices below each other, then the mammograms.
void PlaceViews(OpenedResult& opened, Sheet& sheet)
{
  OpenedMammogram& first = *opened.Mammograms.front();
  const double left = opened.Slices ? NarrowShare : SceneShare;
  const double middle = opened.Slices ? SlicesEnd : left;
  const auto add = [&](BreastScene& scene, double bottom, double top, const char* title)
  {
    sheet.Place(scene.Renderer(), 0, bottom, left, top);
    sheet.Place(scene.MarkRenderer(), 0, bottom, left, top);
    AddText(scene.Renderer(), title, 0.012, 0.985, 14);
    first.LookAt(scene);
  };
  add(first.Squeezed, 1 - SqueezedShare, 1, "between the plates");
  add(*opened.AtRest, 0, 1 - SqueezedShare, "uncompressed");
  for (int pane = 0; opened.Slices && pane < SlicePanes::Count; ++pane)
  {
    constexpr double Step = 1.0 / SlicePanes::Count;
    sheet.Place(opened.Slices->Renderer(pane), left, 1 - (pane + 1) * Step, middle,
      1 - pane * Step);
  }
  if (opened.Slices)
  {
    opened.Slices->Frame();
    opened.Slices->Update();
  }
  const double width = (1 - middle) / static_cast<double>(opened.Mammograms.size());
  for (std::size_t index = 0; index < opened.Mammograms.size(); ++index)
  {
    MammogramPane& pane = opened.Mammograms[index]->Pane;
    const double from = middle + width * static_cast<double>(index);
    sheet.Place(pane.Renderer(), from, 0, from + width, 1);
    pane.Frame();
    pane.Overlay().Update();
  }
}
}

std::string WriteBreastPicture(std::vector<ViewedBreast> viewed, const PictureOptions& options,
  const std::string& path)
{
  RequireDisplay("view");
  if (viewed.empty())
  {
    throw InputError("view: expected a breast, found none");
  }
  OpenedResult opened(std::move(viewed), options.Projector);
  std::string settled;
  std::vector<std::string> lines;
  std::vector<std::string> warnings;
  for (const auto& mammogram : opened.Mammograms)
  {
    const std::string line = Settle(*mammogram, options.Progress);
    settled += (settled.empty() || line.empty() ? "" : "\n") + line;
    mammogram->Live.SetSourceOffset(options.SourceOffset);
    if (options.Energy)
    {
      mammogram->Live.SetKilovoltage(*options.Energy);
    }
    mammogram->Update(1);
    mammogram->Pane.SetBlend(options.Blend);
    lines.push_back(UnitText(*mammogram));
    const Trust trust = mammogram->Viewed.Trust.Level;
    if (trust != Trust::Good)
    {
      warnings.push_back(mammogram->Prefix() + VerdictOf(trust));
    }
  }
  DrawMark(opened, options);
  std::string found = opened.Mark->Text();
  found += (found.empty() || settled.empty() ? "" : "\n") + settled;
  for (const std::string& line : LinesOf(found))
  {
    lines.push_back(line);
  }
  Sheet sheet(options, lines, warnings, opened.Viewed.front().Materials,
    opened.AtRest->TissueColors());
  PlaceViews(opened, sheet);
  sheet.Write(path);
  return found;
}

std::string WriteScenePicture(const Scene& scene, const PictureOptions& options,
  const std::string& path)
{
  RequireDisplay("view");
  LiveProjection live(scene, options.Projector);
  live.SetSourceOffset(options.SourceOffset);
  live.SetEnergy(options.Energy.value_or(live.Energy()));
  ProjectionPane pane(live);
  SampleScene samples(scene.Materials, live, pane.NewTexture());
  samples.Update(live);
  char text[60];
  std::snprintf(text, sizeof text, "%.1f %s, ", live.Energy(),
    live.IsSingleEnergy() ? "keV" : "kV");
  std::vector<std::string> lines{ text + SourceText(live.SourceOffset()) };
  std::string found;
  if (options.Pixel)
  {
    found = live.Describe((*options.Pixel)[0], (*options.Pixel)[1]);
    lines.push_back(found);
    pane.SetMark(options.Pixel);
  }
  Sheet sheet(options, lines, {}, scene.Materials, samples.Colors());
  sheet.Place(samples.Renderer(), 0, 0, SceneShare, 1);
  sheet.Place(pane.Renderer(), SceneShare, 0, 1, 1);
  AddText(samples.Renderer(), "samples", 0.012, 0.985, 14);
  samples.LookAt(live);
  pane.Frame();
  pane.Overlay().Update();
  sheet.Write(path);
  return found;
}
}
