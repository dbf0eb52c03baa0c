// SPDX-License-Identifier: Apache-2.0
// Damages small files of every format, reads each in a process of its own and counts what happens.
#include "Damage.h"
#include "Files.h"
#include "Formats.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/GuardedRead.h"
#include "mammoray/IO/ScratchFolder.h"

#include <CLI/CLI.hpp>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace
{
using namespace mammoray;
using namespace mammoray::hardening;

enum class Outcome
{
  Taken,
  Refused,    ///< in one line without control characters, nothing printed beside it
  Talked,     ///< refused otherwise, or something was printed
  OtherError, ///< an exception of another kind
  Endless,
  Died
};
constexpr std::array<const char*, 6> OutcomeNames{ "taken", "refused", "talked", "exception",
  "endless", "died" };

struct Arguments
{
  std::uint64_t Seed = 1;
  int Count = 100;
  int Seconds = 240;
  std::string Only;
  std::string Keep;
  std::string Write;
  std::vector<std::string> Mammograms;
  bool Says = false;
  bool Unguarded = false;
};

bool IsOneLine(const std::string& text)
{
  return !text.empty() &&
    std::none_of(text.begin(), text.end(),
      [](unsigned char letter) { return letter < 0x20 || letter == 0x7f; });
}

/// The rest of a child: reads, and ends with the outcome.
[[noreturn]] void ReadAndEnd(const Format& format, const std::string& path, int seconds, bool says)
{
  // The whole group is ended then, a reader's reader included.
  alarm(static_cast<unsigned>(seconds));
  const int said = open((path + ".said").c_str(), O_RDWR | O_CREAT | O_TRUNC, 0600);
  const int shown = dup(STDOUT_FILENO);
  dup2(said, STDOUT_FILENO);
  dup2(said, STDERR_FILENO);
  Outcome outcome = Outcome::Taken;
  std::string message;
  NoteKeeper notes; // which may be said beside the answer
  try
  {
    format.Read(path);
  }
  catch (const Error& error)
  {
    message = error.what();
    outcome = IsOneLine(message) ? Outcome::Refused : Outcome::Talked;
  }
  catch (const std::exception& error)
  {
    message = error.what();
    outcome = Outcome::OtherError;
  }
  std::fflush(stdout);
  const std::vector<std::string> lines = notes.Lines();
  const bool areLines = std::all_of(lines.begin(), lines.end(), IsOneLine);
  if ((lseek(said, 0, SEEK_END) > 0 || !areLines) && outcome != Outcome::OtherError)
  {
    outcome = Outcome::Talked;
  }
  if (says)
  {
    dprintf(shown, "%s: %s: %s %s\n", path.c_str(), OutcomeNames[static_cast<std::size_t>(outcome)],
      message.c_str(), test::ReadFile(path + ".said").c_str());
  }
  _exit(static_cast<int>(outcome));
}

Outcome Try(const Format& format, const std::string& path, const Arguments& arguments)
{
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0)
  {
    ReadAndEnd(format, path, arguments.Seconds, arguments.Says);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status))
  {
    return WTERMSIG(status) == SIGALRM ? Outcome::Endless : Outcome::Died;
  }
  const int code = WEXITSTATUS(status);
  return code < static_cast<int>(OutcomeNames.size()) ? static_cast<Outcome>(code) : Outcome::Died;
}

/// All damage to one format; counts outcomes.
class Trial
{
public:
  Trial(const Format& format, const std::string& folder, const Arguments& arguments)
    : Tried(format)
    , Folder(folder)
    , Given(arguments)
  {
  }
  void Run()
  {
    if (Try(this->Tried, this->Folder + "/" + this->Tried.Name, this->Given) != Outcome::Taken)
    {
      throw Error(this->Tried.Name + ": expected the whole file to be taken, found it was not");
    }
    for (int which = 0; this->Tried.IsDicom && which < NumberOfDicomIntegers; ++which)
    {
      this->Add("integer" + std::to_string(which), WithDicomInteger(this->Tried.Bytes, which));
    }
    for (int count = 0; count < this->Given.Count; ++count)
    {
      std::seed_seq seeds{ this->Given.Seed, static_cast<std::uint64_t>(count) };
      std::mt19937_64 random(seeds);
      this->Add(std::to_string(this->Given.Seed) + "-" + std::to_string(count),
        Damage(this->Tried.Bytes, random));
    }
  }
  /// Files of every outcome, in the order of OutcomeNames.
  std::array<int, OutcomeNames.size()> Counts{};

private:
  void Add(const std::string& name, const std::string& bytes)
  {
    if (bytes.empty() || bytes == this->Tried.Bytes)
    {
      return;
    }
    const std::string path = this->Folder + "/damaged/" + name + "-" + this->Tried.Name;
    std::ofstream(path, std::ios::binary) << bytes;
    const Outcome outcome = Try(this->Tried, path, this->Given);
    ++this->Counts[static_cast<std::size_t>(outcome)];
    if (outcome > Outcome::Refused && !this->Given.Keep.empty())
    {
      const auto kept = std::filesystem::path(this->Given.Keep) /
        (OutcomeNames[static_cast<std::size_t>(outcome)] + ("-" + name) + "-" + this->Tried.Name);
      std::filesystem::copy_file(path, kept, std::filesystem::copy_options::overwrite_existing);
    }
    std::filesystem::remove(path);
    std::filesystem::remove(path + ".said");
  }

