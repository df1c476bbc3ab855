// SPDX-License-Identifier: GPL-3.0-or-later
// A boresight error e moves every point of a line by J e (georef/shot_geometry.h), so that line B lies (J_B - J_A) e beside line A.
// Whatever single squares show (rows of like houses, woods), only one e makes all of them meet: the costs of all squares are added up over
// a lattice of e (a generalised Hough transform), then the squares' own displacements near that solution are adjusted.
#include "calib/ties/surface_match.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "calib/ties/height_grid.h"
#include "calib/ties/shift_fit.h"
#include "calib/ties/window_match.h"

namespace swath::calib {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr std::uint64_t most_cells = 48u << 20;  // 6 bytes each
constexpr double full_square_height = 400.0;     // m: squares and cells no longer grow
constexpr double widest_window = 80.0, smallest_window = 8.0, widest_cell = 1.0, smallest_match_cell = 0.25;  // m
constexpr double least_relief = 0.15;  // m, shared by neighbouring cells
constexpr double least_share = 0.4;    // of the relief's rms that neighbouring cells must share
constexpr double level_rms = 0.3;      // m: squares without relief below it are level, above it they are woods
constexpr double relief_cap = 3.0;     // m: more relief than this is not better
constexpr double filled = 0.4;         // share of a square's cells that a line must have seen
constexpr double meets = 0.5;          // share of the typical cost below which two surfaces meet
constexpr double agreed = 0.15;        // share of the squares that must meet:
constexpr double surely_agreed = 0.5;  // this one always, the lower one if it is
constexpr double above_chance = 3.0;   // so many times the share that meets under any boresight
constexpr int fewest_squares = 4;      // with relief: fewer say nothing of pitch and heading
constexpr double match_cells = 10.0;   // a search radius is this many cells or fewer where the cells allow

// A square seen by two views.
struct Pair {
  size_t a = 0, b = 0;  // views
  std::int32_t i = 0, j = 0;
  double relief = 0.0;
  Matrix3d by_a = Matrix3d::Zero(), by_b = Matrix3d::Zero();  // J: east, north, up by roll, pitch, heading, m/rad
  Matrix3d by = Matrix3d::Zero();                             // J_B - J_A
};

struct Round {
  HeightGrids grids;
  int side = 0;  // tiles along a square
  std::vector<Pair> relief, level;
};

double square_side(const Round& r) { return r.grids.cell * HeightTile::side * r.side; }

// The sample return of the tile of a view nearest to the middle of a square.
std::optional<Matrix3d> turn_at(const HeightView& view, std::int32_t i, std::int32_t j, int side, LocalPoints& points) {
  const HeightTile* best = nullptr;
  double least = 1e30;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      if (const HeightTile* t = view.tile(i * side + x, j * side + y)) {
        const double d = std::hypot(x - 0.5 * (side - 1), y - 0.5 * (side - 1));
        if (d < least) least = d, best = t;
      }
  return best ? points.by_boresight(best->time, best->sample) : std::nullopt;
}

// The best `most` of each pair of views; ties and order do not depend on anything but the squares.
std::vector<Pair> chosen(std::vector<Pair> all, size_t most, bool by_relief) {
  std::map<std::pair<size_t, size_t>, std::vector<Pair>> of;
  for (Pair& p : all) of[{p.a, p.b}].push_back(std::move(p));
  if (of.empty()) return {};
  const size_t each = std::max<size_t>(most / of.size(), 4);
  const auto mixed = [](const Pair& p) {
    return (static_cast<std::uint32_t>(p.i) * 2654435761u) ^ (static_cast<std::uint32_t>(p.j) * 2246822519u);
  };
  std::vector<Pair> out;
  for (auto& [views, list] : of) {
    std::sort(list.begin(), list.end(), [&](const Pair& x, const Pair& y) {
      const double rx = by_relief ? std::min(x.relief, relief_cap) : 0.0, ry = by_relief ? std::min(y.relief, relief_cap) : 0.0;
      return std::tuple(-rx, mixed(x), x.i, x.j) < std::tuple(-ry, mixed(y), y.i, y.j);
    });
    if (list.size() > each) list.resize(each);
    for (Pair& p : list) out.push_back(std::move(p));
  }
  return out;
}

Round read_round(const ShotStream& stream, LocalPoints& points, const SurfaceMatchOptions& given) {
  const SurfaceMatchOptions o = sized(given, 0.0);
  Round r;
  r.grids = height_grids(stream, points, o.cell->value, most_cells);
  const double tile = r.grids.cell * HeightTile::side;
  r.side = std::max(2, static_cast<int>(std::lround(o.window->value / tile)));
  const auto square_of = [&](std::int32_t t) { return t >= 0 ? t / r.side : -((-t + r.side - 1) / r.side); };
  struct Seen {
    size_t view;
    int cells = 0;
  };
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<Seen>> squares;
  for (size_t v = 0; v < r.grids.views.size(); ++v)
    for (const HeightTile& t : r.grids.views[v].tiles) {
      auto& seen = squares[{square_of(t.i), square_of(t.j)}];
      if (seen.empty() || seen.back().view != v) seen.push_back({v});
      for (const std::uint16_t n : t.n) seen.back().cells += n > 0;
    }
  const int cells = r.side * HeightTile::side;
  std::vector<Pair> relief, level;
  for (auto& [place, seen] : squares) {
    std::erase_if(seen, [&](const Seen& s) { return s.cells < filled * cells * cells; });
    if (seen.size() < 2) continue;
    std::vector<Relief> in;
    for (const Seen& s : seen)
      in.push_back(
          relief_of(r.grids.views[s.view].raster(std::int64_t{place.first} * cells, std::int64_t{place.second} * cells, cells, cells, 1))
              .value_or(Relief{1e9, 0.0}));
    const auto stands_out = [](const Relief& x) { return x.shared > least_relief && x.shared > least_share * x.rms; };
    for (size_t x = 0; x < seen.size(); ++x)
      for (size_t y = x + 1; y < seen.size(); ++y) {
        Pair p;
        p.a = seen[x].view, p.b = seen[y].view, p.i = place.first, p.j = place.second;
        p.relief = std::min(in[x].shared, in[y].shared);
        if (stands_out(in[x]) && stands_out(in[y]))
          relief.push_back(p);
        else if (std::max(in[x].rms, in[y].rms) < level_rms)
          level.push_back(p);
      }
  }
  r.relief = chosen(std::move(relief), static_cast<size_t>(o.windows), true);
  r.level = chosen(std::move(level), static_cast<size_t>(o.windows), false);
  const auto no_turn = [&](Pair& p) {
    const auto a = turn_at(r.grids.views[p.a], p.i, p.j, r.side, points), b = turn_at(r.grids.views[p.b], p.i, p.j, r.side, points);
    if (a && b) p.by_a = *a, p.by_b = *b, p.by = *b - *a;
    return !(a && b);
  };
  std::erase_if(r.relief, no_turn);
  std::erase_if(r.level, no_turn);
  return r;
}

// A square's surfaces and the costs of laying one over the other.
struct Matched {
  const Pair* pair = nullptr;
  double cell = 0.0;
  Raster a, b;
  ShiftCosts costs;
};

// Half widths of the search of each angle.
using Search = Vector3d;

template <class F>
void for_each_boresight(const Search& search, const Vector3d& step, F&& f) {
  int n[3];
  for (int k = 0; k < 3; ++k) n[k] = static_cast<int>(std::ceil(search[k] / step[k]));
  for (int r = -n[0]; r <= n[0]; ++r)
    for (int p = -n[1]; p <= n[1]; ++p)
      for (int h = -n[2]; h <= n[2]; ++h) f(Vector3d(r * step[0], p * step[1], h * step[2]));
}

Matched match(const Round& r, const Pair& p, const Search& search) {
  Matched m;
  m.pair = &p;
  const Vector3d reach = p.by.cwiseAbs() * search;
  const double widest = std::max(reach.x(), reach.y());
  const int cells = r.side * HeightTile::side;
  int factor = 1;
  while (factor < 8 && widest / (r.grids.cell * factor) > match_cells && cells / (2 * factor) >= 24) factor *= 2;
  m.cell = r.grids.cell * factor;
  const int n = cells / factor, mx = static_cast<int>(std::ceil(reach.x() / m.cell)) + 3,
            my = static_cast<int>(std::ceil(reach.y() / m.cell)) + 3;
  const std::int64_t i = std::int64_t{p.i} * n, j = std::int64_t{p.j} * n;
  m.a = r.grids.views[p.a].raster(i, j, n, n, factor);
  m.b = r.grids.views[p.b].raster(i - mx, j - my, n + 2 * mx, n + 2 * my, factor);
  // Only shifts that some boresight explains, two cells about.
  std::vector<char> wanted(static_cast<size_t>((2 * mx + 1) * (2 * my + 1)), 0);
  Vector3d step;
  for (int k = 0; k < 3; ++k) step[k] = std::max(m.cell / std::max(p.by.col(k).head<2>().norm(), 1.0), search[k] / 20.0);
  for_each_boresight(search, step, [&](const Vector3d& e) {
    const Vector2d d = (p.by * e).head<2>() / m.cell;
    const int x0 = static_cast<int>(std::lround(d.x())), y0 = static_cast<int>(std::lround(d.y()));
    for (int y = std::max(y0 - 2, -my); y <= std::min(y0 + 2, my); ++y)
      for (int x = std::max(x0 - 2, -mx); x <= std::min(x0 + 2, mx); ++x) wanted[static_cast<size_t>((y + my) * (2 * mx + 1) + x + mx)] = 1;
  });
  m.costs = shift_costs(m.a, m.b, mx, my, wanted);
  return m;
}

double share_at(const Matched& m, const Vector3d& e) {
  const Vector2d d = (m.pair->by * e).head<2>() / m.cell;
  return m.costs(d.x(), d.y());
}
double cost_of(const std::vector<Matched>& all, const Search& search, const Vector3d& e) {
  double sum = 0.0;
  for (const Matched& m : all) sum += share_at(m, e);
  return sum + 1e-6 * e.cwiseQuotient(search).squaredNorm();  // of equals the smallest
}

// The boresight error under which most squares meet: the best of a lattice, then of ever finer ones about it.
Vector3d seek(const std::vector<Matched>& all, const Search& search) {
  Vector3d step;
  for (int k = 0; k < 3; ++k) {
    double fastest = 1.0, cell = 1e9;
    for (const Matched& m : all) fastest = std::max(fastest, m.pair->by.col(k).head<2>().norm()), cell = std::min(cell, m.cell);
    step[k] = std::clamp(cell / fastest, search[k] / 20.0, search[k]);
  }
  Vector3d best = Vector3d::Zero();
  double least = cost_of(all, search, best);
  const auto attempt = [&](const Vector3d& e) {
    if (const double c = cost_of(all, search, e); c < least) least = c, best = e;
  };
  for_each_boresight(search, step, attempt);
  for (int halving = 0; halving < 4; ++halving) {
    step *= 0.5;
    for (int again = 0; again < 3; ++again) {
      const Vector3d centre = best;
      for_each_boresight(step, step, [&](const Vector3d& e) { attempt(centre + e); });
      if (centre == best) break;
    }
  }
  return best;
}

double agreement_of(const std::vector<Matched>& all, const Vector3d& e) {
  double n = 0.0;
  for (const Matched& m : all) n += share_at(m, e) < meets;
  return all.empty() ? 0.0 : n / static_cast<double>(all.size());
}
// Do the surfaces meet there as they would not elsewhere?
bool is_agreed(const std::vector<Matched>& all, const Search& search, double agreement) {
  double sum = 0.0, n = 0.0;
  for_each_boresight(search, 0.5 * search, [&](const Vector3d& e) { sum += agreement_of(all, e), n += 1.0; });
  return agreement >= surely_agreed || (agreement >= agreed && agreement > above_chance * sum / n);
}

ObservedShift observation(const Round& r, const Pair& p) {
  ObservedShift o;
  o.line_a = r.grids.views[p.a].line, o.line_b = r.grids.views[p.b].line;
  o.look_a = p.a, o.look_b = p.b;
  o.square = static_cast<std::uint64_t>(static_cast<std::uint32_t>(p.i)) << 32 | static_cast<std::uint32_t>(p.j);
  o.by_a = p.by_a, o.by_b = p.by_b;
  return o;
}

std::vector<ObservedShift> observe(const Round& r, const std::vector<Matched>& matched, const Vector3d& e) {
  std::vector<ObservedShift> out;
  for (const Matched& m : matched) {
    const Vector2d near = (m.pair->by * e).head<2>() / m.cell;
    const auto s = subcell_shift(m.a, m.b, m.costs, near, 3);
    if (!s || s->share > meets) continue;
    ObservedShift o = observation(r, *m.pair);
    o.relief = true;
    o.shift << s->shift * m.cell, s->rise;
    o.covariance.topLeftCorner<2, 2>() = s->covariance * m.cell * m.cell;
    o.covariance(2, 2) = s->rise_variance;
    out.push_back(o);
  }
  for (const Pair& p : r.level) {
    const int n = r.side * HeightTile::side;
    const std::int64_t i = std::int64_t{p.i} * n, j = std::int64_t{p.j} * n;
    const Raster a = r.grids.views[p.a].raster(i, j, n, n, 1);
    const Vector2d d = (p.by * e).head<2>() / r.grids.cell;
    const Raster b = r.grids.views[p.b].raster(i + std::lround(d.x()), j + std::lround(d.y()), n, n, 1);
    const auto f = fit_shift(a, b, 0, 0, 0, 0, 3);
    if (!f) continue;
    ObservedShift o = observation(r, p);
    o.shift.z() = f->rise;
    o.covariance = Vector3d(1e12, 1e12, f->cost / (0.2 * f->cells) + 4e-4).asDiagonal();
    out.push_back(o);
  }
  return out;
}

std::vector<Matched> match_all(const Round& r, const Search& search) {
  std::vector<Matched> out;
  for (const Pair& p : r.relief) out.push_back(match(r, p, search));
  return out;
}

core::Calibration turned(core::Calibration c, const Vector3d& error) {
  c.roll.value -= error[0], c.pitch.value -= error[1], c.heading.value -= error[2];
  return c;
}

void state_findings(SurfaceMatch& m, bool overlap) {
  static const char* names[3] = {"roll", "pitch", "heading"};
  static const char* cures[3] = {"fly lines in opposite directions, or lines that overlap side by side",
                                 "fly lines in opposite directions over buildings or other relief",
                                 "fly lines side by side over buildings or other relief that both see near the edge of the swath"};
  if (!overlap) {
    m.findings.push_back({"no two flight lines overlap", "fly lines that overlap by half a swath or more", {}, true});
    return;
  }
  for (int k = 0; k < 3; ++k)
    if (!m.determined[static_cast<size_t>(k)])
      m.findings.push_back({std::string("the surfaces of the lines do not determine boresight ") + names[k] + ": it is left as it was",
                            cures[k],
                            {static_cast<Parameter>(boresight_roll + k)},
                            false});
}

/// Do the surfaces meet with the sign of the scan angle turned, and far better than the share `agreement` of them that meets as recorded?
bool meets_turned(const ShotStream& stream, const core::Scanner& scanner, const core::Calibration& start,
                  const trajectory::Trajectory& trajectory, const trajectory::LocalFrame& frame, const SurfaceMatchOptions& o,
                  const Search& search, double agreement) {
  core::Calibration turned = start;
  turned.scan_scale = -start.scan_scale;
  LocalPoints points(scanner, turned, trajectory, frame);
  const Round r = read_round(stream, points, o);
  const std::vector<Matched> matched = match_all(r, search);
  const double there = matched.empty() ? 0.0 : agreement_of(matched, seek(matched, search));
  return there > 2.0 * agreement && is_agreed(matched, search, there);
}

}  // namespace

