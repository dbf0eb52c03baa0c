// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ViewWidget_h
#define mammoray_ViewWidget_h

#include "Private/SlicePanes.h"

#include <QPoint>
#include <QVTKOpenGLNativeWidget.h>

#include <array>
#include <functional>
#include <vector>

class vtkRenderer;

namespace mammoray
{
/// What the left button does in pictures and slices.
enum class ViewTool
{
  Mark,
  Grey, ///< Window and level.
  Ruler
};

/**
 * A view of the desktop application: renderers of VTK in a widget of Qt. Pictures and slices are
 * seen along their normal; the right button zooms and the middle one pans. Scenes turn. Places are
 * pixels of the view from its lower left corner.
 */
class ViewWidget : public QVTKOpenGLNativeWidget
{
public:
  enum class Kind
  {
    Picture,
    Slice,
    Scene
  };
  ViewWidget(Kind kind, const QString& name, QWidget* parent = nullptr);
  ~ViewWidget() override;

  /// `layers`: the first is the lowest. `overlay`: of a picture or slice; else null.
  void Show(const std::vector<vtkRenderer*>& layers, PaneOverlay* overlay = nullptr);
  /// Shows nothing, and forgets all functions below but DoubleClicked.
  void Clear();
  /// Draws soon, once for any number of calls.
  void Redraw();
  /// Draws now.
  void Draw();
  void SetTool(ViewTool tool) { this->Tool = tool; }
  void Zoom(double factor);
  /// The picture fills the view again, also when its size changes, until the user zooms.
  void Refit();

  std::function<void()> BeforeDraw;
  std::function<void()> Fit;
  std::function<void(int x, int y)> Clicked;
  /// Window and level by shares of the window.
  std::function<void(double windowFactor, double levelShare)> GreyDragged;
  std::function<void(int steps)> Scrolled;
  /// The overlay's ruler has other ends.
  std::function<void()> Ruled;
  std::function<void()> DoubleClicked;
  /// A scene: whether a press there begins a drag of something; then where it goes.
  std::function<bool(int x, int y)> Grabbed;
  std::function<void(int x, int y)> Dragged;

  std::array<int, 2> PlaceOf(const QPoint& at) const;

protected:
  bool event(QEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

private:
  bool SceneEvent(QEvent* event);
  bool OwnEvent(QEvent* event);
  void Pan(const QPoint& from, const QPoint& to);

  Kind Shown;
  std::vector<vtkRenderer*> Layers;
  PaneOverlay* Overlay = nullptr;
  ViewTool Tool = ViewTool::Mark;
  Qt::MouseButton Button = Qt::NoButton;
  QPoint Pressed;
  QPoint Last;
  bool Moved = false;
  bool Grabs = false;
  bool Fitted = true;
  bool Pending = false;
  double Wheel = 0;
};

using ThreeViews = std::array<ViewWidget*, SlicePanes::Count>;

/// Shows slices, which must outlive that, in three views; `clicked` gets the place.
void ShowSlices(SlicePanes& slices, const ThreeViews& views,
  const std::function<void(const Vector3&)>& clicked);
}

#endif
