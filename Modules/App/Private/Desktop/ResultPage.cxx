// SPDX-License-Identifier: Apache-2.0
#include "Private/Desktop/ResultPage.h"

#include "Private/KilovoltageSpectrum.h"
#include "Private/SceneShapes.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Study/LandmarkEvaluation.h"
#include "mammoray/Study/LesionShadow.h"

#include <QAction>
#include <QActionGroup>
#include <QApplication>
#include <QClipboard>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFileDialog>
#include <QFileInfo>
#include <QFormLayout>
#include <QGroupBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QListWidget>
#include <QProgressBar>
#include <QPushButton>
#include <QScrollArea>
#include <QSlider>
#include <QSplitter>
#include <QStackedLayout>
#include <QToolButton>
#include <QUndoCommand>
#include <QVBoxLayout>

#include <algorithm>
#include <utility>

namespace mammoray
{
namespace
{
constexpr int TickMs = 40;
/// What has moved is drawn at full resolution after this.
constexpr int RestMs = 250;
constexpr double KilovoltageRange = 6;
constexpr double RollRangeDeg = 45;
constexpr int SliderSteps = 100;
/// Merges moves of one mark by a drag.
constexpr int MoveId = 1;
constexpr const char* SliceNames[] = { "axial", "coronal", "sagittal" };

QString FileName(const QString& path)
{
  return QFileInfo(path).fileName();
}

QSlider* NewSlider(const QString& name, int value)
{
  auto* slider = new QSlider(Qt::Horizontal);
  slider->setRange(0, SliderSteps);
  slider->setValue(value);
  slider->setObjectName(name);
  return slider;
}
}

/// From one state of all marks to another.
class MarksCommand : public QUndoCommand
{
public:
  MarksCommand(ResultPage& page, const QString& text, Marks before, Marks after, int merge)
    : QUndoCommand(text)
    , Page(page)
    , Before(std::move(before))
    , After(std::move(after))
    , Merge(merge)
  {
  }
  void undo() override { this->Page.Apply(this->Before); }
  void redo() override { this->Page.Apply(this->After); }
  int id() const override { return this->Merge; }
  bool mergeWith(const QUndoCommand* other) override
  {
    this->After = static_cast<const MarksCommand*>(other)->After;
    return true;
  }

private:
  ResultPage& Page;
  Marks Before;
  Marks After;
  int Merge;
};

ResultPage::ResultPage(const ProjectorOptions& projector)
  : Projector(projector)
{
  this->setObjectName("resultPage");
  this->setAcceptDrops(true);
  this->MakeActions();
  this->Views = this->MakeViews();

  this->Waiting = new QWidget;
  auto* waiting = new QVBoxLayout(this->Waiting);
  this->Stage =
    new QLabel(tr("No result is open.\n\nOpen one with Ctrl+O, or drop its folder here."));
  this->Stage->setAlignment(Qt::AlignCenter);
  this->Progress = new QProgressBar;
  this->Progress->setMaximumWidth(360);
  this->Progress->hide();
  waiting->addStretch();
  waiting->addWidget(this->Stage);
  waiting->addWidget(this->Progress, 0, Qt::AlignHCenter);
  waiting->addStretch();

  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(this->Waiting);
  layout->addWidget(this->Views);
  this->Views->hide();

  this->Opening.Progressed = [this](double fraction, const QString& stage)
  {
    this->Stage->setText(stage);
    this->Progress->setValue(static_cast<int>(100 * fraction));
  };
  const auto complain = [this](const QString& complaint)
  {
    this->Stage->setText(tr("No result is open."));
    this->Complain(complaint);
  };
  this->Opening.Failed = complain;
  this->Opening.Ended = [this]
  {
    this->Progress->hide();
    this->Waiting->setVisible(!this->Result);
    this->Views->setVisible(this->Result != nullptr);
  };
  this->Work.Failed = [this](const QString& complaint) { this->Complain(complaint); };
  connect(&this->Ticker, &QTimer::timeout, this, [this] { this->Tick(); });
  this->Rest.setSingleShot(true);
  connect(&this->Rest, &QTimer::timeout, this,
    [this]
    {
      this->Active().Update(1);
      this->UpdateMark(true);
      this->RedrawAll();
    });
}

ResultPage::~ResultPage()
{
  this->Detach();
}

QWidget* ResultPage::MakeViews()
{
  const auto nest = [](Qt::Orientation orientation, const QList<QWidget*>& widgets)
  {
    auto* splitter = new QSplitter(orientation);
    for (QWidget* widget : widgets)
    {
      splitter->addWidget(widget);
    }
    splitter->setChildrenCollapsible(false);
    return splitter;
  };
  for (std::size_t slice = 0; slice < this->SliceViews.size(); ++slice)
  {
    this->SliceViews[slice] = new ViewWidget(ViewWidget::Kind::Slice, SliceNames[slice]);
  }
  for (std::size_t picture = 0; picture < this->PictureViews.size(); ++picture)
  {
    this->PictureViews[picture] =
      new ViewWidget(ViewWidget::Kind::Picture, QString("mammogram%1").arg(picture + 1));
  }
  this->SqueezedView = new ViewWidget(ViewWidget::Kind::Scene, "squeezed");
  this->RestView = new ViewWidget(ViewWidget::Kind::Scene, "atRest");
  auto* slices =
    nest(Qt::Vertical, { this->SliceViews[0], this->SliceViews[1], this->SliceViews[2] });
  auto* pictures = nest(Qt::Horizontal, { this->PictureViews[0], this->PictureViews[1] });
  auto* scenes = nest(Qt::Horizontal, { this->SqueezedView, this->RestView });
  auto* right = nest(Qt::Vertical, { pictures, scenes });
  right->setStretchFactor(0, 3);
  right->setStretchFactor(1, 2);
  this->Columns = nest(Qt::Horizontal, { slices, right, this->MakeSide() });
  this->Columns->setStretchFactor(0, 3);
  this->Columns->setStretchFactor(1, 7);
  this->Columns->setStretchFactor(2, 0);
  this->Columns->setObjectName("columns");
  this->Columns->setSizes({ 380, 800, 320 });
  right->setSizes({ 560, 380 });
  for (ViewWidget* view : this->AllViews())
  {
    view->DoubleClicked = [this, view] { this->ToggleLarge(view); };
  }
  return this->Columns;
}

/// Pictures first, which are looked at first.
QList<ViewWidget*> ResultPage::AllViews() const
{
  return { this->PictureViews[0], this->PictureViews[1], this->SliceViews[0], this->SliceViews[1],
    this->SliceViews[2], this->SqueezedView, this->RestView };
}

QWidget* ResultPage::MakeSide()
{
  auto* content = new QWidget;
  auto* side = new QVBoxLayout(content);
  this->MakeTrust(side);
  this->MakePlaces(side);
  this->MakePicture(side);
  this->MakeUnit(side);
  side->addStretch();
  auto* scroll = new QScrollArea;
  scroll->setWidget(content);
  scroll->setWidgetResizable(true);
  scroll->setFrameShape(QFrame::NoFrame);
  scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  scroll->setMinimumWidth(content->minimumSizeHint().width() + 20);
  scroll->setMaximumWidth(420);
  return scroll;
}

void ResultPage::MakeTrust(QVBoxLayout* side)
{
  const auto text = [side](const char* name)
  {
    auto* label = new QLabel;
    label->setObjectName(name);
    label->setWordWrap(true);
    label->setTextInteractionFlags(Qt::TextSelectableByMouse);
    side->addWidget(label);
    return label;
  };
  this->Verdict = text("verdict");
  this->Verdict->setMargin(6);
  this->Expected = text("expected");
  this->Why = new QToolButton;
  this->Why->setObjectName("why");
  this->Why->setText(tr("&Why?"));
  this->Why->setCheckable(true);
  side->addWidget(this->Why);
  this->Reasons = text("reasons");
  this->Reasons->hide();
  connect(this->Why, &QToolButton::toggled, this->Reasons, &QLabel::setVisible);
}

void ResultPage::MakePlaces(QVBoxLayout* side)
{
  auto* group = new QGroupBox(tr("Marked place"));
  auto* layout = new QVBoxLayout(group);
  this->Where = new QLabel;
  this->Where->setObjectName("where");
  this->Where->setWordWrap(true);
  this->Where->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
  this->Where->setMinimumHeight(this->fontMetrics().height() * 6);
  this->Where->setAlignment(Qt::AlignTop | Qt::AlignLeft);
  layout->addWidget(this->Where);
  this->PlaceList = new QListWidget;
  this->PlaceList->setObjectName("places");
  this->PlaceList->setMaximumHeight(130);
  this->PlaceList->setEditTriggers(
    QAbstractItemView::EditKeyPressed | QAbstractItemView::DoubleClicked);
  connect(this->PlaceList, &QListWidget::itemClicked, this,
    [this](const QListWidgetItem*)
    {
      const auto row = static_cast<std::size_t>(this->PlaceList->currentRow());
      if (row < this->Current.Places.size())
      {
        this->MarkPoint(this->Current.Places[row].Point);
      }
    });
  connect(this->PlaceList, &QListWidget::itemChanged, this,
    [this](const QListWidgetItem* item)
    { this->RenamePlace(this->PlaceList->row(item), item->text()); });
  layout->addWidget(this->PlaceList);
  auto* buttons = new QHBoxLayout;
  for (QAction* action : this->MarkMenu)
  {
    if (action->objectName().startsWith("button"))
    {
      auto* button = new QToolButton;
      button->setDefaultAction(action);
      buttons->addWidget(button);
    }
  }
  buttons->addStretch();
  layout->addLayout(buttons);
  side->addWidget(group);
}

void ResultPage::MakePicture(QVBoxLayout* side)
{
  auto* group = new QGroupBox(tr("Pictures"));
  auto* form = new QFormLayout(group);
  this->Comparison = new QComboBox;
  this->Comparison->setObjectName("comparison");
  this->Comparison->addItems({ tr("Blend"), tr("Checkerboard"), tr("Swipe") });
  this->Share = NewSlider("share", SliderSteps / 2);
  const auto compare = [this]
  {
    if (!this->Result)
    {
      return;
    }
    for (const auto& mammogram : this->Result->Mammograms)
    {
      mammogram->Pane.SetComparison(
        static_cast<MammogramPane::Comparison>(this->Comparison->currentIndex()));
      mammogram->Pane.SetBlend(static_cast<double>(this->Share->value()) / SliderSteps);
    }
    this->RedrawAll();
  };
  connect(this->Comparison, QOverload<int>::of(&QComboBox::currentIndexChanged), this, compare);
  connect(this->Share, &QSlider::valueChanged, this, compare);
  this->NoMammograms = new QPushButton(tr("&Show the real mammograms..."));
  this->NoMammograms->setToolTip(tr("A result does not keep them"));
  connect(this->NoMammograms, &QPushButton::clicked, this, [this] { this->MammogramsWanted(); });
  form->addRow(this->NoMammograms);
  form->addRow(tr("Compare by"), this->Comparison);
  form->addRow(tr("Synthetic - real"), this->Share);
  this->Tissue = NewSlider("tissue", 28);
  connect(this->Tissue, &QSlider::valueChanged, this,
    [this](int value)
    {
      if (this->Result && this->Result->Slices)
      {
        this->Result->Slices->SetTissueOpacity(static_cast<double>(value) / SliderSteps);
        this->RedrawAll();
      }
    });
  form->addRow(tr("Tissue"), this->Tissue);
  side->addWidget(group);
}

void ResultPage::MakeUnit(QVBoxLayout* side)
{
  auto* group = new QGroupBox(tr("Unit"));
  auto* form = new QFormLayout(group);
  this->Unit = new QComboBox;
  this->Unit->setObjectName("unit");
  connect(this->Unit, QOverload<int>::of(&QComboBox::activated), this,
    [this](int index) { this->Activate(index); });
  const auto number = [](const char* name, const QString& suffix, double step)
  {
    auto* box = new QDoubleSpinBox;
    box->setObjectName(name);
    box->setSuffix(suffix);
    box->setDecimals(1);
    box->setSingleStep(step);
    box->setKeyboardTracking(false);
    return box;
  };
  this->Thickness = number("thickness", tr(" mm"), 0.5);
  this->Roll = number("roll", tr(" deg"), 1);
  this->Kilovoltage = number("kilovoltage", tr(" kV"), 0.5);
  // A box rounds: only the one that was changed counts.
  connect(this->Thickness, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this,
    [this](double value) { this->SetPose(value, {}); });
  connect(this->Roll, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this,
    [this](double value) { this->SetPose({}, value); });
  connect(this->Kilovoltage, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this,
    [this](double value)
    {
      if (this->Result)
      {
        this->Active().Live.SetKilovoltage(value);
        this->Moved();
      }
    });
  this->SourceOffset = new QLabel;
  this->SourceOffset->setObjectName("source");
  auto* back = new QPushButton(tr("Put the source bac&k"));
  back->setObjectName("sourceBack");
  back->setToolTip(tr("Drag the yellow ball to move it"));
  connect(back, &QPushButton::clicked, this, [this] { this->SetSource({ 0, 0, 0 }); });
  this->Equilibrium = new QLabel;
  this->Equilibrium->setWordWrap(true);
  this->Equilibrium->setObjectName("equilibrium");
  form->addRow(tr("Mammogram"), this->Unit);
  form->addRow(tr("Thickness"), this->Thickness);
  form->addRow(tr("Roll"), this->Roll);
  form->addRow(tr("Tube voltage"), this->Kilovoltage);
  form->addRow(tr("Source"), this->SourceOffset);
  form->addRow(back);
  form->addRow(this->Equilibrium);
  side->addWidget(group);
}

void ResultPage::MakeActions()
{
  const auto add = [this](QList<QAction*>& menu, const char* name, const QString& text,
                     const QKeySequence& keys, std::function<void()> run)
  {
    auto* action = new QAction(text, this);
    action->setObjectName(name);
    action->setShortcut(keys);
    connect(action, &QAction::triggered, this, std::move(run));
    menu.append(action);
    return action;
  };
  auto* tools = new QActionGroup(this);
  for (const auto& [tool, name, text, key] :
    { std::tuple{ ViewTool::Mark, "toolMark", tr("&Mark"), Qt::Key_M },
      std::tuple{ ViewTool::Grey, "toolGrey", tr("Window and &level"), Qt::Key_L },
      std::tuple{ ViewTool::Ruler, "toolRuler", tr("&Ruler"), Qt::Key_R } })
  {
    QAction* action =
      add(this->Tools, name, text, key, [this, tool = tool] { this->SetTool(tool); });
    action->setCheckable(true);
    tools->addAction(action);
  }
  this->Tools.front()->setChecked(true);
  add(this->MarkMenu, "buttonAdd", tr("&Add"), Qt::Key_Insert, [this] { this->AddPlace(); })
    ->setToolTip(tr("Add the marked place to the list"));
  add(this->MarkMenu, "buttonRemove", tr("&Remove"), {}, [this] { this->RemovePlace(); })
    ->setToolTip(tr("Remove the selected place from the list"));
  add(this->MarkMenu, "buttonImport", tr("&Import..."), QKeySequence("Ctrl+I"),
    [this]
    {
      const QString path = QFileDialog::getOpenFileName(this, tr("Import lesions or landmarks"), {},
        tr("Segmentations and landmarks (*.dcm *.nrrd *.mha *.nii *.nii.gz *.csv);;All files (*)"));
      if (!path.isEmpty())
      {
        this->ImportPlaces(path);
      }
    })
    ->setToolTip(tr("Read lesions from a segmentation, or landmarks from a table"));
  add(this->MarkMenu, "copyPlace", tr("&Copy the place"), QKeySequence("Ctrl+Shift+C"),
    [this] { QApplication::clipboard()->setText(this->Where->text()); });
  add(this->MarkMenu, "clearMark", tr("C&lear the mark"), Qt::Key_Escape,
    [this] { this->ClearMark(); });
  add(this->ViewMenu, "resetViews", tr("&Fit all views"), Qt::Key_F,
    [this]
    {
      for (ViewWidget* view : this->AllViews())
      {
        view->Refit();
      }
      this->FitWanted();
    });
  add(this->ViewMenu, "resetGrey", tr("Reset &grey"), Qt::Key_G,
    [this]
    {
      this->GreyWanted();
      if (!this->Result)
      {
        return;
      }
      for (const auto& mammogram : this->Result->Mammograms)
      {
        mammogram->Pane.ResetWindow();
      }
      if (this->Result->Slices)
      {
        this->Result->Slices->ResetWindow();
      }
      this->RedrawAll();
    });
  add(this->ViewMenu, "switchPicture", tr("Synthetic or real &mammogram"), Qt::Key_B,
    [this]
    {
      this->Comparison->setCurrentIndex(0);
      this->Share->setValue(this->Share->value() < SliderSteps / 2 ? SliderSteps : 0);
    });
  add(this->ViewMenu, "switchTissue", tr("Show or hide the &tissue"), Qt::Key_T,
    [this] { this->Tissue->setValue(this->Tissue->value() > 0 ? 0 : 28); });
}

void ResultPage::Open(const ViewInput& input)
{
  this->Progress->setValue(0);
  this->Progress->show();
  this->Views->hide();
  this->Waiting->show();
  this->Opening.Start(
    [this, input, projector = this->Projector](const ProgressCallback& progress) -> Task::Outcome
    {
      ReportProgress(progress, 0, "read the result");
      std::vector<ViewedBreast> viewed = ReadViewedBreasts(input);
      auto result =
        std::make_shared<OpenedResult>(std::move(viewed), projector, ShareOf(progress, 0.4, 1));
      result->Input = input;
      return [this, result] { this->Attach(result); };
    });
}

void ResultPage::ShowMammograms(const std::vector<std::string>& files)
{
  if (!this->Result)
  {
    this->Complain(tr("expected a result before its mammograms, found none open"));
    return;
  }
  ViewInput input = this->Result->Input;
  input.Mammograms = files;
  this->Open(input);
}

void ResultPage::Detach()
{
  this->Ticker.stop();
  this->Rest.stop();
  for (ViewWidget* view : this->AllViews())
  {
    view->Clear();
  }
  this->Result.reset();
}

void ResultPage::Attach(std::shared_ptr<OpenedResult> result)
{
  this->Detach();
  this->Result = std::move(result);
  this->Undo.clear();
  this->Current = {};
  const std::string& folder = this->Result->Input.Result;
  try
  {
    if (!folder.empty())
    {
      this->Current.Places = ReadPlaces(QString::fromStdString(folder + "/" + MarksFileName));
    }
  }
  catch (const Error& error)
  {
    this->Complain(error.what());
  }
  this->AttachSlices();
  this->Unit->clear();
  for (std::size_t index = 0; index < this->Result->Mammograms.size(); ++index)
  {
    const std::string& name = this->Result->Viewed[index].View;
    this->Unit->addItem(name.empty() ? tr("the only one") : QString::fromStdString(name).toUpper());
    this->AttachMammogram(index);
  }
  this->PictureViews[1]->setVisible(this->Result->Mammograms.size() > 1);
  const bool both = std::any_of(this->Result->Viewed.begin(), this->Result->Viewed.end(),
    [](const ViewedBreast& viewed) { return viewed.Real.has_value(); });
  this->NoMammograms->setVisible(!both);
  this->Comparison->setEnabled(both);
  this->Share->setEnabled(both);
  this->AttachScene(this->RestView, *this->Result->AtRest, *this->Result->Mammograms.front());
  this->Activate(0);
  this->TellTrust();
  this->ListPlaces();
  this->UpdateMark(false);
  this->Ticker.start(TickMs);
  if (this->Changed)
  {
    this->Changed();
  }
}

void ResultPage::AttachSlices()
{
  const bool shown = this->Result->Slices != nullptr;
  this->SliceViews[0]->parentWidget()->setVisible(shown);
  this->Tissue->setEnabled(shown);
  if (shown)
  {
    ShowSlices(*this->Result->Slices, this->SliceViews,
      [this](const Vector3& place) { this->MarkPoint(place); });
  }
}

void ResultPage::AttachMammogram(std::size_t index)
{
  if (index >= this->PictureViews.size())
  {
    return;
  }
  ViewWidget* view = this->PictureViews[index];
  MammogramPane* pane = &this->Result->Mammograms[index]->Pane;
  view->Fit = [pane] { pane->Frame(); };
  view->Clicked = [this, pane, index](int x, int y)
  {
    double column = 0;
    double row = 0;
    if (pane->PixelAt(x, y, column, row))
    {
      this->MarkPixel(index, { column, row });
    }
  };
  view->GreyDragged = [pane, view](double factor, double share)
  {
    pane->Adjust(factor, share);
    view->Redraw();
  };
  view->Show({ pane->Renderer() }, &pane->Overlay());
}

void ResultPage::AttachScene(ViewWidget* view, BreastScene& scene, const OpenedMammogram& mammogram)
{
  view->Fit = [&scene, &mammogram] { mammogram.LookAt(scene); };
  view->Clicked = [this, &scene, &mammogram](int x, int y)
  {
    if (const auto place = scene.Pick(x, y, mammogram.Viewed.Anatomy))
    {
      this->MarkPoint(*place);
    }
  };
  view->Show({ scene.Renderer(), scene.MarkRenderer() });
}

void ResultPage::TellTrust()
{
  Trust worst = Trust::Good;
  QStringList reasons;
  QStringList expected;
  for (const ViewedBreast& viewed : this->Result->Viewed)
  {
    const QString prefix =
      viewed.View.empty() ? QString() : QString::fromStdString(viewed.View).toUpper() + ": ";
    worst = std::max(worst, viewed.Trust.Level);
    for (const std::string& reason : viewed.Trust.Reasons)
    {
      reasons << "- " + prefix + QString::fromStdString(reason);
    }
    expected << prefix +
        (viewed.Expected ? tr("expected error %1 mm; 95 % of the tissue within %2 mm")
                             .arg(viewed.Expected->MedianMm, 0, 'f', 1)
                             .arg(viewed.Expected->Most95Mm, 0, 'f', 1)
                         : tr("the expected error is unknown"));
  }
  this->Verdict->setText(QString("%1.").arg(VerdictOf(worst)));
  const char* color = worst == Trust::Good ? "#2e7d32"
    : worst == Trust::Doubtful             ? "#b26a00"
                                           : "#b3261e";
  this->Verdict->setStyleSheet(
    QString("background: %1; color: white; font-weight: bold; border-radius: 4px").arg(color));
  this->Expected->setText(expected.join("\n"));
  this->Reasons->setText(reasons.join("\n"));
  this->Why->setVisible(!reasons.isEmpty());
  this->Reasons->setVisible(this->Why->isChecked() && !reasons.isEmpty());
}

void ResultPage::SetTool(ViewTool tool)
{
  for (ViewWidget* view : { this->SliceViews[0], this->SliceViews[1], this->SliceViews[2],
         this->PictureViews[0], this->PictureViews[1] })
  {
    view->SetTool(tool);
  }
  this->ToolChanged(tool);
}

/// One view alone, or all of them.
void ResultPage::ToggleLarge(ViewWidget* view)
{
  QList<QWidget*> others;
  bool alone = true;
  for (ViewWidget* other : this->AllViews())
  {
    if (other != view)
    {
      others << other;
      alone = alone && !other->isVisibleTo(other->window());
    }
  }
  for (QWidget* other : others)
  {
    const bool exists = other != this->PictureViews[1] || this->Result->Mammograms.size() > 1;
    other->setVisible(alone && exists);
  }
  for (QWidget* nested : this->Columns->findChildren<QSplitter*>())
  {
    bool holds = alone;
    for (QWidget* inner = view; inner && inner != this->Columns; inner = inner->parentWidget())
    {
      holds = holds || inner == nested;
    }
    nested->setVisible(
      holds && (this->Result->Slices || nested != this->SliceViews[0]->parentWidget()));
  }
}

void ResultPage::RedrawAll()
{
  for (ViewWidget* view : this->AllViews())
  {
    if (view->isVisible())
    {
      view->Redraw();
    }
  }
}

void ResultPage::Push(const QString& text, const Marks& after, int merge)
{
  this->Undo.push(new MarksCommand(*this, text, this->Current, after, merge));
}

void ResultPage::Apply(const Marks& marks)
{
  const bool listed = this->Current.Places.size() != marks.Places.size() ||
    !std::equal(marks.Places.begin(), marks.Places.end(), this->Current.Places.begin(),
      [](const NamedPlace& a, const NamedPlace& b)
      { return a.Name == b.Name && a.Point == b.Point; });
  this->Current = marks;
  if (listed)
  {
    this->ListPlaces();
    this->SavePlaces();
  }
  this->UpdateMark(false);
}

void ResultPage::MarkPoint(const Vector3& point)
{
  if (this->Result)
  {
    Marks after = this->Current;
    after.Marked = { point, {}, 0 };
    this->Push(tr("mark"), after, MoveId);
  }
}

void ResultPage::MarkPixel(std::size_t mammogram, const std::array<double, 2>& pixel)
{
  if (this->Result && mammogram < this->Result->Mammograms.size())
  {
    Marks after = this->Current;
    after.Marked = { {}, pixel, mammogram };
    this->Push(tr("mark"), after, MoveId);
  }
}

void ResultPage::ClearMark()
{
  if (this->Result)
  {
    Marks after = this->Current;
    after.Marked = {};
    this->Push(tr("clear the mark"), after, -1);
  }
}

void ResultPage::UpdateMark(bool moved)
{
  if (!this->Result)
  {
    return;
  }
  BreastMark& mark = *this->Result->Mark;
  const MarkedPlace& marked = this->Current.Marked;
  QString text = tr("Click in any view to mark a place.");
  try
  {
    if (marked.Point)
    {
      mark.Set(*marked.Point);
    }
    else if (marked.Pixel)
    {
      mark.Set(*marked.Pixel, marked.Mammogram);
    }
    else
    {
      mark.Clear();
    }
    mark.Update(moved);
    if (mark.Middle())
    {
      text = CoordinatesText(*mark.Middle(), this->Result->Viewed.front().Axes);
    }
    if (!mark.Text().empty())
    {
      text += "\n" + QString::fromStdString(mark.Text());
    }
  }
  catch (const Error& error) // beside the breast, which a view may show
  {
    mark.Clear();
    mark.Update(false);
    text = (marked.Point ? CoordinatesText(*marked.Point, this->Result->Viewed.front().Axes) + "\n"
                         : QString()) +
      QString(error.what());
  }
  this->Where->setText(text);
  if (this->Result->Slices)
  {
    this->Result->Slices->SetMark(marked.Point ? marked.Point : mark.Middle(), mark.RestLines());
  }
  this->RedrawAll();
}

void ResultPage::AddPlace()
{
  const std::optional<Vector3> at = this->Current.Marked.Point ? this->Current.Marked.Point
    : this->Result                                             ? this->Result->Mark->Middle()
                                                               : std::nullopt;
  if (!at)
  {
    this->Tell(tr("Mark a place first: click in any view."));
    return;
  }
  Marks after = this->Current;
  after.Places.push_back({ tr("Place %1").arg(after.Places.size() + 1), *at });
  this->Push(tr("add a place"), after, -1);
}

void ResultPage::RenamePlace(int row, const QString& name)
{
  const auto index = static_cast<std::size_t>(row);
  if (index < this->Current.Places.size() && this->Current.Places[index].Name != name)
  {
    Marks after = this->Current;
    after.Places[index].Name = name;
    this->Push(tr("rename a place"), after, -1);
  }
}

void ResultPage::RemovePlace()
{
  const auto row = static_cast<std::size_t>(this->PlaceList->currentRow());
  if (row < this->Current.Places.size())
  {
    Marks after = this->Current;
    after.Places.erase(after.Places.begin() + static_cast<std::ptrdiff_t>(row));
    this->Push(tr("remove a place"), after, -1);
  }
}

void ResultPage::ListPlaces()
{
  const QSignalBlocker quiet(this->PlaceList);
  const int row = this->PlaceList->currentRow();
  this->PlaceList->clear();
  for (const NamedPlace& place : this->Current.Places)
  {
    auto* item = new QListWidgetItem(place.Name, this->PlaceList);
    item->setFlags(item->flags() | Qt::ItemIsEditable);
    item->setToolTip(CoordinatesText(place.Point, this->Result->Viewed.front().Axes));
  }
  this->PlaceList->setCurrentRow(std::min(row, this->PlaceList->count() - 1));
}

void ResultPage::SavePlaces()
{
  const std::string& folder = this->Result->Input.Result;
  if (folder.empty())
  {
    return;
  }
  try
  {
    WritePlaces(this->Current.Places, QString::fromStdString(folder + "/" + MarksFileName));
  }
  catch (const Error& error)
  {
    this->Complain(error.what());
  }
}

void ResultPage::ImportPlaces(const QString& path)
{
  if (!this->Result)
  {
    this->Complain(tr("expected a result before its lesions, found none open"));
    return;
  }
  this->Work.Start(
    [this, path](const ProgressCallback&) -> Task::Outcome
    {
      std::vector<NamedPlace> found;
      const std::string file = path.toStdString();
      if (path.endsWith(".csv", Qt::CaseInsensitive))
      {
        for (const Landmark& landmark : ReadLandmarks(file))
        {
          found.push_back({ tr("Landmark %1").arg(found.size() + 1), landmark.Uncompressed });
        }
      }
      else
      {
        for (const Lesion& lesion : FindLesions(ReadLesions(file)))
        {
          found.push_back(
            { tr("Lesion %1, %2 mm3").arg(lesion.Label).arg(lesion.VolumeMm3, 0, 'f', 0),
              lesion.Centre });
        }
      }
      return [this, found, path]
      {
        Marks after = this->Current;
        after.Places.insert(after.Places.end(), found.begin(), found.end());
        this->Push(tr("import places"), after, -1);
        this->Tell(tr("%1 places of %2").arg(found.size()).arg(FileName(path)));
      };
    });
}

std::vector<Vector3> ResultPage::PlacesToExport() const
{
  std::vector<Vector3> points;
  for (const NamedPlace& place : this->Current.Places)
  {
    points.push_back(place.Point);
  }
  if (points.empty() && this->Current.Marked.Point)
  {
    points.push_back(*this->Current.Marked.Point);
  }
  return points;
}

void ResultPage::Activate(int mammogram)
{
  this->ActiveMammogram = static_cast<std::size_t>(std::max(mammogram, 0));
  OpenedMammogram& active = this->Active();
  const QSignalBlocker first(this->Thickness);
  const QSignalBlocker second(this->Kilovoltage);
  const QSignalBlocker third(this->Roll);
  const double thickness = active.Viewed.Pose.ThicknessMm;
  this->Thickness->setRange(0.6 * thickness, 1.4 * thickness);
  this->Thickness->setValue(active.Live.Pose().ThicknessMm);
  const double roll = active.Viewed.Pose.RollDeg;
  this->Roll->setRange(roll - RollRangeDeg, roll + RollRangeDeg);
  this->Roll->setValue(active.Live.Pose().RollDeg);
  const double voltage = KilovoltageOf(active.Viewed.Spectrum);
  this->Kilovoltage->setRange(voltage - KilovoltageRange, voltage + KilovoltageRange);
  this->Kilovoltage->setValue(active.Live.Kilovoltage());
  this->Equilibrium->clear();
  this->TellSource();
  this->AttachScene(this->SqueezedView, active.Squeezed, active);
  this->SqueezedView->Grabbed = [&active](int x, int y) { return active.Squeezed.OnSource(x, y); };
  this->SqueezedView->Dragged = [this, &active](int x, int y)
  {
    BreastScene& scene = active.Squeezed;
    const Vector3 shown = PlaceUnder(scene.Renderer(), x, y, scene.ShownSource());
    this->SetSource(
      active.Live.Placed().ToGantry(scene.SourceAt(shown)) - active.Viewed.Breast.Unit.FocalSpot());
  };
}

void ResultPage::TellSource()
{
  const Vector3& offset = this->Active().Live.SourceOffset();
  this->SourceOffset->setText(tr("%1, %2, %3 mm beside its place")
                                .arg(offset[0], 0, 'f', 0)
                                .arg(offset[1], 0, 'f', 0)
                                .arg(offset[2], 0, 'f', 0));
}

/// Gantry x, y and z, mm.
void ResultPage::SetSource(const Vector3& offset)
{
  if (this->Result)
  {
    this->Active().Live.SetSourceOffset(offset);
    this->TellSource();
    this->Moved();
  }
}

void ResultPage::SetPose(const std::optional<double>& thicknessMm,
  const std::optional<double>& rollDeg)
{
  if (!this->Result)
  {
    return;
  }
  OpenedMammogram& active = this->Active();
  const BreastPose& pose = active.Live.Pose();
  active.Live.SetPose(thicknessMm.value_or(pose.ThicknessMm), rollDeg.value_or(pose.RollDeg));
  if (const std::optional<CompressedAnatomy> known = active.Compress())
  {
    this->TellEquilibrium(*known);
  }
  this->Moved();
}

void ResultPage::TellEquilibrium(const CompressedAnatomy& answer)
{
  this->Equilibrium->setText(answer.ReducedFrom > 0
      ? tr("about %1 N, between known equilibria; the exact one follows")
          .arg(answer.PaddleForceN, 0, 'f', 0)
      : tr("%1 mm, %2 N, solved in %3 s")
          .arg(answer.Pose.ThicknessMm, 0, 'f', 1)
          .arg(answer.PaddleForceN, 0, 'f', 0)
          .arg(answer.Seconds, 0, 'f', 1));
}

/// Draws at half resolution until nothing has moved for a while.
void ResultPage::Moved()
{
  this->Active().Update(2);
  this->PictureViews[std::min<std::size_t>(this->ActiveMammogram, 1)]->Redraw();
  this->SqueezedView->Redraw();
  this->Rest.start(RestMs);
}

void ResultPage::Tick()
{
  for (const auto& mammogram : this->Result->Mammograms)
  {
    const std::string stage = mammogram->Worker.Stage();
    if (!stage.empty() && mammogram.get() == &this->Active())
    {
      this->Equilibrium->setText(tr("solving: %1").arg(QString::fromStdString(stage)));
    }
    const std::optional<CompressedAnatomy> answer = mammogram->TakeEquilibrium();
    if (!answer)
    {
      continue;
    }
    if (!answer->Error.empty())
    {
      this->Complain(QString::fromStdString(answer->Error));
      continue;
    }
    if (mammogram.get() == &this->Active())
    {
      this->TellEquilibrium(*answer);
      this->Moved();
    }
    else
    {
      mammogram->Update(1);
      this->UpdateMark(true);
    }
  }
}
}
