// SPDX-License-Identifier: Apache-2.0
// An archive that means harm: its answers are bytes that DCMTK would not send.
#include "ArchivedFiles.h"
#include "LoopbackServer.h"
#include "Refusals.h"
#include "mammoray/Dicom/DicomNetwork.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

using mammoray::test::RefusalOf;
using namespace mammoray;
using ::testing::HasSubstr;
using ::testing::Not;

namespace
{
constexpr const char* ImplicitVr = "1.2.840.10008.1.2";
constexpr const char* ExplicitVr = "1.2.840.10008.1.2.1";

/// The lowest `bytes` bytes, the last first, as the network has them.
std::string BigEndian(std::size_t value, int bytes)
{
  std::string text;
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8)
  {
    text += static_cast<char>(value >> shift & 0xff);
  }
  return text;
}

std::string LittleEndian(std::size_t value, int bytes)
{
  std::string text = BigEndian(value, bytes);
  std::reverse(text.begin(), text.end());
  return text;
}

/// An item of an association (PS3.8 9.3).
std::string Item(int type, const std::string& value)
{
  return BigEndian(static_cast<std::size_t>(type) << 8, 2) + BigEndian(value.size(), 2) + value;
}

/// A presentation context that is accepted.
std::string Accepted(int context, const char* syntax)
{
  return Item(0x21,
    BigEndian(static_cast<std::size_t>(context) << 8, 2) + BigEndian(0, 2) + Item(0x40, syntax));
}

/// A-ASSOCIATE-AC (PS3.8 9.3.3).
std::string Acceptance(const std::string& contexts)
{
  const std::string body = BigEndian(1, 2) + BigEndian(0, 2) + std::string(32, ' ') +
    std::string(32, '\0') + Item(0x10, "1.2.840.10008.3.1.1.1") + contexts +
    Item(0x50, Item(0x51, BigEndian(16384, 4)) + Item(0x52, "1.2.3"));
  return BigEndian(0x0200, 2) + BigEndian(body.size(), 4) + body;
}

/// A-RELEASE-RP (PS3.8 9.3.7).
const std::string Released = BigEndian(0x0600, 2) + BigEndian(4, 4) + BigEndian(0, 4);

/// P-DATA-TF (PS3.8 9.3.5): a command, or a data set, in as many fragments as it needs.
std::string Message(int context, bool isCommand, const std::string& bytes)
{
  constexpr std::size_t most = 8000;
  std::string units;
  for (std::size_t at = 0; at < bytes.size(); at += most)
  {
    const std::string part = bytes.substr(at, most);
    const std::size_t control = (isCommand ? 1 : 0) + (at + most >= bytes.size() ? 2 : 0);
    const std::string value = BigEndian(part.size() + 2, 4) +
      BigEndian(static_cast<std::size_t>(context) << 8 | control, 2) + part;
    units += BigEndian(0x0400, 2) + BigEndian(value.size(), 4) + value;
  }
  return units;
}

std::string Element(int group, int element, const std::string& value)
{
  return LittleEndian(static_cast<std::size_t>(group), 2) +
    LittleEndian(static_cast<std::size_t>(element), 2) + LittleEndian(value.size(), 4) + value;
}

std::string Number(int element, std::size_t value)
{
  return Element(0, element, LittleEndian(value, 2));
}

/// A command (PS3.7 E.1), followed by a data set or not.
std::string Command(int field, bool hasData, std::size_t status, const std::string& more = "")
{
  const std::string body = Element(0, 0x0002, std::string("1.2.840.10008.5.1.4.1.1.4", 26)) +
    Number(0x0100, static_cast<std::size_t>(field)) + Number(0x0110, 1) + Number(0x0120, 1) +
    Number(0x0700, 0) + Number(0x0800, hasData ? 1 : 0x0101) + Number(0x0900, status) +
    Element(0, 0x1000, "1.2.3.45") + more;
  return Element(0, 0, LittleEndian(body.size(), 4)) + body;
}

/// Sequences of one item in one another, none of which ends.
std::string Nested(bool isExplicit)
{
  constexpr int depth = 100'000;
  const std::string open = LittleEndian(0xffffffff, 4);
  const std::string sequence = LittleEndian(0x0008, 2) + LittleEndian(0x1115, 2) +
    (isExplicit ? std::string("SQ\0\0", 4) : std::string()) + open;
  const std::string item = LittleEndian(0xfffe, 2) + LittleEndian(0xe000, 2) + open;
  std::string all;
  for (int level = 0; level < depth; ++level)
  {
    all += sequence;
    all += item;
  }
  return all;
}

