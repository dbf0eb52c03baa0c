// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SpellingSuggestions_h
#define mammoray_SpellingSuggestions_h

#include "mammorayFoundationModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/**
 * The known names that are similar to a mistyped one, nearest first, at most `count`: those that
 * contain it or are contained in it, and those within a Levenshtein distance of a third of its
 * letters (at least one). Case is ignored; a name that differs in it alone is the only one.
 */
MAMMORAYFOUNDATION_EXPORT std::vector<std::string> SpellingSuggestions(const std::string& name,
  const std::vector<std::string>& known, std::size_t count = 5);

/// "did you mean a, b or c?", or "known are a, b, c" if no name is similar; for messages.
MAMMORAYFOUNDATION_EXPORT std::string SpellingHint(const std::string& name,
  const std::vector<std::string>& known);
}

#endif
