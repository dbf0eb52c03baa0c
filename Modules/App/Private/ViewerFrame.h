// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ViewerFrame_h
#define mammoray_ViewerFrame_h

#include "Private/ControlPane.h"
#include "Private/ViewerStyle.h"
#include "mammoray/App/BreastViewer.h"

#include "vtkNew.h"
#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkSmartPointer.h"

#include <array>
#include <chrono>
#include <functional>
#include <optional>
#include <string>

class vtkTextActor;

namespace mammoray
{
/// A window with a strip of controls and a help text over it, and its loop of events.
struct ViewerFrame : MouseTarget
{
  /// After the renderers of what is shown and the controls were added.
  void Open(const std::string& title, const std::string& help, const ViewerOptions& options);
  /// Before the renderers go: window and interactor hold each other.
  void Close();
  /// Shows the window and calls `tick` many times a second until it is closed. Once in a process:
  /// see BreastViewer.
  void Run(const std::function<void()>& tick);

  static bool In(vtkRenderer* renderer, int x, int y)
  {
    return renderer->GetRenderWindow() && renderer->GetDraw() != 0 &&
      renderer->IsInViewport(x, y) != 0;
  }
  /// The place under a pixel of the window, in the plane across the view through `depth`.
  static Vector3 WorldUnder(vtkRenderer* view, int x, int y, const Vector3& depth);
  /// Places controls and help; the height of their strip in shares of the window's. Nothing where
  /// the window is as large as it was.
  std::optional<double> LayControls();
  /// True where the help, which any click closes, or the controls take a press.
  bool TakesPress(int x, int y);
  void ToggleHelp();
  /// Something that the picture shows has changed.
  void Moved();
  /// True, once, when nothing has moved for a while.
  bool ComesToRest();

  ControlPane Controls;
  vtkNew<vtkRenderer> HelpView;
  vtkNew<vtkRenderWindow> Window;
  vtkSmartPointer<vtkRenderWindowInteractor> Interactor;
  vtkNew<ViewerStyle> Style;
  vtkSmartPointer<vtkTextActor> Help;
  std::array<int, 2> Size{ 0, 0 };
  bool Moving = false;
  bool Dirty = true;
  std::chrono::steady_clock::time_point LastMove = std::chrono::steady_clock::now();
};
}

#endif
