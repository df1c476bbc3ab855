// SPDX-License-Identifier: GPL-3.0-or-later
// Coordinate reference systems and transformations through PROJ's C interface. PROJ objects are made in a context of their own with the
// log and the network off, and never shared between threads: a Crs keeps only plain facts and its definition.
#include "core/crs.h"

#include <proj.h>
#include <proj_experimental.h>  // proj_crs_promote_to_3D, proj_create_geographic_crs_from_datum

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include "core/error.h"

namespace swath::core {

namespace {

struct ContextEnd {
  void operator()(PJ_CONTEXT* c) const { proj_context_destroy(c); }
};
struct PjEnd {
  void operator()(PJ* p) const { proj_destroy(p); }
};
struct ListEnd {
  void operator()(PJ_OBJ_LIST* l) const { proj_list_destroy(l); }
};
struct FactoryEnd {
  void operator()(PJ_OPERATION_FACTORY_CONTEXT* f) const { proj_operation_factory_context_destroy(f); }
};
using Context = std::unique_ptr<PJ_CONTEXT, ContextEnd>;
using Pj = std::unique_ptr<PJ, PjEnd>;
using List = std::unique_ptr<PJ_OBJ_LIST, ListEnd>;

// The best EPSG states for any operation to or from WGS 84. A missing grid whose operation states no better than this cannot be told from
// the vagueness of WGS 84 itself (ensemble accuracy 2 m), so its absence is no reason to refuse.
constexpr double finest_stated_accuracy = 1.0;

Context new_context() {
  Context c(proj_context_create());
  proj_log_level(c.get(), PJ_LOG_NONE);
  proj_context_set_enable_network(c.get(), 0);
  return c;
}

std::string text(const char* t) { return t ? t : ""; }

std::string short_form(const std::string& definition) { return definition.size() <= 80 ? definition : definition.substr(0, 77) + "..."; }

// Trimmed, "EPSG:a+EPSG:b" as "EPSG:a+b", PROJ text marked as a CRS.
std::string tidy(const std::string& given) {
  constexpr const char* blanks = " \t\r\n";
  std::string d = given.substr(0, given.find('\0'));
  const size_t first = d.find_first_not_of(blanks);
  if (first == std::string::npos) return {};
  d = d.substr(first, d.find_last_not_of(blanks) - first + 1);
  const auto is_epsg = [&](size_t at) {
    return d.size() >= at + 5 &&
           std::equal(d.begin() + at, d.begin() + at + 5, "EPSG:", [](char a, char b) { return std::toupper(a) == b; });
  };
  if (is_epsg(0)) {
    const size_t plus = d.find('+');
    if (plus != std::string::npos && is_epsg(plus + 1)) d.erase(plus + 1, 5);
  } else if ((d.find("+proj=") != std::string::npos || d.find("+init=") != std::string::npos) && d.find("type=crs") == std::string::npos &&
             d.find("+proj=pipeline") == std::string::npos) {
    d += " +type=crs";
  }
  // "@" would make a geoid optional, and heights pass through untouched without it; here a geoid that is named is needed.
  const size_t at = d.find("+geoidgrids=@");
  if (at != std::string::npos) d.erase(at + 12, 1);
  return d;
}

std::string hint_for(const std::string& d) {
  if (!d.empty() && d.find_first_not_of("0123456789") == std::string::npos) return "write the authority too: \"EPSG:" + d + "\"";
  if (d.find('+') != std::string::npos && d.find("+proj") == std::string::npos)
    return "a compound is a two-dimensional CRS and a vertical one, such as \"EPSG:25832+7837\"; look codes up with `projinfo`";
  if (d.find("[") != std::string::npos) return "the WKT is damaged or of a kind PROJ does not read; give an EPSG code instead";
  return "give an EPSG code (\"EPSG:32632\", compound \"EPSG:25832+7837\"), WKT or PROJ text; if every code fails, proj.db is not found: "
         "set "
         "PROJ_DATA to its folder";
}

Pj parse(PJ_CONTEXT* c, const std::string& definition) { return Pj(proj_create(c, definition.c_str())); }

// The CRS inside a bound CRS (one that carries its own shift to WGS 84).
Pj unbound(PJ_CONTEXT* c, Pj crs) {
  while (crs && proj_get_type(crs.get()) == PJ_TYPE_BOUND_CRS) crs = Pj(proj_get_source_crs(c, crs.get()));
  return crs;
}

struct Axis {
  double factor = 1.0;
  std::string unit = "metre";
};

// Axis `index` of a CRS; the metre where it has no such axis.
Axis axis_of(PJ_CONTEXT* c, const PJ* crs, int index) {
  Axis axis;
  const Pj cs(proj_crs_get_coordinate_system(c, crs));
  if (!cs || index >= proj_cs_get_axis_count(c, cs.get())) return axis;
  const char* unit = nullptr;
  if (proj_cs_get_axis_info(c, cs.get(), index, nullptr, nullptr, nullptr, &axis.factor, &unit, nullptr, nullptr)) axis.unit = text(unit);
  return axis;
}

int code_of(const PJ* crs) {
  if (text(proj_get_id_auth_name(crs, 0)) != "EPSG") return 0;
  return std::atoi(text(proj_get_id_code(crs, 0)).c_str());
}

std::string datum_name(PJ_CONTEXT* c, const PJ* crs) {
  Pj datum(proj_crs_get_datum(c, crs));
  if (!datum) datum = Pj(proj_crs_get_datum_ensemble(c, crs));
  return text(proj_get_name(datum ? datum.get() : crs));
}

}  // namespace

struct Crs::State {
  std::string definition, name, wkt, wkt1, vertical_name = "ellipsoidal height";
  int epsg = 0, vertical_epsg = 0;
  bool geographic = false, projected = false, geocentric = false, vertical = false;
  Axis horizontal_axis, vertical_axis;
  bool has_area = false;
  double area[4] = {0, 0, 0, 0};
};

Crs::Crs(const std::string& given) {
  auto s = std::make_shared<State>();
  s->definition = tidy(given);
  const Context context = new_context();
  PJ_CONTEXT* c = context.get();
  if (s->definition.empty()) throw Error("the CRS is empty", {}, hint_for({}));
  const Pj crs = parse(c, s->definition);
  if (!crs) {
    const std::string why = text(proj_context_errno_string(c, proj_context_errno(c)));
    throw Error("PROJ does not know the CRS \"" + short_form(s->definition) + "\"" + (why.empty() ? "" : " (" + why + ")"), {},
                hint_for(s->definition));
  }
  if (!proj_is_crs(crs.get()))
    throw Error("\"" + short_form(s->definition) + "\" is not a coordinate reference system", {}, hint_for(s->definition));

  s->name = text(proj_get_name(crs.get()));
  const char* const one_line[] = {"MULTILINE=NO", nullptr};
  s->wkt = text(proj_as_wkt(c, crs.get(), PJ_WKT2_2019, one_line));
  s->wkt1 = text(proj_as_wkt(c, crs.get(), PJ_WKT1_GDAL, one_line));
  if (s->wkt1.empty()) s->wkt1 = s->wkt;

  Pj horizontal = unbound(c, Pj(proj_clone(c, crs.get())));
  if (proj_get_type(horizontal.get()) == PJ_TYPE_COMPOUND_CRS) {
    const Pj compound = std::move(horizontal);
    horizontal = unbound(c, Pj(proj_crs_get_sub_crs(c, compound.get(), 0)));
    const Pj vertical = unbound(c, Pj(proj_crs_get_sub_crs(c, compound.get(), 1)));
    s->vertical = true;
    s->vertical_epsg = code_of(vertical.get());
    s->vertical_name = datum_name(c, vertical.get());
    s->vertical_axis = axis_of(c, vertical.get(), 0);
  } else {
    s->vertical_axis = axis_of(c, horizontal.get(), 2);
  }
  s->epsg = code_of(horizontal.get());
  const PJ_TYPE type = proj_get_type(horizontal.get());
  s->geographic = type == PJ_TYPE_GEOGRAPHIC_2D_CRS || type == PJ_TYPE_GEOGRAPHIC_3D_CRS;
  s->geocentric = type == PJ_TYPE_GEOCENTRIC_CRS;
  s->projected = type == PJ_TYPE_PROJECTED_CRS;
  if (!s->geographic && !s->geocentric && !s->projected)
    throw Error("\"" + s->name + "\" is neither projected, geographic nor geocentric", {},
                type == PJ_TYPE_VERTICAL_CRS ? "join it to a horizontal CRS: \"EPSG:25832+7837\"" : hint_for(s->definition));
  s->horizontal_axis = axis_of(c, horizontal.get(), 0);
  if (s->geographic) s->horizontal_axis.factor = 0.0;
  double* a = s->area;
  s->has_area = proj_get_area_of_use(c, crs.get(), &a[0], &a[1], &a[2], &a[3], nullptr) && a[0] > -1000.0;
  if (!s->has_area) s->has_area = proj_get_area_of_use(c, horizontal.get(), &a[0], &a[1], &a[2], &a[3], nullptr) && a[0] > -1000.0;
  state_ = std::move(s);
}

namespace {
const Crs::State& of(const Crs& crs) {
  if (crs.empty()) throw Error("a CRS is needed and none is given", {}, "state it: \"EPSG:32632\", \"EPSG:25832+7837\", WKT or PROJ text");
  return *crs.state();
}
}  // namespace

std::string Crs::name() const { return of(*this).name; }
std::string Crs::wkt() const { return of(*this).wkt; }
std::string Crs::wkt1() const { return of(*this).wkt1; }
int Crs::epsg() const { return of(*this).epsg; }
int Crs::vertical_epsg() const { return of(*this).vertical_epsg; }
bool Crs::is_geographic() const { return of(*this).geographic; }
bool Crs::is_projected() const { return of(*this).projected; }
bool Crs::is_geocentric() const { return of(*this).geocentric; }
bool Crs::has_vertical() const { return of(*this).vertical; }
std::string Crs::vertical_name() const { return of(*this).vertical_name; }
double Crs::metres_per_unit() const { return of(*this).horizontal_axis.factor; }
double Crs::vertical_metres_per_unit() const { return of(*this).vertical_axis.factor; }
std::string Crs::unit_name() const { return of(*this).horizontal_axis.unit; }
std::string Crs::vertical_unit_name() const { return of(*this).vertical_axis.unit; }

bool Crs::area_of_use(double& west, double& south, double& east, double& north) const {
  const State& s = of(*this);
  if (!s.has_area) return false;
  west = s.area[0], south = s.area[1], east = s.area[2], north = s.area[3];
  return true;
}

Crs wgs84_ecef() {
  static const Crs crs("EPSG:4978");
  return crs;
}
Crs wgs84_geodetic() {
  static const Crs crs("EPSG:4979");
  return crs;
}

namespace {

// A CRS without a vertical part has ellipsoidal heights in metres: PROJ is told so, or it would drop them.
Pj three_dimensional(PJ_CONTEXT* c, const Crs& crs) {
  Pj plain = parse(c, of(crs).definition);
  if (of(crs).vertical || of(crs).geocentric) return plain;
  Pj promoted(proj_crs_promote_to_3D(c, nullptr, plain.get()));
  return promoted ? std::move(promoted) : std::move(plain);
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
  for (int i = 0; i < proj_coordoperation_get_grid_used_count(c, operation); ++i) {
    const char *name = nullptr, *full = nullptr, *package = nullptr, *url = nullptr;
    int direct = 0, open = 0, available = 0;
    if (!proj_coordoperation_get_grid_used(c, operation, i, &name, &full, &package, &url, &direct, &open, &available) || available)
      continue;
    if (text(name) == "@null" || text(name) == "null") continue;  // PROJ's own grid of zeros
    k.missing += (k.missing.empty() ? "" : ", ") + text(name);
    if (k.hint.empty())
      k.hint = !text(url).empty()
                   ? "fetch it with `projsync --file " + text(name) + "`, or put " + text(url) + " into a folder of PROJ_DATA"
                   : "put the file into a folder of PROJ_DATA, or correct its path in the CRS";
  }
  if (!k.missing.empty())
    k.missing = "the grid file " + k.missing + ", which is not installed";
  else if (!proj_coordoperation_is_instantiable(c, operation))
    k.missing = "a method that this PROJ does not have", k.hint = "install a newer PROJ";
  return k;
}

std::vector<Candidate> candidates_between(PJ_CONTEXT* c, const PJ* from, const PJ* to) {
  const std::unique_ptr<PJ_OPERATION_FACTORY_CONTEXT, FactoryEnd> f(proj_create_operation_factory_context(c, nullptr));
  proj_operation_factory_context_set_spatial_criterion(c, f.get(), PROJ_SPATIAL_CRITERION_PARTIAL_INTERSECTION);
  proj_operation_factory_context_set_grid_availability_use(c, f.get(), PROJ_GRID_AVAILABILITY_USED_FOR_SORTING);
  proj_operation_factory_context_set_allow_ballpark_transformations(c, f.get(), 0);
  proj_operation_factory_context_set_use_proj_alternative_grid_names(c, f.get(), 1);
  const List list(proj_create_operations(c, from, to, f.get()));
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
    throw Error("no transformation is known from " + what, {},
                "the datum of one of them is unknown or unrelated: state CRSs with known datums (PROJ text: +datum=, not only +ellps=)");
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
  if (!out) throw Error("PROJ cannot make the transformation from " + what, {}, text(proj_context_errno_string(c, proj_context_errno(c))));
  return out;
}

}  // namespace

struct Transform::State {
  Context context;
  std::vector<Pj> steps;  // one after the other
  size_t datum_step = 0;  // the one that changes the datum
  std::string what;

