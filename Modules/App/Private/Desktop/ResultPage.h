// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ResultPage_h
#define mammoray_ResultPage_h

#include "Private/Desktop/Places.h"
#include "Private/Desktop/Task.h"
#include "Private/Desktop/ViewWidget.h"
#include "Private/OpenedResult.h"

#include <QCoreApplication>
#include <QTimer>
#include <QUndoStack>
#include <QWidget>

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

class QAction;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QListWidget;
class QProgressBar;
class QPushButton;
class QSlider;
class QSplitter;
class QToolButton;
class QVBoxLayout;

namespace mammoray
{
/**
 * A result: linked slices of the MRI, the mammograms, the breast between the plates and at rest.
 * What is marked in one view is shown in all.
 */
class ResultPage : public QWidget
{
  Q_DECLARE_TR_FUNCTIONS(ResultPage)
public:
  explicit ResultPage(const ProjectorOptions& projector);
  ~ResultPage() override;

  /// Opens it beside the window's thread.
  void Open(const ViewInput& input);
  /// Shows mammograms of the result that is open.
  void ShowMammograms(const std::vector<std::string>& files);
  /// Lesions: a label volume, a segmentation, or landmarks (.csv).
  void ImportPlaces(const QString& path);
  bool IsOpen() const { return this->Result != nullptr; }
  bool IsBusy() const { return this->Opening.Runs() || this->Work.Runs(); }
  const OpenedResult* Opened() const { return this->Result.get(); }
  std::vector<Vector3> PlacesToExport() const;
  QUndoStack* UndoStack() { return &this->Undo; }
  /// Actions for menus and tool bar: tools and views.
  QList<QAction*> ToolActions() const { return this->Tools; }
  QList<QAction*> MarkActions() const { return this->MarkMenu; }
  QList<QAction*> ViewActions() const { return this->ViewMenu; }

  void MarkPoint(const Vector3& point);
  void MarkPixel(std::size_t mammogram, const std::array<double, 2>& pixel);
  void ClearMark();
  /// Adds what is marked to the list.
  void AddPlace();
  ViewWidget* View(const QString& name) const { return this->findChild<ViewWidget*>(name); }

  std::function<void(const QString&)> Complain;
  std::function<void(const QString&)> Tell;
  std::function<void()> Changed;
  /// Another tool was chosen.
  std::function<void(ViewTool)> ToolChanged;
  /// All views, or their grey, are to be as at the beginning.
  std::function<void()> FitWanted;
  std::function<void()> GreyWanted;
  /// The user wants to show the mammograms of the result.
  std::function<void()> MammogramsWanted;

private:
  friend class MarksCommand;
  QWidget* MakeViews();
  QWidget* MakeSide();
  void MakeTrust(QVBoxLayout* side);
  void MakePlaces(QVBoxLayout* side);
  void MakePicture(QVBoxLayout* side);
  void MakeUnit(QVBoxLayout* side);
  void MakeActions();
  void Attach(std::shared_ptr<OpenedResult> result);
  void Detach();
  void AttachSlices();
  void AttachMammogram(std::size_t index);
  void AttachScene(ViewWidget* view, BreastScene& scene, const OpenedMammogram& mammogram);
  void TellTrust();
  void SetTool(ViewTool tool);
  void ToggleLarge(ViewWidget* view);
  void RedrawAll();
  void Push(const QString& text, const Marks& after, int merge);
  void Apply(const Marks& marks);
  void UpdateMark(bool moved);
  void ListPlaces();
  void RenamePlace(int row, const QString& name);
  void RemovePlace();
  void SavePlaces();
  void Activate(int mammogram);
  void TellSource();
  /// Thickness, mm, and roll, degrees; nothing: as it is.
  void SetPose(const std::optional<double>& thicknessMm, const std::optional<double>& rollDeg);
  void SetSource(const Vector3& offset);
  void TellEquilibrium(const CompressedAnatomy& answer);
  void Moved();
  void Tick();
  QList<ViewWidget*> AllViews() const;
  OpenedMammogram& Active() { return *this->Result->Mammograms[this->ActiveMammogram]; }

  ProjectorOptions Projector;
  std::shared_ptr<OpenedResult> Result;
  std::size_t ActiveMammogram = 0;
  Marks Current;
  QUndoStack Undo;
  QList<QAction*> Tools;
  QList<QAction*> MarkMenu;
  QList<QAction*> ViewMenu;
  QTimer Ticker;
  QTimer Rest;

  QSplitter* Columns = nullptr;
  ThreeViews SliceViews{};
  std::array<ViewWidget*, 2> PictureViews{};
  ViewWidget* SqueezedView = nullptr;
  ViewWidget* RestView = nullptr;
  QLabel* Verdict = nullptr;
  QLabel* Expected = nullptr;
  QLabel* Reasons = nullptr;
  QToolButton* Why = nullptr;
  QLabel* Where = nullptr;
  QListWidget* PlaceList = nullptr;
  QComboBox* Comparison = nullptr;
  QSlider* Share = nullptr;
  QSlider* Tissue = nullptr;
  QPushButton* NoMammograms = nullptr;
  QComboBox* Unit = nullptr;
  QDoubleSpinBox* Thickness = nullptr;
  QDoubleSpinBox* Roll = nullptr;
  QDoubleSpinBox* Kilovoltage = nullptr;
  QLabel* SourceOffset = nullptr;
  QLabel* Equilibrium = nullptr;
  QWidget* Views = nullptr;
  QWidget* Waiting = nullptr;
  QLabel* Stage = nullptr;
  QProgressBar* Progress = nullptr;
  /// Last, so that they end first.
  Task Opening{ this };
  Task Work{ this };
};
}

#endif
