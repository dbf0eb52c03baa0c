// SPDX-License-Identifier: Apache-2.0
#include "Private/Desktop/ScenePage.h"

#include "Private/KilovoltageSpectrum.h"
#include "Private/SceneShapes.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/ProjectionImage.h"
#include "mammoray/XRay/Exposer.h"

#include "vtkImageData.h"

#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFileInfo>
#include <QFormLayout>
#include <QGroupBox>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QProgressBar>
#include <QPushButton>
#include <QRegularExpression>
#include <QSlider>
#include <QSplitter>
#include <QTableWidget>
#include <QVBoxLayout>

#include <algorithm>
#include <utility>

namespace mammoray
{
namespace
{
constexpr int SceneRestMs = 250;
/// The most that a source is moved, mm.
constexpr double MostOffsetMm = 1e5;

/// What the X-rays of a scene are, as the control's data.
constexpr const char* OneEnergy = "kev";
constexpr const char* AsGiven = "given";

std::string TextOf(double value)
{
  return QString::number(value, 'g', 12).toStdString();
}

/// Takes a key, and those within it, from what was given.
void Forget(SceneDescription& description, const std::string& key)
{
  std::erase_if(description.Keys,
    [&key](const std::string& given) { return given == key || given.starts_with(key + "."); });
}
}

ScenePage::Scenery::Scenery(const QString& path, const ProjectorOptions& projector)
  : Name(QFileInfo(path).fileName())
  , Description(ReadScene(path.toStdString()))
  , Whole(LoadPlacedScene(this->Description, path.toStdString()))
  , Live(std::make_unique<LiveProjection>(this->Whole, projector))
  , Pane(std::make_unique<ProjectionPane>(*this->Live))
  , Samples(
      std::make_unique<SampleScene>(this->Whole.Materials, *this->Live, this->Pane->NewTexture()))
{
  this->Samples->Update(*this->Live);
  this->Samples->LookAt(*this->Live);
}

ScenePage::ScenePage(const ProjectorOptions& projector)
  : Projector(projector)
{
  this->setObjectName("scenePage");
  this->Head =
    new QLabel(tr("No scene is open. Open a scene file with Ctrl+Alt+O, or drop it here."));
  this->SetupView = new ViewWidget(ViewWidget::Kind::Scene, "setup");
  this->PictureView = new ViewWidget(ViewWidget::Kind::Picture, "xray");
  auto* splitter = new QSplitter(Qt::Horizontal);
  splitter->addWidget(this->SetupView);
  splitter->addWidget(this->PictureView);
  splitter->addWidget(this->MakeSide());
  splitter->setStretchFactor(0, 1);
  splitter->setStretchFactor(1, 1);
  splitter->setChildrenCollapsible(false);
  auto* layout = new QVBoxLayout(this);
  layout->addWidget(this->Head);
  layout->addWidget(splitter, 1);
  const auto complain = [this](const QString& complaint) { this->Complain(complaint); };
  this->Opening.Failed = this->Exposing.Failed = complain;
  this->Opening.Ended = [this]
  { this->Head->setText(this->Opened ? this->Opened->Name : tr("No scene is open.")); };
  this->Exposing.Progressed = [this](double fraction, const QString& stage)
  {
    this->Progress->setValue(static_cast<int>(100 * fraction));
    this->Progress->setFormat(stage + " %p %");
  };
  this->Exposing.Ended = [this]
  {
    this->Progress->hide();
    this->Cancel->hide();
  };
  this->Rest.setSingleShot(true);
  connect(&this->Rest, &QTimer::timeout, this, [this] { this->Draw(1); });
}

ScenePage::~ScenePage()
{
  this->Detach();
}

QDoubleSpinBox* ScenePage::AddNumber(QFormLayout* form, const QString& label, const char* name,
  const QString& suffix)
{
  auto* box = new QDoubleSpinBox;
  box->setObjectName(name);
  box->setSuffix(suffix);
  box->setDecimals(1);
  box->setRange(-MostOffsetMm, MostOffsetMm);
  box->setKeyboardTracking(false);
  form->addRow(label, box);
  return box;
}

void ScenePage::AddBeam(QFormLayout* form)
{
  this->XRays = new QComboBox;
  this->XRays->setObjectName("xrays");
  form->addRow(tr("X-&rays"), this->XRays);
  connect(this->XRays, QOverload<int>::of(&QComboBox::activated), this,
    [this] { this->ReadBeam(); });
  this->Energy = this->AddNumber(form, tr("&Energy"), "energy", tr(" kV"));
  this->Energy->setSingleStep(0.5);
  connect(this->Energy, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this,
    [this] { this->ReadBeam(); });
  this->EnergyLabel = qobject_cast<QLabel*>(form->labelForField(this->Energy));
  this->Filters = new QLineEdit;
  this->Filters->setObjectName("filters");
  this->Filters->setPlaceholderText("Al:2 Cu:0.1");
  this->Filters->setToolTip(tr("Layers in the beam: material and millimetres"));
  form->addRow(tr("&Filters"), this->Filters);
  connect(this->Filters, &QLineEdit::editingFinished, this, [this] { this->ReadBeam(); });
  this->SpectrumPlot = new Plot("spectrum");
  form->addRow(this->SpectrumPlot);
}

QWidget* ScenePage::MakeSide()
{
  auto* content = new QWidget;
  auto* side = new QVBoxLayout(content);
  this->Parts = new QTableWidget(0, 2);
  this->Parts->setObjectName("parts");
  this->Parts->setHorizontalHeaderLabels({ tr("Part"), tr("Material") });
  this->Parts->horizontalHeader()->setStretchLastSection(true);
  this->Parts->verticalHeader()->hide();
  this->Parts->setEditTriggers(QAbstractItemView::NoEditTriggers);
  side->addWidget(this->Parts, 1);
  auto* group = new QGroupBox(tr("Setup"));
  auto* form = new QFormLayout(group);
  this->Turn = new QSlider(Qt::Horizontal);
  this->Turn->setObjectName("turn");
  this->Turn->setRange(0, 360);
  connect(this->Turn, &QSlider::valueChanged, this, [this] { this->ReadControls(); });
  form->addRow(tr("&Turn"), this->Turn);
  const std::array<QString, 3> names{ tr("Source &x"), tr("Source &y"), tr("Source &z") };
  const char* const objects[] = { "sourceX", "sourceY", "sourceZ" };
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    this->Source[axis] = this->AddNumber(form, names[axis], objects[axis], tr(" mm"));
    this->Source[axis]->setSingleStep(5);
    connect(this->Source[axis], QOverload<double>::of(&QDoubleSpinBox::valueChanged), this,
      [this] { this->ReadControls(); });
  }
  this->AddBeam(form);
  side->addWidget(group);
  this->Histogram = new Plot("histogram");
  side->addWidget(this->Histogram);
  this->Profile = new Plot("profile");
  this->Profile->hide();
  side->addWidget(this->Profile);
  this->Seen =
    new QLabel(tr("Click in the picture to see what a pixel sees. Drag the yellow ball to move "
                  "the source."));
  this->Seen->setObjectName("seen");
  this->Seen->setWordWrap(true);
  this->Seen->setTextInteractionFlags(Qt::TextSelectableByMouse);
  side->addWidget(this->Seen);
  this->Progress = new QProgressBar;
  this->Progress->hide();
  side->addWidget(this->Progress);
  this->Cancel = new QPushButton(tr("&Cancel"));
  this->Cancel->hide();
  connect(this->Cancel, &QPushButton::clicked, this, [this] { this->Exposing.Cancel(); });
  side->addWidget(this->Cancel);
  content->setMaximumWidth(360);
  content->setEnabled(false);
  content->setObjectName("sceneSide");
  return content;
}

