#include "serial/recording.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <utility>

#include "core/text/decimal.hpp"

namespace rubicon::serial {

namespace {

void append(bytes& to, const bytes& octets) {
  to.insert(to.end(), octets.begin(), octets.end());
}

/// Takes the next word off.
std::string_view next_word(std::string_view& rest) {
  rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
  const auto word = rest.substr(0, rest.find(' '));
  rest.remove_prefix(word.size());
  return word;
}

std::string_view without_line_end(std::string_view x) {
  while (!x.empty() && (x.back() == '\r' || x.back() == ' '))
    x.remove_suffix(1);
  return x;
}

recording_problem wrong(std::string what) {
  return {0, std::move(what)};
}

std::optional<frame_type> type_of(std::uint8_t x) {
  switch (static_cast<frame_type>(x)) {
  case frame_type::ack:
  case frame_type::packet_with_ack:
  case frame_type::packet:
  case frame_type::unknown:
    return static_cast<frame_type>(x);
  }
  return {};
}

/// "12.004160" in nanoseconds.
std::optional<instant> time_of(std::string_view x) {
  const auto found = number_in(x);
  constexpr double longest_s = 1e9;
  if (!found || *found < 0 || *found > longest_s)
    return {};
  return instant(duration(std::llround(*found * 1e9)));
}

} // namespace

std::string to_text(const recorded_frame& x) {
  auto text = rubicon::to_text(x.at) + ' ' + x.island +
              (x.towards == direction::to_pc ? " up " : " down ") +
              to_hex(bytes{static_cast<std::uint8_t>(x.what.type)});
  if (has_sequence(x.what.type))
    text += ' ' + to_hex(bytes{x.what.sequence});
  if (!x.what.packet.empty())
    text += ' ' + to_hex(x.what.packet);
  return text;
}

std::variant<std::monostate, recorded_frame, recording_problem>
read_recorded(std::string_view line) {
  auto rest = without_line_end(line);
  if (rest.empty() || rest.front() == '#')
    return std::monostate{};
  recorded_frame out;
  const auto time = time_of(next_word(rest));
  if (!time)
    return wrong("expected a time in seconds, as 12.004160, at its beginning");
  out.at = *time;
  out.island = next_word(rest);
  const auto towards = next_word(rest);
  if (out.island.empty() || (towards != "up" && towards != "down"))
    return wrong("expected an island and `up` or `down` behind the time");
  out.towards = towards == "up" ? direction::to_pc : direction::to_mote;
  const auto type = from_hex(next_word(rest));
  const auto known = type && type->size() == 1 ? type_of(type->front()) : std::nullopt;
  if (!known)
    return wrong("expected the type of a frame, 43, 44, 45 or ff");
  out.what.type = *known;
  if (has_sequence(*known)) {
    const auto sequence = from_hex(next_word(rest));
    if (!sequence || sequence->size() != 1)
      return wrong("expected the sequence number of the frame, as two hexadecimal digits");
    out.what.sequence = sequence->front();
  }
  auto packet = from_hex(rest);
  if (!packet || packet->size() > frame_octets_max ||
      (*known == frame_type::ack && !packet->empty()))
    return wrong("expected the packet in hexadecimal, at most " + std::to_string(frame_octets_max) +
                 " octets; an ack has none");
  out.what.packet = std::move(*packet);
  return out;
}

std::variant<std::vector<recorded_frame>, recording_problem>
read_recording(std::string_view text, std::string_view island) {
  std::vector<recorded_frame> out;
  std::size_t number = 0;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    const auto line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    if (number == 1 && without_line_end(line) != recording_title)
      return recording_problem{1, "is not a serial recording: its first line is not `" +
                                      std::string(recording_title) + '`'};
    auto found = read_recorded(line);
    if (auto* problem = std::get_if<recording_problem>(&found))
      return recording_problem{number, std::move(problem->message)};
    auto* x = std::get_if<recorded_frame>(&found);
    const auto is_packet = [](frame_type type) {
      return type == frame_type::packet || type == frame_type::packet_with_ack;
    };
    if (x != nullptr && x->island == island && x->towards == direction::to_pc &&
        is_packet(x->what.type))
      out.push_back(std::move(*x));
  }
  std::ranges::stable_sort(out, {}, &recorded_frame::at);
  return out;
}

replay::replay(std::shared_ptr<const std::vector<recorded_frame>> all, double speed)
    : all_(std::move(all)), speed_(speed) {
  assert(all_ != nullptr && speed > 0);
}

bytes replay::on_time(instant now) {
  bytes out;
  for (; all_ && next_ < all_->size() && due((*all_)[next_]) <= now; ++next_)
    append(out, encode((*all_)[next_].what));
  return out;
}

std::optional<instant> replay::deadline() const {
  if (!all_ || next_ == all_->size())
    return {};
  return due((*all_)[next_]);
}

bytes replay::on_pc(byte_view octets) {
  bytes out;
  for (const auto octet : octets)
    if (const auto x = decoder_.on_octet(octet); x && x->type == frame_type::packet_with_ack)
      append(out, encode(frame{frame_type::ack, x->sequence, {}}));
  return out;
}

instant replay::due(const recorded_frame& x) const {
  if (speed_ == 1)
    return x.at;
  return instant(
      duration(std::llround(static_cast<double>(x.at.time_since_epoch().count()) / speed_)));
}

} // namespace rubicon::serial
