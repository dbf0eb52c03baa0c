// SPDX-License-Identifier: Apache-2.0
#include "Private/Desktop/StudyPage.h"

#include "Private/BreastScene.h"
#include "Private/Desktop/SearchPictures.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/ShippedData.h"

#include "vtkUnstructuredGrid.h"

#include <QComboBox>
#include <QDateTime>
#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QLabel>
#include <QLineEdit>
#include <QProcess>
#include <QProgressBar>
#include <QPushButton>
#include <QSplitter>
#include <QStandardPaths>
#include <QTableWidget>
#include <QTextEdit>
#include <QVBoxLayout>

#include <algorithm>
#include <utility>

namespace mammoray
{
namespace
{
enum SeriesColumn
{
  UseColumn,
  NumberColumn,
  DescriptionColumn,
  SequenceColumn,
  PlaneColumn,
  FatColumn,
  ContrastColumn,
  SlicesColumn,
  SeriesReasonColumn,
  SeriesColumns
};
enum MammogramColumn
{
  TakeColumn,
  ViewColumn,
  SideColumn,
  DateColumn,
  ThicknessColumn,
  MammogramReasonColumn,
  MammogramColumns
};
const QString WarningStyle = "color: #c77700";
const QString RefusalStyle = "color: #d32f2f; font-weight: bold";

QString Text(const std::string& text)
{
  return QString::fromStdString(EscapeControls(text));
}

QTableWidgetItem* Cell(const QString& text)
{
  auto* cell = new QTableWidgetItem(text);
  cell->setFlags(Qt::ItemIsSelectable | Qt::ItemIsEnabled);
  cell->setToolTip(text);
  return cell;
}

QTableWidgetItem* Check(bool checked)
{
  auto* cell = new QTableWidgetItem;
  cell->setFlags(Qt::ItemIsSelectable | Qt::ItemIsEnabled | Qt::ItemIsUserCheckable);
  cell->setCheckState(checked ? Qt::Checked : Qt::Unchecked);
  return cell;
}

bool IsChecked(const QTableWidget* table, int row)
{
  return table->item(row, 0) && table->item(row, 0)->checkState() == Qt::Checked;
}

bool IsTaken(const std::string& reason)
{
  return reason.starts_with("taken");
}

QTableWidget* NewTable(const QString& name, const QStringList& heads)
{
  auto* table = new QTableWidget(0, static_cast<int>(heads.size()));
  table->setObjectName(name);
  table->setHorizontalHeaderLabels(heads);
  table->verticalHeader()->hide();
  table->horizontalHeader()->setStretchLastSection(true);
  table->setSelectionBehavior(QAbstractItemView::SelectRows);
  table->setAlternatingRowColors(true);
  return table;
}

/// The material that there is most of, but air and what is held.
int HostOf(const LabelVolume& volume, const MaterialTable& table)
{
  const std::vector<bool> fixed = table.Fixed();
  std::vector<std::size_t> counts(fixed.size(), 0);
  for (const auto label : volume.Voxels)
  {
    const auto material = static_cast<std::size_t>(label);
    counts[material] += label != 0 && !fixed[material] ? 1 : 0;
  }
  return static_cast<int>(std::max_element(counts.begin(), counts.end()) - counts.begin());
}

/// Corners of the box around the voxels that are tissue, for views to fill.
std::vector<double> CornersOf(const LabelVolume& volume)
{
  std::array<int, 3> low = volume.Size;
  std::array<int, 3> high{ 0, 0, 0 };
  std::size_t voxel = 0;
  for (int k = 0; k < volume.Size[2]; ++k)
  {
    for (int j = 0; j < volume.Size[1]; ++j)
    {
      for (int i = 0; i < volume.Size[0]; ++i, ++voxel)
      {
        if (volume.Voxels[voxel] != 0)
        {
          low = { std::min(low[0], i), std::min(low[1], j), std::min(low[2], k) };
          high = { std::max(high[0], i), std::max(high[1], j), std::max(high[2], k) };
        }
      }
    }
  }
  std::vector<double> points;
  for (int corner = 0; corner < 8; ++corner)
  {
    Vector3 at = volume.Origin;
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const int index = (corner >> axis & 1) != 0 ? high[axis] : low[axis];
      at = at + index * volume.Spacing[axis] * volume.Direction[axis];
    }
    points.insert(points.end(), at.begin(), at.end());
  }
  return points;
}
}

