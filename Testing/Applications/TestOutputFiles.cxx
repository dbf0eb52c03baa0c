// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "OutputFiles.h"
#include "mammoray/Foundation/Error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

using namespace mammoray;
using testing_support::ReadFile;
namespace fs = std::filesystem;

namespace
{
class OutputFiles : public testing::Test
{
protected:
  std::size_t Entries() const
  {
    const fs::directory_iterator files(this->Folder.File(""));
    return static_cast<std::size_t>(std::distance(begin(files), end(files)));
  }

  testing_support::TemporaryFolder Folder;
};
}

TEST_F(OutputFiles, AFileAppearsCompleteOrNotAtAll)
{
  const std::string path = this->Folder.File("volume.nii.gz");
  EXPECT_THROW(WriteComplete(path,
                 [&](const std::string& temporary)
                 {
                   std::ofstream(temporary) << "half";
                   EXPECT_NE(temporary, path);
                   // The writer goes by it.
                   EXPECT_THAT(temporary, testing::EndsWith(".nii.gz"));
                   throw InputError("stopped");
                 }),
    InputError);
  EXPECT_EQ(this->Entries(), 0u);
  WriteTextFile(path, "first");
  WriteTextFile(path, "second");
  EXPECT_EQ(ReadFile(path), "second");
  EXPECT_EQ(this->Entries(), 1u);
}

TEST_F(OutputFiles, FilesAreCheckedBeforeTheWork)
{
  const std::string path = this->Folder.Write("mesh.vtu", "a mesh");
  EXPECT_EQ(CheckInputFile(path), path);
  EXPECT_NO_THROW(CheckInputFileIfAny(""));
  EXPECT_THROW(CheckInputFile(this->Folder.File("none.vtu")), InputError);
  EXPECT_THROW(CheckInputFile(this->Folder.File("")), InputError); // a folder
  EXPECT_THROW(CheckOutputFile(path, false), InputError);
  EXPECT_NO_THROW(CheckOutputFile(path, true));
  EXPECT_THROW(CheckOutputFile("", true), InputError);
  EXPECT_THROW(CheckOutputFile("/nowhere/mesh.vtu", true), InputError);
  EXPECT_THROW(CheckOutputFile(this->Folder.File("mesh.stl"), false, ".vtu", "a volume mesh"),
    InputError);
  EXPECT_NO_THROW(CheckPictureFile("", false));
  EXPECT_THROW(CheckPictureFile(this->Folder.File("picture.jpg"), false), InputError);
}