/// The last fragment of a command, and of a data set (PS3.8 9.3.5.1).
constexpr int LastOfCommand = 3;
constexpr int LastOfData = 2;

/// Accepts associations and answers each message's data set, or its command.
class HostileArchive : public test::LoopbackServer
{
public:
  HostileArchive(const std::string& contexts, const std::string& answer, int last = LastOfData)
    : LoopbackServer([accepting = Acceptance(contexts), answer, last](int client)
        { Serve(client, accepting, answer, last); })
  {
    this->Node.Host = "127.0.0.1";
    this->Node.Port = this->Port;
    this->Node.TimeoutSeconds = 10;
  }

  DicomNode Node;

private:
  static void Serve(int client, const std::string& accepting, const std::string& answer, int last)
  {
    for (std::string unit = Unit(client); !unit.empty(); unit = Unit(client))
    {
      const bool isRequest = unit[0] == 1;
      const bool isRelease = unit[0] == 5;
      const bool isAnswered = unit[0] == 4 && unit.size() > 11 && unit[11] == last;
      const std::string& bytes = isRequest ? accepting : isRelease ? Released : answer;
      if (isRequest || isAnswered || isRelease)
      {
        send(client, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      }
    }
  }
  /// The next protocol data unit; empty where the other side has gone.
  static std::string Unit(int client)
  {
    std::string unit(6, '\0');
    if (recv(client, unit.data(), 6, MSG_WAITALL) != 6)
    {
      return "";
    }
    std::size_t length = 0;
    for (int byte = 2; byte < 6; ++byte)
    {
      length = length << 8 | static_cast<unsigned char>(unit[static_cast<std::size_t>(byte)]);
    }
    unit.resize(6 + length);
    const auto got = recv(client, unit.data() + 6, length, MSG_WAITALL);
    return got == static_cast<ssize_t>(length) ? unit : "";
  }
};

class HostileArchiveOf : public test::ArchivedFiles<test::FolderTest>
{
protected:
  /// Of FindStudies, GetStudies and StoreFiles.
  static std::string Search(const DicomNode& node)
  {
    return RefusalOf([&] { FindStudies("A-100", node); });
  }
  std::string Get(const DicomNode& node) const
  {
    return RefusalOf(
      [&] {
        GetStudies({ { "1.2.3", "A-100", "", "", "" } }, node, this->Folder.File("got"));
      });
  }
  std::string Send(const DicomNode& node) const
  {
    return RefusalOf(
      [&] {
        StoreFiles({ this->MammogramPath() }, node, [](const std::string&, const std::string&) {});
      });
  }
};

TEST_F(HostileArchiveOf, ItsWordsAreUnderstoodAtAll)
{
  // So that the refusals below are for what is hostile in them.
  const std::string study = Element(0x0008, 0x0050, "A-100 ") + Element(0x0010, 0x0020, "P-17") +
    Element(0x0020, 0x000d, "1.2.3.45");
  const HostileArchive finds(Accepted(1, ImplicitVr),
    Message(1, true, Command(0x8020, true, 0xff00)) + Message(1, false, study) +
      Message(1, true, Command(0x8020, false, 0)));
  const std::vector<ArchivedStudy> found = FindStudies("A-100", finds.Node);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].StudyInstanceUid, "1.2.3.45");
  EXPECT_EQ(found[0].AccessionNumber, "A-100");
  EXPECT_EQ(found[0].PatientId, "P-17");
  EXPECT_EQ(found[0].Description, "");

  const HostileArchive stores(Accepted(1, ExplicitVr), Message(1, true, Command(0x8001, false, 0)));
  EXPECT_EQ(this->Send(stores.Node), test::NotRefused);

  const HostileArchive gives(Accepted(1, ImplicitVr) + Accepted(3, ExplicitVr),
    Message(3, true, Command(0x0001, true, 0)) +
      Message(3, false, std::string("\x20\0\x0e\0UI\6\0001.2.3\0", 14)) +
      Message(1, true, Command(0x8010, false, 0)));
  EXPECT_EQ(this->Get(gives.Node), test::NotRefused);
  EXPECT_TRUE(std::filesystem::exists(this->Folder.File("got/001/00001.dcm")));
}

TEST_F(HostileArchiveOf, IsAskedWhetherItAnswers)
{
  const std::string answer = Message(1, true, Command(0x8030, false, 0));
  const HostileArchive willing(Accepted(1, ImplicitVr), answer, LastOfCommand);
  EXPECT_NO_THROW(VerifyNode(willing.Node));
  const HostileArchive mute(Accepted(1, ImplicitVr), Message(1, true, "nonsense"), LastOfCommand);
  EXPECT_THAT(RefusalOf([&] { VerifyNode(mute.Node); }), HasSubstr("expected an answer to C-ECHO"));
}

