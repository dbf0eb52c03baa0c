// SPDX-License-Identifier: Apache-2.0
#include "Private/StoreAnswer.h"

#include "mammoray/Foundation/ValidRange.h"

#include <nlohmann/json.hpp>

namespace mammoray
{
namespace
{
/// Numbers of the first Failure Reason (0008,1197) in a Failed SOP Sequence (0008,1198).
std::string FailureReason(const nlohmann::json& failed)
{
  const nlohmann::json::json_pointer place("/Value/0/00081197/Value/0");
  const bool given = failed.contains(place) && failed.at(place).is_number();
  return "reason " + (given ? failed.at(place).dump() : std::string("not given"));
}
}

std::string WhyNotStored(long status, const std::string& body)
{
  if (status != 200 && status != 202 && status != 409)
  {
    return "status " + std::to_string(status);
  }
  nlohmann::json json;
  try
  {
    json = nlohmann::json::parse(body, JsonNestingLimit{ "the archive's answer" }, false);
  }
  catch (const InputError& error)
  {
    return error.what();
  }
  if (json.is_object())
  {
    const auto failed = json.find("00081198");
    if (failed != json.end() && failed->is_object() && failed->contains("Value") &&
      !(*failed)["Value"].empty())
    {
      return FailureReason(*failed);
    }
  }
  return status == 409 ? "status 409" : std::string();
}
}
