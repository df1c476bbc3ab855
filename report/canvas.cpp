// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/canvas.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <memory>
#include <new>

#include "core/error.h"
#include "report/html.h"

#ifdef __SANITIZE_ADDRESS__
/// fontconfig and Cairo keep two patterns (652 bytes) until the end of the process, whatever is drawn.
extern "C" {
const char* __lsan_default_suppressions();
const char* __lsan_default_suppressions() { return "leak:libfontconfig\n"; }
const char* __lsan_default_options();
const char* __lsan_default_options() { return "print_suppressions=0"; }
}
#endif

namespace swath::report {
namespace {

constexpr const char* typeface = "DejaVu Sans";
constexpr double capitals = 0.73;          // of the em square
constexpr double halo_width = 0.32;        // of the em square
constexpr double far_away = 1e5;           // pixels; nothing is seen there, and Cairo's coordinates end at 8e6
constexpr double fineness = 8.0;           // of coordinates, 1/pixel: finer than any eye sees, and files stay small
constexpr double points_per_pixel = 0.75;  // 72 points or 96 pixels to an inch

template <auto destroy>
struct Destroy {
  void operator()(auto* p) const { destroy(p); }
};
using Surface = std::unique_ptr<cairo_surface_t, Destroy<cairo_surface_destroy>>;
using Context = std::unique_ptr<cairo_t, Destroy<cairo_destroy>>;
using FontOptions = std::unique_ptr<cairo_font_options_t, Destroy<cairo_font_options_destroy>>;

void set_colour(cairo_t* c, core::Rgb colour, double opacity) {
  cairo_set_source_rgba(c, colour[0] / 255.0, colour[1] / 255.0, colour[2] / 255.0, opacity);
}

void set_font(cairo_t* c, double size, bool bold) {
  const FontOptions options(cairo_font_options_create());
  cairo_font_options_set_antialias(options.get(), CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(c, options.get());
  cairo_select_font_face(c, typeface, CAIRO_FONT_SLANT_NORMAL, bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(c, size);
}

double snapped(double v) { return std::round(std::clamp(v, -far_away, far_away) * fineness) / fineness; }

bool has_pixels(cairo_t* c) { return cairo_surface_get_type(cairo_get_target(c)) == CAIRO_SURFACE_TYPE_IMAGE; }

/// A decimal at most.
std::string number(double v) {
  char text[64];
  auto end = std::to_chars(text, text + sizeof text, v, std::chars_format::fixed, 1).ptr;
  if (end - text > 2 && end[-1] == '0') end -= 2;
  return std::string(text, end) == "-0" ? "0" : std::string(text, end);
}

}  // namespace

double text_width(std::string_view utf8, double size, bool bold) {
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1));
  const Context c(cairo_create(surface.get()));
  constexpr double measured = 64.0;  // the same at every size
  set_font(c.get(), measured, bold);
  cairo_text_extents_t extents{};
  cairo_text_extents(c.get(), plain(utf8).c_str(), &extents);
  return extents.x_advance * size / measured;
}

void Canvas::clip(const std::optional<Box>& box) {
  cairo_reset_clip(cairo_);
  if (!box) return;
  cairo_rectangle(cairo_, box->x, box->y, box->width, box->height);
  cairo_clip(cairo_);
}

void Canvas::fill(const Box& b, core::Rgb colour, double opacity) {
  set_colour(cairo_, colour, opacity);
  cairo_rectangle(cairo_, b.x, b.y, b.width, b.height);
  cairo_fill(cairo_);
}

void Canvas::frame(const Box& b, core::Rgb colour) {
  cairo_rectangle(cairo_, b.x + 0.5, b.y + 0.5, b.width - 1.0, b.height - 1.0);
  cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_MITER);
  set_colour(cairo_, colour, 1.0);
  cairo_set_line_width(cairo_, 1.0);
  cairo_stroke(cairo_);
}

void Canvas::path(const std::vector<double>& x, const std::vector<double>& y) {
  for (size_t k = 0; k < x.size(); ++k)
    if (std::isfinite(x[k]) && std::isfinite(y[k]))
      cairo_line_to(cairo_, snapped(x[k]), snapped(y[k]));
    else
      cairo_new_sub_path(cairo_);
}

void Canvas::stroke(double width, core::Rgb colour, double opacity) {
  set_colour(cairo_, colour, opacity);
  cairo_set_line_width(cairo_, width);
  cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_ROUND);
  cairo_stroke(cairo_);
}

void Canvas::line(const std::vector<double>& x, const std::vector<double>& y, double width, core::Rgb colour, double opacity) {
  path(x, y);
  cairo_set_line_cap(cairo_, CAIRO_LINE_CAP_BUTT);
  stroke(width, colour, opacity);
}

