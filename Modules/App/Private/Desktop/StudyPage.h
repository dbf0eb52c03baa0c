// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_StudyPage_h
#define mammoray_StudyPage_h

#include "Private/Desktop/Task.h"
#include "Private/Desktop/ViewWidget.h"
#include "Private/SlicePanes.h"
#include "mammoray/Study/StudyCase.h"

#include <QCoreApplication>
#include <QElapsedTimer>
#include <QFileSystemWatcher>
#include <QObject>

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

class QComboBox;
class QLabel;
class QLineEdit;
class QProgressBar;
class QPushButton;
class QTableWidget;
class QTextEdit;

namespace mammoray
{
class SearchPictures;

/**
 * A clinic's export on its way to a result, in three pages: what is taken of it, its tissue, and
 * the search.
 */
class StudyPages : public QObject
{
  Q_DECLARE_TR_FUNCTIONS(StudyPages)
public:
  explicit StudyPages(const ProjectorOptions& projector);
  ~StudyPages() override;

  QWidget* StudyPage() const { return this->Study; }
  QWidget* TissuePage() const { return this->Tissue; }
  QWidget* RunPage() const { return this->Running; }
  /// Reads its headers beside the window's thread.
  void Open(const QString& folder);
  bool IsBusy() const
  {
    return this->Reading.Runs() || this->Segmenting.Runs() || this->Searching.Runs();
  }
  /// Segments the MRI, or reads the corrected labels.
  void CheckTissue();
  void Run();
  void SaveLabels(const QString& path);
  void SetTool(ViewTool tool);
  void ResetViews();
  /// A case file for the command line. Throws InputError without a study.
  QString CaseText() const;
  const std::optional<StudyChoice>& Choice() const { return this->Chosen; }

  std::function<void(const QString&)> Complain;
  std::function<void(const QString&)> Tell;
  /// The page to show: 0 study, 1 tissue, 2 run.
  std::function<void(int)> Show;
  /// A search has ended: its folder and its mammograms.
  std::function<void(const QString& folder, const std::vector<std::string>& mammograms)> Finished;

private:
  void MakeStudyPage();
  void MakeTissuePage();
  void MakeRunPage();
  void Fill();
  void FillSeries();
  void FillMammograms();
  /// The study with what was changed by hand.
  mammoray::Study Corrected() const;
  std::optional<char> Side() const;
  std::optional<PatientPosition> Position() const;
  std::vector<int> SeriesByHand() const;
  void Choose();
  void ShowTissue(std::shared_ptr<const StudyTissue> tissue);
  void DetachTissue();
  void EditLabels();
  void TellProgress(double fraction, const QString& stage);

  ProjectorOptions Projector;
  QString Folder;
  std::optional<mammoray::Study> Found;
  std::optional<StudyChoice> Chosen;
  bool IsFilling = false;

  QWidget* Study = nullptr;
  QLabel* Head = nullptr;
  QTableWidget* Series = nullptr;
  QTableWidget* Mammograms = nullptr;
  QComboBox* SideBox = nullptr;
  QComboBox* PositionBox = nullptr;
  QLabel* Contradictions = nullptr;
  QPushButton* ToTissue = nullptr;
  QPushButton* ToRun = nullptr;

  QWidget* Tissue = nullptr;
  QLabel* TissueText = nullptr;
  QPushButton* Edit = nullptr;
  QProgressBar* TissueProgress = nullptr;
  ThreeViews TissueViews{};
  std::shared_ptr<const StudyTissue> Segmented;
  ViewedBreast Viewed;
  std::unique_ptr<SlicePanes> Slices;
  QString LabelFile;
  QFileSystemWatcher Watcher;

  QWidget* Running = nullptr;
  QLineEdit* Output = nullptr;
  QComboBox* Thoroughness = nullptr;
  QPushButton* Start = nullptr;
  QPushButton* Cancel = nullptr;
  QProgressBar* Progress = nullptr;
  QLabel* Stage = nullptr;
  SearchPictures* Pictures = nullptr;
  QTextEdit* Log = nullptr;
  QElapsedTimer Clock;

  Task Reading{ this };
  Task Segmenting{ this };
  Task Searching{ this };
};
}

#endif