StudyPages::StudyPages(const ProjectorOptions& projector)
  : Projector(projector)
{
  this->MakeStudyPage();
  this->MakeTissuePage();
  this->MakeRunPage();
  const auto complain = [this](const QString& complaint) { this->Complain(complaint); };
  this->Reading.Failed = this->Segmenting.Failed = complain;
  this->Reading.Progressed = [this](double fraction, const QString& stage)
  { this->Head->setText(tr("%1: %2 %").arg(stage).arg(100 * fraction, 0, 'f', 0)); };
  this->Segmenting.Progressed = [this](double fraction, const QString& stage)
  {
    this->TissueProgress->setValue(static_cast<int>(100 * fraction));
    this->TissueText->setText(stage);
  };
  this->Segmenting.Ended = [this] { this->TissueProgress->hide(); };
  this->Searching.Progressed = [this](double fraction, const QString& stage)
  { this->TellProgress(fraction, stage); };
  this->Searching.Failed = [this](const QString& complaint)
  {
    this->Log->append(complaint);
    this->Complain(complaint);
  };
  this->Searching.Interrupted = [this]
  { this->Log->append(tr("Cancelled before the search had found anything.")); };
  this->Searching.Ended = [this]
  {
    this->Start->setEnabled(true);
    this->Cancel->setEnabled(false);
    this->Progress->hide();
    this->Stage->clear();
  };
  connect(&this->Watcher, &QFileSystemWatcher::fileChanged, this,
    [this](const QString& path)
    {
      this->Tell(tr("%1 was saved; it is read again.").arg(QFileInfo(path).fileName()));
      this->Watcher.addPath(path); // which editors replace
      this->CheckTissue();
    });
}

StudyPages::~StudyPages()
{
  this->DetachTissue();
}

void StudyPages::MakeStudyPage()
{
  this->Study = new QWidget;
  this->Study->setObjectName("studyPage");
  auto* layout = new QVBoxLayout(this->Study);
  this->Head =
    new QLabel(tr("No study is open. Open a clinic's export with Ctrl+Shift+O, or drop its "
                  "folder here."));
  this->Head->setObjectName("studyHead");
  this->Head->setTextInteractionFlags(Qt::TextSelectableByMouse);
  layout->addWidget(this->Head);
  this->Series = NewTable("series",
    { tr("Use"), tr("No."), tr("Series"), tr("Sequence"), tr("Plane"), tr("Fat"), tr("Contrast"),
      tr("Slices"), tr("Why") });
  this->Mammograms = NewTable("mammograms",
    { tr("Use"), tr("View"), tr("Side"), tr("Date"), tr("Thickness"), tr("Why") });
  auto* splitter = new QSplitter(Qt::Vertical);
  splitter->addWidget(this->Series);
  splitter->addWidget(this->Mammograms);
  layout->addWidget(splitter, 1);
  this->Contradictions = new QLabel;
  this->Contradictions->setObjectName("contradictions");
  this->Contradictions->setWordWrap(true);
  this->Contradictions->setTextInteractionFlags(Qt::TextSelectableByMouse);
  layout->addWidget(this->Contradictions);
  auto* row = new QHBoxLayout;
  this->SideBox = new QComboBox;
  this->SideBox->setObjectName("side");
  this->SideBox->addItems({ tr("by the mammograms"), tr("left"), tr("right") });
  this->PositionBox = new QComboBox;
  this->PositionBox->setObjectName("position");
  this->PositionBox->addItems({ tr("by the header"), tr("prone"), tr("supine") });
  auto* sideLabel = new QLabel(tr("Si&de"));
  sideLabel->setBuddy(this->SideBox);
  auto* positionLabel = new QLabel(tr("&Position in the MRI"));
  positionLabel->setBuddy(this->PositionBox);
  this->ToTissue = new QPushButton(tr("Check the &tissue"));
  this->ToTissue->setObjectName("toTissue");
  this->ToRun = new QPushButton(tr("&Register..."));
  this->ToRun->setObjectName("toRun");
  for (QWidget* widget :
    std::initializer_list<QWidget*>{ sideLabel, this->SideBox, positionLabel, this->PositionBox })
  {
    row->addWidget(widget);
  }
  row->addStretch();
  row->addWidget(this->ToTissue);
  row->addWidget(this->ToRun);
  layout->addLayout(row);
  for (QWidget* widget : std::initializer_list<QWidget*>{ this->ToTissue, this->ToRun })
  {
    widget->setEnabled(false);
  }
  const auto choose = [this] { this->Choose(); };
  connect(this->SideBox, QOverload<int>::of(&QComboBox::currentIndexChanged), this, choose);
  connect(this->PositionBox, QOverload<int>::of(&QComboBox::currentIndexChanged), this, choose);
  connect(this->Series, &QTableWidget::itemChanged, this, choose);
  connect(this->Mammograms, &QTableWidget::itemChanged, this, choose);
  connect(this->ToTissue, &QPushButton::clicked, this,
    [this]
    {
      this->Show(1);
      this->CheckTissue();
    });
  connect(this->ToRun, &QPushButton::clicked, this, [this] { this->Show(2); });
}

