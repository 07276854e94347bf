#include "control/frame.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <type_traits>
#include <utility>
#include <variant>

#include "core/codec.hpp"

namespace rubicon::control {

namespace {

constexpr std::uint16_t mark = 0x5275; // Ru
constexpr std::uint8_t layout = 1;

/// Files and reports, and what stands around them.
constexpr std::size_t large_octets_max = deploy::bundle_octets_max + (std::size_t{16} << 20);
constexpr std::size_t tiny_octets_max = 16 * 1024;
constexpr std::size_t list_octets_max = 128 * 1024;

template <class T>
constexpr std::size_t limit_of() {
  using namespace deploy;
  if constexpr (std::is_same_v<T, offer> || std::is_same_v<T, offer_seeds> ||
                std::is_same_v<T, news> || std::is_same_v<T, seeds_news>)
    return large_octets_max;
  else if constexpr (std::is_same_v<T, verdict>)
    return small_octets_max;
  else if constexpr (std::is_same_v<T, run_seeds> || std::is_same_v<T, send_revoked>)
    return list_octets_max;
  else
    return tiny_octets_max;
}

template <class... Each>
constexpr std::array<std::size_t, sizeof...(Each)> limits_of(const std::variant<Each...>* /*of*/) {
  return {limit_of<Each>()...};
}

constexpr auto of_questions = limits_of(static_cast<const deploy::question*>(nullptr));
constexpr auto of_answers = limits_of(static_cast<const deploy::answer*>(nullptr));

} // namespace

bytes encode_header(const frame& x) {
  assert(x.content.size() <= std::numeric_limits<std::uint32_t>::max());
  byte_writer out;
  out.big(mark).octet(layout).octet(x.kind).big(x.number);
  out.big(static_cast<std::uint32_t>(x.content.size()));
  return out.finish();
}

frame_limits question_limits() {
  return of_questions;
}

frame_limits answer_limits() {
  return of_answers;
}

std::size_t frame_reader::feed(byte_view octets) {
  std::size_t taken = 0;
  if (state_ == state::header) {
    taken = std::min(octets.size(), frame_header_octets - header_octets_);
    std::ranges::copy(octets.first(taken),
                      header_.begin() + static_cast<std::ptrdiff_t>(header_octets_));
    header_octets_ += taken;
    if (header_octets_ < frame_header_octets)
      return taken;
    read_header();
  }
  if (state_ == state::content) {
    const auto more = octets.subspan(taken).first(
        std::min(octets.size() - taken, announced_ - frame_.content.size()));
    frame_.content.insert(frame_.content.end(), more.begin(), more.end());
    taken += more.size();
    if (frame_.content.size() == announced_)
      state_ = state::complete;
  }
  return taken;
}

void frame_reader::read_header() {
  byte_reader in(header_);
  if (in.big<std::uint16_t>() != mark)
    return refuse("it does not use rubicon's protocol");
  if (const auto theirs = in.octet(); theirs != layout)
    return refuse("its protocol has version " + std::to_string(theirs) + ", ours " +
                  std::to_string(layout) + ": install the same version on both");
  frame_.kind = in.octet();
  frame_.number = in.big<std::uint32_t>();
  const std::size_t size = in.big<std::uint32_t>();
  if (frame_.kind >= limits_.size())
    return refuse("a message of kind " + std::to_string(frame_.kind) + ", which is unknown");
  if (size > limits_[frame_.kind])
    return refuse("a message of kind " + std::to_string(frame_.kind) + " of " +
                  std::to_string(size) + " octets, which has at most " +
                  std::to_string(limits_[frame_.kind]));
  announced_ = size;
  state_ = state::content;
}

void frame_reader::refuse(std::string why) {
  problem_ = std::move(why);
  state_ = state::refused;
}

frame frame_reader::take() {
  assert(state_ == state::complete);
  state_ = state::header;
  header_octets_ = 0;
  announced_ = 0;
  return std::exchange(frame_, {});
}

} // namespace rubicon::control
