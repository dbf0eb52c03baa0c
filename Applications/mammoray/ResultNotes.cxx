// SPDX-License-Identifier: Apache-2.0
#include "ResultNotes.h"

#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Study/RegisteredMammogram.h"

#include <cstdio>

namespace mammoray
{
std::string Verdict(const Assessment& trust)
{
  std::string verdict = VerdictOf(trust.Level);
  for (const std::string& reason : trust.Reasons)
  {
    verdict += (&reason == &trust.Reasons.front() ? ": " : " ") + reason;
  }
  return verdict;
}

void WarnOfDistrust(const std::string& folder, const Assessment& trust)
{
  if (trust.Level != Trust::Good)
  {
    std::fprintf(stderr, "mammoray: warning: %s: %s\n", folder.c_str(), Verdict(trust).c_str());
  }
}

void NoteOtherMammogram(const ResultFile& result, const std::string& mammogram)
{
  if (IsRegisteredMammogram(result, mammogram))
  {
    return;
  }
  const Mammogram& searched = result.Mammogram;
  const std::string view =
    ReadMammogram(mammogram, { searched.ColumnSpacingMm, searched.View, searched.Laterality }).View;
  if (view != searched.View)
  {
    throw InputError(mammogram + ": expected the mammogram that was registered, " + searched.View +
      ", found " + view);
  }
  std::fprintf(stderr, "mammoray: note: %s is not the file that was registered\n",
    mammogram.c_str());
}
}