void StudyPages::MakeTissuePage()
{
  this->Tissue = new QWidget;
  this->Tissue->setObjectName("tissuePage");
  auto* layout = new QVBoxLayout(this->Tissue);
  auto* row = new QHBoxLayout;
  this->TissueText = new QLabel(tr("The tissue of the study has not been found yet."));
  this->TissueText->setObjectName("tissueText");
  this->TissueText->setWordWrap(true);
  this->TissueText->setTextInteractionFlags(Qt::TextSelectableByMouse);
  row->addWidget(this->TissueText, 1);
  this->TissueProgress = new QProgressBar;
  this->TissueProgress->hide();
  row->addWidget(this->TissueProgress);
  this->Edit = new QPushButton(tr("&Edit the labels..."));
  this->Edit->setObjectName("editLabels");
  this->Edit->setEnabled(false);
  connect(this->Edit, &QPushButton::clicked, this, [this] { this->EditLabels(); });
  row->addWidget(this->Edit);
  auto* onwards = new QPushButton(tr("&Register..."));
  connect(onwards, &QPushButton::clicked, this, [this] { this->Show(2); });
  row->addWidget(onwards);
  layout->addLayout(row);
  auto* splitter = new QSplitter(Qt::Horizontal);
  const char* const names[] = { "tissueAxial", "tissueCoronal", "tissueSagittal" };
  for (std::size_t pane = 0; pane < this->TissueViews.size(); ++pane)
  {
    this->TissueViews[pane] = new ViewWidget(ViewWidget::Kind::Slice, names[pane]);
    splitter->addWidget(this->TissueViews[pane]);
  }
  layout->addWidget(splitter, 1);
}

void StudyPages::MakeRunPage()
{
  this->Running = new QWidget;
  this->Running->setObjectName("runPage");
  auto* layout = new QVBoxLayout(this->Running);
  auto* form = new QFormLayout;
  auto* row = new QHBoxLayout;
  this->Output = new QLineEdit;
  this->Output->setObjectName("output");
  auto* browse = new QPushButton(tr("&Browse..."));
  connect(browse, &QPushButton::clicked, this,
    [this]
    {
      const QString folder = QFileDialog::getExistingDirectory(this->Running,
        tr("A new or empty folder for the result"));
      if (!folder.isEmpty())
      {
        this->Output->setText(folder);
      }
    });
  row->addWidget(this->Output, 1);
  row->addWidget(browse);
  auto* folder = new QLabel(tr("Result &folder"));
  folder->setBuddy(this->Output);
  form->addRow(folder, row);
  this->Thoroughness = new QComboBox;
  this->Thoroughness->setObjectName("thoroughness");
  this->Thoroughness->addItems({ tr("usual"), tr("quick look: coarse pictures, large cells") });
  form->addRow(tr("&Search"), this->Thoroughness);
  layout->addLayout(form);
  auto* buttons = new QHBoxLayout;
  this->Start = new QPushButton(tr("&Register"));
  this->Start->setObjectName("start");
  this->Cancel = new QPushButton(tr("&Cancel, keep what was found"));
  this->Cancel->setObjectName("cancel");
  this->Cancel->setEnabled(false);
  connect(this->Start, &QPushButton::clicked, this, [this] { this->Run(); });
  connect(this->Cancel, &QPushButton::clicked, this,
    [this]
    {
      this->Stage->setText(tr("ending..."));
      this->Searching.Cancel();
    });
  buttons->addWidget(this->Start);
  buttons->addWidget(this->Cancel);
  buttons->addStretch();
  layout->addLayout(buttons);
  this->Progress = new QProgressBar;
  this->Progress->hide();
  layout->addWidget(this->Progress);
  this->Stage = new QLabel;
  this->Stage->setObjectName("stage");
  layout->addWidget(this->Stage);
  this->Pictures = new SearchPictures;
  layout->addWidget(this->Pictures, 3);
  this->Log = new QTextEdit;
  this->Log->setObjectName("log");
  this->Log->setReadOnly(true);
  layout->addWidget(this->Log, 1);
}

