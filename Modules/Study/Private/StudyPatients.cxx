// SPDX-License-Identifier: Apache-2.0
#include "Private/HeaderRules.h"
#include "Private/HeaderWords.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/Sha256.h"

#include <filesystem>

namespace mammoray
{
namespace
{
struct Patient
{
  std::string Id;
  std::string Name;
  std::string BirthDate;
  std::string Sex;
  std::size_t Images = 0;
  std::string FirstFile;
};

/// A name or identifier however it is written: a name may have empty parts ("DOE^JANE^^^").
std::string Normalised(const std::string& text)
{
  std::string words = HeaderWords(text);
  if (words.ends_with(' '))
  {
    words.pop_back();
  }
  return words;
}

Patient PatientOf(const DicomHeader& header)
{
  const DicomIdentity& identity = header.Identity;
  const std::string sex = HeaderWords(identity.PatientSex);
  // O: other, and what anonymisation leaves.
  return { Normalised(identity.PatientId), Normalised(identity.PatientName),
    identity.PatientBirthDate, sex == "f" || sex == "m" ? sex : std::string(), 1, header.Path };
}

enum class Relation
{
  Same,
  /// By two of three.
  Likely,
  Other
};

Relation Compare(const Patient& a, const Patient& b)
{
  const auto agree = [](const std::string& x, const std::string& y)
  { return !x.empty() && x == y; };
  const auto differ = [](const std::string& x, const std::string& y)
  { return !x.empty() && !y.empty() && x != y; };
  const bool ids = differ(a.Id, b.Id);
  const bool names = differ(a.Name, b.Name);
  if (differ(a.BirthDate, b.BirthDate) || differ(a.Sex, b.Sex))
  {
    return Relation::Other;
  }
  if (!ids && !names)
  {
    return Relation::Same;
  }
  const bool born = agree(a.BirthDate, b.BirthDate);
  return born && (agree(a.Id, b.Id) || agree(a.Name, b.Name)) ? Relation::Likely : Relation::Other;
}

/// Four hexadecimal digits: enough to tell patients of a folder apart, too few to find anyone by.
std::string NumberOf(const Patient& patient)
{
  return Sha256OfText(patient.Id + '|' + patient.Name + '|' + patient.BirthDate).substr(0, 4);
}

std::string PlaceOf(const Patient& patient, const std::string& folder)
{
  const std::filesystem::path place =
    std::filesystem::path(patient.FirstFile).lexically_relative(folder).parent_path();
  return place.empty() ? std::string(".") : place.string();
}
}

std::vector<std::string> CheckOnePatient(const std::vector<DicomHeader>& images,
  const std::string& folder)
{
  bool likely = false;
  std::vector<Patient> patients;
  for (const DicomHeader& header : images)
  {
    const Patient patient = PatientOf(header);
    Patient* same = nullptr;
    for (Patient& other : patients)
    {
      const Relation relation = Compare(other, patient);
      likely = likely || relation == Relation::Likely;
      same = relation != Relation::Other && !same ? &other : same;
    }
    if (same)
    {
      ++same->Images;
    }
    else
    {
      patients.push_back(patient);
    }
  }
  if (patients.size() > 1)
  {
    std::string found;
    for (std::size_t number = 0; number < patients.size() && number < 4; ++number)
    {
      const Patient& patient = patients[number];
      found += (number > 0 ? ", " : "") + std::to_string(patient.Images) + " images of patient #" +
        NumberOf(patient) + " (first in " + PlaceOf(patient, folder) + ")";
    }
    throw InputError(folder + ": expected the images of one patient, found those of " +
      std::to_string(patients.size()) + ": " + found + (patients.size() > 4 ? ", ..." : ""));
  }
  if (likely)
  {
    return { "the patient has two identifiers or two names in this folder; taken for one by the "
             "other one and the date of birth" };
  }
  return {};
}
}