void ScenePage::Open(const QString& path)
{
  this->Head->setText(tr("reading %1...").arg(QFileInfo(path).fileName()));
  this->Opening.Start(
    [this, path, projector = this->Projector](const ProgressCallback&) -> Task::Outcome
    {
      auto scenery = std::make_shared<Scenery>(path, projector);
      return [this, scenery] { this->Attach(scenery); };
    });
}

void ScenePage::Detach()
{
  this->Rest.stop();
  this->SetupView->Clear();
  this->PictureView->Clear();
  this->Opened.reset();
}

void ScenePage::Attach(std::shared_ptr<Scenery> scenery)
{
  this->Detach();
  this->Opened = std::move(scenery);
  this->Marked.reset();
  Scenery* opened = this->Opened.get();
  this->PictureView->Fit = [opened] { opened->Pane->Frame(); };
  this->PictureView->Clicked = [this, opened](int x, int y)
  {
    double column = 0;
    double row = 0;
    if (opened->Pane->PixelAt(x, y, column, row))
    {
      this->Marked = { column, row };
      this->Draw(1);
    }
  };
  this->PictureView->GreyDragged = [this, opened](double factor, double share)
  {
    opened->Pane->Adjust(factor, share);
    this->PictureView->Redraw();
  };
  this->SetupView->Fit = [opened] { opened->Samples->LookAt(*opened->Live); };
  this->SetupView->Grabbed = [opened](int x, int y) { return opened->Samples->OnSource(x, y); };
  this->SetupView->Dragged = [this, opened](int x, int y)
  {
    const Vector3 shown = opened->Samples->ShownSource();
    const Vector3 to = PlaceUnder(opened->Samples->Renderer(), x, y, shown);
    opened->Live->SetSourceOffset(
      opened->Live->SourceOffset() + (1 / opened->Samples->SourceShare()) * (to - shown));
    this->TellSource();
    this->Moved();
  };
  this->SetupView->Show({ opened->Samples->Renderer() });
  this->PictureView->Show({ opened->Pane->Renderer() }, &opened->Pane->Overlay());
  this->PictureView->Ruled = [this] { this->PlotProfile(); };
  const QSignalBlocker still(this->Turn);
  this->Turn->setValue(0);
  this->Profile->hide();
  this->TellBeam();
  this->TellSource();
  this->PlotSpectrum();
  this->PlotHistogram();
  this->ListParts();
  this->findChild<QWidget*>("sceneSide")->setEnabled(true);
  if (this->Changed)
  {
    this->Changed();
  }
}