void StudyPages::Open(const QString& folder)
{
  if (this->IsBusy())
  {
    this->Complain(tr("a study is being worked on; cancel it first"));
    return;
  }
  this->Show(0);
  this->Reading.Start(
    [this, folder](const ProgressCallback& progress) -> Task::Outcome
    {
      auto study = std::make_shared<mammoray::Study>(ReadStudy(folder.toStdString(), progress));
      return [this, folder, study]
      {
        this->Folder = folder;
        this->Found = *study;
        this->Chosen.reset();
        this->LabelFile.clear();
        this->DetachTissue();
        const QDir parent = QFileInfo(QDir(folder).absolutePath()).dir();
        this->Output->setText(parent.filePath("result"));
        this->Fill();
      };
    });
}

void StudyPages::Fill()
{
  this->IsFilling = true;
  this->FillSeries();
  this->FillMammograms();
  this->IsFilling = false;
  this->Choose();
}

void StudyPages::FillSeries()
{
  this->Series->setRowCount(0);
  for (const StudySeries& series : this->Found->Series)
  {
    const int row = this->Series->rowCount();
    this->Series->insertRow(row);
    const QString fat = series.Fat == FatSuppression::Absent ? tr("bright")
      : series.Fat == FatSuppression::Present                ? tr("suppressed")
                                                             : tr("unknown");
    const QString contrast = series.Contrast == ContrastPhase::Before ? tr("before")
      : series.Contrast == ContrastPhase::After                       ? tr("after")
                                                                      : tr("unknown");
    this->Series->setItem(row, UseColumn, Check(false));
    this->Series->setItem(row, NumberColumn, Cell(QString::number(row + 1)));
    this->Series->setItem(row, DescriptionColumn, Cell(Text(series.Description)));
    this->Series->setItem(row, SequenceColumn, Cell(Text(series.Sequence)));
    this->Series->setItem(row, PlaneColumn, Cell(Text(series.Plane)));
    this->Series->setItem(row, FatColumn, Cell(fat));
    this->Series->item(row, FatColumn)->setToolTip(Text(series.FatEvidence));
    this->Series->setItem(row, ContrastColumn, Cell(contrast));
    this->Series->item(row, ContrastColumn)->setToolTip(Text(series.ContrastEvidence));
    this->Series->setItem(row, SlicesColumn, Cell(QString::number(series.Slices.size())));
    this->Series->setItem(row, SeriesReasonColumn, Cell({}));
  }
}

void StudyPages::FillMammograms()
{
  this->Mammograms->setRowCount(0);
  for (const StudyMammogram& image : this->Found->Mammograms)
  {
    const int row = this->Mammograms->rowCount();
    this->Mammograms->insertRow(row);
    this->Mammograms->setItem(row, TakeColumn, Check(image.LeftOut.empty()));
    const auto choice = [&](int column, const QStringList& words, const QString& word)
    {
      auto* box = new QComboBox;
      box->addItems(words);
      if (box->findText(word) < 0)
      {
        box->addItem(word);
      }
      box->setCurrentText(word);
      connect(box, QOverload<int>::of(&QComboBox::currentIndexChanged), this,
        [this] { this->Choose(); });
      this->Mammograms->setCellWidget(row, column, box);
    };
    choice(ViewColumn, { "CC", "MLO" }, Text(image.Header.View));
    choice(SideColumn, { "L", "R" }, QString(QChar(image.Header.Laterality)));
    this->Mammograms->setItem(row, DateColumn, Cell(Text(image.Header.AcquisitionDate)));
    this->Mammograms->setItem(row, ThicknessColumn,
      Cell(image.Header.BodyPartThicknessMm
          ? tr("%1 mm").arg(*image.Header.BodyPartThicknessMm, 0, 'f', 0)
          : tr("unknown")));
    this->Mammograms->setItem(row, MammogramReasonColumn, Cell({}));
  }
}

