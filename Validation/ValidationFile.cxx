// SPDX-License-Identifier: Apache-2.0
#include "ValidationFile.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/Registration/RegistrationResult.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <utility>

namespace mammoray
{
namespace
{
constexpr const char* Lists[]{ "twins", "landmarks", "mammograms", "studies" };
}

ValidationFile::ValidationFile(std::string path, const nlohmann::json& settings, bool resume)
  : Path(std::move(path))
{
  ReserveFile(this->Path);
  this->Content = { { "settings", settings }, { "version", MAMMORAY_VERSION },
    { "tissueCorrelationLimits", { LeastTissueCorrelation, GoodTissueCorrelation } } };
  for (const char* list : Lists)
  {
    this->Content[list] = nlohmann::json::array();
  }
  if (!resume || !std::filesystem::exists(this->Path))
  {
    return;
  }
  try
  {
    std::ifstream file(this->Path);
    const nlohmann::json found = nlohmann::json::parse(file, JsonNestingLimit{ this->Path });
    if (found.at("settings") != settings)
    {
      throw InputError(this->Path + ": expected runs with the same settings, " + settings.dump() +
        ", found " + found.at("settings").dump());
    }
    for (const char* list : Lists)
    {
      for (const nlohmann::json& run : found.at(list))
      {
        this->Content[list].push_back(run.get<nlohmann::json::object_t>());
      }
    }
  }
  catch (const nlohmann::json::exception& error)
  {
    throw InputError(this->Path + ": expected a file of mammoray-validate: " + error.what());
  }
}

const nlohmann::json* ValidationFile::Find(const char* list, const nlohmann::json& values) const
{
  const nlohmann::json& runs = this->Content.at(list);
  const auto found = std::find_if(runs.begin(), runs.end(),
    [&](const nlohmann::json& run)
    {
      return std::all_of(values.items().begin(), values.items().end(),
        [&](const auto& item)
        { return run.contains(item.key()) && run[item.key()] == item.value(); });
    });
  return found == runs.end() ? nullptr : &*found;
}

void ValidationFile::Add(const char* list, nlohmann::json run)
{
  this->Content[list].push_back(std::move(run));
  WriteAtomicFile(this->Path,
    this->Content.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  ReserveFile(this->Path); // the next run replaces it
}

std::size_t ValidationFile::NumberOfRuns() const
{
  std::size_t count = 0;
  for (const char* list : Lists)
  {
    count += this->Content.at(list).size();
  }
  return count;
}
}
