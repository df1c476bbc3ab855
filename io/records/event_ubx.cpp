// SPDX-License-Identifier: GPL-3.0-or-later
// Frame: b5 62, class, identifier, length (little-endian), payload, Fletcher-8 over all but the two first bytes. TIM-TM2 (0d 03), 28 bytes:
// channel, flags, count of rising edges, weeks and times of week (ms and ns) of the last rising and falling edge, accuracy in ns. Flags:
// bit 2 new falling edge, 3-4 time base (0 receiver, 1 GNSS, 2 UTC), 6 time valid, 7 new rising edge (u-blox F9 HPG 1.32 interface
// description, UBX-22008968).
#include <map>

#include "core/config/units.h"
#include "core/error.h"
#include "core/time.h"
#include "io/records/event_marks.h"
#include "io/survey/wild_records.h"
#include "io/text/binary_file.h"

namespace swath::io {
namespace {

constexpr std::uint64_t ubx_frame = 8;           // bytes without the payload
constexpr std::uint64_t longest_payload = 8192;  // of any message of u-blox receivers; more is not a frame
constexpr std::uint16_t mark_payload = 28;
constexpr unsigned largest_loss = 1000;  // of the counter; more is a receiver that began anew
constexpr double unix_of_gps_start = 315964800.0;

/// Bytes of a file through a window that moves forward.
class ByteWindow {
 public:
  explicit ByteWindow(const BinaryFile& file) : file_(file), buffer_(1 << 16) {}
  /// n bytes from `at`; null where the file ends before. n below the window's size.
  const unsigned char* bytes(std::uint64_t at, std::uint64_t n) {
    if (at + n > file_.size()) return nullptr;
    if (at < begin_ || at + n > begin_ + fill_) {
      begin_ = at;
      fill_ = file_.read_some(at, buffer_.data(), buffer_.size());
    }
    return buffer_.data() + (at - begin_);
  }

 private:
  const BinaryFile& file_;
  std::vector<unsigned char> buffer_;
  std::uint64_t begin_ = 0, fill_ = 0;
};

bool checks_out(const unsigned char* frame, std::uint64_t payload) {
  std::uint8_t a = 0, b = 0;
  for (std::uint64_t i = 2; i < 6 + payload; ++i) {
    a = static_cast<std::uint8_t>(a + frame[i]);
    b = static_cast<std::uint8_t>(b + a);
  }
  return a == frame[6 + payload] && b == frame[7 + payload];
}

struct TimeMark {
  int input = 0;  // EXTINT0 is 0
  bool rising = false, falling = false, valid = false;
  int base = 0;
  std::uint16_t count = 0;
  std::uint16_t week[2];  // of the rising and the falling edge
  std::uint32_t milliseconds[2], nanoseconds[2];
  double sigma = 0.0;
};

TimeMark time_mark(const unsigned char* p) {
  TimeMark m;
  m.input = p[0];
  m.falling = p[1] >> 2 & 1;
  m.base = p[1] >> 3 & 3;
  m.valid = p[1] >> 6 & 1;
  m.rising = p[1] >> 7 & 1;
  m.count = load<std::uint16_t>(p + 2);
  for (int k = 0; k < 2; ++k) {
    m.week[k] = load<std::uint16_t>(p + 4 + 2 * k);
    m.milliseconds[k] = load<std::uint32_t>(p + 8 + 8 * k);
    m.nanoseconds[k] = load<std::uint32_t>(p + 12 + 8 * k);
  }
  m.sigma = 1e-9 * load<std::uint32_t>(p + 24);
  return m;
}

}  // namespace

std::vector<EventMark> read_ubx_marks(const std::filesystem::path& path, EventEdge edge, int input, core::Tally& tally) {
  const BinaryFile file(path);
  ByteWindow window(file);
  std::vector<EventMark> out;
  std::map<int, std::uint16_t> last_count;
  std::uint64_t frames = 0, marks = 0;
  const size_t which = edge == EventEdge::falling;
  for (std::uint64_t at = 0; const unsigned char* head = window.bytes(at, ubx_frame);) {
    if (head[0] != 0xb5 || head[1] != 0x62) {
      ++at;
      continue;
    }
    const std::uint64_t payload = load<std::uint16_t>(head + 4);
    const unsigned char* frame = payload <= longest_payload ? window.bytes(at, ubx_frame + payload) : nullptr;
    const std::string place = path.string() + ": byte " + std::to_string(at);
    if (!frame || !checks_out(frame, payload)) {
      tally.count("damaged UBX messages, passed over", place);
      ++at;
      continue;
    }
    at += ubx_frame + payload;
    ++frames;
    if (frame[2] != 0x0d || frame[3] != 0x03 || payload != mark_payload) continue;
    const TimeMark m = time_mark(frame + 6);
    if (input > 0 && m.input != input - 1) continue;
    ++marks;
    const auto before = last_count.find(m.input);
    const std::uint16_t passed = before == last_count.end() ? 1 : static_cast<std::uint16_t>(m.count - before->second);
    last_count[m.input] = m.count;
    if (m.rising && passed > 1 && passed < largest_loss)
      tally.count("events that the receiver counted and did not record", place, passed - 1u);
    if (!(edge == EventEdge::rising ? m.rising : m.falling)) continue;
    if (!m.valid || m.milliseconds[which] >= 604800000u || m.nanoseconds[which] >= 1000000u) {
      tally.count("events whose time is not valid, left out", place);
      continue;
    }
    EventMark e;
    e.second = core::from_week(m.week[which], m.milliseconds[which] / 1000);
    e.fraction = (m.milliseconds[which] % 1000) * 1e-3 + m.nanoseconds[which] * 1e-9;
    if (m.base == 2) e.second = core::from_unix(e.second + unix_of_gps_start);  // a week of UTC, leap seconds not counted
    if (!is_instant(e.second)) {
      tally.count("events whose time is not valid, left out", place);
      continue;
    }
    e.sigma = m.sigma;
    e.id = std::to_string(m.count);
    e.doubtful = m.base == 0;
    out.push_back(e);
  }
  if (frames == 0) throw core::Error("holds no message of UBX", path.string(), "u-blox receivers log them; text formats are others");
  if (out.empty())
    throw core::Error("holds no event: " + core::counted(frames, "message") + " of UBX, " + std::to_string(marks) + " of them TIM-TM2",
                      path.string(), marks > 0 ? "event.edge and event.input choose among edges" : "let the receiver log UBX-TIM-TM2");
  return out;
}

}  // namespace swath::io
