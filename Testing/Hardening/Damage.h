// SPDX-License-Identifier: Apache-2.0
// Damage to files, repeatable by a seed.
#ifndef mammoray_Testing_Damage_h
#define mammoray_Testing_Damage_h

#include <cstdint>
#include <random>
#include <string>

namespace mammoray::hardening
{
/// One to eight changes: bits, bytes, integers of the sizes that headers have, numbers in text,
/// pieces cut out, doubled, exchanged, put in; the end cut off. Half of them in the first
/// kilobyte, where headers are.
std::string Damage(const std::string& bytes, std::mt19937_64& random);

/// The number of integer elements (US) of a DICOM image's pixels times the values tried for each,
/// and the file with one of them, explicit little endian; empty where the file lacks the element.
inline constexpr int NumberOfDicomIntegers = 8 * 19;
std::string WithDicomInteger(const std::string& bytes, int which);
}

#endif
