// SPDX-License-Identifier: Apache-2.0
#include "ResultNotes.h"

#include "mammoray/Case/RegisteredMammogram.h"

#include <cstdio>

namespace mammoray
{
void WarnOfDistrust(const std::string& folder, const Assessment& trust)
{
  if (trust.Level == Trust::None)
  {
    std::fprintf(stderr, "mammoray: warning: %s: the match is not to be trusted%s%s\n",
      folder.c_str(), trust.Reasons.empty() ? "" : ": ",
      trust.Reasons.empty() ? "" : trust.Reasons.front().c_str());
  }
}

void NoteOtherMammogram(const ResultFile& result, const std::string& mammogram)
{
  if (!IsRegisteredMammogram(result, mammogram))
  {
    std::fprintf(stderr, "mammoray: note: %s is not the file that was registered\n",
      mammogram.c_str());
  }
}
}
