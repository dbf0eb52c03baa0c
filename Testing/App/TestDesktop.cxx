// SPDX-License-Identifier: Apache-2.0
// The desktop application, by real clicks and keys.
#include "MadeUpStudy.h"
#include "SmallBreast.h"
#include "SurfaceShapes.h"
#include "VirtualDisplay.h"
#include "mammoray/App/Private/Desktop/MainWindow.h"
#include "mammoray/App/Private/Desktop/SearchPictures.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/XRay/Composition.h"
#include "mammoray/XRay/Tube.h"

#include "vtkCamera.h"
#include "vtkPolyData.h"
#include "vtkRenderer.h"

#include <QApplication>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QElapsedTimer>
#include <QFileInfo>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QMouseEvent>
#include <QPushButton>
#include <QSettings>
#include <QSurfaceFormat>
#include <QTableWidget>
#include <QTest>
#include <QTimer>
#include <QWheelEvent>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>

namespace
{
using namespace mammoray;

/// One for all tests; it never ends, as OpenGL's drivers expect of it.
QApplication* Application()
{
  static QApplication* const application = []
  {
    static int count = 1;
    static char name[] = "TestDesktop";
    static char* arguments[] = { name, nullptr };
    qputenv("QT_QPA_PLATFORM", "xcb");
    QSurfaceFormat::setDefaultFormat(QVTKOpenGLNativeWidget::defaultFormat());
    QCoreApplication::setOrganizationName("MammoRayTest");
    QCoreApplication::setApplicationName("TestDesktop");
    return new QApplication(count, arguments);
  }();
  return application;
}

class Desktop : public testing::Test
{
protected:
  void SetUp() override
  {
    if (!test::VirtualDisplay::Instance().Works() || ListDevices().empty())
    {
      GTEST_SKIP() << "no Vulkan device or no Xvfb";
    }
    Application();
    QSettings::setDefaultFormat(QSettings::IniFormat);
    QSettings::setPath(QSettings::IniFormat, QSettings::UserScope,
      QString::fromStdString(this->Folder.File("settings")));
    this->Start();
  }
  void Start()
  {
    this->Window.reset();
    this->Window = std::make_unique<MainWindow>(ProjectorOptions{});
    this->Window->resize(1300, 900);
    this->Window->show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(this->Window.get()));
    this->Window->activateWindow(); // there is no window manager, without which keys reach nobody
    ASSERT_TRUE(QTest::qWaitForWindowActive(this->Window.get()));
  }
  /// The small result, whose table is not shipped.
  void OpenResult()
  {
    ViewInput input = test::WriteSmallBreast(this->Folder);
    input.Mesh.clear();
    input.Orientation = "LPS";
    input.Result =
      this->ResultFolder.empty() ? test::WriteSmallResult(this->Folder) : this->ResultFolder;
    this->ResultFolder = input.Result;
    this->Window->Result().Open(input);
    ASSERT_TRUE(this->Await([this] { return !this->Window->Result().IsBusy(); }));
    ASSERT_EQ(this->Window->Complaint().toStdString(), "");
    ASSERT_TRUE(this->Window->Result().IsOpen());
  }
  template <typename Condition>
  bool Await(const Condition& done)
  {
    return QTest::qWaitFor(done, 60000);
  }
  template <typename Widget>
  Widget* Find(const char* name)
  {
    auto* found = this->Window->findChild<Widget*>(name);
    EXPECT_NE(found, nullptr) << name;
    return found;
  }
  void ClickMiddle(const char* view)
  {
    auto* widget = this->Window->Result().View(view);
    ASSERT_NE(widget, nullptr);
    QTest::mouseClick(widget, Qt::LeftButton, {}, widget->rect().center());
  }
  /// Clicks along a line through the middle until something is marked, which is not `before`.
  void ClickBreast(const char* view, const std::string& before)
  {
    auto* widget = this->Window->Result().View(view);
    for (int step = 1; step < 20 && this->Where() == before; ++step)
    {
      QTest::mouseClick(widget, Qt::LeftButton, {},
        { widget->width() * step / 20, widget->height() / 2 });
    }
  }
  /// A picture of the window, or of its dialog, where MAMMORAY_PICTURES names a folder.
  void Keep(const QString& name)
  {
    const QString folder = qEnvironmentVariable("MAMMORAY_PICTURES");
    if (!folder.isEmpty())
    {
      constexpr int DrawnMs = 500;
      QTest::qWait(DrawnMs);
      QWidget* dialog = QApplication::activeModalWidget();
      QWidget* shown = dialog != nullptr ? dialog : this->Window.get();
      EXPECT_TRUE(shown->grab().save(folder + "/" + name + ".png"));
    }
  }
  std::string Where() { return this->Find<QLabel>("where")->text().toStdString(); }

