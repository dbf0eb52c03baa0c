// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DicomStructure_h
#define mammoray_DicomStructure_h

#include <string>

namespace mammoray
{
/**
 * What is wrong with the structure of a DICOM file; empty when it is whole: preamble, meta
 * information and every element of the data set within the file, sequences closed. Damage must be
 * found before GDCM reads the file: Debian's build asserts, and so ends the process, on a file that
 * is cut short.
 */
std::string FindDicomDamage(const std::string& path);
}

#endif