/// Points with round ends: a fraction of the bytes of as many circles.
void Canvas::dots(const std::vector<double>& x, const std::vector<double>& y, double radius, core::Rgb colour) {
  for (size_t k = 0; k < x.size(); ++k) {
    cairo_new_sub_path(cairo_);
    path({x[k], x[k]}, {y[k], y[k]});
  }
  cairo_set_line_cap(cairo_, CAIRO_LINE_CAP_ROUND);
  stroke(2.0 * radius, colour, 1.0);
}

void Canvas::area(const std::vector<double>& x, const std::vector<double>& upper, const std::vector<double>& lower, core::Rgb colour,
                  double opacity) {
  path(x, upper);
  path({x.rbegin(), x.rend()}, {lower.rbegin(), lower.rend()});
  set_colour(cairo_, colour, opacity);
  cairo_fill(cairo_);
}

void Canvas::text(double x, double y, std::string_view utf8, const TextStyle& style) {
  const std::string text = plain(utf8);
  if (text.empty() || !std::isfinite(x) || !std::isfinite(y) || !std::isfinite(style.angle) || !(style.size > 0.0)) return;
  TextStyle s = style;
  double width = text_width(text, s.size, s.bold);
  if (width > s.room) {
    s.size *= std::max(s.room, 1.0) / width;
    width = std::max(s.room, 1.0);
  }
  const double along = s.anchor == Anchor::start ? 0.0 : s.anchor == Anchor::middle ? -width / 2.0 : -width, down = capitals * s.size / 2.0;
  const double cosine = std::cos(s.angle), sine = std::sin(s.angle);
  const double left = x + along * cosine - down * sine, base = y + along * sine + down * cosine;
  labels_.push_back({text, left, base, width, s.size, s.angle});
  cairo_save(cairo_);
  cairo_translate(cairo_, left, base);
  cairo_rotate(cairo_, s.angle);
  set_font(cairo_, s.size, s.bold);
  cairo_move_to(cairo_, 0.0, 0.0);
  if (s.halo) {
    cairo_text_path(cairo_, text.c_str());
    stroke(halo_width * s.size, *s.halo, 1.0);
    cairo_move_to(cairo_, 0.0, 0.0);
  }
  set_colour(cairo_, s.colour, 1.0);
  // As a path a letter lies where it belongs, not on the nearest pixel.
  if (has_pixels(cairo_)) {
    cairo_text_path(cairo_, text.c_str());
    cairo_fill(cairo_);
  } else {
    cairo_show_text(cairo_, text.c_str());
  }
  cairo_restore(cairo_);
  cairo_new_path(cairo_);
}

void Canvas::pixels(const Box& b, const std::function<core::Rgb(int, int)>& colour) {
  if (b.width <= 0 || b.height <= 0) return;
  const int band = has_pixels(cairo_) ? std::min(b.height, 256) : b.height;  // rows at once
  for (int top = 0; top < b.height; top += band) {
    const int rows = std::min(band, b.height - top);
    const Surface image(cairo_image_surface_create(CAIRO_FORMAT_RGB24, b.width, rows));
    unsigned char* data = cairo_image_surface_get_data(image.get());
    if (!data) throw core::Error("a map of " + std::to_string(b.width) + " x " + std::to_string(b.height) + " pixels is too large to draw");
    for (int y = 0; y < rows; ++y) {
      auto* out = reinterpret_cast<std::uint32_t*>(data + static_cast<std::ptrdiff_t>(y) * cairo_image_surface_get_stride(image.get()));
      for (int x = 0; x < b.width; ++x) {
        const core::Rgb c = colour(x, top + y);
        out[x] = static_cast<std::uint32_t>(c[0]) << 16 | static_cast<std::uint32_t>(c[1]) << 8 | c[2];
      }
    }
    cairo_surface_mark_dirty(image.get());
    cairo_set_source_surface(cairo_, image.get(), b.x, b.y + top);
    cairo_pattern_set_filter(cairo_get_source(cairo_), CAIRO_FILTER_NEAREST);
    cairo_rectangle(cairo_, b.x, b.y + top, b.width, rows);
    cairo_fill(cairo_);
  }
}

void Canvas::inset(double x, double y, double scale, const std::function<void(Canvas&)>& paint) {
  cairo_save(cairo_);
  cairo_translate(cairo_, x, y);
  cairo_scale(cairo_, scale, scale);
  paint(*this);
  cairo_restore(cairo_);
}

