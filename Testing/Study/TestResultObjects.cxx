// SPDX-License-Identifier: Apache-2.0
#include "ArchivedFiles.h"
#include "DicomTesting.h"
#include "Refusals.h"
#include "SqueezedBox.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Study/Intake.h"
#include "mammoray/Study/ResultObjects.h"

#include <gdcmReader.h>
#include <gdcmSequenceOfItems.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

using mammoray::test::DicomTextOf;
using mammoray::test::ExpectValidDicom;
using mammoray::test::RefusalOf;
using namespace mammoray;
using ::testing::AllOf;
using ::testing::HasSubstr;

namespace
{
/// The first item of a sequence.
gdcm::DataSet FirstItem(const gdcm::DataSet& data, const gdcm::Tag& tag)
{
  const auto sequence = data.GetDataElement(tag).GetValueAsSQ();
  return sequence && sequence->GetNumberOfItems() > 0 ? sequence->GetItem(1).GetNestedDataSet()
                                                      : gdcm::DataSet();
}

template <typename T>
std::vector<T> NumbersOf(const gdcm::DataSet& data, const gdcm::Tag& tag)
{
  const gdcm::ByteValue* bytes = data.GetDataElement(tag).GetByteValue();
  std::vector<T> numbers(bytes ? bytes->GetLength() / sizeof(T) : 0);
  if (bytes)
  {
    std::memcpy(numbers.data(), bytes->GetPointer(), numbers.size() * sizeof(T));
  }
  return numbers;
}

gdcm::DataSet DataOf(const std::string& path)
{
  gdcm::Reader reader;
  reader.SetFileName(path.c_str());
  EXPECT_TRUE(reader.Read()) << path;
  return reader.GetFile().GetDataSet();
}

class ResultObjectsOf : public test::ArchivedFiles<test::SqueezedBox>
{
protected:
  void SetUp() override
  {
    ArchivedFiles::SetUp();
    this->Objects.Mammogram = this->MammogramPath();
    std::filesystem::create_directories(this->Out());
  }
  std::string Out(const std::string& name = "") const
  {
    return this->Folder.File("objects") + (name.empty() ? "" : "/" + name);
  }
  void Write()
  {
    const ResultFile result = ReadResultFile(this->Folder.File(""));
    WriteResultObjects(result, *this->Breast, this->Objects, {}, this->Out());
  }

