// SPDX-License-Identifier: GPL-3.0-or-later
// ISO 19157-2:2016, the XML of ISO 19157. Every measure has its own report: the value, and where a requirement judges it the verdict.
#include <cmath>
#include <cstdio>

#include "report/html.h"
#include "stages/adapters/quality/quality_facts.h"

namespace swath::stages {
namespace {

constexpr const char* specification = "USGS Lidar Base Specification 2025 rev. A";

std::string element(const std::string& name, const std::string& inside) { return "<" + name + ">" + inside + "</" + name + ">"; }
std::string characters(const std::string& text) { return element("gco:CharacterString", report::escaped(text)); }

/// One measure of quality, of a kind as ISO 19157 names it.
struct Measure {
  std::string kind, name, description, unit;
  std::optional<double> value;
  const quality::Requirement* judged_by = nullptr;
};

std::string unit_of(const std::string& unit) {
  if (unit.empty()) return {};
  const std::string id = unit == "1/m2" ? "per_m2" : unit;
  return element("mdq:valueUnit", "<gml:UnitDefinition gml:id=\"unit_" + id + "_NUMBER\"><gml:identifier codeSpace=\"UCUM\">" +
                                      report::escaped(unit) + "</gml:identifier></gml:UnitDefinition>");
}

std::string quantity(const Measure& m, int number) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", *m.value);
  std::string unit = unit_of(m.unit);
  if (const size_t at = unit.find("NUMBER"); at != std::string::npos) unit.replace(at, 6, std::to_string(number));
  return element("mdq:result", element("mdq:DQ_QuantitativeResult", element("mdq:value", element("gco:Record", text)) + unit));
}

std::string conformance(const quality::Requirement& r, const std::string& level) {
  char text[80];
  std::snprintf(text, sizeof text, "%s %.6g %s", r.is_least ? "at least" : "at most", r.limit, r.unit.c_str());
  const std::string title = r.is_stated ? "limits stated for this survey" : std::string(specification) + ", " + level;
  return element("mdq:result", element("mdq:DQ_ConformanceResult",
                                       element("mdq:specification", element("cit:CI_Citation", element("cit:title", characters(title)))) +
                                           element("mdq:explanation", characters(r.what + ": " + text)) +
                                           element("mdq:pass", element("gco:Boolean", r.is_met() ? "true" : "false"))));
}

const quality::Requirement* requirement_of(const QualityFacts& f, const std::string& begins) {
  for (const quality::Requirement& r : f.requirements)
    if (r.what.find(begins) != std::string::npos) return &r;
  return nullptr;
}

std::vector<Measure> measures_in(const QualityFacts& f) {
  std::vector<Measure> out;
  const auto add = [&](const char* kind, const char* name, const char* about, const char* unit, std::optional<double> value,
                       const char* judged = "") {
    if (value) out.push_back({kind, name, about, unit, value, *judged ? requirement_of(f, judged) : nullptr});
  };
  const char *complete = "DQ_CompletenessOmission", *absolute = "DQ_AbsoluteExternalPositionalAccuracy",
             *relative = "DQ_RelativeInternalPositionalAccuracy", *gridded = "DQ_GriddedDataPositionalAccuracy";
  add(complete, "nominal pulse density", "First returns of all lines per square metre.", "1/m2", f.density.known("density"), "(ANPD)");
  add(complete, "nominal pulse spacing", "1 / sqrt of the density.", "m", f.density.known("spacing_m"), "(ANPS)");
  add(complete, "spatial distribution", "Share of cells of twice the pulse spacing with a first return.", "", f.swath.known("even"),
      "2 ANPS");
  add(complete, "area of data voids", "Areas of (4 ANPS)^2 or more without a first return, apart from water.", "m2",
      f.swath.known("void_m2"), "voids");
  add(relative, "intraswath scatter", "Scatter of one line about planes on its smoothest ground.", "m", f.swath.known("hard_m"),
      "(intraswath)");
  add(relative, "interswath difference", "Difference of overlapping lines on smooth level ground, rms.", "m",
      f.swath.known("overlap_rms_m"), "(interswath)");
  add(absolute, "non-vegetated vertical accuracy", "RMSE at open check points with their own error.", "m", f.points.known("nva_m"),
      "(NVA)");
  add(absolute, "vegetated vertical accuracy", "RMSE at vegetated check points with their own error.", "m", f.points.known("vva_m"));
  add(absolute, "vegetated vertical accuracy, 95 %", "95 % of the absolute errors at vegetated check points are smaller.", "m",
      f.points.known("vva_95_m"), "(VVA)");
  add(absolute, "horizontal accuracy", "Radial RMSE of roofs with the targets' own error.", "m",
      f.points.table("planimetry").known("rmse_with_targets_m"));
  add(gridded, "difference from a reference model", "Terrain model less reference, rms.", "m", f.surface.known("rms_m"));
  return out;
}

}  // namespace

std::string quality_xml(const QualityFacts& f) {
  std::string out =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<mdq:DQ_DataQuality xmlns:mdq=\"http://standards.iso.org/iso/19157/-2/mdq/1.0\" "
      "xmlns:mcc=\"http://standards.iso.org/iso/19115/-3/mcc/1.0\"\n"
      "  xmlns:cit=\"http://standards.iso.org/iso/19115/-3/cit/1.0\" xmlns:gco=\"http://standards.iso.org/iso/19115/-3/gco/1.0\"\n"
      "  xmlns:gml=\"http://www.opengis.net/gml/3.2\">\n"
      "<mdq:scope><mcc:MD_Scope><mcc:level><mcc:MD_ScopeCode "
      "codeList=\"http://standards.iso.org/iso/19115/resources/Codelists/cat/codelists.xml#MD_ScopeCode\" "
      "codeListValue=\"dataset\">dataset</mcc:MD_ScopeCode></mcc:level><mcc:levelDescription><mcc:MD_ScopeDescription>" +
      element("mcc:dataset", characters(f.survey)) + "</mcc:MD_ScopeDescription></mcc:levelDescription></mcc:MD_Scope></mdq:scope>\n";
  int number = 0;
  for (const Measure& m : measures_in(f)) {
    const std::string reference =
        element("mdq:nameOfMeasure", characters(m.name)) + element("mdq:measureDescription", characters(m.description));
    std::string inside = element("mdq:measure", element("mdq:DQ_MeasureReference", reference)) + quantity(m, ++number);
    if (m.judged_by) inside += conformance(*m.judged_by, f.level);
    out += element("mdq:report", element("mdq:" + m.kind, inside)) + "\n";
  }
  return out + "</mdq:DQ_DataQuality>\n";
}

}  // namespace swath::stages
