// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MainWindow_h
#define mammoray_MainWindow_h

#include "Private/Desktop/ResultPage.h"
#include "Private/Desktop/ScenePage.h"
#include "Private/Desktop/StudyPage.h"

#include <QActionGroup>
#include <QCoreApplication>
#include <QMainWindow>

class QFrame;
class QLabel;
class QLineEdit;
class QMenu;
class QStackedWidget;

namespace mammoray
{
/// The application's window: pages, menus, and a line for what went wrong.
class MainWindow : public QMainWindow
{
  Q_DECLARE_TR_FUNCTIONS(MainWindow)
public:
  enum Page
  {
    StudyPage,
    TissuePage,
    RunPage,
    ResultsPage,
    ScenesPage
  };
  explicit MainWindow(const ProjectorOptions& projector);
  ~MainWindow() override;

  /// A folder of a result or a study, a scene file, or mammograms of the result that is open.
  void OpenPaths(const QStringList& paths);
  void OpenResult(const QString& folder, const std::vector<std::string>& mammograms = {});
  void ShowPage(Page page);
  Page ShownPage() const;
  ResultPage& Result() { return *this->Results; }
  StudyPages& Study() { return *this->Studies; }
  ScenePage& Scenes() { return *this->SceneView; }
  void Complain(const QString& line);
  QString Complaint() const;
  bool IsBusy() const;
  void WriteScreenshot(const QString& path, const QSize& size);
  void ExportDisplacement(const QString& path);
  void ExportDicom(const QString& folder);
  void WriteCaseFile(const QString& path);

protected:
  void closeEvent(QCloseEvent* event) override;
  void dragEnterEvent(QDragEnterEvent* event) override;
  void dropEvent(QDropEvent* event) override;

private:
  QAction* Add(QMenu* menu, const char* name, const QString& text, const QKeySequence& keys,
    std::function<void()> run);
  void MakePages();
  void MakeErrorBar();
  void MakeMenus();
  void MakeFileMenu();
  void MakeExportMenu(QMenu* menu);
  void MakeViewMenu();
  void MakeHelpMenu();
  void MakeToolBar();
  void SetTheme(const QString& theme);
  void Remember(const QString& path);
  void ListRecent();
  void AskSend();
  QWidget* NewConnectionTest(const QLineEdit* address, const QLineEdit* title);
  /// Asks for a file or folder, and calls `save` with its path if there is one.
  void AskSave(const QString& title, const QString& filter,
    const std::function<void(const QString&)>& save);
  void UpdateActions();
  void RestoreSettings();

  ResultPage* Results = nullptr;
  ScenePage* SceneView = nullptr;
  std::unique_ptr<StudyPages> Studies;
  QStackedWidget* Pages = nullptr;
  QActionGroup* PageActions = nullptr;
  QActionGroup* ThemeActions = nullptr;
  QList<QAction*> NeedResult;
  QList<QAction*> NeedScene;
  QMenu* Recent = nullptr;
  QFrame* ErrorBar = nullptr;
  QLabel* ErrorText = nullptr;
  Task Exporting{ this };
  Task Asking{ this };
};
}

#endif
