// SPDX-License-Identifier: GPL-3.0-or-later
// Areas are cut by the four borders in turn (Sutherland and Hodgman 1974); what this leaves along a border encloses nothing.
#include "terrain/water/breakline_area.h"

#include <cmath>
#include <string>

#include "core/config/units.h"
#include "core/error.h"
#include "core/few.h"

namespace swath::terrain {
namespace {

using core::Area;
using core::Box;
using core::Breakline;
using Eigen::Vector3d;
using Ring = std::vector<Vector3d>;

constexpr const char* outside = "breakline vertices outside the survey's area, left out";

class Cut {
 public:
  Cut(const Area& area, const Vector3d& origin, core::Tally& tally) : area_(area), origin_(origin), tally_(tally) {}

  std::vector<Breakline> lines_of(const Breakline& line) {
    std::vector<Breakline> out;
    for (const Ring& part : line.parts) {
      Ring piece;
      const auto end_piece = [&] {
        if (piece.size() >= 2) {
          out.push_back(line);
          out.back().parts = {piece};
        }
        piece.clear();
      };
      for (const Vector3d& v : part) {
        if (is_possible(line, v) && in_box(v)) {
          piece.push_back(v);
          continue;
        }
        count(outside, line, v);
        end_piece();
      }
      end_piece();
    }
    return out;
  }

  /// Empty where nothing of the outer ring lies within.
  std::vector<Breakline> areas_of(const Breakline& feature) {
    Breakline out = feature;
    out.parts.clear();
    for (const Ring& part : feature.parts) {
      Ring ring = without_single_ones(feature, part);
      bool beyond = false;
      for (const Vector3d& v : ring) beyond = beyond || !in_box(v);
      if (beyond) {
        tally_.count("breakline areas that reach beyond the survey's area, cut at its border", feature.place);
        ring = clipped(std::move(ring));
      }
      if (ring.size() >= 3)
        out.parts.push_back(std::move(ring));
      else if (out.parts.empty())
        return {};
    }
    if (out.parts.empty()) return {};
    return {out};
  }

  void count(const char* what, const Breakline& feature, const Vector3d& v) {
    const auto number = [](double d) { return core::format_number(std::isfinite(d) ? std::round(d * 100.0) / 100.0 : d); };
    const Vector3d at = v + origin_;
    tally_.count(what,
                 feature.place + ": x " + number(at.x()) + ", y " + number(at.y()) + (feature.has_height ? ", z " + number(at.z()) : ""));
  }

 private:
  bool in_box(const Vector3d& v) const {
    const Box& b = area_.box;
    return v.x() >= b.x0 && v.x() <= b.x1 && v.y() >= b.y0 && v.y() <= b.y1;
  }
  bool is_possible(const Breakline& b, const Vector3d& v) const {
    return v.allFinite() && (!b.has_height || area_.has_height(v.z() + origin_.z()));
  }

  Ring without_single_ones(const Breakline& feature, const Ring& ring) {
    Ring possible, out;
    for (const Vector3d& v : ring)
      if (is_possible(feature, v))
        possible.push_back(v);
      else
        count(outside, feature, v);
    const size_t n = possible.size();
    for (size_t k = 0; k < n; ++k) {
      const bool single = !in_box(possible[k]) && in_box(possible[(k + n - 1) % n]) && in_box(possible[(k + 1) % n]);
      if (single)
        count(outside, feature, possible[k]);
      else
        out.push_back(possible[k]);
    }
    // An area without one of its corners may still be that area; without many it is another.
    if (const size_t lost = ring.size() - out.size(); lost > 1 && lost < ring.size() && !core::are_few(lost, ring.size()))
      throw core::Error(std::to_string(lost) + " of the area's " + std::to_string(ring.size()) +
                            " vertices are not finite or lie alone outside the survey's area",
                        feature.place, "correct the feature, or state [area] in the survey as wide as it is");
    return out;
  }

  Ring clipped(Ring ring) const {
    const Box& b = area_.box;
    ring = clipped(ring, 0, b.x0, 1.0);
    ring = clipped(ring, 0, b.x1, -1.0);
    ring = clipped(ring, 1, b.y0, 1.0);
    return clipped(ring, 1, b.y1, -1.0);
  }
  /// Where side * (coordinate - border) >= 0.
  static Ring clipped(const Ring& ring, int axis, double border, double side) {
    Ring out;
    for (size_t k = 0; k < ring.size(); ++k) {
      const Vector3d &p = ring[k], &q = ring[(k + 1) % ring.size()];
      const double from = side * (p[axis] - border), to = side * (q[axis] - border);
      if (from >= 0.0) out.push_back(p);
      if ((from >= 0.0) == (to >= 0.0)) continue;
      Vector3d at = p + (q - p) * (from / (from - to));
      at[axis] = border;
      out.push_back(at);
    }
    return out;
  }

  const Area& area_;
  const Vector3d& origin_;
  core::Tally& tally_;
};

}  // namespace

void keep_in_area(std::vector<Breakline>& features, const core::Area& area, const Vector3d& origin, core::Tally& tally) {
  Cut cut(area, origin, tally);
  std::vector<Breakline> out;
  for (const Breakline& f : features) {
    std::vector<Breakline> kept = f.is_area() ? cut.areas_of(f) : cut.lines_of(f);
    if (kept.empty()) tally.count("breaklines with nothing in the survey's area, left out", f.place);
    for (Breakline& one : kept) out.push_back(std::move(one));
  }
  if (out.empty() && !features.empty())
    throw core::Error("none of the breaklines lies in the survey's area", features.front().place,
                      "check the CRS and units of the [[breaklines]], or state [area] in the survey");
  features = std::move(out);
}

}  // namespace swath::terrain