void ScenePage::ResetViews()
{
  this->SetupView->Refit();
  this->PictureView->Refit();
}

void ScenePage::ResetGrey()
{
  if (this->Opened)
  {
    this->Opened->Pane->ResetWindow();
    this->PictureView->Redraw();
  }
}

void ScenePage::ListParts()
{
  this->Parts->setRowCount(0);
  const auto add = [this](const std::string& part, const std::string& material)
  {
    const int row = this->Parts->rowCount();
    this->Parts->insertRow(row);
    this->Parts->setItem(row, 0,
      new QTableWidgetItem(QFileInfo(QString::fromStdString(part)).fileName()));
    this->Parts->setItem(row, 1, new QTableWidgetItem(QString::fromStdString(material)));
  };
  const SceneDescription& description = this->Opened->Description;
  for (const SurfaceSample& sample : description.Samples)
  {
    add(sample.File, sample.Material);
  }
  if (!description.Mesh.empty())
  {
    for (const std::string& name : this->Opened->Whole.Materials.Names())
    {
      add(description.Mesh, name);
    }
  }
  this->Parts->resizeColumnToContents(0);
}

/// The source's place as numbers.
void ScenePage::TellSource()
{
  const XRaySource& source = this->Opened->Live->Source();
  const bool parallel = source.Type == XRaySource::Kind::Parallel;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const QSignalBlocker quiet(this->Source[axis]);
    this->Source[axis]->setEnabled(!parallel);
    this->Source[axis]->setValue(parallel ? 0 : source.Position[axis]);
  }
}

/// The scene's X-rays in the controls.
void ScenePage::TellBeam()
{
  SceneDescription description = this->Opened->Description;
  CompleteUnit(description);
  const QString anode = QString::fromStdString(description.Tube.Anode);
  const bool single = description.EnergyKeV.has_value();
  this->XRays->clear();
  this->XRays->addItem(tr("of one energy"), OneEnergy);
  for (const auto& [symbol, metal] :
    { std::pair{ "W", tr("tungsten") }, { "Mo", tr("molybdenum") }, { "Rh", tr("rhodium") } })
  {
    this->XRays->addItem(tr("%1 tube").arg(metal), symbol);
  }
  if (!single && anode.isEmpty())
  {
    this->XRays->addItem(tr("spectrum of the scene"), AsGiven);
  }
  this->XRays->setCurrentIndex(this->XRays->findData(single ? OneEnergy
      : anode.isEmpty()                                     ? AsGiven
                                                            : anode));
  QStringList filters;
  for (const std::string& filter : description.Filters)
  {
    filters << QString::fromStdString(filter);
  }
  this->Filters->setText(filters.join(' '));
  this->LimitEnergy();
  const QSignalBlocker quiet(this->Energy);
  this->Energy->setValue(
    anode.isEmpty() ? this->Opened->Live->Energy() : description.Tube.KilovoltagePeak);
}

