// SPDX-License-Identifier: Apache-2.0
#include "ResultNotes.h"

#include "mammoray/Case/RegisteredBreast.h"
#include "mammoray/Case/RegisteredMammogram.h"

#include <cstdio>

namespace mammoray
{
void WarnOfDistrust(const std::string& folder)
{
  if (const std::string reason = DistrustOf(folder); !reason.empty())
  {
    std::fprintf(stderr, "mammoray: warning: %s: the match is not to be trusted: %s\n",
      folder.c_str(), reason.c_str());
  }
}

void NoteOtherMammogram(const std::string& folder, const std::string& mammogram)
{
  if (!IsRegisteredMammogram(folder, mammogram))
  {
    std::fprintf(stderr, "mammoray: note: %s is not the file that was registered\n",
      mammogram.c_str());
  }
}
}
