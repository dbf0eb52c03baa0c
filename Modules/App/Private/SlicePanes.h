// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SlicePanes_h
#define mammoray_SlicePanes_h

#include "Private/PaneOverlay.h"
#include "mammoray/App/ViewedBreast.h"
#include "mammorayAppModule.h"

#include "vtkRenderer.h"
#include "vtkSmartPointer.h"

#include <array>
#include <memory>
#include <optional>
#include <vector>

class vtkImageData;
class vtkImageProperty;
class vtkImageSlice;
class vtkImageStack;

namespace mammoray
{
/**
 * Three slices of the volume through one point: across the patient, from the front and from the
 * patient's left, as radiologists hang them. The MRI in grey with the tissues over it, or the
 * tissues alone; lesions over both. Volume frame, mm.
 */
class MAMMORAYAPP_EXPORT SlicePanes
{
public:
  static constexpr int Count = 3;
  /// `viewed` must outlive this and have an image or labels; colours by material.
  SlicePanes(const ViewedBreast& viewed, const std::vector<std::array<double, 3>>& colors);
  ~SlicePanes();

  vtkRenderer* Renderer(int pane) { return this->Panes[static_cast<std::size_t>(pane)].View; }
  PaneOverlay& Overlay(int pane) { return *this->Panes[static_cast<std::size_t>(pane)].Over; }
  /// All of the breast in each pane, through its middle or the marked point.
  void Frame();
  /// Marks a point and takes all slices there; nothing: no mark, the slices stay. `lines` are seen
  /// in all panes: what lies behind a pixel, ellipses of uncertainty.
  void SetMark(const std::optional<Vector3>& point, std::vector<std::vector<Vector3>> lines);
  /// Goes so many voxels along the pane's normal.
  void Scroll(int pane, int steps);
  /// Changes grey: window and level by shares of the window.
  void Adjust(double windowFactor, double levelShare);
  void ResetWindow();
  /// [0, 1].
  void SetTissueOpacity(double opacity);
  /// Follows cameras and sizes; before the window is drawn.
  void Update();

private:
  struct Pane
  {
    vtkSmartPointer<vtkRenderer> View;
    /// Draws what lies in one plane in its order.
    vtkSmartPointer<vtkImageStack> Stack;
    std::unique_ptr<PaneOverlay> Over;
    const char* Name = "";
    Vector3 Along{ 0, 0, 1 };
    Vector3 Up{ 0, 1, 0 };
    double StepMm = 1;

    /// The place that the slice goes through, in the middle of the pane.
    Vector3 Focal() const;
    /// Takes the slice there.
    void LookThrough(const Vector3& focal);
  };
  void AddVolume(Pane& pane);
  vtkSmartPointer<vtkImageSlice> AddSlice(Pane& pane, vtkImageData* data, const VolumeGrid& grid,
    vtkImageProperty* property, int layer);
  static vtkSmartPointer<vtkImageProperty> LabelProperty(
    const std::vector<std::array<double, 3>>& colors, double opacity);

  const ViewedBreast& Viewed;
  const VolumeGrid& Grid;
  std::array<Pane, Count> Panes;
  vtkSmartPointer<vtkImageProperty> Grey;
  vtkSmartPointer<vtkImageProperty> TissueColors;
  vtkSmartPointer<vtkImageProperty> LesionColors;
  std::vector<vtkSmartPointer<vtkImageSlice>> TissueSlices;
  double Window = 1;
  double Level = 0.5;
  std::optional<Vector3> Point;
  std::vector<std::vector<Vector3>> Lines;
};
}

#endif
