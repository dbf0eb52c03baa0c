// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SpellingSuggestions_h
#define mammoray_SpellingSuggestions_h

#include "mammorayFoundationModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/**
 * The known names that a mistyped one may have meant, nearest first, at most `count`: those that
 * hold it or are fixed by it, and those at most a third of its letters (one at least) away by
 * insertions, deletions and replacements (Levenshtein distance). Case is ignored.
 */
MAMMORAYFOUNDATION_EXPORT std::vector<std::string> SpellingSuggestions(const std::string& name,
  const std::vector<std::string>& known, std::size_t count = 5);

/// "did you mean a, b or c?", or "known are a, b, c" where nothing is near; for messages.
MAMMORAYFOUNDATION_EXPORT std::string SpellingHint(const std::string& name,
  const std::vector<std::string>& known);
}

#endif