  test::TemporaryFolder Folder;
  std::string ResultFolder;
  std::unique_ptr<MainWindow> Window;
};

TEST_F(Desktop, MarksWhatIsClickedInAnyView)
{
  this->OpenResult();
  EXPECT_EQ(this->Find<QLabel>("verdict")->text(), "The match should be checked by eye.");
  EXPECT_FALSE(this->Find<QLabel>("reasons")->isVisible());
  QTest::mouseClick(this->Find<QWidget>("why"), Qt::LeftButton);
  EXPECT_TRUE(this->Find<QLabel>("reasons")->isVisible());
  EXPECT_THAT(this->Find<QLabel>("reasons")->text().toStdString(),
    testing::HasSubstr("The outlines lie apart."));

  this->ClickMiddle("mammogram1");
  EXPECT_THAT(this->Where(), testing::HasSubstr("pixel ("));
  EXPECT_THAT(this->Where(), testing::HasSubstr("LPS"));
  EXPECT_THAT(this->Where(), testing::HasSubstr("RAS"));
  const std::string ofPixel = this->Where();
  this->ClickBreast("squeezed", ofPixel);
  EXPECT_THAT(this->Where(), testing::HasSubstr("(1 sd)"));
  EXPECT_THAT(this->Where(), testing::HasSubstr(" mm in "));
  const std::string ofPoint = this->Where();
  this->ClickBreast("atRest", ofPoint);
  EXPECT_NE(this->Where(), ofPoint);
  QTest::keyClick(this->Window.get(), Qt::Key_Escape);
  EXPECT_THAT(this->Where(), testing::HasSubstr("Click in any view"));
}

TEST_F(Desktop, KeepsPlacesAndUndoesThem)
{
  this->OpenResult();
  auto* places = this->Find<QListWidget>("places");
  this->ClickMiddle("mammogram1");
  QTest::keyClick(this->Window.get(), Qt::Key_Insert);
  ASSERT_EQ(places->count(), 1);
  QTest::keyClick(this->Window.get(), Qt::Key_Z, Qt::ControlModifier);
  EXPECT_EQ(places->count(), 0);
  QTest::keyClick(this->Window.get(), Qt::Key_Z, Qt::ControlModifier | Qt::ShiftModifier);
  ASSERT_EQ(places->count(), 1);
  places->item(0)->setText("lesion A");

  // As after a kill: another window opens the folder.
  this->Start();
  this->OpenResult();
  places = this->Find<QListWidget>("places");
  ASSERT_EQ(places->count(), 1);
  EXPECT_EQ(places->item(0)->text(), "lesion A");
  QTest::mouseClick(places->viewport(), Qt::LeftButton, {},
    places->visualItemRect(places->item(0)).center());
  EXPECT_THAT(this->Where(), testing::HasSubstr("(1 sd)"));
}

