// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Conversation_h
#define mammoray_Conversation_h

#include "mammoray/IO/GuardedRead.h"

#include <functional>
#include <string>
#include <vector>

namespace mammoray
{
/**
 * Talks to an archive in a process of its own (IO's WorkGuarded) and gives what `talk` has found
 * out: DCMTK reads all that comes in memory and by recursion, so what an archive nests by tens of
 * thousands, or never ends, would end the process that asks. The archive's `name` is for messages.
 * A NetworkError or InputError of `talk` arrives as it was thrown; the death of its process is a
 * NetworkError of one line.
 */
std::vector<std::string> TalkTo(const std::string& name,
  const std::function<std::vector<std::string>(const TellCallback& tell)>& talk,
  const TellCallback& heard);
}

#endif