mammoray::Study StudyPages::Corrected() const
{
  mammoray::Study study = *this->Found;
  for (int row = 0; row < this->Mammograms->rowCount(); ++row)
  {
    StudyMammogram& image = study.Mammograms[static_cast<std::size_t>(row)];
    const auto word = [&](int column)
    {
      return qobject_cast<QComboBox*>(this->Mammograms->cellWidget(row, column))
        ->currentText()
        .toStdString();
    };
    image.Header.View = word(ViewColumn);
    image.Header.Laterality = word(SideColumn).empty() ? '?' : word(SideColumn).front();
    if (IsChecked(this->Mammograms, row))
    {
      image.LeftOut.clear();
    }
    else if (image.LeftOut.empty())
    {
      image.LeftOut = "by hand";
    }
  }
  return study;
}

std::optional<char> StudyPages::Side() const
{
  const int index = this->SideBox->currentIndex();
  return index == 0 ? std::nullopt : std::optional<char>(index == 1 ? 'L' : 'R');
}

std::optional<PatientPosition> StudyPages::Position() const
{
  switch (this->PositionBox->currentIndex())
  {
    case 1:
      return PatientPosition::Prone;
    case 2:
      return PatientPosition::Supine;
    default:
      return std::nullopt;
  }
}

/// None are checked: intake chooses.
std::vector<int> StudyPages::SeriesByHand() const
{
  std::vector<int> numbers;
  for (int row = 0; row < this->Series->rowCount(); ++row)
  {
    if (IsChecked(this->Series, row))
    {
      numbers.push_back(row + 1);
    }
  }
  return numbers;
}

void StudyPages::Choose()
{
  if (!this->Found || this->IsFilling)
  {
    return;
  }
  QStringList warnings;
  QString refusal;
  try
  {
    this->Chosen = ChooseForRegistration(this->Corrected(), this->Side(), this->SeriesByHand(),
      this->Position());
    for (const std::string& warning : this->Chosen->Warnings)
    {
      warnings << Text(warning);
    }
    refusal = Text(this->Chosen->Refusal);
  }
  catch (const Error& error)
  {
    this->Chosen.reset();
    refusal = error.what();
  }
  this->IsFilling = true;
  const auto reason = [](QTableWidget* table, int row, int column, const std::string& why)
  {
    QTableWidgetItem* cell = table->item(row, column);
    cell->setText(Text(why));
    cell->setToolTip(Text(why));
    QFont font = cell->font();
    font.setBold(IsTaken(why));
    for (int other = 0; other < table->columnCount(); ++other)
    {
      if (QTableWidgetItem* beside = table->item(row, other))
      {
        beside->setFont(font);
      }
    }
  };
  for (std::size_t row = 0; this->Chosen && row < this->Chosen->Found.Series.size(); ++row)
  {
    reason(this->Series, static_cast<int>(row), SeriesReasonColumn,
      this->Chosen->Found.Series[row].Reason);
  }
  for (std::size_t row = 0; this->Chosen && row < this->Chosen->Found.Mammograms.size(); ++row)
  {
    reason(this->Mammograms, static_cast<int>(row), MammogramReasonColumn,
      this->Chosen->Found.Mammograms[row].Reason);
  }
  this->IsFilling = false;
  const int last = this->Series->columnCount() - 1;
  for (int column = 0; column < last; ++column)
  {
    this->Series->resizeColumnToContents(column);
    this->Series->setColumnWidth(column, std::min(this->Series->columnWidth(column), 260));
  }
  this->Head->setText(
    tr("%1 series and %2 mammograms. Check a series to take it instead of what intake "
       "chooses.")
      .arg(this->Found->Series.size())
      .arg(this->Found->Mammograms.size()));
  this->Contradictions->setStyleSheet(refusal.isEmpty() ? WarningStyle : RefusalStyle);
  this->Contradictions->setText(refusal.isEmpty() ? warnings.join("\n") : refusal);
  const bool possible = this->Chosen && refusal.isEmpty();
  this->ToTissue->setEnabled(possible);
  this->ToRun->setEnabled(possible);
}

