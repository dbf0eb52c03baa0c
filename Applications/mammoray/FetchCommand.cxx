// SPDX-License-Identifier: Apache-2.0
#include "ArchiveOptions.h"
#include "Commands.h"
#include "ProgressBar.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"

#include <cstdio>
#include <string>
#include <vector>

namespace mammoray
{
namespace
{
struct FetchArguments
{
  std::string Pacs;
  DicomNode Node;
  std::vector<std::string> Accessions;
  std::string Output;
};

void Declare(const OptionList& add, FetchArguments& arguments)
{
  AddPacsOption(add, arguments.Pacs)->required();
  add("--accession", arguments.Accessions,
    "accession number of a study, once for each\n(such as the MRI's and the mammograms')")
    ->required();
  AddNodeOptions(add, arguments.Node);
  add("-o,--output", arguments.Output, "a new or empty folder, for 'mammoray register --study'")
    ->required();
}

void Run(FetchArguments& arguments)
{
  SetAddress(arguments.Node, arguments.Pacs);
  ReserveEmptyFolder(arguments.Output);
  std::vector<ArchivedStudy> studies;
  for (const std::string& accession : arguments.Accessions)
  {
    for (const ArchivedStudy& study : FindStudies(accession, arguments.Node))
    {
      if (!studies.empty() && study.PatientId != studies.front().PatientId)
      {
        throw InputError(arguments.Pacs + ": expected studies of one patient, found those of '" +
          studies.front().PatientId + "' and '" + study.PatientId + "'");
      }
      std::printf("study %s of %s: %s\n", EscapeControls(accession).c_str(),
        EscapeControls(study.Date).c_str(), EscapeControls(study.Description).c_str());
      studies.push_back(study);
    }
  }
  const std::size_t count =
    GetStudies(studies, arguments.Node, arguments.Output, MakeProgressBar());
  std::printf("wrote %s: %zu objects\n", arguments.Output.c_str(), count);
}
}

void AddFetchCommand(CLI::App& application)
{
  AddCommand<FetchArguments>(application, "fetch",
    "Get studies by accession number from an archive (PACS) into a folder\nC-FIND and C-GET: all "
    "comes over the connection that is opened to the archive, no port is opened here.",
    "fetch --pacs pacs.example.org:104 --accession A123 -o export", Declare, Run);
}
}
