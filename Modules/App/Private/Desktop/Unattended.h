// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Unattended_h
#define mammoray_Unattended_h

#include <QString>

#include <array>
#include <optional>

namespace mammoray
{
class MainWindow;

/// What is done without a user, after a window has opened what it was given. Both return the exit
/// code: 0, or 1 after a line on standard error.

/// Prints how fast the views of a result follow.
int RunBenchmark(MainWindow& window);

/// Marks a pixel of the result's first mammogram, if wanted, and writes the window's picture.
int RunScreenshot(MainWindow& window, const QString& path,
  const std::optional<std::array<double, 2>>& pixel);
}

#endif
