// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Case/ResultFile.h"

#include "mammoray/Foundation/Error.h"

#include <nlohmann/json.hpp>

#include <fstream>

namespace mammoray
{
void ReadResultFile(const std::string& folder,
  const std::function<void(const nlohmann::json&)>& read)
{
  const std::string path = folder + "/result.json";
  std::ifstream file(path);
  if (!file)
  {
    throw InputError(path + ": no such file");
  }
  try
  {
    read(nlohmann::json::parse(file));
  }
  catch (const nlohmann::json::exception& error)
  {
    throw InputError(path + ": expected the result of 'mammoray register': " + error.what());
  }
}
}