/// Names the energy, and keeps it in the range, of the X-rays that are chosen.
void ScenePage::LimitEnergy()
{
  constexpr double LeastVoltage = 18;
  constexpr double MostVoltage = 42;
  constexpr double MostOfTungsten = 450;
  const QString kind = this->XRays->currentData().toString();
  const bool single = kind == OneEnergy;
  const QSignalBlocker quiet(this->Energy);
  this->EnergyLabel->setText(single ? tr("Photon &energy") : tr("Tube &voltage"));
  this->Energy->setSuffix(single ? tr(" keV") : tr(" kV"));
  if (single || kind == AsGiven)
  {
    const std::array<double, 2>& range = this->Opened->Live->EnergyRange();
    this->Energy->setRange(range[0], range[1]);
  }
  else
  {
    this->Energy->setRange(LeastVoltage, kind == "W" ? MostOfTungsten : MostVoltage);
  }
}

/// The scene with the X-rays that the controls ask for. Throws InputError.
SceneDescription ScenePage::AskedBeam() const
{
  SceneDescription asked = this->Opened->Description;
  const std::string kind = this->XRays->currentData().toString().toStdString();
  const std::string energy = TextOf(this->Energy->value());
  if (kind != AsGiven)
  {
    for (const char* key :
      { "beam.kev", "beam.energies", "beam.photons", "beam.spectrum", "beam.tube", "beam.kvp" })
    {
      Forget(asked, key);
    }
    asked.EnergyKeV.reset();
    asked.EnergiesKeV.clear();
    asked.Photons.clear();
    asked.Tube.Anode.clear();
  }
  if (kind == OneEnergy)
  {
    SetQuantity({ "beam", "beam.kev", { energy } }, asked);
  }
  else if (kind != AsGiven)
  {
    SetQuantity({ "beam", "beam.tube", { kind } }, asked);
    SetQuantity({ "beam", "beam.kvp", { energy } }, asked);
  }
  if (asked.Tube.Anode != "W" && asked.Tube.TargetAngleDeg != 0)
  {
    Forget(asked, "beam.target-angle");
    asked.Tube.TargetAngleDeg = 0;
  }
  Forget(asked, "beam.filter");
  asked.Filters.clear();
  std::vector<std::string> filters;
  for (const QString& filter :
    this->Filters->text().split(QRegularExpression("[\\s,;]+"), Qt::SkipEmptyParts))
  {
    filters.push_back(filter.toStdString());
  }
  if (!filters.empty())
  {
    SetQuantity({ "filters", "beam.filter", filters }, asked);
  }
  CompleteUnit(asked);
  return asked;
}

void ScenePage::ReadBeam()
{
  if (!this->Opened)
  {
    return;
  }
  LiveProjection& live = *this->Opened->Live;
  this->LimitEnergy();
  try
  {
    const SceneDescription asked = this->AskedBeam();
    live.SetSpectrum(FindSpectrum(asked));
    if (this->XRays->currentData() == AsGiven)
    {
      live.SetEnergy(this->Energy->value());
    }
    this->Opened->Description = asked;
    this->Opened->Whole.Field.Heel.Target =
      asked.Tube.Anode.empty() ? this->Opened->Whole.Field.Heel.Target : asked.Tube.Anode;
  }
  catch (const Error& error)
  {
    this->Complain(error.what());
    return;
  }
  this->LimitEnergy();
  this->PlotSpectrum();
  this->Moved();
}

void ScenePage::PlotSpectrum()
{
  const Spectrum& spectrum = this->Opened->Live->XRays();
  this->SpectrumPlot->setVisible(spectrum.EnergiesKeV.size() > 1);
  this->SpectrumPlot->SetCurve(spectrum.EnergiesKeV, spectrum.Weights, tr("photons, keV"));
}

/// Of the log attenuation where there is something in the beam.
void ScenePage::PlotHistogram()
{
  constexpr std::size_t Bins = 100;
  constexpr float Least = 1e-3F; // air
  const std::vector<float>& values = this->Opened->Live->Project(1);
  const auto most = values.empty() ? 0.0F : *std::max_element(values.begin(), values.end());
  std::vector<double> edges(Bins);
  std::vector<double> counts(Bins);
  for (std::size_t bin = 0; bin < Bins; ++bin)
  {
    edges[bin] = most * static_cast<double>(bin) / (Bins - 1);
  }
  for (const float value : values)
  {
    if (value > Least)
    {
      counts[std::min(static_cast<std::size_t>(value / most * (Bins - 1)), Bins - 1)] += 1;
    }
  }
  this->Histogram->SetCurve(most > Least ? edges : std::vector<double>(), counts,
    tr("pixels by log attenuation"));
}