TEST_F(Desktop, SqueezesTheBreastAnew)
{
  this->OpenResult();
  auto* thickness = this->Find<QDoubleSpinBox>("thickness");
  thickness->setFocus();
  thickness->setValue(thickness->value() + 2);
  auto* told = this->Find<QLabel>("equilibrium");
  EXPECT_TRUE(this->Await([told] { return told->text().contains("solved in"); }))
    << told->text().toStdString() << this->Window->Complaint().toStdString();
}

TEST_F(Desktop, GoesThroughSlicesAndChangesTheirGrey)
{
  this->ResultFolder = test::WriteSmallResult(this->Folder);
  WriteIntensityVolume(*test::Ramp(), this->ResultFolder + "/mri.nrrd");
  this->OpenResult();
  ViewWidget* view = this->Window->Result().View("sagittal");
  const QPoint middle = view->rect().center();
  const auto grey = [&]
  {
    view->Draw();
    return qGray(view->grabFramebuffer().pixel(middle));
  };
  const auto mouse = [&](QEvent::Type type, const QPoint& at)
  {
    QMouseEvent event(type, at, Qt::LeftButton, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(view, &event);
  };
  const int first = grey();
  QWheelEvent wheel(middle, view->mapToGlobal(middle), {}, { 0, 10 * 120 }, Qt::NoButton,
    Qt::NoModifier, Qt::NoScrollPhase, false);
  QApplication::sendEvent(view, &wheel);
  const int scrolled = grey();
  // The sagittal slice shows one x; towards the patient's right by 10 voxels of 59.
  EXPECT_NEAR(first - scrolled, 255 * 10 / 59.0, 2);
  QTest::keyClick(this->Window.get(), Qt::Key_L);
  mouse(QEvent::MouseButtonPress, middle);
  mouse(QEvent::MouseMove, middle - QPoint(0, 30));
  mouse(QEvent::MouseButtonRelease, middle - QPoint(0, 30));
  EXPECT_GT(grey(), scrolled + 10); // up is brighter
  QTest::keyClick(this->Window.get(), Qt::Key_G);
  EXPECT_EQ(grey(), scrolled);
}

TEST_F(Desktop, MeasuresWithARuler)
{
  this->OpenResult();
  ViewWidget* view = this->Window->Result().View("mammogram1");
  QTest::keyClick(this->Window.get(), Qt::Key_R);
  constexpr int Pixels = 120;
  const QPoint from = view->rect().center();
  QTest::mousePress(view, Qt::LeftButton, {}, from);
  QMouseEvent move(QEvent::MouseMove, from + QPoint(Pixels, 0), Qt::NoButton, Qt::LeftButton,
    Qt::NoModifier);
  QApplication::sendEvent(view, &move);
  QTest::mouseRelease(view, Qt::LeftButton, {}, from + QPoint(Pixels, 0));
  MammogramPane& pane = this->Window->Result().Opened()->Mammograms.front()->Pane;
  const auto& ends = pane.Overlay().RulerEnds();
  ASSERT_TRUE(ends.has_value());
  const double pixelMm =
    2 * pane.Renderer()->GetActiveCamera()->GetParallelScale() / view->height();
  EXPECT_NEAR(Norm((*ends)[1] - (*ends)[0]), Pixels * pixelMm, 1e-6);
  // It is drawn there, in yellow.
  view->Draw();
  const QImage drawn = view->grabFramebuffer();
  int yellow = 0;
  for (int x = from.x(); x < from.x() + Pixels; ++x)
  {
    for (int y = from.y() - 1; y <= from.y() + 1; ++y)
    {
      const QColor color = drawn.pixelColor(x, y);
      yellow += color.red() > 200 && color.green() > 150 && color.blue() < 120 ? 1 : 0;
    }
  }
  EXPECT_GT(yellow, Pixels);
  this->Keep("ruler");
}

TEST_F(Desktop, MovesTheSourceOfAMammogram)
{
  this->OpenResult();
  ViewWidget* view = this->Window->Result().View("squeezed");
  view->Draw();
  OpenedMammogram& opened = *this->Window->Result().Opened()->Mammograms.front();
  vtkRenderer* renderer = opened.Squeezed.Renderer();
  const Vector3& source = opened.Squeezed.ShownSource();
  renderer->SetWorldPoint(source[0], source[1], source[2], 1);
  renderer->WorldToDisplay();
  const QPoint ball(static_cast<int>(renderer->GetDisplayPoint()[0]),
    view->height() - 1 - static_cast<int>(renderer->GetDisplayPoint()[1]));
  QTest::mousePress(view, Qt::LeftButton, {}, ball);
  QMouseEvent move(QEvent::MouseMove, ball + QPoint(30, 0), Qt::NoButton, Qt::LeftButton,
    Qt::NoModifier);
  QApplication::sendEvent(view, &move);
  QTest::mouseRelease(view, Qt::LeftButton, {}, ball + QPoint(30, 0));
  EXPECT_GT(Norm(opened.Live.SourceOffset()), 30);
  EXPECT_FALSE(this->Find<QLabel>("source")->text().startsWith("0, 0, 0"));
  QTest::mouseClick(this->Find<QPushButton>("sourceBack"), Qt::LeftButton);
  EXPECT_EQ(Norm(opened.Live.SourceOffset()), 0);
  EXPECT_TRUE(this->Find<QLabel>("source")->text().startsWith("0, 0, 0"));
}

TEST_F(Desktop, ImportsLesions)
{
  this->OpenResult();
  LabelVolume lesions;
  lesions.Size = { 1, 1, 1 };
  lesions.Spacing = { 2, 2, 2 };
  lesions.Origin = { 5, 20, 3 };
  lesions.Voxels = { 4 };
  const std::string file = this->Folder.File("lesions.nrrd");
  WriteLabelVolume(lesions, file);
  this->Window->Result().ImportPlaces(QString::fromStdString(file));
  ASSERT_TRUE(this->Await([this] { return !this->Window->IsBusy(); }));
  auto* places = this->Find<QListWidget>("places");
  ASSERT_EQ(places->count(), 1);
  EXPECT_EQ(places->item(0)->text(), "Lesion 4, 8 mm3");
  QTest::mouseClick(places->viewport(), Qt::LeftButton, {},
    places->visualItemRect(places->item(0)).center());
  EXPECT_THAT(this->Where(), testing::HasSubstr("(5.0, 20.0, 3.0) mm in gland"));
}

TEST_F(Desktop, TakesAnotherSeriesByHand)
{
  test::MadeUpStudy files;
  files.AddSlices(test::MadeUpMr("1.2.4", "t1"), 30);
  files.AddSlices(test::MadeUpMr("1.2.5", "t1 again"), 30);
  files.Add(test::MadeUpMammogram("L", "CC"));
  this->Window->OpenPaths({ QString::fromStdString(files.Folder()) });
  ASSERT_TRUE(this->Await([this] { return !this->Window->IsBusy(); }));
  EXPECT_EQ(this->Window->ShownPage(), MainWindow::StudyPage);
  auto* series = this->Find<QTableWidget>("series");
  ASSERT_EQ(series->rowCount(), 2);
  const int reason = series->columnCount() - 1;
  const auto taken = [&](int row) { return series->item(row, reason)->text().startsWith("taken"); };
  ASSERT_NE(taken(0), taken(1)) << this->Find<QLabel>("contradictions")->text().toStdString();
  const int other = taken(0) ? 1 : 0;
  series->item(other, 0)->setCheckState(Qt::Checked);
  EXPECT_TRUE(taken(other));
  EXPECT_FALSE(taken(1 - other));
  EXPECT_TRUE(this->Find<QPushButton>("toRun")->isEnabled());

  // A search of made-up pixels fails in a line, and the window goes on.
  QTest::mouseClick(this->Find<QPushButton>("toRun"), Qt::LeftButton);
  EXPECT_EQ(this->Window->ShownPage(), MainWindow::RunPage);
  this->Find<QLineEdit>("output")->setText(QString::fromStdString(this->Folder.File("new-result")));
  QTest::mouseClick(this->Find<QPushButton>("start"), Qt::LeftButton);
  EXPECT_TRUE(this->Find<QPushButton>("cancel")->isEnabled());
  ASSERT_TRUE(this->Await([this] { return !this->Window->IsBusy(); }));
  EXPECT_FALSE(this->Find<QPushButton>("cancel")->isEnabled());
  EXPECT_NE(this->Window->Complaint(), "");
  EXPECT_FALSE(this->Window->Complaint().contains('\n'));
  const QString caseFile = QString::fromStdString(this->Folder.File("case.json"));
  this->Window->WriteCaseFile(caseFile);
  EXPECT_TRUE(QFileInfo::exists(caseFile));

  // The mammogram shows the left breast.
  this->Window->ShowPage(MainWindow::StudyPage);
  this->Find<QComboBox>("side")->setCurrentIndex(2);
  EXPECT_NE(this->Find<QLabel>("contradictions")->text(), "");
  EXPECT_FALSE(this->Find<QPushButton>("toRun")->isEnabled());
}

TEST_F(Desktop, MovesAndExportsAScene)
{
  SurfaceMesh box;
  shapes::AddBox(box, { -10, -10, -10 }, { 10, 10, 10 }, 1);
  WriteMesh(ToPolyData(box, {}), this->Folder.File("box.stl"));
  const std::string scene = this->Folder.Write("scene.json", R"({
    "source": { "position": [0, -500, 0] },
    "detector": { "origin": [-31, 100, 31], "column-direction": [1, 0, 0],
      "row-direction": [0, 0, -1], "columns": 64, "rows": 64, "pixel-spacing": 1 },
    "beam": { "kev": 60 },
    "samples": [ { "file": "box.stl", "unit": "mm", "material": "Al" } ] })");
  const auto open = [this](const std::string& path)
  {
    this->Window->OpenPaths({ QString::fromStdString(path) });
    return this->Await([this] { return !this->Window->IsBusy(); }) &&
      this->Window->Scenes().IsOpen();
  };
  ASSERT_TRUE(open(scene)) << this->Window->Complaint().toStdString();
  EXPECT_EQ(this->Find<QTableWidget>("parts")->rowCount(), 1);
  auto* picture = this->Window->Scenes().findChild<ViewWidget*>("xray");
  QTest::mouseClick(picture, Qt::LeftButton, {}, picture->rect().center());
  EXPECT_THAT(this->Find<QLabel>("seen")->text().toStdString(), testing::HasSubstr("Al 20"));

  this->Find<QDoubleSpinBox>("sourceX")->setValue(50);
  this->Find<QDoubleSpinBox>("energy")->setValue(80);
  const QString saved = QString::fromStdString(this->Folder.File("moved.json"));
  const QString exported = QString::fromStdString(this->Folder.File("xray.tif"));
  this->Window->Scenes().SaveScene(saved);
  this->Window->Scenes().Expose(exported);
  ASSERT_TRUE(this->Await([this] { return !this->Window->IsBusy(); }));
  EXPECT_EQ(this->Window->Complaint().toStdString(), "");
  EXPECT_TRUE(std::filesystem::exists(exported.toStdString()));
  ASSERT_TRUE(open(saved.toStdString())) << this->Window->Complaint().toStdString();
  EXPECT_EQ(this->Find<QDoubleSpinBox>("sourceX")->value(), 50);
  EXPECT_EQ(this->Find<QDoubleSpinBox>("energy")->value(), 80);
}

