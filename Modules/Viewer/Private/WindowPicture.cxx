// SPDX-License-Identifier: Apache-2.0
#include "Private/WindowPicture.h"

#include "mammoray/Foundation/Error.h"

#include "vtkNew.h"
#include "vtkPNGWriter.h"
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
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(capture->GetOutputPort());
  writer->SetFileName(path.c_str());
  writer->Write();
  if (writer->GetErrorCode() != 0)
  {
    throw InputError(path + ": cannot be written");
  }
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
