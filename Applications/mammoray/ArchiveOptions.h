// SPDX-License-Identifier: Apache-2.0
// Options of the commands that connect to an archive.
#ifndef mammoray_ArchiveOptions_h
#define mammoray_ArchiveOptions_h

#include "OptionList.h"
#include "mammoray/Dicom/DicomNetwork.h"

#include <string>

namespace mammoray
{
/// Where 'dicom' puts the objects of a result, and 'send' looks for them, within its folder.
inline constexpr const char* ObjectsFolderName = "dicom";

/// Adds --pacs; gives the option.
inline CLI::Option* AddPacsOption(const OptionList& add, std::string& address)
{
  return add("--pacs", address,
    "HOST:PORT of the archive's DICOM service\n(what goes there is encrypted with --tls only)");
}

/// Adds --called-title, --calling-title, --timeout, and --tls with its certificates.
inline void AddNodeOptions(const OptionList& add, DicomNode& node)
{
  const OptionList expert = add.Expert();
  expert("--called-title", node.CalledTitle, "application entity title of the archive");
  expert("--calling-title", node.CallingTitle, "application entity title of this program");
  expert("--timeout", node.TimeoutSeconds, Between(1, 3600, "s"),
    "longest wait for the connection, and for each answer");
  CLI::Option* tls = add.Flag("--tls", node.Tls.Wanted,
    "encrypt what goes to --pacs and comes from there\n(the archive must prove its name)");
  // Through a pipe, too, as of what keeps secrets.
  const auto pem = [&expert](const char* name, std::string& file, const std::string& help)
  { return expert(name, file, help)->type_name(InputTypeName); };
  pem("--authorities", node.Tls.AuthoritiesFile,
    "certificates (PEM) that may vouch for the archive\n(with --tls or https; default: the "
    "system's)");
  pem("--certificate", node.Tls.CertificateFile,
    "our own certificate (PEM), where the archive asks for one")
    ->needs(tls);
  pem("--key", node.Tls.KeyFile, "its key (PEM), without passphrase")->needs(tls);
}
}

#endif
