// SPDX-License-Identifier: Apache-2.0
#include "Private/HeaderWords.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <regex>

namespace mammoray
{
namespace
{
void Replace(std::string& text, const std::string& from, const std::string& to)
{
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
  {
    text.replace(at, from.size(), to);
  }
}

/// The plain letter for one of Latin 1's from 0xc0 on; 0 if there is none.
char PlainLetter(unsigned char latin)
{
  static constexpr char letters[] = "aaaaaaaceeeeiiiidnooooo\0ouuuuy\0s"
                                    "aaaaaaaceeeeiiiidnooooo\0ouuuuy\0y";
  return latin < 0xc0 ? '\0' : letters[latin - 0xc0];
}
}

// NOLINTNEXTLINE(readability-function-size): a table, one row per list of words.
const std::vector<HeaderVocabularyRow>& HeaderVocabulary()
{
  using M = HeaderMeaning;
  static const std::vector<HeaderVocabularyRow> rows{
    { M::Left, "en", "left|lt", "Sag T1 left, Sag T1 LT" },
    { M::Left, "de", "links", "Mamma links" },
    { M::Left, "fr", "gauche", "Sein gauche" },
    { M::Left, "pt", "esquerd\\w*", "Mamografia esquerda" },
    { M::Left, "es", "izquierd\\w*", "Mama izquierda" },
    { M::Left, "it", "sinistr\\w*", "Mammella sinistra" },
    { M::Right, "en", "right|rt", "Sag T1 right, Sag T1 RT" },
    { M::Right, "de", "rechts", "Mamma rechts" },
    { M::Right, "fr", "droit\\w*", "Sein droit" },
    { M::Right, "pt", "direit\\w*", "Mamografia direita" },
    { M::Right, "es", "derech\\w*", "Mama derecha" },
    { M::Right, "it", "destr\\w*", "Mammella destra" },

    { M::Projection, "", "\\w*mips?|mip\\w*", "t1_sub_MIP, MIPsag" },
    { M::Projection, "en", "proj\\w*", "Projection" },

    { M::Subtraction, "", "subs?\\d*|ph ?\\d+ ph ?\\d+|dyn ?\\d+ dyn ?\\d+",
      "SUB2, Ph2-Ph1, dyn3-dyn1" },
    { M::Subtraction, "en", "subtr\\w*|phase ?\\d+ phase ?\\d+|post ?\\d* pre",
      "Subtraction, phase 3 - phase 1, post2-pre" },
    { M::Subtraction, "it", "sottr\\w*", "Sottrazione" },
    { M::Subtraction, "es", "sustr\\w*|resta", "Sustracci\xc3\xb3n, Resta" },

    { M::Localizer, "", "locs?|surv|3 ?pl", "3-plane loc, SURV, 3Pl T2" },
    { M::Localizer, "en", "locali[sz]\\w*|scouts?|survey\\w*|3 ?plane\\w*",
      "localiser, Scout, Survey_BH, 3-Plane" },
    { M::Localizer, "de", "lokali\\w*", "Lokalizer" },
    { M::Localizer, "fr", "reperage", "Rep\xc3\xa9rage" },

    { M::Calibration, "", "cal|asset|shim\\w*|b1 ?map\\w*|prescan|smartbrain|coilsurvey|ref",
      "Cal Breast, ASSET, Shimming, B1-Map, Prescan, SmartBrain, CoilSurvey, Ref_Breast" },
    { M::Calibration, "en", "calib\\w*", "Calibration" },

    { M::Diffusion, "",
      "dwi\\w*|diff|e?adc\\w*|dti|ivim|trace\\w*|ep ?2d\\w*|resolve|b\\d{2,4}\\w*",
      "DWIBS, ax diff, eADC map, DTI, IVIM, TRACEW, ep2d_tra, RESOLVE, b800" },
    { M::Diffusion, "en", "diffusion\\w*", "Diffusion" },

    { M::ComputedMap, "en",
      "maps?|mapping|wash ?in|wash ?out|kinetic\\w*|field ?map\\w*|colou?r\\w*",
      "T2 Map, T1 mapping, Wash-in, WashOut, Kinetics, Field Map, Colour" },
    { M::ComputedMap, "", "t[12]map\\w*|ttp|pei|iauc|ktrans|perf\\w*|cad|t2 ?star",
      "T2Mapping, TTP, PEI, iAUC, Ktrans, Perfusion, CAD, T2-Star" },

    { M::Reformat, "", "mpr\\w*", "MPRcor" },
    { M::Reformat, "en", "reformat\\w*", "Reformatted" },

    { M::PhaseImage, "en", "phase ?image\\w*", "Phase Images" },
    { M::PhaseImage, "", "pha", "t1_PHA" },

    { M::Spectrum, "", "spectro\\w*|mrs|press|svs", "Spectroscopy, MRS, PRESS, SVS" },

    { M::WaterImage, "en", "water(?= )", "WATER: Ax VIBRANT" },
    { M::FatImage, "en", "fat only", "Fat only" },
    { M::InPhaseImage, "en", "in ?phase", "In Phase" },
    { M::OutOfPhaseImage, "en", "out ?phase|opp phase", "OutPhase, opp-phase" },

    { M::DixonTechnique, "", "m?dixon\\w*|dix|vibedix\\w*|\\w*flex|ideal",
      "mDIXON, t1_dix, VibeDix, Ax LAVA-Flex, IDEAL" },
    { M::DixonWater, "", "w|water", "t1_vibe_dixon_tra_W, Dixon water" },
    { M::DixonFat, "", "f|fat(?! sat| sup)", "t1_vibe_dixon_tra_F, Dixon fat" },
    { M::DixonInPhase, "", "in|ip|in ?phase", "t1_dixon_in, dixon IP, Dixon InPhase" },
    { M::DixonOutOfPhase, "", "opp|op|out|out ?phase|opposed",
      "t1_dixon_opp, dixon OP, dixon out, Dixon OutPhase, Dixon opposed" },

    { M::FatSuppressed, "",
      "\\w*fs|fatsep\\w*|spair\\w*|spir\\w*|special|proset|chemsat|we|waterexc\\w*|vibrant|"
      "e?thrive\\w*|bliss|stir|tirm",
      "t1_tse_fs, FatSep, t1_spair, SPIR, SPECIAL, ProSet, CHEMSAT, fl3d_we, WaterExc, VIBRANT, "
      "eTHRIVE, BLISS, STIR, TIRM" },
    { M::FatSuppressed, "en", "fat ?sat\\w*|fat ?sup\\w*|water exc\\w*",
      "T1 fat-sat, fat suppressed, water excitation" },
    { M::FatSuppressed, "it", "supg\\w*", "SupGrasso" },
    { M::FatSuppressed, "de", "fett ?s\\w*", "Fetts\xc3\xa4ttigung" },

    { M::FatSuppressed, "", "t1w?fs(?:pre|post)\\w*", "T1FSpostGd" },

    { M::NotFatSuppressed, "en", "(?:non?|w o|wo|without) ?<fat>", "T1 without fat sat" },
    { M::NotFatSuppressed, "de", "ohne ?<fat>", "t1 ohne FS" },
    { M::NotFatSuppressed, "fr", "sans ?<fat>", "T1 sans FS" },
    { M::NotFatSuppressed, "es", "sin ?<fat>", "T1 sin FatSat" },
    { M::NotFatSuppressed, "pt", "sem ?<fat>", "T1 sem fat" },
    { M::NotFatSuppressed, "it", "senza ?<fat>", "T1 senza FS" },
    { M::NotFatSuppressed, "", "n?ofs|nfs|nonfs|wofs", "t1_nofs, T1 NFS, T1 NonFS, T1 woFS" },

    { M::InversionRecovery, "", "stir|tirm\\w*|\\w+stir|flair", "STIR, tirm_tra, t2stir, FLAIR" },

    { M::SteadyState, "", "trufi\\w*|true ?fisp\\w*|fiesta\\w*|b ?ffe|btfe|balanced|ciss",
      "trufi_loc, True FISP, FIESTA, B-FFE, BTFE, balanced, CISS" },

    { M::NamedWeighting, "", "(?:ax|sag|cor|tra)?t[12]\\w*|pd\\w*|proton\\w*",
      "AxT2 TSE, PDw, Proton density" },

    { M::T1Sequence, "",
      "\\w*vibe\\w*|vibrant\\w*|e?thrive\\w*|\\w*flash\\w*|fl3d\\w*|lava\\w*|bliss|f?spgr\\w*|"
      "dyn\\w*",
      "cVIBE, VIBRANT-XV, eTHRIVE, flash3d, fl3d_tra, LAVA, BLISS, FSPGR, Dynamic" },

    { M::BothContrasts, "",
      "(?:w|with|mit|avec|con|com|met|med) (?:(?:and|or|und|et|y|e|en|och) )?"
      "(?:w o|wo|without|ohne|sans|sin|sem|senza|zonder|utan)|"
      "(?:w o|wo|without|ohne|sans|sin|sem|senza|zonder|utan) (?:(?:and|or|und|et|y|e|en|och) )?"
      "(?:w|with|mit|avec|con|com|met|med)",
      "T1 W/WO CONTRAST, T1 ohne und mit KM" },

    { M::BeforeContrast, "", "pre ?<agent>|pre(?! ?<treatment>) ?[cg]\\w*",
      "T1 pre mdc, t1_pre_gd" },
    { M::BeforeContrast, "de", "nativ|(?:ohne|vor) ?<agent>|(?:km|kontrastmittel) ?frei",
      "T1 nativ, t1 ohne Kontrastmittel, T1 KM-frei" },
    { M::BeforeContrast, "fr", "nati[fv]\\w*|(?:sans|avant|non) ?<agent>",
      "T1 native, T1 avant injection de gadolinium" },
    { M::BeforeContrast, "en",
      "(?:un|non ?)enhanced|(?:non?|w o|wo|without|before|prior to) ?<agent>",
      "T1 unenhanced, T1 without IV contrast" },
    { M::BeforeContrast, "it", "basale?|(?:senza|prima) ?<agent>", "T1 basale, T1 prima del mdc" },
    { M::BeforeContrast, "es", "(?:sin|antes) ?<agent>", "T1 sin CIV" },
    { M::BeforeContrast, "pt", "sem ?<agent>|s contrast\\w*", "T1 sem contraste, T1 S/ CONTRASTE" },
    { M::BeforeContrast, "nl", "blanco|(?:zonder|voor) ?<agent>", "T1 blanco, T1 zonder contrast" },
    { M::BeforeContrast, "sv", "ut[ae]n ?<agent>", "T1 utan kontrast" },
    { M::BeforeContrast, "", "(?:t1(?:w?fs)?|fs)?pre(?! ?<treatment>)|nonc|mask",
      "T1FSpre, T1 NonC, VIBRANT MASK" },

    { M::AfterContrast, "",
      "(?:t1(?:w?fs)?|fs)?post(?! ?<treatment>|erior)\\w*|gad\\w*|gd|mdc|civ|\\+ "
      "?c\\w*|c\\+|dotarem|magnevist|prohance|multihance",
      "T1 postgad, T1 Gadovist, T1 Gd, T1 mdc, T1 CIV, T1 +C, T1 C+, T1 Dotarem, T1 Magnevist, "
      "T1 ProHance, T1 MultiHance" },
    { M::AfterContrast, "de", "(?:mit|nach) ?<agent>|km|kontrast\\w*|spae?t(?:e\\w*|phase\\w*)?",
      "t1 nach KM, t1 KM, t1 Kontrastmittel, t1 Sp\xc3\xa4tphase" },
    { M::AfterContrast, "en",
      "(?:with|after) ?<agent>|contrast\\w*|delay\\w*|late|\\d(?:st|nd|rd|th) pass",
      "T1 with contrast, T1 contrast, T1 delayed, T1 late, T1 2nd pass" },
    { M::AfterContrast, "fr", "(?:avec|apres) ?<agent>|tardi\\w*|inj\\w*",
      "T1 apr\xc3\xa8s injection, T1 tardif, T1 inject\xc3\xa9" },
    { M::AfterContrast, "es", "(?:con|tras|despues) ?<agent>|iny\\w*",
      "T1 despu\xc3\xa9s de contraste, T1 inyectado" },
    { M::AfterContrast, "pt", "(?:com|pos|apos|depois) ?<agent>", "T1 p\xc3\xb3s contraste" },
    { M::AfterContrast, "it", "dopo ?<agent>", "T1 dopo mdc" },
    { M::AfterContrast, "nl", "(?:na(?!ct?(?= |$))|met) ?<agent>", "T1 na contrast" },

    { M::NoAgent, "en", "no|none|without", "NO, None, without" },
    { M::NoAgent, "", "n|nil|0", "N, nil, 0" },
    { M::NoAgent, "de", "nein", "nein" },
    { M::NoAgent, "fr", "non", "non" },

    { M::LeftMammogram, "", "l|lcc|lmlo", "L CC, LCC ID, LMLO" },
    { M::RightMammogram, "", "r|rcc|rmlo", "R-CC, RCC, RMLO" },
    { M::ContrastMammogram, "en", "recombined|subtracted|subtraction|high energy|he",
      "L CC Recombined, L CC subtracted, Subtraction, High Energy, HE" },
    { M::Biopsy, "en", "stereo\\w*|biops\\w*|scout|wire|specimen|probe",
      "stereotactic, Biopsy, scout, Wire, L Specimen, Probe" },
    { M::Biopsy, "de", "stanz\\w*", "Stanzbiopsie" },
    { M::ImplantDisplaced, "en", "id|implant displaced|eklund|cc ?id|mlo ?id|[lr]ccid|[lr]mloid",
      "LCC ID, implant displaced, Eklund, CCID, MLOID, RCCID, RMLOID" },
    { M::Magnified, "en", "mag|m?magnif\\w*|\\w+mag", "CC mag, Magnification, CCmag" },
    { M::SpotCompression, "en", "spot\\w*|\\w+spot|spt\\w*|cone\\w*",
      "Spot 9cm, CCspot, SPT, Cone" },
    { M::SyntheticMammogram, "", "c view|cview|intelligent 2d|v preview|insight 2d|synth\\w*|s2d",
      "C-View, CView, Intelligent 2D, V-Preview, Insight 2D, Synthetic, S2D" },
  };
  return rows;
}

std::string PatternOf(const HeaderVocabularyRow& row)
{
  std::string pattern = row.Words;
  Replace(pattern, "<fat>", "(?:fat ?sat\\w*|fs|fat ?sup\\w*|fat|spair|sat)");
  // "contrast", "iv contrast", "del medio di contrasto", "injection de gadolinium".
  const std::string agent = "(?:c|ce|contrast\\w*|kontrast\\w*|gad\\w*|gd|iv|civ|km|mdc|pdc|"
                            "in[jy]\\w*|iniez\\w*)";
  const std::string between = "(?:(?:iv|ev|an?|da|de|del|della|dell|dem|der|di|do|du|el|het|il|la|"
                              "le|l|o|of|the|agent|med[iz]o|meio|mezzo|produit) )*";
  Replace(pattern, "<agent>", between + agent + "(?: " + between + agent + ")*");
  // "post-op", "prechemo", "post radiotherapy": before or after something else than contrast.
  Replace(pattern, "<treatment>",
    "(?:op(?:s|er\\w*)?(?= "
    "|$)|surg|chir|quir|cirug|intervent|biop|bx|mastec|lump|quadran|chemo|chim|"
    "quim|nact?(?= |$)|neoadj|treat|tratt?am|tto(?= "
    "|$)|tx|therap|terap|radiot|radiat|radiac|proces|"
    "menop|partum)");
  return pattern;
}

std::string HeaderWords(const std::string& text)
{
  std::string words;
  for (const char letter : text)
  {
    const auto c = static_cast<unsigned char>(letter);
    // Letters beyond ASCII stay as they are.
    const bool kept = std::isalnum(c) != 0 || c >= 0x80 || letter == '+';
    if (kept)
    {
      words.push_back(static_cast<char>(std::tolower(c)));
    }
    else if (!words.empty() && words.back() != ' ')
    {
      words.push_back(' ');
    }
  }
  return words;
}

std::string PlainWords(const std::string& text)
{
  std::string words = HeaderWords(text);
  std::string plain;
  for (std::size_t at = 0; at < words.size(); ++at)
  {
    const auto next = static_cast<unsigned char>(at + 1 < words.size() ? words[at + 1] : 0);
    const auto c = static_cast<unsigned char>(words[at]);
    const bool continues = next >= 0x80 && next < 0xc0; // a letter of several bytes in UTF-8
    const auto latin = static_cast<unsigned char>(c == 0xc3 && continues ? next + 0x40 : c);
    const char letter = continues && c != 0xc3 ? '\0' : PlainLetter(latin);
    plain.push_back(letter != '\0' ? letter : words[at]);
    at += letter != '\0' && continues ? 1 : 0;
  }
  return plain;
}

std::string FindMeaning(const std::string& words, HeaderMeaning meaning)
{
  // Compiled once: that takes longer than all searches.
  static const std::map<HeaderMeaning, std::regex> expressions = []
  {
    std::map<HeaderMeaning, std::string> patterns;
    for (const HeaderVocabularyRow& row : HeaderVocabulary())
    {
      std::string& pattern = patterns[row.Meaning];
      pattern += pattern.empty() ? "" : "|";
      pattern += PatternOf(row);
    }
    std::map<HeaderMeaning, std::regex> made;
    for (const auto& [key, pattern] : patterns)
    {
      made.emplace(key, "(?:^| )(" + pattern + ")(?= |$)");
    }
    return made;
  }();
  std::smatch match;
  return std::regex_search(words, match, expressions.at(meaning)) ? match[1].str() : "";
}

char SideInWords(const std::string& words, bool ofMammogram)
{
  const auto names = [&](HeaderMeaning side, HeaderMeaning sideOfMammogram)
  {
    return !FindMeaning(words, side).empty() ||
      (ofMammogram && !FindMeaning(words, sideOfMammogram).empty());
  };
  const bool left = names(HeaderMeaning::Left, HeaderMeaning::LeftMammogram);
  const bool right = names(HeaderMeaning::Right, HeaderMeaning::RightMammogram);
  return left == right ? '?' : left ? 'L' : 'R';
}

std::string FindValue(const std::vector<std::string>& values,
  std::initializer_list<const char*> wanted)
{
  const auto found = std::find_first_of(values.begin(), values.end(), wanted.begin(), wanted.end());
  return found == values.end() ? std::string() : *found;
}

std::string FindPart(const std::vector<std::string>& values,
  std::initializer_list<const char*> parts)
{
  const auto found = std::find_first_of(values.begin(), values.end(), parts.begin(), parts.end(),
    [](const std::string& value, const char* part)
    { return value.find(part) != std::string::npos; });
  return found == values.end() ? std::string() : *found;
}

FoundKind FindKind(std::span<const ImageKind> kinds, const std::vector<std::string>& imageType,
  const std::string& words)
{
  for (const ImageKind& kind : kinds)
  {
    std::string value = FindValue(imageType, kind.Values);
    value = value.empty() ? FindPart(imageType, kind.Parts) : value;
    if (!value.empty())
    {
      return { kind.Name, "ImageType " + value };
    }
    if (const std::string found = FindMeaning(words, kind.Meaning); !found.empty())
    {
      return { kind.Name, "description '" + found + "'" };
    }
  }
  return {};
}
}
