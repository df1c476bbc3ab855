// SPDX-License-Identifier: GPL-3.0-or-later
// Source: GDAL's virtual file systems (gdal.org, "GDAL Virtual File Systems"), whose configuration options these are.
// GDAL tries a request again where a server is busy; a connection that breaks within the data is tried again here.
#include "io/store/object.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <cpl_vsi_error.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <mutex>
#include <string_view>
#include <thread>
#include <vector>

#include "core/error.h"
#include "core/printable.h"
#include "io/store/address.h"
#include "io/text/binary_file.h"

namespace swath::io {
namespace {

constexpr const char *allowed_name = "CPL_VSIL_CURL_ALLOWED_FILENAME", *listing = "GDAL_DISABLE_READDIR_ON_OPEN";
constexpr const char* not_read = "cannot read from the store";
constexpr std::size_t copied_at_once = std::size_t{8} << 20;
constexpr int read_attempts = 3;
constexpr std::chrono::milliseconds first_pause{500};

/// What bounds a request in time, unless the user's configuration does.
void set_limits() {
  constexpr std::array<std::array<const char*, 2>, 5> limits{{{"GDAL_HTTP_CONNECTTIMEOUT", "10"},
                                                              {"GDAL_HTTP_LOW_SPEED_TIME", "30"},
                                                              {"GDAL_HTTP_LOW_SPEED_LIMIT", "1"},
                                                              {"GDAL_HTTP_MAX_RETRY", "3"},
                                                              {"GDAL_HTTP_RETRY_DELAY", "1"}}};
  static std::once_flag once;
  std::call_once(once, [&] {
    for (const auto& [key, value] : limits)
      if (!CPLGetConfigOption(key, nullptr)) CPLSetConfigOption(key, value);
  });
}

/// GDAL's last failure on this thread as long as the object lives, or its last warning where there is none; nothing is printed.
class Failure {
 public:
  Failure() { CPLPushErrorHandlerEx(note, this); }
  ~Failure() { CPLPopErrorHandler(); }
  Failure(const Failure&) = delete;
  Failure& operator=(const Failure&) = delete;
  std::string text;

