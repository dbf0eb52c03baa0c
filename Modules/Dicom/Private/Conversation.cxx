// SPDX-License-Identifier: Apache-2.0
#include "Private/Conversation.h"

#include "mammoray/Dicom/DicomNetwork.h"

#include <cstdint>
#include <limits>

namespace mammoray
{
namespace
{
/// An object of an archive has 4 GiB at most (PS3.5 7.1.1: lengths of 32 bits).
constexpr std::uint64_t MostMemory = std::uint64_t{ 5 } << 30;
/// What the answer begins with.
const std::string Found = "found";
const std::string BadInput = "input";
const std::string BadNetwork = "network";
}

std::vector<std::string> TalkTo(const std::string& name,
  const std::function<std::vector<std::string>(const TellCallback& tell)>& talk,
  const TellCallback& heard)
{
  std::vector<std::string> answer;
  try
  {
    answer = ReadGuarded(
      name, "answers of an archive", { MostMemory, std::numeric_limits<double>::infinity() },
      [&](const TellCallback& tell) -> std::vector<std::string>
      {
        try
        {
          std::vector<std::string> found = talk(tell);
          found.insert(found.begin(), Found);
          return found;
        }
        catch (const NetworkError& error)
        {
          return { BadNetwork, error.what() };
        }
        catch (const InputError& error)
        {
          return { BadInput, error.what() };
        }
      },
      heard);
  }
  catch (const InputError& death)
  {
    throw NetworkError(death.what());
  }
  // What led that process astray may have answered anything.
  if (answer.empty())
  {
    throw NetworkError(name + ": expected an answer of its reader, found none");
  }
  if (answer.front() == BadNetwork)
  {
    throw NetworkError(answer.back());
  }
  if (answer.front() == BadInput)
  {
    throw InputError(answer.back());
  }
  answer.erase(answer.begin());
  return answer;
}
}