TEST_F(Desktop, ChoosesTheXRaysOfAScene)
{
  SurfaceMesh box;
  shapes::AddBox(box, { -10, -10, -10 }, { 10, 10, 10 }, 1);
  WriteMesh(ToPolyData(box, {}), this->Folder.File("box.stl"));
  const QString scene = QString::fromStdString(this->Folder.Write("scene.json", R"({
    "source": { "position": [0, -500, 0] },
    "detector": { "origin": [-31, 100, 31], "column-direction": [1, 0, 0],
      "row-direction": [0, 0, -1], "columns": 64, "rows": 64, "pixel-spacing": 1 },
    "beam": { "kev": 60 },
    "samples": [ { "file": "box.stl", "unit": "mm", "material": "Al" } ] })"));
  this->Window->OpenPaths({ scene });
  ASSERT_TRUE(this->Await([this] { return !this->Window->IsBusy(); }));
  auto* xrays = this->Find<QComboBox>("xrays");
  auto* energy = this->Find<QDoubleSpinBox>("energy");
  auto* filters = this->Find<QLineEdit>("filters");
  const auto choose = [xrays](const char* kind)
  {
    xrays->setCurrentIndex(xrays->findData(kind));
    Q_EMIT xrays->activated(xrays->currentIndex());
  };
  EXPECT_EQ(xrays->currentData().toString(), "kev");
  choose("W");
  energy->setValue(120.5);
  const auto type = [filters](const char* text)
  {
    filters->setFocus();
    filters->clear();
    QTest::keyClicks(filters, text);
    QTest::keyClick(filters, Qt::Key_Return);
  };
  type("Al:2, Cu:0.1");
  EXPECT_EQ(this->Window->Complaint().toStdString(), "");
  // What a pixel sees is what the tube, computed apart, leaves behind 20 mm of aluminium.
  auto* picture = this->Window->Scenes().findChild<ViewWidget*>("xray");
  QTest::mouseClick(picture, Qt::LeftButton, {}, picture->rect().center());
  const Spectrum tube = TubeSpectrum({ "W", 120.5, { { "Al", 2 }, { "Cu", 0.1 } } });
  AttenuationTable aluminium;
  ASSERT_TRUE(FindComposition("Al", aluminium));
  const Beam beam(tube, DetectorResponse::EnergyIntegrating, { nullptr, &aluminium }, { 0, 0 });
  const double lengths[] = { 0, 20 };
  const std::string seen = this->Find<QLabel>("seen")->text().toStdString();
  const std::size_t at = seen.find("transmission ");
  ASSERT_NE(at, std::string::npos) << seen;
  // Rays through the middle are up to a tenth of a degree oblique.
  EXPECT_NEAR(std::stod(seen.substr(at + 13)), beam.Transmission(lengths), 1e-3);

  QTest::keyClick(this->Window.get(), Qt::Key_R);
  const QPoint middle = picture->rect().center();
  QTest::mousePress(picture, Qt::LeftButton, {}, middle);
  QTest::mouseMove(picture, middle + QPoint(40, 0));
  QTest::mouseRelease(picture, Qt::LeftButton, {}, middle + QPoint(40, 0));
  EXPECT_TRUE(this->Find<QWidget>("profile")->isVisible());
  this->Keep("xrays");

  const QString saved = QString::fromStdString(this->Folder.File("tube.json"));
  this->Window->Scenes().SaveScene(saved);
  type("Al:two");
  EXPECT_THAT(this->Window->Complaint().toStdString(), testing::HasSubstr("Al:two"));
  choose("Mo");
  EXPECT_EQ(energy->value(), 42);
  this->Window->OpenPaths({ saved });
  ASSERT_TRUE(this->Await([this] { return !this->Window->IsBusy(); }));
  EXPECT_EQ(this->Window->Complaint().toStdString(), "");
  EXPECT_EQ(xrays->currentData().toString(), "W");
  EXPECT_EQ(energy->value(), 120.5);
  EXPECT_EQ(filters->text().toStdString(), "Al:2 Cu:0.1");
}

