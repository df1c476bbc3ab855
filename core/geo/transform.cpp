// SPDX-License-Identifier: GPL-3.0-or-later
// Transformations between coordinate reference systems through PROJ's C interface (core/geo/crs.h).
#include <proj_experimental.h>  // proj_create_geographic_crs_from_datum

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/error.h"
#include "core/geo/crs.h"
#include "core/geo/proj_handles.h"

namespace swath::core {

namespace {

// The best EPSG states for any operation to or from WGS 84. A missing grid whose operation states no better than this cannot be
// distinguished from the vagueness of WGS 84 itself (ensemble accuracy 2 m), so its absence is no reason to refuse.
constexpr double finest_stated_accuracy = 1.0;

std::string shown(const Crs& crs) {
  const CrsFacts& s = crs.facts();
  return "\"" + (s.name.rfind("unknown", 0) == 0 ? short_form(s.definition) : s.name) + "\"";
}

// Heights above a geoid or level and heights of an unknown system have no relation: none is invented.
void hold_heights(const Crs& from, const Crs& to, const std::string& what) {
  const Heights a = from.heights(), b = to.heights();
  if ((a == Heights::unknown) == (b == Heights::unknown) || (a != Heights::vertical && b != Heights::vertical)) return;
  const Crs &open = a == Heights::unknown ? from : to, &known = a == Heights::unknown ? to : from;
  const std::string plain = open.epsg() ? "EPSG:" + std::to_string(open.epsg()) : std::string("EPSG:32632");
  const std::string level = known.vertical_epsg() ? std::to_string(known.vertical_epsg()) : std::string("5773");
  throw Error("heights cannot be transformed from " + what + ": " + shown(open) + " does not state its height system, the other's is " +
                  known.vertical_name(),
              {},
              "state both: \"" + plain + "+" + level + "\" where its heights are those already, \"" + plain +
                  "+ellipsoidal\" where they are ellipsoidal");
}

struct Candidate {
  double accuracy = 0.0;  // m; infinite where unknown
  double west = -180.0, south = -90.0, east = 180.0, north = 90.0;
  std::string missing;  // what it needs and is not there; empty where it can be used
  std::string hint;