  ResultObjects Objects;
};

TEST_F(ResultObjectsOf, APointIsWhereTheRayMeetsTheMammogram)
{
  const Vector3 point{ 8, 20, 0 };
  this->Objects.Points = { point };
  this->Write();
  for (const char* name : { "lesions.dcm", "presentation.dcm", "report.dcm" })
  {
    ExpectValidDicom(this->Out(name));
    EXPECT_EQ(DicomTextOf(this->Out(name), 0x10, 0x20), "P-17") << name;
    EXPECT_EQ(DicomTextOf(this->Out(name), 0x20, 0xd), this->Identity.StudyInstanceUid) << name;
  }
  const gdcm::DataSet state = DataOf(this->Out("presentation.dcm"));
  const gdcm::DataSet annotation = FirstItem(state, { 0x70, 1 });
  // Squeezed to (10, 23, 12), seen from (0, 0, 650 or so); half a pixel from corner to centre.
  const ImagedPoint imaged = this->Breast->ToMammogram(point);
  const auto anchor = NumbersOf<float>(FirstItem(annotation, { 0x70, 8 }), { 0x70, 0x14 });
  ASSERT_EQ(anchor.size(), 2U);
  EXPECT_NEAR(anchor[0], imaged.Column + 0.5, 1e-4);
  EXPECT_NEAR(anchor[1], imaged.Row + 0.5, 1e-4);
  // One parameter moves all along x, which is along the rows: a line of 2 sigma of 2 mm, 2.45
  // times.
  const auto ellipse = NumbersOf<float>(FirstItem(annotation, { 0x70, 9 }), { 0x70, 0x22 });
  ASSERT_EQ(ellipse.size(), 8U);
  const double sigma = imaged.Uncertainty->MajorMm;
  EXPECT_NEAR(std::hypot(ellipse[2] - ellipse[0], ellipse[3] - ellipse[1]),
    2 * std::sqrt(-2 * std::log(0.05)) * sigma / 2, 1e-3);
  EXPECT_NEAR(0.5 * (ellipse[0] + ellipse[2]), anchor[0], 1e-4);
  EXPECT_NEAR(0.5 * (ellipse[1] + ellipse[3]), anchor[1], 1e-4);
  // The picture's own window and polarity.
  const gdcm::DataSet window = FirstItem(state, { 0x28, 0x3110 });
  EXPECT_TRUE(window.FindDataElement(gdcm::Tag(0x28, 0x1050)));
  EXPECT_EQ(DicomTextOf(this->Out("presentation.dcm"), 0x2050, 0x20), "IDENTITY");
  if (std::system("command -v dsrdump >/dev/null 2>&1") == 0)
  {
    const std::string text = this->Folder.File("report.txt");
    EXPECT_EQ(std::system(("dsrdump " + this->Out("report.dcm") + " >" + text + " 2>&1").c_str()),
      0);
    const std::string report = test::ReadFile(text);
    EXPECT_THAT(report, HasSubstr("Imaging Measurement Report"));
    EXPECT_THAT(report, HasSubstr("Measurement Group"));
    EXPECT_THAT(report, HasSubstr("\"doubtful\""));
    EXPECT_THAT(report, ::testing::Not(HasSubstr("\nE: ")));
  }
}

TEST_F(ResultObjectsOf, TheRegistrationLeadsFromTheCompressedBreastToTheMri)
{
  this->Objects.Mri = this->MriPath();
  this->Objects.Points = { { 8, 20, 0 } };
  this->Write();
  ExpectValidDicom(this->Out("registration.dcm"));
  const gdcm::DataSet data = DataOf(this->Out("registration.dcm"));
  const gdcm::DataSet item = FirstItem(data, { 0x64, 2 });
  const gdcm::DataSet grid = FirstItem(item, { 0x64, 5 });
  const auto size = NumbersOf<std::uint32_t>(grid, { 0x64, 7 });
  const auto spacing = NumbersOf<double>(grid, { 0x64, 8 });
  const auto vectors = NumbersOf<float>(grid, { 0x64, 9 });
  ASSERT_EQ(size.size(), 3U);
  ASSERT_EQ(vectors.size(), 3ULL * size[0] * size[1] * size[2]);
  const gdcm::ByteValue* origin = grid.GetDataElement(gdcm::Tag(0x20, 0x32)).GetByteValue();
  double at[3];
  ASSERT_EQ(std::sscanf(std::string(origin->GetPointer(), origin->GetLength()).c_str(),
              "%lf\\%lf\\%lf", &at[0], &at[1], &at[2]),
    3);
  int inside = 0;
  for (std::uint32_t k = 0; k < size[2]; ++k)
  {
    for (std::uint32_t j = 0; j < size[1]; ++j)
    {
      for (std::uint32_t i = 0; i < size[0]; ++i)
      {
        const Vector3 p{ at[0] + i * spacing[0], at[1] + j * spacing[1], at[2] + k * spacing[2] };
        const Vector3 rest{ p[0] / 1.25, p[1] - 3, 2 * (p[2] - 12) };
        const bool within =
          std::abs(rest[0]) < 30 && rest[1] > 0 && rest[1] < 50 && std::abs(rest[2]) < 20;
        const float* by = &vectors[3 * ((static_cast<std::size_t>(k) * size[1] + j) * size[0] + i)];
        if (within)
        {
          ++inside;
          // Floats, and decimal strings of ten digits.
          ASSERT_LT(Norm(p + Vector3{ by[0], by[1], by[2] } - rest), 1e-4);
        }
      }
    }
  }
  EXPECT_GT(inside, 1000);
  // Its frames of reference: the new series', and the MRI's.
  const std::string slice = this->Out("mri/00001.dcm");
  ExpectValidDicom(slice);
  EXPECT_EQ(DicomTextOf(this->Out("registration.dcm"), 0x20, 0x52), DicomTextOf(slice, 0x20, 0x52));
  EXPECT_NE(DicomTextOf(slice, 0x20, 0x52), this->MriFrame);
  EXPECT_EQ(DicomTextOf(slice, 0x20, 0xd), this->Identity.StudyInstanceUid);
  EXPECT_EQ(DicomTextOf(slice, 0x10, 0x20), "P-17");
  EXPECT_THAT(DicomTextOf(slice, 8, 0x103e), HasSubstr("MRI between the plates: t1 axial"));
  // The value that the MRI has where the tissue came from; rounded in both.
  const IntensityVolume image = ReadIntensityVolume(this->Out("mri"));
  const Vector3 place{ 5, 30, 11 };
  EXPECT_NEAR(image.ValueAt(place).value(), MriAt({ 4, 27, -2 }), 1.5);
}

TEST_F(ResultObjectsOf, TheMriMayBeOneOfTheVolumesOfAFolder)
{
  IntensityVolume other;
  other.Size = { 20, 16, 8 };
  other.Spacing = { 3, 3, 3 };
  other.Voxels.assign(20 * 16 * 8, 5);
  DicomHeader header;
  header.Identity = this->Identity;
  header.FrameOfReferenceUid = this->MriFrame;
  header.SeriesDescription = "t2 axial";
  std::vector<std::string> paths;
  for (int slice = 0; slice < 8; ++slice)
  {
    paths.push_back(this->MriPath() + "/t2-" + std::to_string(slice) + ".dcm");
  }
  WriteMrSeries(other, header, paths);
  this->Objects.Mri = this->MriPath();
  this->Objects.Points = { { 8, 20, 0 } };
  EXPECT_THAT(RefusalOf([&] { this->Write(); }),
    AllOf(HasSubstr("expected one volume, found 2"),
      HasSubstr("'t2 axial' (8 slices of 20 x 16)")));
  const std::vector<StudySeries> series = ReadStudy(this->MriPath()).Series;
  const auto t1 = std::find_if(series.begin(), series.end(),
    [](const StudySeries& one) { return one.Description.starts_with("t1 axial"); });
  this->Objects.MriSeries = static_cast<int>(t1 - series.begin()) + 1;
  this->Write();
  EXPECT_THAT(DicomTextOf(this->Out("mri/00001.dcm"), 8, 0x103e), HasSubstr("plates: t1 axial"));
}

TEST_F(ResultObjectsOf, ALesionAndWhereItMayBeAreSegments)
{
  this->Objects.Lesions = ReadLabelVolume(this->Folder.File("lesion.nrrd"));
  try
  {
    this->Write();
  }
  catch (const Error& error)
  {
    if (std::string(error.what()).find("ulkan") != std::string::npos)
    {
      GTEST_SKIP() << error.what();
    }
    throw;
  }
  ExpectValidDicom(this->Out("lesions.dcm"));
  const gdcm::DataSet data = DataOf(this->Out("lesions.dcm"));
  const auto segments = data.GetDataElement(gdcm::Tag(0x62, 2)).GetValueAsSQ();
  ASSERT_GE(segments->GetNumberOfItems(), 1U);
  const auto bits = NumbersOf<unsigned char>(data, { 0x7fe0, 0x10 });
  const auto count = [&](std::size_t frame)
  {
    std::size_t sum = 0;
    for (std::size_t pixel = 30 * 50 * frame; pixel < 30 * 50 * (frame + 1); ++pixel)
    {
      sum += bits.at(pixel / 8) >> pixel % 8 & 1;
    }
    return sum;
  };
  // 10 x 8 mm on pixels of 2 mm, to a pixel on each side.
  EXPECT_GE(count(0), 3U * 3U);
  EXPECT_LE(count(0), 7U * 6U);
  ExpectValidDicom(this->Out("presentation.dcm"));
  ExpectValidDicom(this->Out("report.dcm"));
}

TEST_F(ResultObjectsOf, RefusesWhatBelongsToAnother)
{
  this->Objects.Points = { { 500, 0, 0 } };
  EXPECT_THAT(RefusalOf([&] { this->Write(); }), HasSubstr("expected a place in the breast"));
  this->Objects.Points = { { 8, 20, 0 } };
  this->Objects.Mri = this->MriPath();
  this->Identity.PatientId = "P-18";
  this->WriteRealMammogram();
  EXPECT_THAT(RefusalOf([&] { this->Write(); }),
    HasSubstr("expected the MRI of the mammogram's patient, 'P-18', found that of 'P-17'"));
}
}
