// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/ValidRange.h"

#include <cstdio>

namespace mammoray
{
void CheckValidRange(const ValidRange& range, double value, const std::string& where,
  const std::vector<std::string>& remedies)
{
  if (value >= range.Least && value <= range.Most)
  {
    return;
  }
  const bool isThousandth = value >= 1e3 * range.Least && value <= 1e3 * range.Most;
  char text[200];
  std::snprintf(text, sizeof text, ": expected a %s from %g to %g %s, found %g%s%s%s",
    range.Quantity, range.Least, range.Most, range.Unit, value, isThousandth ? " (in " : "",
    isThousandth ? range.Thousandth : "", isThousandth ? "?)" : "");
  char number[32];
  std::snprintf(number, sizeof number, "%g", value);
  throw InputError(where + text, { range.Field, number, remedies });
}

void CheckValidRange(const ValidRange& range, const Vector3& values, const std::string& where,
  const std::vector<std::string>& remedies)
{
  for (const double value : values)
  {
    CheckValidRange(range, value, where, remedies);
  }
}
}