TEST_F(Desktop, ShowsTheStepsOfASearch)
{
  SearchPictures::Pair pair;
  pair.Target = QImage(40, 60, QImage::Format_Grayscale8);
  pair.Target.fill(200);
  pair.Synthetic = pair.Target;
  pair.Synthetic.fill(90);
  pair.Outline << QPointF(5, 10) << QPointF(35, 10);
  SearchPictures shown;
  shown.resize(400, 200);
  shown.SetPairs({ pair, pair });
  const QImage drawn = shown.grab().toImage();
  const auto greyAt = [&](double across) // the middle of a picture, of four
  { return qGray(drawn.pixel(static_cast<int>(across * drawn.width()), drawn.height() * 2 / 3)); };
  for (const double left : { 0.0, 0.5 })
  {
    EXPECT_EQ(greyAt(left + 0.125), 200);
    EXPECT_EQ(greyAt(left + 0.375), 90);
  }
  int orange = 0;
  for (int row = 0; row < drawn.height(); ++row)
  {
    const QColor color = drawn.pixelColor(drawn.width() / 8, row);
    orange += color.red() > color.blue() + 100 ? 1 : 0;
  }
  EXPECT_GE(orange, 1);
  EXPECT_LE(orange, 3);
}

TEST_F(Desktop, SaysWhatIsWrongInALine)
{
  const auto complaint = [this](const std::string& path)
  {
    this->Window->OpenPaths({ QString::fromStdString(path) });
    EXPECT_TRUE(this->Await([this] { return !this->Window->IsBusy(); }));
    const std::string told = this->Window->Complaint().toStdString();
    EXPECT_EQ(told.find('\n'), std::string::npos) << told;
    return told;
  };
  EXPECT_THAT(complaint(this->Folder.File("absent")), testing::HasSubstr("no such file"));
  EXPECT_THAT(complaint(this->Folder.Write("bad.json", "{")), testing::HasSubstr("bad.json"));
  std::filesystem::create_directory(this->Folder.File("empty"));
  EXPECT_THAT(complaint(this->Folder.File("empty")), testing::HasSubstr("found no file in it"));
  EXPECT_THAT(complaint(this->Folder.Write("picture.dcm", "x")), testing::HasSubstr("result"));
  std::filesystem::create_directory(this->Folder.File("broken"));
  this->Folder.Write("broken/result.json", "{}");
  EXPECT_THAT(complaint(this->Folder.File("broken")), testing::HasSubstr("result.json"));
  EXPECT_FALSE(this->Window->Result().IsOpen());
}