SurfaceMatchOptions sized(SurfaceMatchOptions o, double height) {
  const bool low = height > 0.0 && height < full_square_height;
  if (!o.window) o.window = core::Metres(low ? std::max(smallest_window, widest_window * height / full_square_height) : widest_window);
  if (!o.cell) o.cell = core::Metres(low ? std::max(smallest_match_cell, widest_cell * height / full_square_height) : widest_cell);
  return o;
}

bool scan_is_reversed(const ShotStream& stream, const core::Scanner& scanner, const core::Calibration& start,
                      const trajectory::Trajectory& trajectory, const trajectory::LocalFrame& frame, const SurfaceMatchOptions& o) {
  const Search search = Vector3d::Constant(o.search.value);
  double agreement = 0.0;
  {
    LocalPoints points(scanner, start, trajectory, frame);
    const Round r = read_round(stream, points, o);
    const std::vector<Matched> matched = match_all(r, search);
    if (matched.size() < fewest_squares) return false;
    agreement = agreement_of(matched, seek(matched, search));
    if (is_agreed(matched, search, agreement)) return false;
  }
  return meets_turned(stream, scanner, start, trajectory, frame, o, search, agreement);
}

SurfaceMatch match_surfaces(const ShotStream& stream, const core::Scanner& scanner, const core::Calibration& start,
                            const trajectory::Trajectory& trajectory, const trajectory::LocalFrame& frame, const SurfaceMatchOptions& o) {
  SurfaceMatch out;
  out.calibration = start;
  Search search = Vector3d::Constant(o.search.value);
  bool overlap = false;
  for (int round = 1; round <= o.rounds; ++round) {
    LocalPoints points(scanner, out.calibration, trajectory, frame);
    const Round r = read_round(stream, points, o);
    overlap = !r.relief.empty() || !r.level.empty();
    if (!overlap) break;
    const std::vector<Matched> matched = match_all(r, search);
    const Vector3d found = matched.empty() ? Vector3d::Zero() : seek(matched, search);
    if (round == 1) {
      out.agreement = agreement_of(matched, found);
      if (matched.size() >= fewest_squares && !is_agreed(matched, search, out.agreement)) {
        if (meets_turned(stream, scanner, start, trajectory, frame, o, search, out.agreement)) {
          out.scan_reversed = true;
          out.findings.push_back({"the surfaces of the lines meet with the sign of the scan angle turned, and not as recorded",
                                  "state that the file counts scan angles positive to port (angle_to_port)",
                                  {},
                                  true});
        } else {
          out.findings.push_back({"the surfaces of the lines do not meet under any boresight within the search",
                                  "widen `search`; check the trajectory, time tags, line numbers and the scanner model",
                                  {},
                                  true});
        }
        return out;
      }
    }
    std::vector<ObservedShift> seen = observe(r, matched, found);
    if (matched.size() < fewest_squares) std::erase_if(seen, [](const ObservedShift& x) { return x.relief; });
    const LineErrors errors{o.position_error.value, o.height_error.value, o.attitude_error.value};
    const ShiftFit3 s = fit_shifts(seen, errors, o.undetermined.value, 0.5 * o.search.value);
    out.calibration = turned(out.calibration, s.error);
    out.covariance = s.covariance;
    out.sigma = s.sigma;
    out.determined = s.determined;
    out.rms = s.rms;
    out.cell = r.grids.cell;
    out.rounds = round;
    out.windows.clear();
    for (const ObservedShift& x : seen) {
      const Vector2d square(static_cast<std::int32_t>(x.square >> 32), static_cast<std::int32_t>(x.square & 0xffffffffu));
      out.windows.push_back({x.line_a, x.line_b, (square + Vector2d::Constant(0.5)) * square_side(r), x.relief, x.shift,
                             x.shift - (x.by_b - x.by_a) * s.error, x.weight});
    }
    if (s.error.cwiseAbs().maxCoeff() < o.settled.value) break;
    for (int k = 0; k < 3; ++k)
      if (s.determined[static_cast<size_t>(k)]) search[k] = std::clamp(4.0 * s.sigma[k], 0.05 * core::degree, search[k]);
  }
  out.change = {out.calibration.roll.value - start.roll.value, out.calibration.pitch.value - start.pitch.value,
                out.calibration.heading.value - start.heading.value};
  state_findings(out, overlap);
  return out;
}

}  // namespace swath::calib