  bool covers(const Candidate& o) const { return west <= o.west && south <= o.south && east >= o.east && north >= o.north; }
};

Candidate candidate_of(PJ_CONTEXT* c, const PJ* operation) {
  Candidate k;
  k.accuracy = proj_coordoperation_get_accuracy(c, operation);
  if (k.accuracy < 0.0) k.accuracy = std::numeric_limits<double>::infinity();
  double west, south, east, north;
  if (proj_get_area_of_use(c, operation, &west, &south, &east, &north, nullptr) && west > -1000.0)
    k.west = west, k.south = south, k.east = east, k.north = north;
  std::vector<std::string> grids;  // missing
  bool has_null = false;           // PROJ's own grid of zeros: no file, and not counted as available
  for (int i = 0; i < proj_coordoperation_get_grid_used_count(c, operation); ++i) {
    const char *name = nullptr, *url = nullptr;
    int available = 0;
    if (!proj_coordoperation_get_grid_used(c, operation, i, &name, nullptr, nullptr, &url, nullptr, nullptr, &available) || available)
      continue;
    const std::string grid = proj_text(name);
    if (grid == "@null" || grid == "null") {
      has_null = true;
      continue;
    }
    grids.push_back(grid);
    k.hint +=
        (k.hint.empty() ? "" : "; ") +
        (proj_text(url).empty() ? "put " + grid +
                                      " into a folder of PROJ_DATA or correct its path; where this PROJ has no such grid, name a GTX or "
                                      "GeoTIFF file of it in PROJ text: +geoidgrids=FILE"
                                : "fetch " + proj_text(url) + " with `projsync --file " + grid + "`, or put it into a folder of PROJ_DATA");
  }
  for (size_t i = 0; i < grids.size(); ++i) k.missing += (i == 0 ? "" : i + 1 == grids.size() ? " and " : ", ") + grids[i];
  if (!grids.empty())
    k.missing = (grids.size() == 1 ? "the grid file " : "the grid files ") + k.missing + ", not installed";
  else if (!has_null && !proj_coordoperation_is_instantiable(c, operation))
    k.missing = "a method that this PROJ does not have", k.hint = "install a newer PROJ";
  return k;
}

std::vector<Candidate> candidates_between(PJ_CONTEXT* c, const PJ* from, const PJ* to) {
  const PjFactory f(proj_create_operation_factory_context(c, nullptr));
  proj_operation_factory_context_set_spatial_criterion(c, f.get(), PROJ_SPATIAL_CRITERION_PARTIAL_INTERSECTION);
  proj_operation_factory_context_set_grid_availability_use(c, f.get(), PROJ_GRID_AVAILABILITY_USED_FOR_SORTING);
  proj_operation_factory_context_set_allow_ballpark_transformations(c, f.get(), 0);
  proj_operation_factory_context_set_use_proj_alternative_grid_names(c, f.get(), 1);
  const PjList list(proj_create_operations(c, from, to, f.get()));
  std::vector<Candidate> out;
  for (int i = 0; list && i < proj_list_get_count(list.get()); ++i) {
    const Pj operation(proj_list_get(c, list.get(), i));
    if (!proj_coordoperation_has_ballpark_transformation(c, operation.get())) out.push_back(candidate_of(c, operation.get()));
  }
  return out;
}

// PROJ would go on with the next best operation where a grid is missing, and with none at all where only the vertical part needs it.
void refuse_where_worse(const std::vector<Candidate>& all, const std::string& what) {
  if (all.empty())
    throw Error(
        "no transformation is known from " + what, {},
        "a datum is not known (PROJ text: give +datum=, not only +ellps=), or PROJ has no shift or geoid between the two: choose the "
        "CRS of the data's own datum");
  const auto here = [](const Candidate& k) { return k.missing.empty(); };
  const bool any = std::any_of(all.begin(), all.end(), here);
  for (const Candidate& k : all) {
    if (here(k)) continue;
    const bool matched = std::any_of(all.begin(), all.end(), [&](const Candidate& o) {
      return here(o) && ((o.accuracy <= k.accuracy && o.covers(k)) || k.accuracy > finest_stated_accuracy);
    });
    if (!any || !matched) throw Error("the transformation from " + what + " needs " + k.missing, {}, k.hint);
  }
}

// The geographic CRS with heights on the datum of a geocentric one.
Pj geographic_of(PJ_CONTEXT* c, const PJ* geocentric) {
  Pj datum(proj_crs_get_datum(c, geocentric));
  if (!datum) datum = Pj(proj_crs_get_datum_ensemble(c, geocentric));
  const Pj axes(proj_create_ellipsoidal_3D_cs(c, PJ_ELLPS3D_LATITUDE_LONGITUDE_HEIGHT, nullptr, 0.0, nullptr, 0.0));
  return Pj(proj_create_geographic_crs_from_datum(c, proj_get_name(geocentric), datum.get(), axes.get()));
}

Pj operation_between(PJ_CONTEXT* c, const PJ* from, const PJ* to, const std::string& what) {
  const char* const options[] = {"ALLOW_BALLPARK=NO", nullptr};
  const Pj found(proj_create_crs_to_crs_from_pj(c, from, to, nullptr, options));
  Pj out(found ? proj_normalize_for_visualization(c, found.get()) : nullptr);
  if (!out) {
    const std::string why = proj_reason(c);
    throw Error("PROJ cannot make the transformation from " + what, {},
                why.empty() ? "PROJ knows no operation between these datums: `projinfo -s FROM -t TO` lists what there is" : why);
  }
  return out;
}

}  // namespace

struct Transform::State {
  ProjContext context;
  std::vector<Pj> steps;  // one after the other
  size_t datum_step = 0;  // the one that changes the datum
  std::string what;
  bool flat = false;  // heights are handed through

