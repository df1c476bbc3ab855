// SPDX-License-Identifier: GPL-3.0-or-later
// Source: the kinds of ground of the USGS Lidar Base Specification and ASPRS 2024: bare earth, sand, rock, short grass and urban ground are
// not vegetated; tall grass, crops, brush and forest are. Words that mean both kinds (field) are not known.
#include "quality/cover_words.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace swath::quality {
namespace {

struct CoverWords {
  std::string_view english, words;  ///< words: lower case without accents, each between bars
};

constexpr std::array<CoverWords, 9> cover_words{{
    {"open",
     "|open|open terrain|open ground|open field|non vegetated|nonvegetated|not vegetated|unvegetated|clear"
     "|short grass|low grass|lawn|mowed grass"
     "|offen|offenland|freiflache|freiflaeche|offenes gelande|offenes gelaende|unbewachsen|ohne vegetation|vegetationslos|rasen|kurzrasen"
     "|ouvert|terrain ouvert|degage|sans vegetation|non vegetalise|pelouse|gazon"
     "|abierto|terreno abierto|despejado|sin vegetacion|cesped"
     "|aperto|terreno aperto|campo aperto|senza vegetazione|prato rasato"
     "|open veld|open terrein|onbegroeid|zonder vegetatie|grasmat|"},
    {"bare",
     "|bare|bare earth|bare ground|bare soil|soil|dirt|plowed field|sand|gravel|rock|rocks|rocky|hard surface"
     "|kahl|boden|nackter boden|offener boden|rohboden|kies|schotter|fels|felsen|gestein"
     "|nu|sol nu|terre nue|sable|gravier|roche|rocher|rochers"
     "|suelo|suelo desnudo|desnudo|tierra|arena|grava|roca|rocas"
     "|nudo|suolo nudo|terreno nudo|suolo|sabbia|ghiaia|roccia|rocce"
     "|kaal|kale grond|zand|grind|rots|"},
    {"urban",
     "|urban|built up|builtup|paved|pavement|asphalt|concrete|road|street|parking|parking lot"
     "|bebaut|bebauung|siedlung|stadt|stadtisch|staedtisch|urbanes gebiet|befestigt|versiegelt|asphaltiert|beton|strasse|weg|parkplatz"
     "|urbain|bati|zone urbaine|ville|route|rue|chaussee|asphalte|enrobe|bitume|goudron"
     "|urbano|zona urbana|edificado|construido|asfalto|pavimento|pavimentado|hormigon|carretera|calle|camino"
     "|urbana|area urbana|edificato|costruito|asfaltato|calcestruzzo|strada|parcheggio"
     "|stedelijk|bebouwd|bebouwing|stad|verhard|verharding|asfalt|straat|parkeerplaats|"},
    {"NVA", "|nva|fva|"},
    {"grass",
     "|grass|tall grass|high grass|long grass|weeds|meadow|pasture|grassland"
     "|gras|hohes gras|wiese|weide|grunland|gruenland"
     "|herbe|herbes|hautes herbes|herbe haute|prairie|pre|prairies|paturage"
     "|hierba|hierba alta|hierbas|pasto|pastizal|pradera|prado"
     "|erba|erba alta|prato|prateria|pascolo"
     "|hoog gras|weiland|grasland|"},
    {"crops",
     "|crop|crops|cropland|acker|ackerland|getreide|culture|cultures|cultivo|cultivos|coltivo|coltivato|colture"
     "|akker|akkerland|gewas|gewassen|"},
    {"brush",
     "|brush|brushland|shrub|shrubs|scrub|bush|bushes|low trees|brush and low trees|heath|hedge"
     "|busch|busche|buesche|gebusch|gebuesch|strauch|straucher|straeucher|gestrupp|gestruepp|hecke|heide"
     "|buisson|buissons|broussaille|broussailles|arbuste|arbustes|maquis|garrigue|fourre|haie|lande"
     "|arbusto|arbustos|matorral|maleza|monte bajo|seto"
     "|arbusti|cespuglio|cespugli|arbusteto|macchia|siepe"
     "|struik|struiken|struikgewas|kreupelhout|heg|"},
    {"forest",
     "|forest|forested|wood|woods|woodland|tree|trees|wald|forst|gehoelz|geholz|baum|baume|baeume|laubwald|nadelwald|mischwald|hochwald"
     "|foret|bois|boise|arbre|arbres|bosque|arbolado|arbol|arboles|bosco|boschi|foresta|albero|alberi|bos|woud|boom|bomen|"},
    {"VVA", "|vva|vegetated|vegetation|bewachsen|vegetation dense|vegetalise|vegetacion|vegetazione|begroeid|vegetatie|cva|sva|"},
}};

/// Lower case, accents of Latin-1 letters in UTF-8 taken off, one blank between words.
std::string plain_cover(const std::string& cover) {
  constexpr std::string_view letters = "aaaaaaaceeeeiiiidnooooo ouuuuyty";  // of U+00E0 to U+00FF
  std::string out;
  for (size_t k = 0; k < cover.size(); ++k) {
    const auto c = static_cast<unsigned char>(cover[k]);
    const unsigned char next = k + 1 < cover.size() ? static_cast<unsigned char>(cover[k + 1]) : 0;
    if (c == 0xc3 && next >= 0x80 && next < 0xc0) {
      out += next == 0x9f ? std::string("ss") : std::string(1, letters[next & 0x1f]);
      ++k;
    } else if (c == ' ' || c == '_' || c == '-' || c == '\t') {
      if (!out.empty() && out.back() != ' ') out += ' ';
    } else {
      out += c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : cover[k];
    }
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out;
}

}  // namespace

std::string cover_in_english(const std::string& cover) {
  const std::string plain = plain_cover(cover);
  if (plain.empty() || plain.find('|') != std::string::npos) return {};
  for (const CoverWords& one : cover_words)
    if (one.words.find("|" + plain + "|") != std::string_view::npos) return std::string(one.english);
  return {};
}

bool is_open_cover(const std::string& cover, const std::vector<std::string>& open) {
  const std::string plain = plain_cover(cover), english = plain_cover(cover_in_english(cover));
  return std::any_of(open.begin(), open.end(), [&](const std::string& one) {
    const std::string is_open = plain_cover(one);
    return is_open == plain || (!english.empty() && is_open == english);
  });
}

}  // namespace swath::quality
