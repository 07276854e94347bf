#include "io/files/pcapng.hpp"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "core/text/printable.hpp"

namespace rubicon::io {

namespace pcapng {

namespace {

constexpr std::uint32_t section_block = 0x0a0d0d0a;
constexpr std::uint32_t interface_block = 1;
constexpr std::uint32_t packet_block = 6;
constexpr std::uint32_t byte_order = 0x1a2b3c4d;

/// Codes of options (sections 3.5, 4.1, 4.2).
constexpr std::uint16_t end_of_options = 0;
constexpr std::uint16_t comment_option = 1;
constexpr std::uint16_t interface_name = 2;
constexpr std::uint16_t user_application = 4;
constexpr std::uint16_t time_resolution = 9;

void put(bytes& out, std::uint64_t x, std::size_t octets) {
  for (std::size_t i = 0; i < octets; ++i)
    out.push_back(static_cast<std::uint8_t>(x >> (8 * i)));
}

/// Octets, and zeros up to a multiple of four.
void put_padded(bytes& out, byte_view octets) {
  out.insert(out.end(), octets.begin(), octets.end());
  out.resize((out.size() + 3) / 4 * 4);
}

void put_option(bytes& out, std::uint16_t code, byte_view value) {
  put(out, code, 2);
  put(out, value.size(), 2);
  put_padded(out, value);
}

/// Cut between characters.
bytes text_octets(std::string_view x) {
  std::size_t size = 0;
  while (size < x.size()) {
    const auto next = std::max<std::size_t>(character_size(x.substr(size)), 1);
    if (size + next > comment_octets_max)
      break;
    size += next;
  }
  return to_bytes(x.substr(0, size));
}

/// @param body a multiple of four octets
bytes block(std::uint32_t type, const bytes& body) {
  constexpr std::size_t around = 12; // type, and the length before and behind
  bytes out;
  out.reserve(body.size() + around);
  put(out, type, 4);
  put(out, body.size() + around, 4);
  out.insert(out.end(), body.begin(), body.end());
  put(out, body.size() + around, 4);
  return out;
}

} // namespace

bytes section_header(std::string_view program) {
  bytes body;
  put(body, byte_order, 4);
  put(body, 1, 2); // version 1.0
  put(body, 0, 2);
  put(body, ~std::uint64_t{0}, 8); // how long it is, is not said
  put_option(body, user_application, text_octets(program));
  put_option(body, end_of_options, {});
  return block(section_block, body);
}

bytes interface_description(std::uint16_t link_type, std::uint32_t octets_max,
                            std::string_view name) {
  bytes body;
  put(body, link_type, 2);
  put(body, 0, 2);
  put(body, octets_max, 4);
  if (!name.empty())
    put_option(body, interface_name, text_octets(name));
  put_option(body, time_resolution, bytes{9}); // 10^-9 s
  put_option(body, end_of_options, {});
  return block(interface_block, body);
}

bytes enhanced_packet(instant at, byte_view octets, std::string_view comment) {
  assert(at >= instant{});
  const auto since = static_cast<std::uint64_t>(at.time_since_epoch().count());
  bytes body;
  put(body, 0, 4); // the only interface
  put(body, since >> 32, 4);
  put(body, since & 0xffffffff, 4);
  put(body, octets.size(), 4); // captured
  put(body, octets.size(), 4); // on the air
  put_padded(body, octets);
  if (!comment.empty()) {
    put_option(body, comment_option, text_octets(comment));
    put_option(body, end_of_options, {});
  }
  return block(packet_block, body);
}

} // namespace pcapng

namespace {

struct close_file {
  void operator()(std::FILE* x) const { std::fclose(x); }
};

} // namespace

struct pcapng_file::impl {
  std::string path;
  std::unique_ptr<std::FILE, close_file> file;
  std::string error;

  void put(const bytes& block) {
    if (!error.empty())
      return;
    errno = 0;
    check(std::fwrite(block.data(), 1, block.size(), file.get()) != block.size());
  }
  /// Right after a call that may have failed.
  void check(bool failed) {
    const auto reason = errno;
    if (failed)
      error = path + ": " + std::generic_category().message(reason != 0 ? reason : EIO);
  }
};

std::variant<pcapng_file, std::string> pcapng_file::open(const std::string& path,
                                                         std::string_view name) {
  auto x = std::make_unique<impl>();
  x->path = path;
  errno = 0;
  x->file.reset(std::fopen(path.c_str(), "wbe"));
  if (!x->file)
    return path + ": " + std::generic_category().message(errno != 0 ? errno : EIO);
  x->put(pcapng::section_header("rubicon"));
  x->put(pcapng::interface_description(pcapng::ieee802154_with_fcs, psdu_max, name));
  return pcapng_file(std::move(x));
}

pcapng_file::pcapng_file(std::unique_ptr<impl> x) : impl_(std::move(x)) {}

pcapng_file::~pcapng_file() = default;
pcapng_file::pcapng_file(pcapng_file&&) noexcept = default;
pcapng_file& pcapng_file::operator=(pcapng_file&&) noexcept = default;

void pcapng_file::write(instant at, byte_view psdu, std::string_view comment) {
  assert(psdu.size() <= psdu_max);
  impl_->put(pcapng::enhanced_packet(at, psdu, comment));
}

void pcapng_file::flush() {
  if (!impl_->error.empty())
    return;
  errno = 0;
  impl_->check(std::fflush(impl_->file.get()) != 0);
}

const std::string& pcapng_file::error() const {
  return impl_->error;
}

} // namespace rubicon::io
