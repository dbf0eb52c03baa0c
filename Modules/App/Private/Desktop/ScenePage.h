// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ScenePage_h
#define mammoray_ScenePage_h

#include "Private/Desktop/Plot.h"
#include "Private/Desktop/Task.h"
#include "Private/Desktop/ViewWidget.h"
#include "Private/LiveProjection.h"
#include "Private/ProjectionPane.h"
#include "Private/SampleScene.h"
#include "mammoray/IO/SceneIO.h"

#include <QCoreApplication>
#include <QTimer>
#include <QWidget>

#include <array>
#include <functional>
#include <memory>
#include <optional>

class QComboBox;
class QDoubleSpinBox;
class QFormLayout;
class QLabel;
class QLineEdit;
class QProgressBar;
class QPushButton;
class QSlider;
class QTableWidget;

namespace mammoray
{
/// A scene, and its X-ray as source, samples and energy are moved.
class ScenePage : public QWidget
{
  Q_DECLARE_TR_FUNCTIONS(ScenePage)
public:
  explicit ScenePage(const ProjectorOptions& projector);
  ~ScenePage() override;

  void Open(const QString& path);
  bool IsOpen() const { return this->Opened != nullptr; }
  bool IsBusy() const { return this->Opening.Runs() || this->Exposing.Runs(); }
  /// Writes the picture with all that the scene has: scatter, grid, noise and blur.
  void Expose(const QString& path);
  /// Writes the scene as it stands. Samples that were turned have no scene file.
  void SaveScene(const QString& path);
  void SetTool(ViewTool tool) { this->PictureView->SetTool(tool); }
  void ResetViews();
  void ResetGrey();

  std::function<void(const QString&)> Complain;
  std::function<void(const QString&)> Tell;
  std::function<void()> Changed;

private:
  struct Scenery
  {
    Scenery(const QString& path, const ProjectorOptions& projector);
    QString Name;
    SceneDescription Description;
    Scene Whole;
    std::unique_ptr<LiveProjection> Live;
    std::unique_ptr<ProjectionPane> Pane;
    std::unique_ptr<SampleScene> Samples;
  };
  QWidget* MakeSide();
  void AddBeam(QFormLayout* form);
  QDoubleSpinBox* AddNumber(QFormLayout* form, const QString& label, const char* name,
    const QString& suffix);
  void Attach(std::shared_ptr<Scenery> scenery);
  void Detach();
  void ListParts();
  SceneDescription AskedBeam() const;
  void ReadBeam();
  void TellBeam();
  void LimitEnergy();
  void ReadControls();
  void TellSource();
  void PlotSpectrum();
  void PlotHistogram();
  void PlotProfile();
  void Moved();
  void Draw(int divisor);
  Scene Current() const;
  bool CanSave();

  ProjectorOptions Projector;
  std::shared_ptr<Scenery> Opened;
  std::optional<std::array<double, 2>> Marked;
  QTimer Rest;
  QLabel* Head = nullptr;
  QTableWidget* Parts = nullptr;
  QSlider* Turn = nullptr;
  QComboBox* XRays = nullptr;
  QDoubleSpinBox* Energy = nullptr;
  QLineEdit* Filters = nullptr;
  std::array<QDoubleSpinBox*, 3> Source{};
  QLabel* EnergyLabel = nullptr;
  Plot* SpectrumPlot = nullptr;
  Plot* Histogram = nullptr;
  Plot* Profile = nullptr;
  QLabel* Seen = nullptr;
  QProgressBar* Progress = nullptr;
  QPushButton* Cancel = nullptr;
  ViewWidget* SetupView = nullptr;
  ViewWidget* PictureView = nullptr;
  Task Opening{ this };
  Task Exposing{ this };
};
}

#endif