void StudyPages::CheckTissue()
{
  if (!this->Chosen || !this->Chosen->Refusal.empty())
  {
    this->Complain(tr("expected a study that can be registered, found none open"));
    return;
  }
  this->TissueProgress->show();
  this->Segmenting.Start(
    [this, choice = *this->Chosen, file = this->LabelFile.toStdString()](
      const ProgressCallback& progress) -> Task::Outcome
    {
      const MaterialTable table = FindMaterialTable(StudyMaterials);
      LabelSource labels{ .SpacingMm = 0.5, .OnlyCoarsen = true };
      labels.Path = file;
      auto tissue = std::make_shared<const StudyTissue>(file.empty()
          ? SegmentStudy(choice, table, progress)
          : LabelStudy(choice, labels, table, progress));
      return [this, tissue] { this->ShowTissue(tissue); };
    });
}

void StudyPages::DetachTissue()
{
  for (ViewWidget* view : this->TissueViews)
  {
    view->Clear();
  }
  this->Slices.reset();
  this->Segmented.reset();
  this->Edit->setEnabled(false);
  this->TissueText->setText(tr("The tissue of the study has not been found yet."));
}

void StudyPages::ShowTissue(std::shared_ptr<const StudyTissue> tissue)
{
  this->DetachTissue();
  this->Segmented = std::move(tissue);
  this->Viewed = {};
  this->Viewed.Image =
    std::shared_ptr<const IntensityVolume>(this->Segmented, &this->Segmented->Mri);
  this->Viewed.Tissue =
    std::shared_ptr<const LabelVolume>(this->Segmented, &this->Segmented->Labels);
  this->Viewed.Anatomy.Points = CornersOf(this->Segmented->Breast);
  this->Viewed.Axes = AnatomicalAxes::FromCode("LPS");
  const MaterialTable table = FindMaterialTable(StudyMaterials);
  this->Slices = std::make_unique<SlicePanes>(this->Viewed,
    TissueColors(table, HostOf(this->Segmented->Breast, table)));
  ShowSlices(*this->Slices, this->TissueViews,
    [this](const Vector3& place)
    {
      this->Slices->SetMark(place, {});
      for (ViewWidget* view : this->TissueViews)
      {
        view->Redraw();
      }
    });
  QStringList text{ tr("Breast %1 cm3, %2 % gland, stands out by %3 mm.")
                      .arg(this->Segmented->BreastCm3, 0, 'f', 0)
                      .arg(100 * this->Segmented->GlandFraction, 0, 'f', 0)
                      .arg(this->Segmented->DepthMm, 0, 'f', 0) };
  if (!this->Segmented->Doubt.empty())
  {
    text << tr("Doubtful: %1").arg(Text(this->Segmented->Doubt));
  }
  for (const std::string& warning : this->Segmented->Warnings)
  {
    text << Text(warning);
  }
  this->TissueText->setStyleSheet(this->Segmented->Doubt.empty() ? QString() : WarningStyle);
  this->TissueText->setText(text.join("\n"));
  this->Edit->setEnabled(true);
}

void StudyPages::SetTool(ViewTool tool)
{
  for (ViewWidget* view : this->TissueViews)
  {
    view->SetTool(tool);
  }
}

void StudyPages::ResetViews()
{
  for (ViewWidget* view : this->TissueViews)
  {
    view->Refit();
  }
}

void StudyPages::SaveLabels(const QString& path)
{
  if (!this->Segmented)
  {
    this->Complain(tr("expected labels to save, found none; check the tissue first"));
    return;
  }
  try
  {
    WriteLabelVolume(this->Segmented->Labels, path.toStdString());
    this->LabelFile = path;
    this->Watcher.addPath(path);
    this->Tell(tr("The search takes the labels of %1.").arg(QFileInfo(path).fileName()));
  }
  catch (const Error& error)
  {
    this->Complain(error.what());
  }
}

/// Opens the labels in a program that edits them, if there is one, and reads them when it saves.
void StudyPages::EditLabels()
{
  const QString path = this->LabelFile.isEmpty()
    ? QFileDialog::getSaveFileName(this->Tissue, tr("Labels to edit"),
        QDir(this->Folder).filePath("../labels.seg.nrrd"),
        tr("Label volumes (*.seg.nrrd *.nii.gz)"))
    : this->LabelFile;
  if (path.isEmpty())
  {
    return;
  }
  if (this->LabelFile.isEmpty())
  {
    this->SaveLabels(path);
  }
  for (const auto& [program, arguments] :
    { std::pair{ "itksnap", QStringList{ "-s", path } }, { "Slicer", { path } } })
  {
    const QString found = QStandardPaths::findExecutable(program);
    if (!found.isEmpty() && QProcess::startDetached(found, arguments))
    {
      return;
    }
  }
  this->Tell(tr("Neither ITK-SNAP nor 3D Slicer is installed. Edit %1; it is read again when it is "
                "saved.")
               .arg(path));
}