  const PJ* used(Pj& holder) const {
    holder = Pj(proj_trans_get_last_used_operation(steps[datum_step].get()));
    return holder ? holder.get() : steps[datum_step].get();
  }
};

Transform::Transform(const Crs& from, const Crs& to) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.context = new_context();
  PJ_CONTEXT* c = s.context.get();
  s.what = "\"" + of(from).name + "\" to \"" + of(to).name + "\"";
  Pj source = three_dimensional(c, from);
  Pj target = three_dimensional(c, to);
  const std::vector<Candidate> candidates = candidates_between(c, source.get(), target.get());
  refuse_where_worse(candidates, s.what);
  // Where it has a choice PROJ goes by the point's place, and reads geocentric coordinates as if they were longitude and latitude: it is
  // given these. (With no choice it stays one operation: through a null shift in degrees heights would keep the wrong ellipsoid, 0.1 mm.)
  const bool choice = std::count_if(candidates.begin(), candidates.end(), [](const Candidate& k) { return k.missing.empty(); }) > 1;
  Pj last;
  if (choice && of(from).geocentric) {
    Pj geographic = geographic_of(c, source.get());
    s.steps.push_back(operation_between(c, source.get(), geographic.get(), s.what));
    source = std::move(geographic);
  }
  if (choice && of(to).geocentric) {
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
  s->context = new_context();
  s->what = state_->what;
  s->datum_step = state_->datum_step;
  for (const Pj& step : state_->steps) {
    s->steps.emplace_back(proj_clone(s->context.get(), step.get()));
    if (!s->steps.back()) throw Error("PROJ cannot copy the transformation from " + s->what);
  }
  return Transform(std::move(s));
}

size_t Transform::apply(double* x, double* y, double* z, size_t n) const {
  constexpr size_t step = sizeof(double);
  for (const Pj& operation : state_->steps) {
    proj_trans_generic(operation.get(), PJ_FWD, x, step, n, y, step, n, z, step, n, nullptr, 0, 0);
    proj_errno_reset(operation.get());
  }
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
  return text(proj_pj_info(const_cast<PJ*>(used)).description);  // PROJ's signature lacks the const
}

double Transform::accuracy() const {
  Pj holder;
  const PJ* used = state_->used(holder);
  return proj_coordoperation_get_accuracy(state_->context.get(), used);
}

}  // namespace swath::core