TEST_F(Desktop, AsksAnArchiveWhetherItAnswers)
{
  std::string said;
  QTimer::singleShot(0,
    [&]
    {
      auto* dialog = QApplication::activeModalWidget();
      ASSERT_NE(dialog, nullptr);
      dialog->findChild<QLineEdit*>("archive")->setText("127.0.0.1:1");
      QTest::mouseClick(dialog->findChild<QPushButton*>("askArchive"), Qt::LeftButton);
      auto* answer = dialog->findChild<QLabel*>("archiveAnswer");
      EXPECT_TRUE(this->Await([answer] { return answer->text().contains("127.0.0.1:1"); }));
      said = answer->text().toStdString();
      this->Keep("archive");
      QTest::keyClick(dialog, Qt::Key_Escape);
    });
  auto* send = this->Find<QAction>("send");
  send->setEnabled(true);
  send->trigger();
  EXPECT_THAT(said, testing::HasSubstr("found none"));
}

TEST_F(Desktop, RemembersFoldersAndNoPatient)
{
  this->OpenResult();
  this->Window->OpenPaths({ QString::fromStdString(this->ResultFolder) }); // without its table
  ASSERT_TRUE(this->Await([this] { return !this->Window->IsBusy(); }));
  this->Window->close();
  this->Start();
  const QSettings settings;
  EXPECT_EQ(settings.value("recent").toStringList().front().toStdString(), this->ResultFolder);
  EXPECT_EQ(this->Window->windowTitle(), "MammoRay");
}

