// SPDX-License-Identifier: Apache-2.0
#include "ArchivedFiles.h"
#include "LoopbackServer.h"
#include "Refusals.h"
#include "mammoray/Dicom/DicomNetwork.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>

using mammoray::test::RefusalOf;
using namespace mammoray;
using ::testing::HasSubstr;

namespace
{
/// After what comes first from a connection answers what it is told to, or nothing.
class Peer : public test::LoopbackServer
{
public:
  explicit Peer(const std::string& answer = "")
    : LoopbackServer([answer](int client) { Serve(client, answer); })
  {
  }

private:
  static void Serve(int client, const std::string& answer)
  {
    const timeval patience{ 5, 0 };
    setsockopt(client, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    std::string got;
    char bytes[65536];
    // Until the request's last boundary, or the other side has gone.
    for (ssize_t count = 0; (count = recv(client, bytes, sizeof bytes, 0)) > 0;)
    {
      got.append(bytes, static_cast<std::size_t>(count));
      if (!answer.empty() && got.ends_with("--\r\n"))
      {
        send(client, answer.data(), answer.size(), MSG_NOSIGNAL);
        got.clear();
      }
    }
  }
};

class ArchiveOf : public test::ArchivedFiles<test::FolderTest>
{
protected:
  static DicomNode NodeAt(int port)
  {
    DicomNode node;
    SetAddress(node, "127.0.0.1:" + std::to_string(port));
    node.TimeoutSeconds = 1;
    return node;
  }
  std::string StoreOnWeb(const std::string& answer)
  {
    const Peer peer(answer);
    this->Stored = 0;
    const DicomWebServer server{ "http://127.0.0.1:" + std::to_string(peer.Port) + "/dicom-web", "",
      1 };
    try
    {
      StoreFilesOnWeb({ this->MammogramPath() }, server,
        [&](const std::string&, const std::string& why) { this->Stored += why.empty() ? 1 : 0; });
    }
    catch (const NetworkError& error)
    {
      return error.what();
    }
    return "";
  }
  int Stored = 0;
};

TEST(DicomNode, TakesAnAddressOrNone)
{
  DicomNode node;
  SetAddress(node, "pacs.example.org:11112");
  EXPECT_EQ(node.Host, "pacs.example.org");
  EXPECT_EQ(node.Port, 11112);
  SetAddress(node, "[::1]:104");
  EXPECT_EQ(node.Host, "::1");
  for (const char* bad :
    { "", "pacs", ":104", "pacs:", "pacs:0", "pacs:65536", "pacs:1a", "a:b:1" })
  {
    EXPECT_THAT(RefusalOf([&] { SetAddress(node, bad); }), HasSubstr("expected HOST:PORT")) << bad;
  }
}

TEST(DicomNode, AsksForOneStudyOnly)
{
  for (const char* bad : { "", "*", "A?", "A\\B", "12345678901234567" })
  {
    EXPECT_THAT(RefusalOf([&] { FindStudies(bad, {}); }), HasSubstr("accession number")) << bad;
  }
}

TEST_F(ArchiveOf, AnArchiveThatIsNotThereIsToldInOneLine)
{
  const test::LoopbackServer closed({});
  const std::string said = RefusalOf(
    [&]
    {
      StoreFiles({ this->MammogramPath() }, NodeAt(closed.Port),
        [](const std::string&, const std::string&) {});
    });
  EXPECT_THAT(said, HasSubstr("archive 127.0.0.1:" + std::to_string(closed.Port)));
  EXPECT_THAT(said, HasSubstr("found none"));
  EXPECT_THAT(said, ::testing::Not(HasSubstr("\\x0a")));
}

TEST_F(ArchiveOf, AnArchiveThatIsSilentIsNotWaitedForForEver)
{
  const Peer silent;
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(RefusalOf(
                [&]
                {
                  StoreFiles({ this->MammogramPath() }, NodeAt(silent.Port),
                    [](const std::string&, const std::string&) {});
                }),
    HasSubstr("within 1 s"));
  EXPECT_THAT(RefusalOf([&] { FindStudies("A-100", NodeAt(silent.Port)); }),
    HasSubstr("within 1 s"));
  // Twice the time-out, on a busy machine.
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
  EXPECT_THAT(this->StoreOnWeb(""), HasSubstr("stored 0 of 1"));
}

TEST_F(ArchiveOf, WhatTheWebDoesNotTakeIsSaid)
{
  const auto answer = [](const std::string& status, const std::string& body)
  {
    return "HTTP/1.1 " + status +
      "\r\nContent-Type: application/dicom+json\r\nContent-Length: " + std::to_string(body.size()) +
      "\r\n\r\n" + body;
  };
  EXPECT_EQ(this->StoreOnWeb(answer("200 OK", "{}")), "");
  EXPECT_EQ(this->Stored, 1);
  EXPECT_THAT(this->StoreOnWeb(answer("401 Unauthorized", "")), HasSubstr("status 401"));
  EXPECT_EQ(this->Stored, 0);
  EXPECT_THAT(this->StoreOnWeb(answer("409 Conflict", "no JSON")), HasSubstr("status 409"));
  EXPECT_THAT(this->StoreOnWeb(answer("202 Accepted",
                R"({"00081198":{"vr":"SQ","Value":[{"00081197":{"vr":"US","Value":[272]}}]}})")),
    HasSubstr("272"));
  // Printed by recursion it would end the process.
  const std::string deep = std::string(200000, '[') + std::string(200000, ']');
  EXPECT_THAT(this->StoreOnWeb(answer("202 Accepted",
                R"({"00081198":{"Value":[{"00081197":{"Value":[)" + deep + "]}}]}}")),
    HasSubstr("nested deeper than 64"));
  for (const char* const odd : { "\"x\"", "[7]", R"([{"00081197":7}])" })
  {
    const std::string body = R"({"00081198":{"Value":)" + std::string(odd) + "}}";
    EXPECT_THAT(this->StoreOnWeb(answer("200 OK", body)), HasSubstr("not given"));
  }
  // What is refused stops no other.
  const Peer conflicts(answer("409 Conflict", ""));
  int sent = 0;
  EXPECT_THAT(RefusalOf(
                [&]
                {
                  StoreFilesOnWeb({ this->MammogramPath(), this->MammogramPath() },
                    { "http://127.0.0.1:" + std::to_string(conflicts.Port), "", 1 },
                    [&sent](const std::string&, const std::string&) { ++sent; });
                }),
    HasSubstr("stored 0 of 2"));
  EXPECT_EQ(sent, 2);
  EXPECT_THAT(this->StoreOnWeb(answer("302 Found\r\nLocation: http://127.0.0.2/", "")),
    HasSubstr("status 302"))
    << "what is sent goes nowhere else";
  EXPECT_THAT(RefusalOf([&] { StoreFilesOnWeb({ this->MammogramPath() }, { "file:///tmp" }, {}); }),
    HasSubstr("expected an address https"));
}

TEST_F(ArchiveOf, OnlyDicomIsSent)
{
  EXPECT_EQ(FindDicomFiles({ this->MammogramPath(), this->MriPath() }).size(), 31U);
  EXPECT_THAT(RefusalOf([&] { FindDicomFiles({ this->Folder.File("lesion.nrrd") }); }),
    HasSubstr("expected a DICOM file"));
  // Where they are told, the others are sent.
  std::string told;
  EXPECT_EQ(FindDicomFiles({ this->Folder.File("lesion.nrrd"), this->MammogramPath() },
              [&told](const std::string& file, const std::string& why)
              { told += file + "|" + why; }),
    std::vector<std::string>{ this->MammogramPath() });
  EXPECT_EQ(told, this->Folder.File("lesion.nrrd") + "|expected a DICOM file, found another");
  const std::string missing = this->Folder.File("missing.dcm");
  EXPECT_EQ(RefusalOf(
              [&] {
                FindDicomFiles({ this->MammogramPath(), missing });
              }),
    missing + ": no such file");
  std::filesystem::create_directories(this->Folder.File("empty"));
  EXPECT_THAT(RefusalOf([&] { FindDicomFiles({ this->Folder.File("empty") }); }),
    HasSubstr("found none"));
}
}
