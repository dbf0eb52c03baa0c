// SPDX-License-Identifier: Apache-2.0
#include "mammoray/App/Desktop.h"

#include "Private/Desktop/MainWindow.h"
#include "Private/Desktop/Unattended.h"
#include "Private/RequireDisplay.h"
#include "mammoray/Foundation/Error.h"

#include <QApplication>
#include <QCommandLineParser>
#include <QSurfaceFormat>

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>

namespace mammoray
{
namespace
{
void SetUpQt()
{
  // VTK 9.1 draws through GLX.
  if (qEnvironmentVariableIsEmpty("QT_QPA_PLATFORM"))
  {
    qputenv("QT_QPA_PLATFORM", "xcb");
  }
#if QT_VERSION < QT_VERSION_CHECK(6, 0, 0)
  QCoreApplication::setAttribute(Qt::AA_EnableHighDpiScaling);
  QCoreApplication::setAttribute(Qt::AA_UseHighDpiPixmaps);
#endif
  QGuiApplication::setHighDpiScaleFactorRoundingPolicy(
    Qt::HighDpiScaleFactorRoundingPolicy::PassThrough);
  QSurfaceFormat format = QVTKOpenGLNativeWidget::defaultFormat();
  format.setSamples(0);
  QSurfaceFormat::setDefaultFormat(format);
  QCoreApplication::setOrganizationName("MammoRay");
  QCoreApplication::setApplicationName("mammoray-app");
  QCoreApplication::setApplicationVersion(MAMMORAY_VERSION);
  QGuiApplication::setApplicationDisplayName("MammoRay");
  QGuiApplication::setDesktopFileName("mammoray");
}

/// Two numbers with a comma between them; nothing where the option is not given. Throws InputError.
std::optional<std::array<double, 2>> NumbersOf(const QCommandLineParser& parser,
  const QCommandLineOption& option)
{
  if (!parser.isSet(option))
  {
    return std::nullopt;
  }
  const QString text = parser.value(option);
  const QStringList parts = text.split(',');
  bool first = false;
  bool second = false;
  const std::array<double, 2> numbers{ parts.value(0).toDouble(&first),
    parts.value(1).toDouble(&second) };
  if (parts.size() != 2 || !first || !second)
  {
    throw InputError(option.names().front().toStdString() +
      ": expected two numbers with a comma between them, found " + text.toStdString());
  }
  return numbers;
}

int Run(int argc, char* argv[])
{
  RequireDisplay("app");
  SetUpQt();
  QApplication application(argc, argv);
  QCommandLineParser parser;
  parser.setApplicationDescription("MammoRay's desktop application");
  parser.addHelpOption();
  parser.addVersionOption();
  const QCommandLineOption benchmark("benchmark", "Print how fast views are, and stop.");
  const QCommandLineOption screenshot("screenshot",
    "Write the window's picture when everything is open, and stop.", "FILE");
  const QCommandLineOption pixel("pixel", "A pixel of the first mammogram to mark.", "COLUMN,ROW");
  const QCommandLineOption size("size", "Of the window, pixels.", "WIDTH,HEIGHT");
  const QCommandLineOption page("page", "Of the window, from 0: study, tissue, run, result, scene.",
    "N");
  const QCommandLineOption mammograms("mammogram", "A mammogram of the result; may be repeated.",
    "FILE");
  parser.addOptions({ benchmark, screenshot, pixel, size, page, mammograms });
  parser.addPositionalArgument("path", "A result, a study, or a scene.", "[PATH]");
  parser.process(application);

  MainWindow window({});
  if (const auto given = NumbersOf(parser, size))
  {
    window.resize(static_cast<int>((*given)[0]), static_cast<int>((*given)[1]));
  }
  window.show();
  const QStringList paths = parser.positionalArguments();
  std::vector<std::string> files;
  for (const QString& file : parser.values(mammograms))
  {
    files.push_back(file.toStdString());
  }
  if (!paths.isEmpty())
  {
    files.empty() ? window.OpenPaths(paths) : window.OpenResult(paths.front(), files);
  }
  if (parser.isSet(page))
  {
    window.ShowPage(static_cast<MainWindow::Page>(std::clamp(parser.value(page).toInt(), 0, 4)));
  }
  if (parser.isSet(benchmark))
  {
    return RunBenchmark(window);
  }
  if (parser.isSet(screenshot))
  {
    return RunScreenshot(window, parser.value(screenshot), NumbersOf(parser, pixel));
  }
  return QApplication::exec();
}
}

int RunDesktop(int argc, char* argv[])
{
  try
  {
    return Run(argc, argv);
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "mammoray: %s\n", EscapeControls(error.what()).c_str());
    return 1;
  }
}
}
