// SPDX-License-Identifier: Apache-2.0
#include "Private/SeriesWords.h"

#include "Private/HeaderWords.h"

#include <map>

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

// NOLINTNEXTLINE(readability-function-size): a table, one row per word.
const std::vector<SeriesWord>& SeriesVocabulary()
{
  using M = SeriesMeaning;
  static const std::vector<SeriesWord> rows{
    { M::Projection, "", "\\w*mips?", "t1_sub_MIP" },
    { M::Projection, "", "mip\\w*", "MIPsag" },
    { M::Projection, "en", "proj\\w*", "Projection" },

    { M::Subtraction, "", "subs?\\d*", "SUB2" },
    { M::Subtraction, "en", "subtr\\w*", "Subtraction" },
    { M::Subtraction, "it", "sottr\\w*", "Sottrazione" },
    { M::Subtraction, "es", "sustr\\w*", "Sustracci\xc3\xb3n" },
    { M::Subtraction, "es", "resta", "Resta" },
    { M::Subtraction, "", "ph ?\\d+ ph ?\\d+", "Ph2-Ph1" },
    { M::Subtraction, "en", "phase ?\\d+ phase ?\\d+", "phase 3 - phase 1" },
    { M::Subtraction, "", "dyn ?\\d+ dyn ?\\d+", "dyn3-dyn1" },
    { M::Subtraction, "en", "post ?\\d* pre", "post2-pre" },

    { M::Localizer, "", "locs?", "3-plane loc" },
    { M::Localizer, "en", "localiz\\w*", "Localizer" },
    { M::Localizer, "en", "localis\\w*", "localiser" },
    { M::Localizer, "de", "lokali\\w*", "Lokalizer" },
    { M::Localizer, "en", "scouts?", "Scout" },
    { M::Localizer, "en", "survey\\w*", "Survey_BH" },
    { M::Localizer, "", "surv", "SURV" },
    { M::Localizer, "fr", "reperage", "Rep\xc3\xa9rage" },
    { M::Localizer, "en", "3 ?plane\\w*", "3-Plane" },
    { M::Localizer, "", "3 ?pl", "3Pl T2" },

    { M::Calibration, "", "cal", "Cal Breast" },
    { M::Calibration, "en", "calib\\w*", "Calibration" },
    { M::Calibration, "", "asset", "ASSET" },
    { M::Calibration, "", "shim\\w*", "Shimming" },
    { M::Calibration, "", "b1 ?map\\w*", "B1-Map" },
    { M::Calibration, "", "prescan", "Prescan" },
    { M::Calibration, "", "smartbrain", "SmartBrain" },
    { M::Calibration, "", "coilsurvey", "CoilSurvey" },
    { M::Calibration, "", "ref", "Ref_Breast" },

    { M::Diffusion, "", "dwi\\w*", "DWI_b800" },
    { M::Diffusion, "", "dwibs", "DWIBS" },
    { M::Diffusion, "", "diff", "ax diff" },
    { M::Diffusion, "en", "diffusion\\w*", "Diffusion" },
    { M::Diffusion, "", "e?adc\\w*", "eADC map" },
    { M::Diffusion, "", "dti", "DTI" },
    { M::Diffusion, "", "ivim", "IVIM" },
    { M::Diffusion, "", "trace\\w*", "TRACEW" },
    { M::Diffusion, "", "ep2d\\w*", "ep2d_tra" },
    { M::Diffusion, "", "ep 2d\\w*", "ep_2d" },
    { M::Diffusion, "", "resolve", "RESOLVE" },
    { M::Diffusion, "", "b\\d{2,4}\\w*", "b800" },

    { M::ComputedMap, "en", "maps?", "T2 Map" },
    { M::ComputedMap, "", "t1map\\w*", "T1Map" },
    { M::ComputedMap, "", "t2map\\w*", "T2Mapping" },
    { M::ComputedMap, "en", "mapping", "T1 mapping" },
    { M::ComputedMap, "en", "wash ?in", "Wash-in" },
    { M::ComputedMap, "en", "wash ?out", "WashOut" },
    { M::ComputedMap, "", "ttp", "TTP" },
    { M::ComputedMap, "", "pei", "PEI" },
    { M::ComputedMap, "", "iauc", "iAUC" },
    { M::ComputedMap, "", "ktrans", "Ktrans" },
    { M::ComputedMap, "en", "kinetic\\w*", "Kinetics" },
    { M::ComputedMap, "", "perf\\w*", "Perfusion" },
    { M::ComputedMap, "en", "field ?map\\w*", "Field Map" },
    { M::ComputedMap, "en", "colou?r\\w*", "Colour" },
    { M::ComputedMap, "", "cad", "CAD" },
    { M::ComputedMap, "", "t2 ?star", "T2-Star" },

    { M::Reformat, "", "mprs?", "MPR" },
    { M::Reformat, "", "mpr\\w*", "MPRcor" },
    { M::Reformat, "en", "reformat\\w*", "Reformatted" },

    { M::PhaseImage, "en", "phase ?image\\w*", "Phase Images" },
    { M::PhaseImage, "", "pha", "t1_PHA" },

    { M::Spectrum, "", "spectro\\w*", "Spectroscopy" },
    { M::Spectrum, "", "mrs", "MRS" },
    { M::Spectrum, "", "press", "PRESS" },
    { M::Spectrum, "", "svs", "SVS" },

    { M::WaterImage, "en", "water(?= )", "WATER: Ax VIBRANT" },
    { M::FatImage, "en", "fat only", "Fat only" },
    { M::InPhaseImage, "en", "inphase", "InPhase" },
    { M::InPhaseImage, "en", "in phase", "In Phase" },
    { M::OutOfPhaseImage, "en", "outphase", "OutPhase" },
    { M::OutOfPhaseImage, "en", "out phase", "Out Phase" },
    { M::OutOfPhaseImage, "", "opp phase", "opp-phase" },

    { M::DixonTechnique, "", "m?dixon\\w*", "mDIXON" },
    { M::DixonTechnique, "", "dix", "t1_dix" },
    { M::DixonTechnique, "", "vibedix\\w*", "VibeDix" },
    { M::DixonTechnique, "", "\\w*flex", "Ax LAVA-Flex" },
    { M::DixonTechnique, "", "ideal", "IDEAL" },
    { M::DixonWater, "", "w", "t1_vibe_dixon_tra_W" },
    { M::DixonWater, "en", "water", "Dixon water" },
    { M::DixonFat, "", "f", "t1_vibe_dixon_tra_F" },
    { M::DixonFat, "en", "fat(?! sat| sup)", "Dixon fat" },
    { M::DixonInPhase, "", "in", "t1_dixon_in" },
    { M::DixonInPhase, "", "ip", "dixon IP" },
    { M::DixonInPhase, "en", "inphase", "Dixon InPhase" },
    { M::DixonInPhase, "en", "in phase", "Dixon in-phase" },
    { M::DixonOutOfPhase, "", "opp", "t1_dixon_opp" },
    { M::DixonOutOfPhase, "", "op", "dixon OP" },
    { M::DixonOutOfPhase, "", "out", "dixon out" },
    { M::DixonOutOfPhase, "en", "outphase", "Dixon OutPhase" },
    { M::DixonOutOfPhase, "en", "out phase", "Dixon out-phase" },
    { M::DixonOutOfPhase, "en", "opposed", "Dixon opposed" },

    { M::FatSuppressed, "", "\\w*fs", "t1_tse_fs" },
    { M::FatSuppressed, "en", "fat ?sat\\w*", "T1 fat-sat" },
    { M::FatSuppressed, "en", "fat ?sup\\w*", "fat suppressed" },
    { M::FatSuppressed, "", "fatsep\\w*", "FatSep" },
    { M::FatSuppressed, "", "spair\\w*", "t1_spair" },
    { M::FatSuppressed, "", "spir\\w*", "SPIR" },
    { M::FatSuppressed, "", "special", "SPECIAL" },
    { M::FatSuppressed, "", "proset", "ProSet" },
    { M::FatSuppressed, "", "chemsat", "CHEMSAT" },
    { M::FatSuppressed, "", "we", "fl3d_we" },
    { M::FatSuppressed, "en", "water exc\\w*", "water excitation" },
    { M::FatSuppressed, "", "waterexc\\w*", "WaterExc" },
    { M::FatSuppressed, "", "vibrant", "VIBRANT" },
    { M::FatSuppressed, "", "e?thrive\\w*", "eTHRIVE" },
    { M::FatSuppressed, "", "bliss", "BLISS" },
    { M::FatSuppressed, "", "stir", "STIR" },
    { M::FatSuppressed, "", "tirm", "TIRM" },
    { M::FatSuppressed, "it", "supg\\w*", "SupGrasso" },
    { M::FatSuppressed, "de", "fett ?s\\w*", "Fetts\xc3\xa4ttigung" },

    { M::NotFatSuppressed, "en", "(?:non?|w o|wo|without) ?<fat>", "T1 without fat sat" },
    { M::NotFatSuppressed, "de", "ohne ?<fat>", "t1 ohne FS" },
    { M::NotFatSuppressed, "fr", "sans ?<fat>", "T1 sans FS" },
    { M::NotFatSuppressed, "es", "sin ?<fat>", "T1 sin FatSat" },
    { M::NotFatSuppressed, "pt", "sem ?<fat>", "T1 sem fat" },
    { M::NotFatSuppressed, "it", "senza ?<fat>", "T1 senza FS" },
    { M::NotFatSuppressed, "", "n?ofs", "t1_nofs" },
    { M::NotFatSuppressed, "", "nfs", "T1 NFS" },
    { M::NotFatSuppressed, "", "nonfs", "T1 NonFS" },
    { M::NotFatSuppressed, "", "wofs", "T1 woFS" },

    { M::InversionRecovery, "", "stir", "STIR" },
    { M::InversionRecovery, "", "tirm\\w*", "tirm_tra" },
    { M::InversionRecovery, "", "\\w+stir", "t2stir" },
    { M::InversionRecovery, "", "flair", "FLAIR" },

    { M::SteadyState, "", "trufi\\w*", "trufi_loc" },
    { M::SteadyState, "", "true ?fisp\\w*", "True FISP" },
    { M::SteadyState, "", "fiesta\\w*", "FIESTA" },
    { M::SteadyState, "", "b ?ffe", "B-FFE" },
    { M::SteadyState, "", "btfe", "BTFE" },
    { M::SteadyState, "en", "balanced", "balanced" },
    { M::SteadyState, "", "ciss", "CISS" },

    { M::NamedWeighting, "", "(?:ax|sag|cor|tra)?t[12]\\w*", "AxT2 TSE" },
    { M::NamedWeighting, "", "pd\\w*", "PDw" },
    { M::NamedWeighting, "", "proton\\w*", "Proton density" },

    { M::T1Sequence, "", "\\w*vibe\\w*", "cVIBE" },
    { M::T1Sequence, "", "vibrant\\w*", "VIBRANT-XV" },
    { M::T1Sequence, "", "e?thrive\\w*", "eTHRIVE" },
    { M::T1Sequence, "", "\\w*flash\\w*", "flash3d" },
    { M::T1Sequence, "", "fl3d\\w*", "fl3d_tra" },
    { M::T1Sequence, "", "lava\\w*", "LAVA" },
    { M::T1Sequence, "", "bliss", "BLISS" },
    { M::T1Sequence, "", "f?spgr\\w*", "FSPGR" },
    { M::T1Sequence, "", "dyn\\w*", "Dynamic" },

    { M::BeforeContrast, "", "pre ?c\\w*", "T1 pre contrast" },
    { M::BeforeContrast, "", "pre ?g\\w*", "t1_pre_gd" },
    { M::BeforeContrast, "de", "pre ?km", "t1 tra pre KM" },
    { M::BeforeContrast, "", "pre", "T1 pre" },
    { M::BeforeContrast, "fr", "nati[fv]\\w*", "T1 native" },
    { M::BeforeContrast, "de", "nativ", "T1 nativ" },
    { M::BeforeContrast, "en", "unenhanced", "T1 unenhanced" },
    { M::BeforeContrast, "it", "basale?", "T1 basale" },
    { M::BeforeContrast, "en", "non ?contrast", "T1 non contrast" },
    { M::BeforeContrast, "", "nonc", "T1 NonC" },
    { M::BeforeContrast, "en", "(?:w o|wo|without) ?(?:iv )?<agent>", "T1 without IV contrast" },
    { M::BeforeContrast, "de", "(?:ohne|vor) ?(?:iv )?<agent>", "t1 ohne Kontrastmittel" },
    { M::BeforeContrast, "fr", "(?:sans|avant) ?(?:iv )?<agent>", "T1 avant injection" },
    { M::BeforeContrast, "es", "sin ?(?:iv )?<agent>", "T1 sin contraste" },
    { M::BeforeContrast, "pt", "sem ?(?:iv )?<agent>", "T1 sem contraste" },
    { M::BeforeContrast, "it", "senza ?(?:iv )?<agent>", "T1 senza mdc" },

    { M::AfterContrast, "", "post\\w*", "T1 postgad" },
    { M::AfterContrast, "", "gad\\w*", "T1 Gadovist" },
    { M::AfterContrast, "", "gd", "T1 Gd" },
    { M::AfterContrast, "", "\\+ ?c\\w*", "T1 +C" },
    { M::AfterContrast, "", "c\\+", "T1 C+" },
    { M::AfterContrast, "de", "(?:mit|nach) ?km", "t1 nach KM" },
    { M::AfterContrast, "de", "km", "t1 KM" },
    { M::AfterContrast, "en", "contrast", "T1 contrast" },
    { M::AfterContrast, "de", "kontrast\\w*", "t1 nach Kontrastmittel" },
    { M::AfterContrast, "en", "delay\\w*", "T1 delayed" },
    { M::AfterContrast, "en", "late", "T1 late" },
    { M::AfterContrast, "de", "spae?t(?:e\\w*|phase\\w*)?", "t1 Sp\xc3\xa4tphase" },
    { M::AfterContrast, "fr", "tardi\\w*", "T1 tardif" },
    { M::AfterContrast, "", "dotarem", "T1 Dotarem" },
    { M::AfterContrast, "", "magnevist", "T1 Magnevist" },
    { M::AfterContrast, "", "prohance", "T1 ProHance" },
    { M::AfterContrast, "", "multihance", "T1 MultiHance" },
    { M::AfterContrast, "en", "\\d(?:st|nd|rd|th) pass", "T1 2nd pass" },
    { M::AfterContrast, "en", "(?:with|after) ?<given>", "T1 with contrast" },
    { M::AfterContrast, "fr", "(?:avec|apres) ?<given>", "T1 apr\xc3\xa8s injection" },
    { M::AfterContrast, "es", "con ?<given>", "T1 con contraste" },
    { M::AfterContrast, "pt", "com ?<given>", "T1 com contraste" },

    { M::NoAgent, "en", "no", "NO" },
    { M::NoAgent, "en", "none", "None" },
    { M::NoAgent, "", "n", "N" },
    { M::NoAgent, "", "nil", "nil" },
    { M::NoAgent, "de", "nein", "nein" },
    { M::NoAgent, "", "0", "0" },
    { M::NoAgent, "en", "without", "without" },
    { M::NoAgent, "fr", "non", "non" },
  };
  return rows;
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

std::string PatternOf(const SeriesWord& row)
{
  std::string pattern = row.Pattern;
  Replace(pattern, "<fat>", "(?:fat ?sat\\w*|fs|fat ?sup\\w*|fat|spair|sat)");
  Replace(pattern, "<agent>", "(?:c|ce|contrast\\w*|kontrast\\w*|gad\\w*|gd|iv|km|mdc|inj\\w*)");
  Replace(pattern, "<given>", "(?:c|contrast\\w*|gad\\w*|inj\\w*|mdc)");
  return pattern;
}

std::string FindMeaning(const std::string& words, SeriesMeaning meaning)
{
  static const std::map<SeriesMeaning, std::string> patterns = []
  {
    std::map<SeriesMeaning, std::string> made;
    for (const SeriesWord& row : SeriesVocabulary())
    {
      std::string& pattern = made[row.Meaning];
      pattern += (pattern.empty() ? "" : "|") + PatternOf(row);
    }
    return made;
  }();
  return FindWords(words, patterns.at(meaning).c_str());
}
}