/// A presentation context whose class the archive does not take.
std::string Rejected(int context)
{
  return Item(0x21,
    BigEndian(static_cast<std::size_t>(context) << 8, 2) + BigEndian(3 << 8, 2) +
      Item(0x40, ExplicitVr));
}

TEST_F(HostileArchiveOf, WhatIsRefusedStopsNoOther)
{
  // An archive that takes mammograms alone, of which it refuses none.
  const HostileArchive mammograms(Rejected(1) + Accepted(3, ExplicitVr),
    Message(3, true, Command(0x8001, false, 0)));
  const std::vector<std::string> files = FindDicomFiles({ this->MriPath() });
  ASSERT_GT(files.size(), 1u);
  std::vector<std::string> told;
  const StoredCallback tell = [&told](const std::string& file, const std::string& why)
  { told.push_back(file + (why.empty() ? "" : ": " + why)); };
  const std::string said = RefusalOf(
    [&] {
      StoreFiles({ files[0], this->MammogramPath(), files[1] }, mammograms.Node, tell);
    });
  const std::string kind = "it does not take this kind of object";
  EXPECT_THAT(told,
    ::testing::ElementsAre(files[0] + ": " + kind, this->MammogramPath(), files[1] + ": " + kind));
  EXPECT_THAT(said, HasSubstr("first " + files[0] + " (" + kind + "); stored 1 of 3"));
  // By what it lacks: the archive is not asked.
  told.clear();
  std::string nameless = test::ReadFile(this->MammogramPath());
  const std::size_t uid = nameless.rfind(std::string("\x8\0\x18\0UI", 6));
  ASSERT_NE(uid, std::string::npos);
  const auto length = static_cast<unsigned char>(nameless[uid + 6]);
  nameless.erase(uid + 8, length);
  nameless[uid + 6] = '\0';
  const HostileArchive all(Accepted(1, ExplicitVr), Message(1, true, Command(0x8001, false, 0)));
  const std::string bad = this->Folder.Write("nameless.dcm", nameless);
  EXPECT_THAT(RefusalOf(
                [&] {
                  StoreFiles({ bad, this->MammogramPath() }, all.Node, tell);
                }),
    HasSubstr("stored 1 of 2"));
  EXPECT_THAT(told, ::testing::ElementsAre(HasSubstr("nameless.dcm: "), this->MammogramPath()));
  // By a status.
  told.clear();
  const HostileArchive full(Accepted(1, ExplicitVr),
    Message(1, true, Command(0x8001, false, 0xa700)));
  EXPECT_THAT(RefusalOf([&] { StoreFiles({ this->MammogramPath() }, full.Node, tell); }),
    HasSubstr("(status a700h: out of resources); stored 0 of 1"));
  EXPECT_EQ(told.size(), 1u);
}

TEST_F(HostileArchiveOf, SequencesInOneAnotherEndNothing)
{
  const auto isRefused =
    HasSubstr("expected answers of an archive, found damaged data, at which its reader ended");
  const HostileArchive answers(Accepted(1, ImplicitVr),
    Message(1, true, Command(0x8020, true, 0xff00)) + Message(1, false, Nested(false)));
  EXPECT_THAT(this->Search(answers.Node), isRefused);
  const HostileArchive objects(Accepted(1, ImplicitVr) + Accepted(3, ExplicitVr),
    Message(3, true, Command(0x0001, true, 0)) + Message(3, false, Nested(true)));
  EXPECT_THAT(this->Get(objects.Node), isRefused);
  EXPECT_FALSE(std::filesystem::exists(this->Folder.File("got")));
  const HostileArchive commands(Accepted(1, ExplicitVr),
    Message(1, true, Command(0x8001, false, 0, Nested(false))));
  EXPECT_THAT(this->Send(commands.Node), isRefused);
  EXPECT_THAT(this->Send(commands.Node), Not(HasSubstr("\\x0a")));
}

TEST_F(HostileArchiveOf, AFetchIsInterruptedWhileTheArchiveIsSilent)
{
  const HostileArchive silent(Accepted(1, ImplicitVr), "");
  int asked = 0;
  EXPECT_THROW(GetStudies({ { "1.2.3", "A-100", "", "", "" } }, silent.Node,
                 this->Folder.File("got"), [&](double, const char*) { return ++asked < 3; }),
    Interrupted);
  EXPECT_EQ(asked, 3);
  EXPECT_FALSE(std::filesystem::exists(this->Folder.File("got")));
}
}
