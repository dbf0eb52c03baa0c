// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_WindowPicture_h
#define mammoray_WindowPicture_h

#include <string>

class vtkRenderWindow;

namespace mammoray
{
/// Writes what the window shows (.png). Throws InputError when it cannot be written.
void WriteWindowPicture(vtkRenderWindow* window, const std::string& path);

/// The first of name-1.png, name-2.png, ... in a folder that no file has yet.
std::string FreePictureName(const std::string& folder, const std::string& name);
}

#endif
