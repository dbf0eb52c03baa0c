// SPDX-License-Identifier: Apache-2.0
#include "Private/WindowPicture.h"

#include "mammoray/IO/ProjectionImage.h"

#include "vtkNew.h"
#include "vtkRenderWindow.h"
#include "vtkWindowToImageFilter.h"

#include <filesystem>

namespace mammoray
{
void WriteWindowPicture(vtkRenderWindow* window, const std::string& path)
{
  vtkNew<vtkWindowToImageFilter> capture;
  capture->SetInput(window);
  capture->ReadFrontBufferOff();
  capture->ShouldRerenderOff();
  capture->Update();
  WritePicture(capture->GetOutput(), path);
}

std::string FreePictureName(const std::string& folder, const std::string& name)
{
  for (int number = 1;; ++number)
  {
    const auto path =
      std::filesystem::path(folder) / (name + "-" + std::to_string(number) + ".png");
    if (!std::filesystem::exists(path))
    {
      return path.string();
    }
  }
}
}
