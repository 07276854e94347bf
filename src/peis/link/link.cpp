#include "peis/link/link.hpp"

#include <algorithm>

#include "peis/wire/layout.hpp"

namespace rubicon::peis {

namespace {

constexpr std::size_t connect_network_at = 12;
constexpr std::size_t network_size = 64;

} // namespace

bytes encode(const connect_request& request) {
  layout_writer<connect_request_size> to;
  to.big(0, request.version).big(4, request.id.value).big(8, request.flags);
  to.text(connect_network_at, network_size, request.network);
  return to_bytes(to.view());
}

result<connect_request> decode_connect_request(byte_view octets) {
  if (octets.size() < connect_request_size)
    return errc::truncated;
  const layout_reader from(octets);
  const auto network = from.text(connect_network_at, network_size);
  if (!network)
    return errc::bad_value;
  return connect_request{from.big<std::int32_t>(0), peer_id{from.big<std::int32_t>(4)},
                         from.big<std::uint32_t>(8), std::string(*network)};
}

void stream_decoder::feed(byte_view piece) {
  keep_rest();
  piece_ = piece;
}

void stream_decoder::keep_rest() {
  if (piece_.empty())
    return;
  held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(used_));
  used_ = 0;
  held_.insert(held_.end(), piece_.begin(), piece_.end());
  piece_ = {};
}

/// Are so many octets there in one run? An incomplete unit is completed in held_ with just what it
/// lacks, so that all that follows is read from the piece without copying.
bool stream_decoder::available(std::size_t count) {
  if (used_ == held_.size()) {
    held_.clear();
    used_ = 0;
    if (piece_.size() >= count)
      return true;
  }
  const auto have = held_.size() - used_;
  if (have >= count)
    return true;
  const auto lacking = piece_.first(std::min(piece_.size(), count - have));
  held_.insert(held_.end(), lacking.begin(), lacking.end());
  piece_ = piece_.subspan(lacking.size());
  return held_.size() - used_ >= count;
}

byte_view stream_decoder::take(std::size_t count) {
  if (held_.empty()) {
    const auto taken = piece_.first(count);
    piece_ = piece_.subspan(count);
    return taken;
  }
  const auto taken = byte_view(held_).subspan(used_, count);
  used_ += count;
  return taken;
}

std::optional<byte_view> stream_decoder::take_connect_request() {
  if (!available(connect_request_size))
    return std::nullopt;
  return take(connect_request_size);
}

std::optional<received_package> stream_decoder::next() {
  if (broken_ || !available(header_size))
    return std::nullopt;
  const auto start = held_.empty() ? piece_ : byte_view(held_).subspan(used_);
  const auto header = decode_header(start);
  if (!header) {
    broken_ = true;
    return std::nullopt;
  }
  if (!available(header_size + header->length))
    return std::nullopt;
  const auto whole = take(header_size + header->length);
  return received_package{*header, whole.subspan(header_size)};
}

} // namespace rubicon::peis
