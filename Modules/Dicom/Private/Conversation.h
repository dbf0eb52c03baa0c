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
 * Runs `talk`, a conversation with an archive, in a process of its own (IO's ReadGuarded) and
 * returns its result. DCMTK reads answers into memory and by recursion, so deeply nested or endless
 * answers would otherwise end this process. `name` is the archive in messages. A NetworkError or
 * InputError of `talk` is thrown on; the death of its process becomes a NetworkError of one line.
 */
std::vector<std::string> TalkTo(const std::string& name,
  const std::function<std::vector<std::string>(const TellCallback& tell)>& talk,
  const TellCallback& heard);
}

#endif
