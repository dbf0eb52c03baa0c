// SPDX-License-Identifier: Apache-2.0
#include "Private/Desktop/MainWindow.h"

#include "mammoray/Dicom/DicomNetwork.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/Study/CompressedVolume.h"
#include "mammoray/Study/RegisteredMammogram.h"
#include "mammoray/Study/ResultObjects.h"

#include <QAction>
#include <QApplication>
#include <QCheckBox>
#include <QClipboard>
#include <QCloseEvent>
#include <QDesktopServices>
#include <QDialog>
#include <QDialogButtonBox>
#include <QDir>
#include <QDragEnterEvent>
#include <QDropEvent>
#include <QFileDialog>
#include <QFileInfo>
#include <QFormLayout>
#include <QFrame>
#include <QHBoxLayout>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QMenuBar>
#include <QMessageBox>
#include <QMimeData>
#include <QPointer>
#include <QPushButton>
#include <QSettings>
#include <QSpinBox>
#include <QStackedWidget>
#include <QStatusBar>
#include <QStyle>
#include <QStyleFactory>
#include <QToolBar>
#include <QToolButton>
#include <QUrl>
#include <QVBoxLayout>

#include <algorithm>
#include <utility>

namespace mammoray
{
namespace
{
constexpr int MostRecent = 8;
constexpr int TellMs = 8000;

QPalette DarkPalette()
{
  QPalette palette;
  const QColor window(45, 47, 51);
  const QColor base(30, 31, 34);
  const QColor text(224, 226, 230);
  const QColor faint(128, 131, 137);
  for (const auto& [role, color] :
    { std::pair{ QPalette::Window, window }, { QPalette::WindowText, text },
      { QPalette::Base, base }, { QPalette::AlternateBase, QColor(38, 40, 43) },
      { QPalette::Text, text }, { QPalette::Button, QColor(56, 58, 63) },
      { QPalette::ButtonText, text }, { QPalette::ToolTipBase, base },
      { QPalette::ToolTipText, text }, { QPalette::BrightText, Qt::red },
      { QPalette::Link, QColor(110, 170, 250) }, { QPalette::Highlight, QColor(60, 120, 200) },
      { QPalette::HighlightedText, QColor(255, 255, 255) }, { QPalette::PlaceholderText, faint } })
  {
    palette.setColor(role, color);
  }
  for (const QPalette::ColorRole role :
    { QPalette::WindowText, QPalette::Text, QPalette::ButtonText })
  {
    palette.setColor(QPalette::Disabled, role, faint);
  }
  return palette;
}

DicomNode NodeOf(const std::string& address, const std::string& title)
{
  DicomNode node;
  SetAddress(node, address);
  node.CalledTitle = title;
  return node;
}

bool IsResult(const QString& path)
{
  return QFileInfo(path).isDir() && QFileInfo::exists(QDir(path).filePath("result.json"));
}
}

MainWindow::MainWindow(const ProjectorOptions& projector)
{
  this->setObjectName("mammoray");
  this->setWindowTitle("MammoRay");
  this->setWindowIcon(QIcon::fromTheme("mammoray"));
  this->setAcceptDrops(true);
  this->Results = new ResultPage(projector);
  this->SceneView = new ScenePage(projector);
  this->Studies = std::make_unique<StudyPages>(projector);
  this->MakePages();
  this->MakeMenus();
  this->MakeToolBar();
  this->statusBar();
  this->Exporting.Failed = [this](const QString& complaint) { this->Complain(complaint); };
  this->Exporting.Progressed = [this](double fraction, const QString& stage)
  { this->statusBar()->showMessage(tr("%1: %2 %").arg(stage).arg(100 * fraction, 0, 'f', 0)); };
  this->RestoreSettings();
  this->UpdateActions();
}

MainWindow::~MainWindow() = default;

void MainWindow::MakePages()
{
  auto* central = new QWidget;
  auto* layout = new QVBoxLayout(central);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  this->MakeErrorBar();
  layout->addWidget(this->ErrorBar);
  this->Pages = new QStackedWidget;
  for (QWidget* page : std::initializer_list<QWidget*>{ this->Studies->StudyPage(),
         this->Studies->TissuePage(), this->Studies->RunPage(), this->Results, this->SceneView })
  {
    this->Pages->addWidget(page);
  }
  layout->addWidget(this->Pages, 1);
  this->setCentralWidget(central);

  const auto complain = [this](const QString& line) { this->Complain(line); };
  const auto tell = [this](const QString& line) { this->statusBar()->showMessage(line, TellMs); };
  const auto changed = [this] { this->UpdateActions(); };
  this->Results->Complain = this->SceneView->Complain = this->Studies->Complain = complain;
  this->Results->Tell = this->SceneView->Tell = this->Studies->Tell = tell;
  this->Results->Changed = this->SceneView->Changed = changed;
  this->Results->ToolChanged = [this](ViewTool tool)
  {
    this->SceneView->SetTool(tool);
    this->Studies->SetTool(tool);
  };
  this->Results->FitWanted = [this]
  {
    this->SceneView->ResetViews();
    this->Studies->ResetViews();
  };
  this->Results->GreyWanted = [this] { this->SceneView->ResetGrey(); };
  this->Results->MammogramsWanted = [this]
  { this->findChild<QAction*>("showMammograms")->trigger(); };
  this->Studies->Show = [this](int page) { this->ShowPage(static_cast<Page>(page)); };
  this->Studies->Finished =
    [this](const QString& folder, const std::vector<std::string>& mammograms)
  { this->OpenResult(folder, mammograms); };
}

void MainWindow::MakeErrorBar()
{
  this->ErrorBar = new QFrame;
  this->ErrorBar->setObjectName("errorBar");
  this->ErrorBar->setStyleSheet(
    "#errorBar { background: #b3261e } #errorBar QLabel { color: white }");
  auto* row = new QHBoxLayout(this->ErrorBar);
  this->ErrorText = new QLabel;
  this->ErrorText->setObjectName("errorText");
  this->ErrorText->setWordWrap(true);
  this->ErrorText->setTextInteractionFlags(
    Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
  row->addWidget(this->ErrorText, 1);
  auto* copy = new QToolButton;
  copy->setText(tr("Copy"));
  connect(copy, &QToolButton::clicked, this,
    [this]
    {
      QApplication::clipboard()->setText(
        QString("%1 %2, Qt %3, %4: %5")
          .arg(QApplication::applicationDisplayName(), QApplication::applicationVersion(),
            qVersion(), QSysInfo::prettyProductName(), this->ErrorText->text()));
    });
  auto* close = new QToolButton;
  close->setObjectName("closeError");
  close->setText(tr("Close"));
  connect(close, &QToolButton::clicked, this->ErrorBar, &QWidget::hide);
  row->addWidget(copy);
  row->addWidget(close);
  this->ErrorBar->hide();
}

void MainWindow::Complain(const QString& line)
{
  this->ErrorText->setText(line);
  this->ErrorBar->show();
}

QString MainWindow::Complaint() const
{
  return this->ErrorBar->isHidden() ? QString() : this->ErrorText->text();
}

QAction* MainWindow::Add(QMenu* menu, const char* name, const QString& text,
  const QKeySequence& keys, std::function<void()> run)
{
  auto* action = new QAction(text, this);
  action->setObjectName(name);
  action->setShortcut(keys);
  connect(action, &QAction::triggered, this, std::move(run));
  menu->addAction(action);
  return action;
}

void MainWindow::MakeMenus()
{
  this->MakeFileMenu();
  QMenu* edit = this->menuBar()->addMenu(tr("&Edit"));
  QAction* undo = this->Results->UndoStack()->createUndoAction(this, tr("&Undo"));
  undo->setShortcut(QKeySequence::Undo);
  QAction* redo = this->Results->UndoStack()->createRedoAction(this, tr("&Redo"));
  redo->setShortcut(QKeySequence::Redo);
  edit->addActions({ undo, redo });
  edit->addSeparator();
  edit->addActions(this->Results->MarkActions());
  edit->addSeparator();
  edit->addActions(this->Results->ToolActions());
  this->NeedResult << this->Results->MarkActions();
  this->MakeViewMenu();
  this->MakeHelpMenu();
}

void MainWindow::MakeFileMenu()
{
  QMenu* file = this->menuBar()->addMenu(tr("&File"));
  const auto folder = [this](const QString& title) {
    return QFileDialog::getExistingDirectory(this, title, QSettings().value("folder").toString());
  };
  this->Add(file, "openResult", tr("&Open a result..."), QKeySequence::Open,
    [this, folder] { this->OpenPaths({ folder(tr("A result's folder")) }); });
  this->Add(file, "openStudy", tr("Open a &study..."), QKeySequence("Ctrl+Shift+O"),
    [this, folder] { this->OpenPaths({ folder(tr("A clinic's export")) }); });
  this->Add(file, "openScene", tr("Open a s&cene..."), QKeySequence("Ctrl+Alt+O"),
    [this]
    {
      this->OpenPaths({ QFileDialog::getOpenFileName(this, tr("A scene"),
        QSettings().value("folder").toString(), tr("Scenes (*.json)")) });
    });
  this->Recent = file->addMenu(tr("Open &recent"));
  file->addSeparator();
  this->NeedResult << this->Add(file, "showMammograms", tr("Show the &mammograms of the result..."),
    QKeySequence("Ctrl+M"),
    [this]
    {
      this->OpenPaths(QFileDialog::getOpenFileNames(this, tr("The mammograms that were registered"),
        QSettings().value("folder").toString()));
    });
  this->MakeExportMenu(file->addMenu(tr("&Export")));
  file->addSeparator();
  this->Add(file, "quit", tr("&Quit"), QKeySequence::Quit, [this] { this->close(); });
}

void MainWindow::MakeExportMenu(QMenu* menu)
{
  this->NeedResult << this->Add(menu, "openReport", tr("Open the &report"), QKeySequence("Ctrl+R"),
    [this]
    {
      const QString folder = QString::fromStdString(this->Results->Opened()->Input.Result);
      QDesktopServices::openUrl(QUrl::fromLocalFile(QDir(folder).filePath("report.html")));
    });
  this->NeedResult << this->Add(menu, "exportDisplacement", tr("&Displacement field..."), {},
    [this]
    {
      this->AskSave(tr("The displacement field"), tr("Fields and transforms (*.nrrd *.mha *.h5)"),
        [this](const QString& path) { this->ExportDisplacement(path); });
    });
  this->NeedResult << this->Add(menu, "exportDicom", tr("DICOM &objects..."), {},
    [this]
    {
      if (QMessageBox::question(this, tr("DICOM objects"),
            tr("The objects refer to the mammogram and name its patient and study. Go on?")) ==
        QMessageBox::Yes)
      {
        this->AskSave(tr("A new folder"), {},
          [this](const QString& folder) { this->ExportDicom(folder); });
      }
    });
  this->NeedResult << this->Add(menu, "send", tr("&Send DICOM objects..."), {},
    [this] { this->AskSend(); });
  this->Add(menu, "exportCase", tr("&Case file for the command line..."), {},
    [this]
    {
      this->AskSave(tr("The case file"), tr("Case files (*.json)"),
        [this](const QString& path) { this->WriteCaseFile(path); });
    });
  this->Add(menu, "exportScreenshot", tr("Scr&eenshot..."), QKeySequence("Ctrl+P"),
    [this]
    {
      this->AskSave(tr("The window's picture"), tr("Pictures (*.png)"),
        [this](const QString& path) { this->WriteScreenshot(path, this->size()); });
    });
  menu->addSeparator();
  this->NeedScene << this->Add(menu, "exportXray", tr("&X-ray of the scene..."),
    QKeySequence("Ctrl+E"),
    [this]
    {
      this->AskSave(tr("The X-ray"), tr("Pictures and volumes (*.tif *.png *.mha *.nrrd *.vti)"),
        [this](const QString& path) { this->SceneView->Expose(path); });
    });
  this->NeedScene << this->Add(menu, "exportScene", tr("Scene &file..."), QKeySequence::SaveAs,
    [this]
    {
      this->AskSave(tr("The scene as it stands"), tr("Scenes (*.json)"),
        [this](const QString& path) { this->SceneView->SaveScene(path); });
    });
}

void MainWindow::MakeViewMenu()
{
  QMenu* view = this->menuBar()->addMenu(tr("&View"));
  this->PageActions = new QActionGroup(this);
  const std::array<std::pair<const char*, QString>, 5> pages{ { { "pageStudy", tr("&Study") },
    { "pageTissue", tr("&Tissue") }, { "pageRun", tr("R&un") }, { "pageResult", tr("&Result") },
    { "pageScene", tr("&X-ray a scene") } } };
  for (std::size_t page = 0; page < pages.size(); ++page)
  {
    QAction* action = this->Add(view, pages[page].first, pages[page].second,
      QKeySequence(QString("Ctrl+%1").arg(page + 1)),
      [this, page] { this->ShowPage(static_cast<Page>(page)); });
    action->setCheckable(true);
    this->PageActions->addAction(action);
  }
  view->addSeparator();
  view->addActions(this->Results->ViewActions());
  this->NeedResult << this->Results->ViewActions().mid(2); // the first two serve all pages
  view->addSeparator();
  this->ThemeActions = new QActionGroup(this);
  for (const auto& [name, text] : { std::pair{ "light", tr("&Light") }, { "dark", tr("&Dark") } })
  {
    QAction* action =
      this->Add(view, name, text, {}, [this, name = QString(name)] { this->SetTheme(name); });
    action->setCheckable(true);
    this->ThemeActions->addAction(action);
  }
  view->addSeparator();
  QAction* full = this->Add(view, "fullScreen", tr("&Full screen"), QKeySequence::FullScreen,
    [this] { this->setWindowState(this->windowState() ^ Qt::WindowFullScreen); });
  full->setCheckable(true);
}

void MainWindow::MakeHelpMenu()
{
  QMenu* help = this->menuBar()->addMenu(tr("&Help"));
  this->Add(help, "shortcuts", tr("&Keys and mouse"), QKeySequence::HelpContents,
    [this]
    {
      QString text =
        tr("<p>Click a view to mark a place in all of them. Turn the wheel to go through "
           "slices; with Ctrl it zooms. Drag the right button to zoom, the middle one to move, "
           "with Shift to measure. Double-click a view to see it alone.</p><table>");
      for (const QAction* action : this->findChildren<QAction*>())
      {
        if (!action->shortcut().isEmpty())
        {
          text += QString("<tr><td>%1&nbsp;&nbsp;</td><td>%2</td></tr>")
                    .arg(action->shortcut().toString(QKeySequence::NativeText),
                      QString(action->text()).remove('&'));
        }
      }
      QMessageBox::information(this, tr("Keys and mouse"), text + "</table>");
    });
  this->Add(help, "about", tr("&About MammoRay"), {},
    [this]
    {
      QMessageBox::about(this, tr("About MammoRay"),
        tr("MammoRay %1\n\nSynthetic X-rays of meshes, and registration of breast MRI with "
           "mammograms.\nFor research; not a medical device.")
          .arg(QApplication::applicationVersion()));
    });
}

void MainWindow::MakeToolBar()
{
  QToolBar* bar = this->addToolBar(tr("Pages"));
  bar->setObjectName("pagesBar");
  bar->setMovable(false);
  bar->setToolButtonStyle(Qt::ToolButtonTextOnly);
  bar->addActions(this->PageActions->actions());
  bar->addSeparator();
  bar->addActions(this->Results->ToolActions());
  bar->addSeparator();
  bar->addActions(this->Results->ViewActions());
}

void MainWindow::ShowPage(Page page)
{
  this->Pages->setCurrentIndex(page);
  this->PageActions->actions()[page]->setChecked(true);
}

MainWindow::Page MainWindow::ShownPage() const
{
  return static_cast<Page>(this->Pages->currentIndex());
}

void MainWindow::UpdateActions()
{
  for (QAction* action : this->NeedResult)
  {
    action->setEnabled(this->Results->IsOpen());
  }
  for (QAction* action : this->NeedScene)
  {
    action->setEnabled(this->SceneView->IsOpen());
  }
}

void MainWindow::SetTheme(const QString& theme)
{
  const bool dark = theme == "dark";
  QApplication::setStyle(QStyleFactory::create("Fusion"));
  QApplication::setPalette(dark ? DarkPalette() : QApplication::style()->standardPalette());
  // Fusion draws an empty box of a dark table almost as dark as the table.
  qApp->setStyleSheet(
    "QAbstractItemView::indicator { width: 0.9em; height: 0.9em; border: 1px solid "
    "gray; border-radius: 2px }"
    "QAbstractItemView::indicator:checked { background: palette(highlight); "
    "border-color: palette(highlight) }");
  QSettings().setValue("theme", dark ? "dark" : "light");
  this->ThemeActions->actions()[dark ? 1 : 0]->setChecked(true);
}

void MainWindow::RestoreSettings()
{
  const QSettings settings;
  this->resize(1500, 940);
  this->restoreGeometry(settings.value("geometry").toByteArray());
  this->restoreState(settings.value("state").toByteArray());
  this->SetTheme(settings.value("theme", "dark").toString());
  this->ListRecent();
  this->ShowPage(ResultsPage);
}

void MainWindow::Remember(const QString& path)
{
  QSettings settings;
  QStringList recent = settings.value("recent").toStringList();
  const QString absolute = QDir(path).absolutePath();
  recent.removeAll(absolute);
  recent.prepend(absolute);
  settings.setValue("recent", QStringList(recent.mid(0, MostRecent)));
  settings.setValue("folder", QFileInfo(absolute).path());
  this->ListRecent();
}

void MainWindow::ListRecent()
{
  this->Recent->clear();
  for (const QString& path : QSettings().value("recent").toStringList())
  {
    QAction* action = this->Recent->addAction(path);
    connect(action, &QAction::triggered, this, [this, path] { this->OpenPaths({ path }); });
  }
  this->Recent->setEnabled(!this->Recent->isEmpty());
}

void MainWindow::OpenPaths(const QStringList& paths)
{
  if (paths.isEmpty() || paths.front().isEmpty())
  {
    return;
  }
  this->ErrorBar->hide();
  const QString& path = paths.front();
  const QFileInfo info(path);
  if (!info.exists())
  {
    this->Complain(tr("%1: no such file or folder").arg(path));
  }
  else if (IsResult(path))
  {
    this->OpenResult(path);
  }
  else if (info.isDir())
  {
    this->Remember(path);
    this->Studies->Open(path);
  }
  else if (path.endsWith(".json", Qt::CaseInsensitive))
  {
    this->Remember(path);
    this->ShowPage(ScenesPage);
    this->SceneView->Open(path);
  }
  else
  {
    std::vector<std::string> files;
    for (const QString& file : paths)
    {
      files.push_back(file.toStdString());
    }
    this->ShowPage(ResultsPage);
    this->Results->ShowMammograms(files);
  }
}

void MainWindow::OpenResult(const QString& folder, const std::vector<std::string>& mammograms)
{
  this->Remember(folder);
  ViewInput input;
  input.Result = folder.toStdString();
  input.Mammograms = mammograms;
  this->ShowPage(ResultsPage);
  this->Results->Open(input);
}

void MainWindow::AskSave(const QString& title, const QString& filter,
  const std::function<void(const QString&)>& save)
{
  const QString path =
    QFileDialog::getSaveFileName(this, title, QSettings().value("folder").toString(), filter);
  if (!path.isEmpty())
  {
    save(path);
  }
}

void MainWindow::WriteScreenshot(const QString& path, const QSize& size)
{
  const QSize before = this->size();
  this->resize(size);
  QApplication::processEvents();
  const QPixmap picture = this->grab();
  this->resize(before);
  if (!picture.save(path))
  {
    this->Complain(tr("%1: cannot be written").arg(path));
    return;
  }
  this->statusBar()->showMessage(tr("wrote %1").arg(path), TellMs);
}

void MainWindow::ExportDisplacement(const QString& path)
{
  this->Exporting.Start(
    [this, path, folder = this->Results->Opened()->Input.Result](
      const ProgressCallback& progress) -> Task::Outcome
    {
      CheckDisplacementExtension(path.toStdString());
      constexpr double SpacingMm = 2;
      constexpr double MarginMm = 10;
      const ResultFile result = ReadResultFiles(folder).front();
      const RegisteredBreast breast(ReadBreastInUnit(result));
      WriteDisplacement(FindDisplacement(breast, DisplacementDirection::CompressedToVolume,
                          SpacingMm, MarginMm, progress),
        path.toStdString());
      return [this, path] { this->statusBar()->showMessage(tr("wrote %1").arg(path), TellMs); };
    });
}

/// One folder for each mammogram that is shown.
void MainWindow::ExportDicom(const QString& folder)
{
  const ViewInput input = this->Results->Opened()->Input;
  if (input.Mammograms.empty())
  {
    this->Complain(
      tr("expected the mammograms of the result, to which DICOM objects refer; show them "
         "first"));
    return;
  }
  this->Exporting.Start(
    [this, folder, input, points = this->Results->PlacesToExport()](
      const ProgressCallback& progress) -> Task::Outcome
    {
      ReserveEmptyFolder(folder.toStdString());
      const std::vector<ResultFile> results = ReadResultFiles(input.Result);
      WriteAtomicFolder(folder.toStdString(),
        [&](const std::string& staged)
        {
          for (const ResultFile& result : results)
          {
            const auto mammogram = std::find_if(input.Mammograms.begin(), input.Mammograms.end(),
              [&](const std::string& file)
              { return input.Mammograms.size() == 1 || IsRegisteredMammogram(result, file); });
            if (mammogram == input.Mammograms.end())
            {
              continue;
            }
            std::string place = staged;
            if (results.size() > 1)
            {
              place += '/';
              place += QFileInfo(QString::fromStdString(result.Folder)).fileName().toStdString();
              QDir().mkpath(QString::fromStdString(place));
            }
            ResultObjects objects;
            objects.Mammogram = *mammogram;
            objects.Points = points;
            const RegisteredBreast breast(ReadBreastInUnit(result));
            WriteResultObjects(result, breast, objects, {}, place, progress);
          }
        });
      return [this, folder] { this->statusBar()->showMessage(tr("wrote %1").arg(folder), TellMs); };
    });
}

/// A button, and what the archive answers.
QWidget* MainWindow::NewConnectionTest(const QLineEdit* address, const QLineEdit* title)
{
  constexpr int PatienceSeconds = 5;
  auto* widget = new QWidget;
  auto* column = new QVBoxLayout(widget);
  auto* ask = new QPushButton(tr("T&est the connection"));
  ask->setObjectName("askArchive");
  ask->setAutoDefault(false);
  auto* answer = new QLabel;
  answer->setObjectName("archiveAnswer");
  answer->setWordWrap(true);
  answer->setTextInteractionFlags(Qt::TextSelectableByMouse);
  answer->setMinimumHeight(3 * answer->fontMetrics().height());
  column->addWidget(ask, 0, Qt::AlignLeft);
  column->addWidget(answer, 1);
  // The dialog may be closed before the answer.
  const auto tell = [ask = QPointer<QPushButton>(ask),
                      answer = QPointer<QLabel>(answer)](const QString& text, bool done)
  {
    if (answer)
    {
      ask->setEnabled(done);
      answer->setText(text);
    }
  };
  connect(ask, &QPushButton::clicked, this,
    [this, tell, address, title]
    {
      tell(tr("asking..."), false);
      this->Asking.Failed = [tell](const QString& complaint) { tell(complaint, true); };
      this->Asking.Start(
        [tell, to = address->text().toStdString(), called = title->text().toStdString()](
          const ProgressCallback&) -> Task::Outcome
        {
          DicomNode node = NodeOf(to, called);
          node.TimeoutSeconds = PatienceSeconds;
          VerifyNode(node);
          return [tell] { tell(tr("The archive answers."), true); };
        });
    });
  return widget;
}

void MainWindow::AskSend()
{
  QDialog dialog(this);
  dialog.setWindowTitle(tr("Send DICOM objects"));
  dialog.setMinimumWidth(480);
  auto* form = new QFormLayout(&dialog);
  auto* folder = new QLineEdit;
  folder->setObjectName("objects");
  auto* address = new QLineEdit(QSettings().value("archive").toString());
  address->setObjectName("archive");
  address->setPlaceholderText("pacs.example.org:104");
  auto* called = new QLineEdit(QSettings().value("archiveTitle", "ANY-SCP").toString());
  form->addRow(tr("&Folder of objects"), folder);
  form->addRow(tr("&Archive"), address);
  form->addRow(tr("Its &title"), called);
  form->addRow(QString(), this->NewConnectionTest(address, called));
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel);
  form->addRow(buttons);
  connect(buttons, &QDialogButtonBox::accepted, &dialog, &QDialog::accept);
  connect(buttons, &QDialogButtonBox::rejected, &dialog, &QDialog::reject);
  if (dialog.exec() != QDialog::Accepted)
  {
    return;
  }
  QSettings().setValue("archive", address->text());
  QSettings().setValue("archiveTitle", called->text());
  this->Exporting.Start(
    [this, from = folder->text().toStdString(), to = address->text().toStdString(),
      title = called->text().toStdString()](const ProgressCallback& progress) -> Task::Outcome
    {
      const DicomNode node = NodeOf(to, title);
      const std::vector<std::string> files = FindDicomFiles({ from });
      std::size_t stored = 0;
      const auto told = [&stored](const std::string&, const std::string& refusal)
      { stored += refusal.empty() ? 1 : 0; };
      StoreFiles(files, node, told,
        [&]
        {
          return progress &&
            !progress(static_cast<double>(stored) / static_cast<double>(files.size()), "send");
        });
      return [this, stored]
      { this->statusBar()->showMessage(tr("stored all %1 objects").arg(stored), TellMs); };
    });
}

void MainWindow::WriteCaseFile(const QString& path)
{
  try
  {
    WriteAtomicFile(path.toStdString(), this->Studies->CaseText().toStdString());
    this->statusBar()->showMessage(tr("wrote %1").arg(path), TellMs);
  }
  catch (const Error& error)
  {
    this->Complain(error.what());
  }
}

bool MainWindow::IsBusy() const
{
  return this->Results->IsBusy() || this->SceneView->IsBusy() || this->Studies->IsBusy() ||
    this->Exporting.Runs();
}

void MainWindow::closeEvent(QCloseEvent* event)
{
  if (this->Studies->IsBusy() &&
    QMessageBox::question(this, tr("A search is running"),
      tr(
        "End it? Its last step is kept, and a later run for the same folder can go on from it.")) !=
      QMessageBox::Yes)
  {
    event->ignore();
    return;
  }
  QSettings settings;
  settings.setValue("geometry", this->saveGeometry());
  settings.setValue("state", this->saveState());
  event->accept();
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event)
{
  if (event->mimeData()->hasUrls())
  {
    event->acceptProposedAction();
  }
}

void MainWindow::dropEvent(QDropEvent* event)
{
  QStringList paths;
  for (const QUrl& url : event->mimeData()->urls())
  {
    paths << url.toLocalFile();
  }
  this->OpenPaths(paths);
}
}