QString StudyPages::CaseText() const
{
  if (!this->Chosen)
  {
    throw InputError("expected a study for a case file, found none open");
  }
  QJsonObject text{ { "study", QDir(this->Folder).absolutePath() },
    { "output", this->Output->text() } };
  if (this->Side())
  {
    text["side"] = *this->Side() == 'L' ? "left" : "right";
  }
  QJsonArray series;
  for (const int number : this->SeriesByHand())
  {
    series.append(number);
  }
  if (!series.isEmpty())
  {
    text["series"] = series;
  }
  if (this->Position())
  {
    text["mri-position"] = *this->Position() == PatientPosition::Prone ? "prone" : "supine";
  }
  if (!this->LabelFile.isEmpty())
  {
    text["labels"] = this->LabelFile;
  }
  return QJsonDocument(text).toJson();
}

void StudyPages::TellProgress(double fraction, const QString& stage)
{
  this->Progress->setValue(static_cast<int>(1000 * fraction));
  const double seconds = static_cast<double>(this->Clock.elapsed()) / 1000;
  const QString left = fraction > 0.02
    ? tr(", about %1 min left").arg(seconds * (1 - fraction) / fraction / 60, 0, 'f', 1)
    : QString();
  this->Stage->setText(tr("%1 (%2 min%3)").arg(stage).arg(seconds / 60, 0, 'f', 1).arg(left));
}

void StudyPages::Run()
{
  if (!this->Chosen || !this->Chosen->Refusal.empty())
  {
    this->Complain(tr("expected a study that can be registered, found none open"));
    return;
  }
  const std::string output = this->Output->text().trimmed().toStdString();
  RegistrationCase input;
  input.Series = this->SeriesByHand();
  input.ImagePosition = this->Position();
  input.Labels.Path = this->LabelFile.toStdString();
  input.Projector = this->Projector;
  if (this->Thoroughness->currentIndex() == 1)
  {
    input.Options.PixelSizesMm = { 3.0 };
    input.AnatomyCellSizeMm = 8;
    input.SimulationCellSizeMm = 16;
  }
  try
  {
    if (output.empty())
    {
      throw InputError("result folder: expected a name, found none");
    }
    CheckResultFolder(output, false);
    TakeStudy(this->Corrected(), this->Side(), input);
  }
  catch (const Error& error)
  {
    this->Complain(error.what());
    return;
  }
  input.Checkpoint = CheckpointPath(output);
  for (const auto* view : { &this->Chosen->Cc, &this->Chosen->Mlo })
  {
    if (*view)
    {
      input.MammogramViews.push_back((*view)->Header.View);
    }
  }
  this->Start->setEnabled(false);
  this->Cancel->setEnabled(true);
  this->Progress->setRange(0, 1000);
  this->Progress->setValue(0);
  this->Progress->show();
  this->Pictures->SetPairs({});
  this->Log->append(tr("%1: registering").arg(QDateTime::currentDateTime().toString("hh:mm:ss")));
  this->Clock.start();
  this->Searching.Start(
    [this, input, output](const ProgressCallback& progress) -> Task::Outcome
    {
      const RegistrationCaseResult result = RunRegistrationCase(input, progress,
        [this](const std::vector<SearchedView>& views)
        {
          QMetaObject::invokeMethod(
            this, [this, pairs = SearchPictures::Take(views)] { this->Pictures->SetPairs(pairs); },
            Qt::QueuedConnection);
        });
      WriteRegistrationCase(input, result, output);
      QStringList lines;
      for (const RegisteredView& view : result.Views)
      {
        const ViewResult& registration = view.Registration;
        lines << tr("%1: %2; outline distance %3 mm")
                   .arg(Text(view.Mammogram.View), VerdictOf(registration.Trust.Level))
                   .arg(registration.After.MeanOutlineDistanceMm, 0, 'f', 2);
      }
      lines << tr("%1 s: %2")
                 .arg(result.Views.front().Registration.Seconds, 0, 'f', 0)
                 .arg(Text(result.Views.front().Registration.StopReason));
      return [this, output, lines, mammograms = input.Mammograms]
      {
        this->Log->append(lines.join("\n"));
        this->Finished(QString::fromStdString(output), mammograms);
      };
    });
}
}
