// SPDX-License-Identifier: Apache-2.0
#include "Private/Desktop/ViewWidget.h"

#include "vtkCamera.h"
#include "vtkGenericOpenGLRenderWindow.h"
#include "vtkInteractorStyleTrackballCamera.h"
#include "vtkNew.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkRenderer.h"
#include "vtkRendererCollection.h"

#include <QKeyEvent>
#include <QMouseEvent>
#include <QTimer>
#include <QWheelEvent>

#include <cmath>

namespace mammoray
{
namespace
{
/// A press that moves less is a click, pixels.
constexpr int ClickPixels = 4;
/// A drag across so many pixels takes window or zoom to e times its value.
constexpr double DragPixels = 250;
constexpr double ZoomStep = 1.15;
constexpr int KeyPanPixels = 24;
}

ViewWidget::ViewWidget(Kind kind, const QString& name, QWidget* parent)
  : QVTKOpenGLNativeWidget(parent)
  , Shown(kind)
{
  this->setObjectName(name);
  this->setAccessibleName(name);
  this->setFocusPolicy(Qt::StrongFocus);
  this->setMinimumSize(120, 100);
  vtkNew<vtkGenericOpenGLRenderWindow> window;
  window->SetMultiSamples(0);
  window->SetNumberOfLayers(2);
  this->setRenderWindow(window);
  vtkNew<vtkInteractorStyleTrackballCamera> style;
  this->interactor()->SetInteractorStyle(style);
}

ViewWidget::~ViewWidget()
{
  for (vtkRenderer* layer : this->Layers)
  {
    this->renderWindow()->RemoveRenderer(layer);
  }
}

void ViewWidget::Show(const std::vector<vtkRenderer*>& layers, PaneOverlay* overlay)
{
  for (vtkRenderer* layer : this->Layers)
  {
    this->renderWindow()->RemoveRenderer(layer);
  }
  this->Layers = layers;
  this->Overlay = overlay;
  for (vtkRenderer* layer : layers)
  {
    this->renderWindow()->AddRenderer(layer);
  }
  this->Refit();
}

void ViewWidget::Clear()
{
  this->Show({});
  this->BeforeDraw = nullptr;
  this->Fit = nullptr;
  this->Clicked = nullptr;
  this->GreyDragged = nullptr;
  this->Scrolled = nullptr;
  this->Ruled = nullptr;
  this->Grabbed = nullptr;
  this->Dragged = nullptr;
}

void ShowSlices(SlicePanes& slices, const ThreeViews& views,
  const std::function<void(const Vector3&)>& clicked)
{
  for (int pane = 0; pane < SlicePanes::Count; ++pane)
  {
    ViewWidget* view = views[static_cast<std::size_t>(pane)];
    view->Fit = [&slices] { slices.Frame(); };
    view->BeforeDraw = [&slices] { slices.Update(); };
    view->Clicked = [&slices, pane, clicked](int x, int y)
    { clicked(slices.Overlay(pane).WorldAt(x, y)); };
    view->Scrolled = [&slices, pane, view](int steps)
    {
      slices.Scroll(pane, steps);
      view->Redraw();
    };
    view->GreyDragged = [&slices, views](double factor, double share)
    {
      slices.Adjust(factor, share);
      for (ViewWidget* shown : views)
      {
        shown->Redraw();
      }
    };
    view->Show({ slices.Renderer(pane) }, &slices.Overlay(pane));
  }
}

void ViewWidget::Redraw()
{
  if (this->Pending || this->Layers.empty())
  {
    return;
  }
  this->Pending = true;
  QTimer::singleShot(0, this,
    [this]
    {
      if (this->Pending)
      {
        this->Draw();
      }
    });
}

void ViewWidget::Draw()
{
  this->Pending = false;
  if (this->BeforeDraw)
  {
    this->BeforeDraw();
  }
  if (this->Overlay)
  {
    this->Overlay->Update();
  }
  this->renderWindow()->Render();
}

void ViewWidget::Refit()
{
  this->Fitted = true;
  if (this->Fit && !this->Layers.empty())
  {
    this->Fit();
  }
  this->Redraw();
}

void ViewWidget::Zoom(double factor)
{
  if (this->Layers.empty())
  {
    return;
  }
  this->Fitted = false;
  vtkCamera* camera = this->Layers.front()->GetActiveCamera();
  if (this->Shown == Kind::Scene)
  {
    camera->Dolly(factor);
    this->Layers.front()->ResetCameraClippingRange();
  }
  else
  {
    camera->SetParallelScale(camera->GetParallelScale() / factor);
  }
  this->Redraw();
}

void ViewWidget::Pan(const QPoint& from, const QPoint& to)
{
  if (!this->Overlay)
  {
    return;
  }
  this->Fitted = false;
  const std::array<int, 2> first = this->PlaceOf(from);
  const std::array<int, 2> second = this->PlaceOf(to);
  const Vector3 shift =
    this->Overlay->WorldAt(first[0], first[1]) - this->Overlay->WorldAt(second[0], second[1]);
  vtkCamera* camera = this->Layers.front()->GetActiveCamera();
  Vector3 focal;
  Vector3 position;
  camera->GetFocalPoint(focal.data());
  camera->GetPosition(position.data());
  focal = focal + shift;
  position = position + shift;
  camera->SetFocalPoint(focal.data());
  camera->SetPosition(position.data());
  this->Redraw();
}

std::array<int, 2> ViewWidget::PlaceOf(const QPoint& at) const
{
  const double ratio = this->devicePixelRatioF();
  return { static_cast<int>(std::lround(at.x() * ratio)),
    static_cast<int>(std::lround((this->height() - 1 - at.y()) * ratio)) };
}

/// VTK is to see all but the mouse of pictures and slices, and keys: its own change styles and end
/// programs.
bool ViewWidget::event(QEvent* event)
{
  switch (event->type())
  {
    case QEvent::MouseButtonPress:
    case QEvent::MouseMove:
    case QEvent::MouseButtonRelease:
    case QEvent::MouseButtonDblClick:
      return this->Shown == Kind::Scene ? this->SceneEvent(event) : this->OwnEvent(event);
    case QEvent::Wheel:
      return this->Shown == Kind::Scene ? QVTKOpenGLNativeWidget::event(event)
                                        : this->OwnEvent(event);
    case QEvent::KeyPress: // VTK's own keys change styles and end programs
    case QEvent::KeyRelease:
    case QEvent::ShortcutOverride:
      return this->OwnEvent(event);
    default:
      return QVTKOpenGLNativeWidget::event(event);
  }
}

bool ViewWidget::OwnEvent(QEvent* event)
{
  // NOLINTNEXTLINE(bugprone-parent-virtual-call): what VTK would do with it is not wanted.
  return QOpenGLWidget::event(event);
}

/// VTK turns the scene; what is grabbed and clicks are ours.
bool ViewWidget::SceneEvent(QEvent* event)
{
  const auto* mouse = static_cast<QMouseEvent*>(event);
  const auto [x, y] = this->PlaceOf(mouse->pos());
  if (event->type() == QEvent::MouseButtonDblClick && this->DoubleClicked)
  {
    this->DoubleClicked();
    return true;
  }
  if (event->type() == QEvent::MouseButtonPress)
  {
    this->setFocus();
    this->Pressed = mouse->pos();
    this->Moved = false;
    this->Grabs = mouse->button() == Qt::LeftButton && this->Grabbed && this->Grabbed(x, y);
  }
  this->Moved = this->Moved || (mouse->pos() - this->Pressed).manhattanLength() >= ClickPixels;
  if (this->Grabs)
  {
    if (event->type() == QEvent::MouseMove && this->Dragged)
    {
      this->Dragged(x, y);
    }
    if (event->type() == QEvent::MouseButtonRelease)
    {
      this->Grabs = false;
    }
    return true;
  }
  if (event->type() == QEvent::MouseMove && mouse->buttons() != Qt::NoButton)
  {
    this->Fitted = false;
  }
  const bool handled = QVTKOpenGLNativeWidget::event(event);
  if (event->type() == QEvent::MouseButtonRelease && !this->Moved &&
    mouse->button() == Qt::LeftButton && this->Clicked)
  {
    this->Clicked(x, y);
  }
  return handled;
}

void ViewWidget::mousePressEvent(QMouseEvent* event)
{
  if (this->Layers.empty())
  {
    return;
  }
  this->Button = event->button();
  this->Pressed = this->Last = event->pos();
  this->Moved = false;
  if (this->Button == Qt::LeftButton && this->Overlay &&
    (this->Tool == ViewTool::Ruler || (event->modifiers() & Qt::ShiftModifier) != 0))
  {
    const auto [x, y] = this->PlaceOf(event->pos());
    const Vector3 from = this->Overlay->WorldAt(x, y);
    this->Overlay->SetRuler({ { from, from } });
    this->Grabs = true;
  }
}

void ViewWidget::mouseMoveEvent(QMouseEvent* event)
{
  if (this->Button == Qt::NoButton || this->Layers.empty())
  {
    return;
  }
  this->Moved = this->Moved || (event->pos() - this->Pressed).manhattanLength() >= ClickPixels;
  const QPoint step = event->pos() - this->Last;
  const auto [x, y] = this->PlaceOf(event->pos());
  if (this->Grabs)
  {
    this->Overlay->SetRuler({ { (*this->Overlay->RulerEnds())[0], this->Overlay->WorldAt(x, y) } });
    if (this->Ruled)
    {
      this->Ruled();
    }
    this->Redraw();
  }
  else if (this->Button == Qt::LeftButton && this->Tool == ViewTool::Grey && this->GreyDragged)
  {
    this->GreyDragged(std::exp(step.x() / DragPixels), step.y() / DragPixels);
  }
  else if (this->Button == Qt::LeftButton && this->Moved && this->Clicked)
  {
    this->Clicked(x, y); // the mark follows the mouse
  }
  else if (this->Button == Qt::RightButton)
  {
    this->Zoom(std::exp(-step.y() / DragPixels));
  }
  else if (this->Button == Qt::MiddleButton)
  {
    this->Pan(this->Last, event->pos());
  }
  this->Last = event->pos();
}

void ViewWidget::mouseReleaseEvent(QMouseEvent* event)
{
  const bool click = this->Button == Qt::LeftButton && !this->Moved && !this->Grabs;
  this->Button = Qt::NoButton;
  this->Grabs = false;
  if (click && this->Tool == ViewTool::Mark && this->Clicked)
  {
    const auto [x, y] = this->PlaceOf(event->pos());
    this->Clicked(x, y);
  }
}

void ViewWidget::mouseDoubleClickEvent(QMouseEvent* event)
{
  this->Button = Qt::NoButton;
  if (event->button() == Qt::LeftButton && this->DoubleClicked)
  {
    this->DoubleClicked();
  }
}

void ViewWidget::wheelEvent(QWheelEvent* event)
{
  constexpr double NotchEighths = 120;
  this->Wheel += event->angleDelta().y() / NotchEighths;
  const int steps = static_cast<int>(this->Wheel);
  this->Wheel -= steps;
  if (steps == 0)
  {
    return;
  }
  if (this->Shown == Kind::Slice && this->Scrolled &&
    (event->modifiers() & Qt::ControlModifier) == 0)
  {
    this->Scrolled(steps);
  }
  else
  {
    this->Zoom(std::pow(ZoomStep, steps));
  }
  event->accept();
}

void ViewWidget::keyPressEvent(QKeyEvent* event)
{
  const auto pan = [this](int right, int down) {
    this->Pan({ 0, 0 }, { -right * KeyPanPixels, -down * KeyPanPixels });
  };
  switch (event->key())
  {
    case Qt::Key_Plus:
    case Qt::Key_Equal:
      return this->Zoom(ZoomStep);
    case Qt::Key_Minus:
      return this->Zoom(1 / ZoomStep);
    case Qt::Key_Left:
      return pan(-1, 0);
    case Qt::Key_Right:
      return pan(1, 0);
    case Qt::Key_Up:
      return pan(0, -1);
    case Qt::Key_Down:
      return pan(0, 1);
    case Qt::Key_PageUp:
    case Qt::Key_PageDown:
      if (this->Scrolled)
      {
        this->Scrolled(event->key() == Qt::Key_PageUp ? 1 : -1);
      }
      return;
    default:
      QOpenGLWidget::keyPressEvent(event);
  }
}

void ViewWidget::resizeEvent(QResizeEvent* event)
{
  QVTKOpenGLNativeWidget::resizeEvent(event);
  if (this->Fitted && this->Fit && !this->Layers.empty())
  {
    this->Fit();
  }
  this->Redraw();
}
}
