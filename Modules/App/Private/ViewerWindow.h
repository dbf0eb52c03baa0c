// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ViewerWindow_h
#define mammoray_ViewerWindow_h

#include "Private/BreastMark.h"
#include "Private/BreastScene.h"
#include "Private/CompressionWorker.h"
#include "Private/LiveMammogram.h"
#include "Private/MammogramPane.h"
#include "Private/SlicePanes.h"
#include "Private/ViewerFrame.h"
#include "mammoray/App/BreastViewer.h"

#include "vtkNew.h"
#include "vtkSmartPointer.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

class vtkTextActor;

namespace mammoray
{
/// One mammogram with the unit that makes it: its picture, and the breast between its plates.
struct ViewedUnit
{
  ViewedUnit(const ViewedBreast& viewed, const ViewerOptions& options);

  const ViewedBreast& Viewed;
  LiveMammogram Live;
  CompressionWorker Worker;
  MammogramPane Pane;
  BreastScene Squeezed;
  /// Where the unit was and how thick the breast is, in words.
  vtkSmartPointer<vtkTextActor> UnitText;
  /// What the points shown are made of where they were not solved for, in words.
  std::string Reduced;
};

/**
 * The parts of the window and what the mouse does to them. Of several mammograms all are shown; one
 * of them is active: its unit is in the scene between the plates, and the sliders move it.
 */
struct ViewerWindow : ViewerFrame
{
  ViewerWindow(BreastViewer& viewer, const std::vector<ViewedBreast>& viewed,
    const ViewerOptions& options);
  ~ViewerWindow() override;

  Kind KindAt(int x, int y) override;
  bool OnPress(int x, int y, bool shift) override;
  void OnDrag(int x, int y) override;
  void OnRelease() override { this->Dragging = Drag::Nothing; }
  void OnClick(int x, int y) override { this->Viewer.Click(x, y); }
  void OnWindow(int right, int up) override;
  bool OnWheel(int x, int y, int steps) override;
  void OnKey(const std::string& name) override { this->Viewer.Key(name); }

  ViewedUnit& Active() { return *this->Units[this->ActiveUnit]; }
  const ViewedUnit& Active() const { return *this->Units[this->ActiveUnit]; }
  /// The number of the mammogram or slice there; nothing beside them.
  std::optional<std::size_t> MammogramAt(int x, int y) const;
  std::optional<int> SliceAt(int x, int y);
  /// The overlay of the picture there; null where there is none.
  PaneOverlay* PictureAt(int x, int y);

  void AddControls();
  /// Divides the window, by its size, among the renderers.
  void Lay();
  void Activate(std::size_t unit);
  /// Cameras and greys as at the beginning.
  void LookAt();
  void Draw(int divisor);
  void Compress(ViewedUnit& unit);
  void Show(ViewedUnit& unit, const CompressedAnatomy& answer);
  void TakeEquilibria();
  /// Waits for those under way and takes them. Throws Interrupted.
  void AwaitEquilibria();
  /// Draws the mark in all views, takes the slices there, and tells of it.
  void UpdateMark();
  /// False, with the reason as message, where there is nothing to mark.
  bool TryMark();
  void TellStatus();
  void SavePictures();
  void MoveBy(const std::string& key);
  /// What is being computed; empty: nothing.
  std::string Stage() const;
  /// Goes to the next lesion of the list.
  void NextLesion();

  enum class Drag
  {
    Nothing,
    Source,
    Ruler,
    Controls
  };

  BreastViewer& Viewer;
  ViewerOptions Options;
  std::vector<std::unique_ptr<ViewedUnit>> Units;
  std::size_t ActiveUnit = 0;
  BreastScene AtRest;
  std::unique_ptr<SlicePanes> Slices;
  BreastMark Mark;
  int ThicknessSlider = 0;
  int RollSlider = 0;
  int BlendSlider = -1;
  int KilovoltageSlider = 0;

  double ShownSource = NearSource;
  Drag Dragging = Drag::Nothing;
  PaneOverlay* Ruled = nullptr;
  PaneOverlay* Pressed = nullptr;
  std::size_t LesionNumber = 0;
  std::string Message;
  std::string StatusText;
};
}

#endif