 private:
  static void note(CPLErr kind, CPLErrorNum, const char* message) {
    auto* self = static_cast<Failure*>(CPLGetErrorHandlerUserData());
    if (!self || kind < CE_Warning || (kind == CE_Warning && self->is_failure_)) return;
    self->text = without_access(message);
    self->is_failure_ = kind >= CE_Failure;
  }
  bool is_failure_ = false;
};

bool knows_system(const std::string& name) {
  const CPLStringList known(VSIGetFileSystemsPrefixes());
  for (int i = 0; i < known.size(); ++i)
    if (name.starts_with(known[i])) return true;
  return false;
}

struct Hint {
  std::string_view part;  ///< of the message, in small letters
  std::string_view hint;
};
constexpr std::string_view endpoint =
    "is the server there? AWS_S3_ENDPOINT=HOST:PORT names a store other than Amazon's, AWS_HTTPS=NO one without TLS";
constexpr std::string_view no_access = "the credentials do not open it: check them and the rights of their owner";
constexpr std::string_view no_object = "check the name: keys are case-sensitive and have no leading slash";
constexpr std::array<Hint, 14> hints{{
    {"configuration options not defined",
     "set AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY, or AWS_NO_SIGN_REQUEST=YES for a public bucket; docs/stores.md names those of "
     "others"},
    {"bucket does not exist", "check the bucket's name, and AWS_S3_ENDPOINT where the store is not Amazon's"},
    {"key does not exist", no_object},
    {"does not exist", no_object},
    {"404", no_object},
    {"401", no_access},
    {"403", no_access},
    {"access denied", no_access},
    {"forbidden", no_access},
    {"signature", no_access},
    {"access key", no_access},
    {"could not resolve", endpoint},
    {"connect", endpoint},
    {"timed out", endpoint},
}};

std::string hint_of(const std::string& message) {
  const std::string small = core::lower_case(message);
  for (const Hint& h : hints)
    if (small.find(h.part) != std::string::npos) return std::string(h.hint);
  return "check the address and the store's settings: docs/stores.md";
}

[[noreturn]] void cannot_read(const std::filesystem::path& address, const std::string& message) {
  throw core::Error(not_read + (message.empty() ? message : ": " + message), shown_name(address), hint_of(message));
}

/// What GDAL says of the last attempt to open.
std::string reason(const Failure& failure) {
  const std::string last = without_access(VSIGetLastErrorMsg());
  return last.empty() ? failure.text : last;
}

void expect_network(const std::filesystem::path& address) {
  if (!knows_system(gdal_name(address)))
    throw core::Error("this build's GDAL cannot reach stores: it was made without network access", shown_name(address),
                      "fetch the file, or build swath with a GDAL that has libcurl (docs/stores.md)");
}

/// Why the copy failed; empty where all bytes were taken.
std::string copied(const BinaryFile& in, const std::filesystem::path& address) {
  const Failure failure;
  VSIErrorReset();
  VSILFILE* out = VSIFOpenExL(gdal_name(address).c_str(), "wb", TRUE);
  const std::string why = "the store does not take it";
  if (!out) return reason(failure).empty() ? why : reason(failure);
  struct Closing {
    VSILFILE* file;
    ~Closing() {
      if (file) VSIFCloseL(file);
    }
  } closing{out};  // where the local file cannot be read to its end
  std::vector<char> buffer(copied_at_once);
  bool is_taken = true;
  for (std::uint64_t at = 0; is_taken && at < in.size();) {
    const std::size_t n = in.read_some(at, buffer.data(), buffer.size());
    if (n == 0) return "the local file has become shorter";
    is_taken = VSIFWriteL(buffer.data(), 1, n, out) == n;
    at += n;
  }
  closing.file = nullptr;
  is_taken = VSIFCloseL(out) == 0 && is_taken;
  return is_taken ? "" : failure.text.empty() ? why : failure.text;
}

VSILFILE* handle(void* file) { return static_cast<VSILFILE*>(file); }

}  // namespace

OpenAddress::OpenAddress(const std::filesystem::path& address) {
  set_limits();
  CPLSetThreadLocalConfigOption(allowed_name, gdal_name(address).c_str());
  CPLSetThreadLocalConfigOption(listing, "EMPTY_DIR");  // of the folder: what lies beside the object is not looked for
}

OpenAddress::~OpenAddress() {
  CPLSetThreadLocalConfigOption(allowed_name, nullptr);
  CPLSetThreadLocalConfigOption(listing, nullptr);
}

StoredObject::StoredObject(std::filesystem::path address) : address_(std::move(address)) {
  const OpenAddress open(address_);
  const Failure failure;
  VSIErrorReset();
  file_ = VSIFOpenExL(gdal_name(address_).c_str(), "rb", TRUE);
  if (!file_) expect_network(address_), cannot_read(address_, reason(failure));
  VSIFSeekL(handle(file_), 0, SEEK_END);
  size_ = VSIFTellL(handle(file_));
}

StoredObject::~StoredObject() {
  if (file_) VSIFCloseL(handle(file_));
}

std::size_t StoredObject::read_some(std::uint64_t at, void* to, std::size_t n) {
  if (at >= size_) return 0;
  const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(n, size_ - at));
  std::string why;
  for (int attempt = 0; attempt < read_attempts; ++attempt) {
    if (attempt > 0) std::this_thread::sleep_for(first_pause * (1 << attempt));
    const Failure failure;
    if (VSIFSeekL(handle(file_), at, SEEK_SET) == 0 && VSIFReadL(to, 1, wanted, handle(file_)) == wanted) return wanted;
    why = failure.text;
  }
  cannot_read(address_, (why.empty() ? "" : why + ", ") + "at byte " + std::to_string(at) + " of " + std::to_string(size_) + ", in " +
                            std::to_string(read_attempts) + " attempts");
}

ObjectState object_state(const std::filesystem::path& address) {
  const StoredObject object(address);
  ObjectState out{object.size(), {}};
  const OpenAddress open(address);
  const Failure ignored;
  const CPLStringList headers(VSIGetFileMetadata(gdal_name(address).c_str(), "HEADERS", nullptr));
  for (const char* key : {"ETag", "Last-Modified"})  // found regardless of case
    if (const char* value = headers.FetchNameValue(key)) out.version += std::string(key) + " " + value + "\n";
  return out;
}

std::uint64_t store_file(const std::filesystem::path& file, const std::filesystem::path& address, const std::string& hint) {
  const BinaryFile in(file);
  set_limits();
  expect_network(address);
  std::string why = copied(in, address);
  try {
    const std::uint64_t there = StoredObject(address).size();
    if (why.empty() && there != in.size()) why = "it has " + std::to_string(there) + " bytes there, the file " + std::to_string(in.size());
  } catch (const core::Error& e) {
    // Of a write that failed GDAL does not say why; of one that worked the object must be there.
    const std::string said = std::string(e.what()).substr(std::string(not_read).size());
    if (why.empty() || e.hint() != no_object) why = said.empty() ? why : said.substr(said.find_first_not_of(": "));
  }
  if (!why.empty()) throw core::SystemError("cannot write to the store: " + why, shown_name(address), hint_of(why) + "; " + hint);
  return in.size();
}

}  // namespace swath::io
