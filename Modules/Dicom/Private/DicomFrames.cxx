// SPDX-License-Identifier: Apache-2.0
#include "Private/DicomFrames.h"

#include "mammoray/Foundation/Error.h"

namespace mammoray
{
namespace
{
void Add(DcmElement& element, DcmItem& to)
{
  to.insert(static_cast<DcmElement*>(element.clone()), OFTrue);
}

/// Adds copies of what the first items of the groups hold.
void AddGroups(DcmItem& groups, DcmItem& to)
{
  for (unsigned long index = 0; index < groups.card(); ++index)
  {
    const DcmTagKey tag = groups.getElement(index)->getTag();
    // Images that this one was derived from have elements of the same names.
    DcmItem* group = tag == DCM_DerivationImageSequence || tag == DCM_ReferencedImageSequence
      ? nullptr
      : DicomFirstItem(groups, tag);
    for (unsigned long within = 0; group && within < group->card(); ++within)
    {
      if (group->getElement(within)->ident() != EVR_SQ)
      {
        Add(*group->getElement(within), to);
      }
    }
  }
}
}

bool HasResonanceFrames(DcmItem& data)
{
  return DicomText(data, DCM_Modality) == "MR" &&
    data.tagExists(DCM_PerFrameFunctionalGroupsSequence);
}

DicomFrames::DicomFrames(DcmItem& data, const std::string& path)
  : Own(std::make_unique<DcmItem>())
  , Shared(DicomFirstItem(data, DCM_SharedFunctionalGroupsSequence))
{
  data.findAndGetSequence(DCM_PerFrameFunctionalGroupsSequence, this->Groups);
  const double said = DicomNumber(data, DCM_NumberOfFrames).value_or(1);
  const unsigned long found = this->Groups ? this->Groups->card() : 0;
  if (found < 1 || said != static_cast<double>(found))
  {
    throw InputError(path + ": expected functional groups for each of " +
      std::to_string(static_cast<long>(said)) + " frames, found " + std::to_string(found));
  }
  for (unsigned long index = 0; index < data.card(); ++index)
  {
    DcmElement* element = data.getElement(index);
    if (element->ident() != EVR_SQ && element->getTag() != DCM_PixelData)
    {
      Add(*element, *this->Own);
    }
  }
  // A flat data set has one frame.
  this->Own->findAndDeleteElement(DCM_NumberOfFrames);
}

std::unique_ptr<DcmItem> DicomFrames::Flat(std::size_t frame) const
{
  auto flat = std::make_unique<DcmItem>(*this->Own);
  if (this->Shared)
  {
    AddGroups(*this->Shared, *flat);
  }
  AddGroups(*this->Groups->getItem(static_cast<unsigned long>(frame)), *flat);
  return flat;
}
}