/// From a study to marks in its result; some minutes.
TEST_F(Desktop, DoesTheWholeJob)
{
  const char* const study = std::getenv("MAMMORAY_STUDY");
  if (!std::getenv("MAMMORAY_LONG_TESTS") || !study)
  {
    GTEST_SKIP() << "MAMMORAY_LONG_TESTS, and MAMMORAY_STUDY: the export of a virtual study";
  }
  constexpr int LongMs = 3600000;
  const auto wait = [this]
  {
    return QTest::qWaitFor([this] { return !this->Window->IsBusy(); }, LongMs) &&
      this->Window->Complaint().isEmpty();
  };
  this->Window->OpenPaths({ QString(study) });
  ASSERT_TRUE(wait()) << this->Window->Complaint().toStdString();
  QTest::mouseClick(this->Find<QPushButton>("toTissue"), Qt::LeftButton);
  EXPECT_EQ(this->Window->ShownPage(), MainWindow::TissuePage);
  ASSERT_TRUE(wait()) << this->Window->Complaint().toStdString();
  EXPECT_THAT(this->Find<QLabel>("tissueText")->text().toStdString(), testing::HasSubstr("cm3"));
  this->Keep("tissue");
  QTest::mouseClick(this->Find<QPushButton>("toRun"), Qt::LeftButton);
  this->Find<QComboBox>("thoroughness")->setCurrentIndex(1);
  this->ResultFolder = this->Folder.File("whole-result");
  this->Find<QLineEdit>("output")->setText(QString::fromStdString(this->ResultFolder));
  QTest::mouseClick(this->Find<QPushButton>("start"), Qt::LeftButton);

  // No event waits while the search runs.
  QElapsedTimer since;
  since.start();
  qint64 longest = 0;
  QTimer ticks;
  QObject::connect(&ticks, &QTimer::timeout,
    [&]
    {
      longest = std::max(longest, since.restart());
      if (!this->Find<QPushButton>("cancel")->isEnabled())
      {
        ticks.stop();
      }
    });
  ticks.start(10);
  const auto* pictures = static_cast<SearchPictures*>(this->Find<QWidget>("searchPictures"));
  const auto hasStep = [&] { return !pictures->Pairs().empty() || !this->Window->IsBusy(); };
  ASSERT_TRUE(QTest::qWaitFor(hasStep, LongMs));
  this->Keep("running");
  ASSERT_TRUE(wait()) << this->Window->Complaint().toStdString();
  EXPECT_EQ(pictures->Pairs().size(), 2U);
  RecordProperty("LongestWaitMs", static_cast<int>(longest));
  std::printf("an event waited %d ms at most\n", static_cast<int>(longest));
  this->Keep("result");
  ASSERT_TRUE(this->Window->Result().IsOpen());
  EXPECT_EQ(this->Window->ShownPage(), MainWindow::ResultsPage);
  this->ClickMiddle("mammogram1");
  EXPECT_THAT(this->Where(), testing::HasSubstr("LPS"));
  this->Window->Result().AddPlace();
  this->Window->ExportDisplacement(QString::fromStdString(this->Folder.File("field.nrrd")));
  ASSERT_TRUE(wait()) << this->Window->Complaint().toStdString();
  this->Window->ExportDicom(QString::fromStdString(this->Folder.File("objects")));
  ASSERT_TRUE(wait()) << this->Window->Complaint().toStdString();
  EXPECT_TRUE(std::filesystem::exists(this->Folder.File("field.nrrd")));
  EXPECT_TRUE(std::filesystem::exists(this->Folder.File("objects/cc/report.dcm")));
  this->Start();
  this->Window->OpenPaths({ QString::fromStdString(this->ResultFolder) });
  ASSERT_TRUE(wait()) << this->Window->Complaint().toStdString();
  EXPECT_EQ(this->Find<QListWidget>("places")->count(), 1);
}
}