  const PJ* used(Pj& holder) const {
    holder = Pj(proj_trans_get_last_used_operation(steps[datum_step].get()));
    return holder ? holder.get() : steps[datum_step].get();
  }
};

Transform::Transform(const Crs& from, const Crs& to) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.context = new_proj_context();
  PJ_CONTEXT* c = s.context.get();
  s.what = shown(from) + " to " + shown(to);
  hold_heights(from, to, s.what);
  s.flat = from.heights() == Heights::unknown && to.heights() == Heights::unknown;
  Pj source = s.flat ? parse_crs(c, from.facts().horizontal_wkt) : three_dimensional(c, from.facts());
  Pj target = s.flat ? parse_crs(c, to.facts().horizontal_wkt) : three_dimensional(c, to.facts());
  const std::vector<Candidate> candidates = candidates_between(c, source.get(), target.get());
  refuse_where_worse(candidates, s.what);
  // Where it has a choice PROJ follows the point's place, and reads geocentric coordinates as if they were longitude and latitude: it is
  // given these. (With no choice it stays one operation: through a null shift in degrees heights would keep the wrong ellipsoid, 0.1 mm.)
  const bool choice = std::count_if(candidates.begin(), candidates.end(), [](const Candidate& k) { return k.missing.empty(); }) > 1;
  Pj last;
  if (choice && from.facts().geocentric) {
    Pj geographic = geographic_of(c, source.get());
    s.steps.push_back(operation_between(c, source.get(), geographic.get(), s.what));
    source = std::move(geographic);
  }
  if (choice && to.facts().geocentric) {
    Pj geographic = geographic_of(c, target.get());
    last = operation_between(c, geographic.get(), target.get(), s.what);
    target = std::move(geographic);
  }
  s.datum_step = s.steps.size();
  s.steps.push_back(operation_between(c, source.get(), target.get(), s.what));
  if (last) s.steps.push_back(std::move(last));
}

Transform::Transform(std::unique_ptr<State> state) : state_(std::move(state)) {}
Transform::~Transform() = default;
Transform::Transform(Transform&&) noexcept = default;
Transform& Transform::operator=(Transform&&) noexcept = default;

Transform Transform::copy() const {
  auto s = std::make_unique<State>();
  s->context = new_proj_context();
  s->what = state_->what;
  s->datum_step = state_->datum_step;
  s->flat = state_->flat;
  for (const Pj& step : state_->steps) {
    s->steps.emplace_back(proj_clone(s->context.get(), step.get()));
    if (!s->steps.back()) throw Error("PROJ cannot copy the transformation from " + s->what);
  }
  return Transform(std::move(s));
}

size_t Transform::apply(double* x, double* y, double* z, size_t n) const {
  constexpr size_t step = sizeof(double);
  const std::vector<double> heights = state_->flat ? std::vector<double>(z, z + n) : std::vector<double>();
  for (const Pj& operation : state_->steps) {
    proj_trans_generic(operation.get(), PJ_FWD, x, step, n, y, step, n, z, step, n, nullptr, 0, 0);
    proj_errno_reset(operation.get());
  }
  if (state_->flat) std::copy(heights.begin(), heights.end(), z);
  size_t failed = 0;
  for (size_t i = 0; i < n; ++i) {
    if (std::isfinite(x[i]) && std::isfinite(y[i]) && std::isfinite(z[i])) continue;
    x[i] = y[i] = z[i] = std::numeric_limits<double>::quiet_NaN();
    ++failed;
  }
  return failed;
}

Eigen::Vector3d Transform::operator()(const Eigen::Vector3d& p) const {
  Eigen::Vector3d q = p;
  if (apply(&q.x(), &q.y(), &q.z(), 1) != 0)
    throw Error("the point " + std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) +
                    " has no result in the transformation from " + state_->what,
                {}, "it lies outside the projection's domain or the grid's area; check the CRSs and the order easting, northing");
  return q;
}

std::string Transform::description() const {
  Pj holder;
  const PJ* used = state_->used(holder);
  return proj_text(proj_pj_info(const_cast<PJ*>(used)).description);  // PROJ's signature lacks the const
}

double Transform::accuracy() const {
  Pj holder;
  const PJ* used = state_->used(holder);
  return proj_coordoperation_get_accuracy(state_->context.get(), used);
}

}  // namespace swath::core
