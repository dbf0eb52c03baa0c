// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/Sha256.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

using namespace mammoray;

TEST(Sha256, MatchesThePublishedExamples)
{
  const test::TemporaryFolder folder;
  const std::string path = folder.File("message");
  const auto hash = [&](const std::string& message)
  {
    std::ofstream(path, std::ios::binary) << message;
    return Sha256OfFile(path);
  };
  // FIPS 180-4 example computations (NIST): one block, two blocks, a million letters; and none.
  EXPECT_EQ(hash("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(hash("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
    "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(hash(std::string(1000000, 'a')),
    "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  EXPECT_EQ(hash(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  // The buffer's own size, a mebibyte, is a boundary too (sha256sum of coreutils).
  EXPECT_EQ(hash(std::string(1 << 20, '\0')),
    "30e14955ebf1352266dc2ff8067e68104607e750abb9d3b36582b8af909fcb58");
  EXPECT_THROW(Sha256OfFile(folder.File("absent")), InputError);
  // A folder: its files one after the other, here "ab" and "c".
  const std::string series = folder.File("series");
  std::filesystem::create_directory(series);
  std::ofstream(series + "/2.dcm") << "c";
  std::ofstream(series + "/1.dcm") << "ab";
  EXPECT_EQ(Sha256OfFile(series),
    "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  // Files in the order they are given.
  EXPECT_EQ(Sha256OfFiles({ series + "/1.dcm", series + "/2.dcm" }), Sha256OfFile(series));
  EXPECT_NE(Sha256OfFiles({ series + "/2.dcm", series + "/1.dcm" }), Sha256OfFile(series));
}