  const Format& Tried;
  const std::string& Folder;
  const Arguments& Given;
};

std::vector<Format> FormatsOf(const Arguments& arguments, const std::string& folder)
{
  if (arguments.Mammograms.empty())
  {
    return MakeFormats(folder);
  }
  std::vector<Format> formats;
  for (const std::string& path : arguments.Mammograms)
  {
    const std::string name = std::filesystem::path(path).filename();
    std::filesystem::copy_file(path, folder + "/" + name);
    formats.push_back(
      { name, test::ReadFile(path), [](const std::string& file) { ReadMammogram(file); }, true });
  }
  return formats;
}

int Run(const Arguments& arguments)
{
  if (!arguments.Write.empty())
  {
    std::filesystem::create_directories(arguments.Write);
    MakeFormats(arguments.Write);
    return 0;
  }
  if (arguments.Unguarded)
  {
    ReadWithoutGuard();
  }
  const ScratchFolder scratch;
  const std::string folder = scratch.File("");
  std::filesystem::create_directories(folder + "/damaged");
  if (!arguments.Keep.empty())
  {
    std::filesystem::create_directories(arguments.Keep);
  }
  std::printf("%-18s", "format");
  for (const char* const name : OutcomeNames)
  {
    std::printf("%10s", name);
  }
  std::puts("");
  std::array<int, OutcomeNames.size()> all{};
  int bad = 0;
  for (const Format& format : FormatsOf(arguments, folder))
  {
    if (!arguments.Only.empty() && format.Name.find(arguments.Only) == std::string::npos)
    {
      continue;
    }
    Trial trial(format, folder, arguments);
    trial.Run();
    std::printf("%-18s", format.Name.c_str());
    for (std::size_t outcome = 0; outcome < trial.Counts.size(); ++outcome)
    {
      std::printf("%10d", trial.Counts[outcome]);
      all[outcome] += trial.Counts[outcome];
      bad += outcome > static_cast<std::size_t>(Outcome::Refused) ? trial.Counts[outcome] : 0;
    }
    std::puts("");
    std::fflush(stdout);
  }
  std::printf("%-18s", "all");
  for (const int count : all)
  {
    std::printf("%10d", count);
  }
  std::puts("");
  return bad == 0 ? 0 : 1;
}
}

int main(int argc, char* argv[])
{
  CLI::App application{ "Damages small files of every format that MammoRay reads and counts how "
                        "they are read: taken, refused in one line, or worse (exit status 1)." };
  Arguments arguments;
  application.add_option("--seed", arguments.Seed, "Which damage")->capture_default_str();
  application.add_option("--count", arguments.Count, "Files of each format")->capture_default_str();
  application.add_option("--seconds", arguments.Seconds, "After which reading is called endless")
    ->capture_default_str();
  application.add_option("--only", arguments.Only, "Formats whose name holds this");
  application.add_option("--keep", arguments.Keep, "Folder for files that are not refused well");
  application.add_option("--write", arguments.Write,
    "Write the whole files into this folder and do nothing else");
  application.add_option("--mammogram", arguments.Mammograms,
    "DICOM files to damage in their place");
  application.add_flag("--unguarded", arguments.Unguarded,
    "Let the libraries' readers end the process that asks");
  application.add_flag("--say", arguments.Says, "Print each answer");
  CLI11_PARSE(application, argc, argv);
  try
  {
    return Run(arguments);
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "damageFiles: %s\n", error.what());
    return 1;
  }
}
