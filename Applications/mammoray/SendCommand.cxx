// SPDX-License-Identifier: Apache-2.0
#include "ArchiveOptions.h"
#include "Commands.h"
#include "ProgressBar.h"
#include "SharedOptions.h"
#include "mammoray/Dicom/DicomNetwork.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Study/ResultFile.h"

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace mammoray
{
namespace
{
struct SendArguments
{
  std::string Result;
  std::vector<std::string> Files;
  std::string Pacs;
  DicomNode Node;
  DicomWebServer Web;
};

void Declare(const OptionList& add, SendArguments& arguments)
{
  const OptionList what = add.OneOf("What to send, one of");
  what(Shared::Result, arguments.Result);
  what.Input("--files", arguments.Files, "DICOM files, and folders of them");
  const OptionList where = add.OneOf("Where to, one of");
  AddPacsOption(where, arguments.Pacs);
  where("--web", arguments.Web.Url,
    "address of the archive's DICOMweb service\n(https://pacs.example.org/dicom-web; name and "
    "password: ~/.netrc)");
  AddNodeOptions(add, arguments.Node);
}

/// The objects of all mammograms of a result.
std::vector<std::string> ObjectsOf(const std::string& result)
{
  std::vector<std::string> folders;
  for (const ResultFile& one : ReadResultFiles(result))
  {
    const std::string folder = one.Folder + "/" + ObjectsFolderName;
    if (std::filesystem::is_directory(folder))
    {
      folders.push_back(folder);
    }
  }
  if (folders.empty())
  {
    throw InputError(result + ": expected objects to send, found none; 'mammoray dicom --result " +
      result + " --same-patient ...' writes them");
  }
  return folders;
}

void Run(SendArguments& arguments)
{
  if (!arguments.Pacs.empty())
  {
    SetAddress(arguments.Node, arguments.Pacs);
  }
  else if (arguments.Node.Tls.Wanted)
  {
    throw CLI::ValidationError("--tls: expected with --pacs; --web is encrypted with https://");
  }
  std::string unread;
  const StoredCallback stored = [](const std::string& file, const std::string& refusal)
  {
    std::printf("%s %s%s%s\n", refusal.empty() ? "stored" : "refused", file.c_str(),
      refusal.empty() ? "" : ": ", refusal.c_str());
    std::fflush(stdout);
  };
  const std::vector<std::string> files =
    FindDicomFiles(arguments.Result.empty() ? arguments.Files : ObjectsOf(arguments.Result),
      [&](const std::string& file, const std::string& refusal)
      {
        stored(file, refusal);
        unread += unread.empty() ? file + ": " + refusal : "";
      });
  if (!arguments.Pacs.empty())
  {
    StoreFiles(files, arguments.Node, stored, InterruptRequested);
  }
  else
  {
    arguments.Web.TimeoutSeconds = arguments.Node.TimeoutSeconds;
    arguments.Web.AuthoritiesFile = arguments.Node.Tls.AuthoritiesFile;
    StoreFilesOnWeb(files, arguments.Web, stored, InterruptRequested);
  }
  if (!unread.empty())
  {
    throw InputError(unread + "; stored the other " + std::to_string(files.size()));
  }
  std::printf("stored all %zu\n", files.size());
}
}

void AddSendCommand(CLI::App& application)
{
  AddCommand<SendArguments>(application, "send",
    "Store DICOM objects of a registration in an archive (PACS)\nby C-STORE or DICOMweb. Only what "
    "is named is sent, and only there.",
    "send --result result --pacs pacs.example.org:104", Declare, Run);
}
}