/// Of the log attenuation along the ruler.
void ScenePage::PlotProfile()
{
  const ProjectionPane::Profile profile = this->Opened->Pane->AlongRuler();
  this->Profile->setVisible(!profile.Mm.empty());
  this->Profile->SetCurve(profile.Mm, profile.LogAttenuation, tr("log attenuation, mm"));
}

void ScenePage::ReadControls()
{
  if (!this->Opened)
  {
    return;
  }
  LiveProjection& live = *this->Opened->Live;
  live.SetTurn(this->Turn->value());
  const XRaySource& first = this->Opened->Whole.Source;
  if (first.Type != XRaySource::Kind::Parallel)
  {
    const Vector3 asked{ this->Source[0]->value(), this->Source[1]->value(),
      this->Source[2]->value() };
    live.SetSourceOffset(asked - first.Position);
  }
  this->Moved();
}

void ScenePage::Moved()
{
  this->Draw(2);
  this->Rest.start(SceneRestMs);
}

void ScenePage::Draw(int divisor)
{
  if (!this->Opened)
  {
    return;
  }
  Scenery& opened = *this->Opened;
  opened.Pane->Update(*opened.Live, divisor);
  opened.Pane->SetMark(this->Marked);
  opened.Samples->Update(*opened.Live);
  if (divisor == 1)
  {
    this->PlotHistogram();
  }
  this->PlotProfile();
  if (this->Marked && divisor == 1)
  {
    this->Seen->setText(
      QString::fromStdString(opened.Live->Describe((*this->Marked)[0], (*this->Marked)[1])));
  }
  this->PictureView->Redraw();
  this->SetupView->Redraw();
}

/// The scene with source and energy as they stand.
Scene ScenePage::Current() const
{
  Scene scene = this->Opened->Whole;
  const LiveProjection& live = *this->Opened->Live;
  scene.Source = live.Source();
  scene.XRays = live.XRays();
  return scene;
}

/// False, after a complaint, where no scene is open or its samples are turned.
bool ScenePage::CanSave()
{
  if (!this->Opened)
  {
    this->Complain(tr("expected a scene, found none open"));
    return false;
  }
  if (this->Opened->Live->Turn() != 0)
  {
    this->Complain(tr("samples: expected them as the scene has them, found them turned"));
    return false;
  }
  return true;
}

void ScenePage::Expose(const QString& path)
{
  if (!this->CanSave())
  {
    return;
  }
  this->Progress->show();
  this->Cancel->show();
  this->Exposing.Start(
    [this, path, scene = this->Current(), projector = this->Projector](
      const ProgressCallback& progress) -> Task::Outcome
    {
      const std::string file = path.toStdString();
      CheckProjectionExtension(file);
      Exposer exposer(projector);
      const Exposure exposure = exposer.Expose(scene, progress);
      const auto image = ToImage(exposure, scene.Detector, scene.Materials.Names());
      WriteProjection(image, file);
      return [this, path] { this->Tell(tr("wrote %1").arg(path)); };
    });
}

void ScenePage::SaveScene(const QString& path)
{
  if (!this->CanSave())
  {
    return;
  }
  try
  {
    const LiveProjection& live = *this->Opened->Live;
    SceneDescription description = this->Opened->Description;
    const XRaySource& source = live.Source();
    if (source.Type != XRaySource::Kind::Parallel && description.HasSource())
    {
      const Vector3& at = source.Position;
      SetQuantity({ "source", "source.position", { TextOf(at[0]), TextOf(at[1]), TextOf(at[2]) } },
        description);
    }
    if (this->XRays->currentData() == AsGiven &&
      live.Energy() != KilovoltageOf(FindSpectrum(description)))
    {
      throw InputError("beam: expected a tube or a single energy for another voltage, found a "
                       "spectrum from a table");
    }
    WriteAtomicFile(path.toStdString(), WriteScene(description));
    this->Tell(tr("wrote %1").arg(path));
  }
  catch (const Error& error)
  {
    this->Complain(error.what());
  }
}
}
