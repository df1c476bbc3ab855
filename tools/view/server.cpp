// SPDX-License-Identifier: GPL-3.0-or-later
// Only programs of this machine reach 127.0.0.1. A page of the web could still have its reader's browser ask there under a name of its own
// that it lets point to 127.0.0.1 (DNS rebinding): requests under any other name than ours are refused.
#include "tools/view/server.h"

#include <httplib.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <map>
#include <memory>
#include <thread>

#include "core/error.h"
#include "tools/view/pages.h"

namespace swath::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* loopback = "127.0.0.1";
constexpr std::size_t piece = 1 << 16;  // bytes of a file that are sent at a time
constexpr std::size_t most_request = 1 << 16;

const char* type_of(const fs::path& file) {
  static const std::map<std::string, const char*> types{
      {".html", "text/html; charset=utf-8"}, {".json", "application/json"},      {".png", "image/png"}, {".svg", "image/svg+xml"},
      {".txt", "text/plain; charset=utf-8"}, {".csv", "text/csv; charset=utf-8"}};
  const auto at = types.find(file.extension().string());
  return at == types.end() ? "application/octet-stream" : at->second;
}

void send_file(const fs::path& file, httplib::Response& response) {
  const auto in = std::make_shared<std::ifstream>(file, std::ios::binary);
  std::error_code ignored;
  const std::uintmax_t size = fs::file_size(file, ignored);
  if (!*in || ignored) {
    response.status = 404;
    return;
  }
  if (size == 0) return response.set_content("", type_of(file));
  response.set_content_provider(size, type_of(file), [in](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
    std::string bytes(std::min(length, piece), '\0');
    in->clear();
    in->seekg(static_cast<std::streamoff>(offset));
    in->read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return in->gcount() > 0 && sink.write(bytes.data(), static_cast<std::size_t>(in->gcount()));
  });
}

bool is_ours(const httplib::Request& request, int port) {
  const std::string host = request.get_header_value("Host"), number = ":" + std::to_string(port);
  return request.get_header_value_count("Host") == 1 && (host == loopback + number || host == "localhost" + number);
}

void add_answers(httplib::Server& server, const Served& served) {
  server.Get("/", [&](const httplib::Request&, httplib::Response& r) { r.set_content(served.page, "text/html; charset=utf-8"); });
  server.Get("/scene/(.+)", [&](const httplib::Request& q, httplib::Response& r) {
    for (const Blob& b : served.blobs)
      if (b.name == q.matches[1].str()) return r.set_content(b.bytes, "application/octet-stream");
    r.status = 404;
  });
  // The decoder is compiled in the browser from its bytes.
  server.Get("/stream.js", [&](const httplib::Request&, httplib::Response& r) {
    r.set_header("Content-Security-Policy", "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; connect-src 'self'");
    r.set_content(std::string(stream_script), "text/javascript; charset=utf-8");
  });
  server.Get("/cloud/([0-9]{1,6})", [&](const httplib::Request& q, httplib::Response& r) {
    const std::size_t number = std::stoul(q.matches[1].str());
    if (number < served.clouds.size()) return send_file(served.clouds[number], r);
    r.status = 404;
  });
  server.Get("/files/(.+)", [&](const httplib::Request& q, httplib::Response& r) {
    const fs::path file = file_within(served.folder, q.matches[1].str());
    if (file.empty()) {
      r.status = 404;
      return;
    }
    send_file(file, r);
  });
}

std::atomic<int> wake = -1;  // written to by a signal

void end_asked(int) {
  const char byte = 0;
  if (const int fd = wake; fd >= 0) [[maybe_unused]]
    const auto sent = write(fd, &byte, 1);
}

/// While it lives, signals that ask to end are noted in place of ending the process.
class EndSignals {
 public:
  EndSignals() {
    if (pipe(ends_) != 0) throw core::SystemError("no pipe is to be had from the system");
    wake = ends_[1];
    struct sigaction action {};
    action.sa_handler = end_asked;
    for (std::size_t k = 0; k < signals.size(); ++k) sigaction(signals[k], &action, &before_[k]);
  }
  ~EndSignals() {
    for (std::size_t k = 0; k < signals.size(); ++k) sigaction(signals[k], &before_[k], nullptr);
    wake = -1;
    close(ends_[0]);
    close(ends_[1]);
  }
  EndSignals(const EndSignals&) = delete;
  EndSignals& operator=(const EndSignals&) = delete;
  void wait() const {
    char byte = 0;
    while (read(ends_[0], &byte, 1) < 0 && errno == EINTR) {
    }
  }

 private:
  static constexpr std::array signals{SIGINT, SIGTERM, SIGHUP};
  int ends_[2]{-1, -1};
  std::array<struct sigaction, 3> before_{};
};

}  // namespace

fs::path file_within(const fs::path& folder, const std::string& path) {
  if (folder.empty() || path.find('\0') != std::string::npos) return {};
  for (const fs::path& part : fs::path(path))
    if (part.string().starts_with(".") || part.is_absolute()) return {};
  std::error_code fault;
  const fs::path root = fs::canonical(folder, fault);
  if (fault) return {};
  const fs::path file = fs::canonical(root / path, fault);
  if (fault || !fs::is_regular_file(file, fault)) return {};
  const fs::path inner = file.lexically_relative(root);
  return inner.empty() || inner.begin()->string() == ".." ? fs::path() : file;
}

void serve(int port, const std::function<Served()>& prepare, const std::function<void(const std::string&)>& ready) {
  httplib::Server server;
  // The library's own choice would let two servers share a port, each with some of the requests.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  server.set_payload_max_length(most_request);
  server.set_keep_alive_max_count(1000);
  if (port == 0)
    port = server.bind_to_any_port(loopback);
  else if (!server.bind_to_port(loopback, port))
    port = -1;
  if (port < 0)
    throw core::usage_error("the port is in use or not allowed", "--port", "name another, or leave --port out: a free one is taken");
  server.set_pre_routing_handler([port](const httplib::Request& q, httplib::Response& r) {
    r.set_header("X-Content-Type-Options", "nosniff");
    r.set_header("Cross-Origin-Resource-Policy", "same-origin");
    r.set_header("Referrer-Policy", "no-referrer");
    r.set_header("Cache-Control", "no-store");
    if (is_ours(q, port)) return httplib::Server::HandlerResponse::Unhandled;
    r.status = 403;
    r.set_content("swath view answers under its own address alone\n", "text/plain; charset=utf-8");
    return httplib::Server::HandlerResponse::Handled;
  });
  const Served served = prepare();
  const EndSignals signals;
  add_answers(server, served);
  std::thread listener([&] { server.listen_after_bind(); });
  ready("http://" + std::string(loopback) + ":" + std::to_string(port) + "/");
  signals.wait();
  while (!server.is_running()) std::this_thread::yield();
  server.stop();
  listener.join();
}

}  // namespace swath::tools
