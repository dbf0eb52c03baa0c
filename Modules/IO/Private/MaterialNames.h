// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_MaterialNames_h
#define mammoray_Private_MaterialNames_h

#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshConversion.h"

#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkStringArray.h"

#include <string>
#include <vector>

namespace mammoray
{
/// Adds the field array "MaterialNames".
inline void AddMaterialNames(vtkDataObject* data, const std::vector<std::string>& names)
{
  vtkNew<vtkStringArray> array;
  array->SetName(MaterialNamesArrayName);
  for (const std::string& name : names)
  {
    array->InsertNextValue(name);
  }
  data->GetFieldData()->AddArray(array);
}

/// The reverse; empty where there is no such array.
inline std::vector<std::string> FindMaterialNames(vtkDataObject* data)
{
  std::vector<std::string> names;
  if (auto* array = vtkStringArray::SafeDownCast(
        data->GetFieldData()->GetAbstractArray(MaterialNamesArrayName)))
  {
    for (vtkIdType index = 0; index < array->GetNumberOfValues(); ++index)
    {
      names.push_back(EscapeControls(array->GetValue(index)));
    }
  }
  return names;
}
}

#endif