namespace {

void check(cairo_status_t status, const Drawing& d) {
  if (status != CAIRO_STATUS_SUCCESS)
    throw core::Error("cannot draw a picture of " + std::to_string(d.width) + " x " + std::to_string(d.height) +
                          " pixels: " + cairo_status_to_string(status),
                      {}, "a side has at most 32767 pixels");
}

/// Draws and closes the file, where it is one and `is_last`. Returns the texts.
std::vector<Canvas::Label> paint(cairo_surface_t* surface, const Drawing& d, double scale = 1.0, bool is_last = true) {
  check(cairo_surface_status(surface), d);
  const Context c(cairo_create(surface));
  cairo_scale(c.get(), scale, scale);
  set_colour(c.get(), {255, 255, 255}, 1.0);
  cairo_paint(c.get());
  Canvas canvas(c.get());
  d.paint(canvas);
  check(cairo_status(c.get()), d);
  if (!is_last) cairo_show_page(c.get());
  if (is_last && !has_pixels(c.get())) cairo_surface_finish(surface);
  cairo_surface_flush(surface);
  check(cairo_surface_status(surface), d);
  return canvas.labels();
}

cairo_status_t append(void* out, const unsigned char* data, unsigned int length) try {
  static_cast<std::string*>(out)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
} catch (const std::bad_alloc&) {  // no exception may pass through Cairo's frames
  return CAIRO_STATUS_NO_MEMORY;
}

/// Names counted in the order of the file: Cairo counts its surfaces through the whole run.
std::string with_counted_names(const std::string& text) {
  std::map<std::string, std::string> names;
  constexpr std::string_view mark = " id=\"";
  for (size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + 1)) {
    const size_t from = at + mark.size();
    names.emplace(text.substr(from, text.find('"', from) - from), "d" + std::to_string(names.size() + 1));
  }
  std::string out;
  for (size_t at = 0; at < text.size();) {
    size_t from = std::string::npos;
    for (const std::string_view m : {mark, std::string_view("url(#"), std::string_view("href=\"#")})
      if (const size_t found = text.find(m, at); found != std::string::npos) from = std::min(from, found + m.size());
    if (from == std::string::npos) return out.append(text, at);
    const size_t end = text.find_first_of("\")", from);
    const auto name = names.find(text.substr(from, end - from));
    out.append(text, at, from - at).append(name == names.end() ? text.substr(from, end - from) : name->second);
    at = end;
  }
  return out;
}

std::string unseen(const std::vector<Canvas::Label>& labels) {
  std::string out = "<g fill=\"none\" font-family=\"sans-serif\">\n";
  for (const Canvas::Label& l : labels) {
    out += "<text font-size=\"" + number(l.size) + "\" textLength=\"" + number(l.width) + "\" lengthAdjust=\"spacingAndGlyphs\"";
    const std::string at = number(l.x), base = number(l.y);
    out += l.angle == 0.0 ? " x=\"" + at + "\" y=\"" + base + "\">"
                          : " transform=\"translate(" + at + "," + base + ") rotate(" + number(l.angle * 180.0 / M_PI) + ")\">";
    out += escaped(l.text) + "</text>\n";
  }
  return out + "</g>\n";
}

}  // namespace

core::Picture draw(const Drawing& d) {
  if (d.width <= 0 || d.height <= 0) return core::Picture();
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, d.width, d.height));
  paint(surface.get(), d);
  core::Picture out(d.width, d.height);
  const unsigned char* data = cairo_image_surface_get_data(surface.get());
  for (int y = 0; y < d.height; ++y) {
    const auto* row =
        reinterpret_cast<const std::uint32_t*>(data + static_cast<std::ptrdiff_t>(y) * cairo_image_surface_get_stride(surface.get()));
    for (int x = 0; x < d.width; ++x)
      for (int k = 0; k < 3; ++k) out.at(x, y)[k] = static_cast<std::uint8_t>(row[x] >> (16 - 8 * k));
  }
  return out;
}

std::string svg(const Drawing& d) {
  std::string out;
  if (d.width <= 0 || d.height <= 0) return out;
  const Surface surface(cairo_svg_surface_create_for_stream(append, &out, d.width, d.height));
  cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_USER);
  const auto labels = paint(surface.get(), d);
  out = with_counted_names(out.substr(out.find("<svg")));  // without <?xml?>: it is also put into pages
  return out.insert(out.rfind("</svg>"), unseen(labels));
}

std::string pdf(const Drawing& d) { return pdf(std::vector<Drawing>{d}); }

std::string pdf(const std::vector<Drawing>& pages) {
  std::string out;
  if (pages.empty() || pages[0].width <= 0 || pages[0].height <= 0) return out;
  const auto points = [](int pixels) { return pixels * points_per_pixel; };
  const Surface surface(cairo_pdf_surface_create_for_stream(append, &out, points(pages[0].width), points(pages[0].height)));
  cairo_pdf_surface_restrict_to_version(surface.get(), CAIRO_PDF_VERSION_1_4);  // the same with every Cairo
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
  for (size_t k = 0; k < pages.size(); ++k) {
    cairo_pdf_surface_set_size(surface.get(), points(pages[k].width), points(pages[k].height));
    paint(surface.get(), pages[k], points_per_pixel, k + 1 == pages.size());
  }
  return out;
}

}  // namespace swath::report
