#include "network/sink_event.hpp"

#include <cassert>

#include "core/codec.hpp"
#include "core/network_time.hpp"

namespace rubicon::network {

namespace {

enum class kind : std::uint8_t {
  joined = 1,
  left = 2,
  roster = 3,
  describe = 4,
  started = 5,
  time_request = 6,
  time_answer = 7,
  gateway_poll = 8,
  gateway_answer = 9,
};

struct encoder {
  byte_writer& out;

  byte_writer& start(kind x) const { return out.octet(static_cast<std::uint8_t>(x)); }

  void operator()(const mote_joined& x) const {
    start(kind::joined).big(x.mote.value).big(x.incarnation).big(x.type).append(x.descriptor);
  }
  void operator()(const mote_left& x) const {
    start(kind::left).big(x.mote.value).octet(static_cast<std::uint8_t>(x.cause));
  }
  void operator()(const roster& x) const {
    assert(x.entries.size() <= roster_entries_max);
    start(kind::roster).big(x.number).octet(x.page).octet(x.pages);
    for (const auto& entry : x.entries)
      out.big(entry.mote.value).big(entry.incarnation);
  }
  void operator()(const describe& x) const { start(kind::describe).big(x.mote.value); }
  void operator()(const sink_started&) const { start(kind::started); }
  void operator()(const time_request& x) const {
    start(kind::time_request).big(x.number).big(std::uint64_t{0}).big(std::uint32_t{0});
  }
  void operator()(const gateway_poll& x) const {
    start(kind::gateway_poll).big(x.life).big(x.term).octet(x.leads ? 1 : 0);
  }
  void operator()(const gateway_answer& x) const {
    start(kind::gateway_answer).big(x.life).big(x.term);
  }
  void operator()(const time_answer& x) const {
    start(kind::time_answer)
        .big(x.number)
        .big(static_cast<std::uint64_t>(x.since_1970.count()))
        .big(static_cast<std::uint32_t>(x.held.count()));
  }
};

result<sink_event> finish(const byte_reader& in, sink_event x) {
  if (!in.ok())
    return errc::truncated;
  if (in.remaining() > 0)
    return errc::too_long;
  return x;
}

result<sink_event> decode_joined(byte_reader& in) {
  mote_joined x;
  x.mote = mote_id{in.big<std::uint16_t>()};
  x.incarnation = in.big<std::uint32_t>();
  x.type = in.big<std::uint32_t>();
  if (in.ok())
    x.descriptor = to_bytes(in.rest());
  return finish(in, std::move(x));
}

result<sink_event> decode_left(byte_reader& in) {
  mote_left x;
  x.mote = mote_id{in.big<std::uint16_t>()};
  const auto cause = in.octet();
  if (in.ok() && (cause < static_cast<std::uint8_t>(leave_cause::notice) ||
                  cause > static_cast<std::uint8_t>(leave_cause::out_of_range)))
    return errc::bad_value;
  x.cause = static_cast<leave_cause>(cause);
  return finish(in, x);
}

result<sink_event> decode_roster(byte_reader& in) {
  roster x;
  x.number = in.big<std::uint16_t>();
  x.page = in.octet();
  x.pages = in.octet();
  if (in.ok() && x.page >= x.pages)
    return errc::bad_value;
  while (in.ok() && in.remaining() > 0) {
    if (x.entries.size() == roster_entries_max)
      return errc::too_long;
    roster_entry entry;
    entry.mote = mote_id{in.big<std::uint16_t>()};
    entry.incarnation = in.big<std::uint32_t>();
    x.entries.push_back(entry);
  }
  return finish(in, std::move(x));
}

result<sink_event> decode_time_request(byte_reader& in) {
  const time_request x{in.big<std::uint16_t>()};
  if (in.big<std::uint64_t>() != 0 || in.big<std::uint32_t>() != 0)
    return errc::bad_value;
  return finish(in, x);
}

result<sink_event> decode_time_answer(byte_reader& in) {
  const auto number = in.big<std::uint16_t>();
  const auto us = in.big<std::uint64_t>();
  constexpr auto end = std::chrono::duration_cast<std::chrono::microseconds>(network_time_end);
  if (us >= static_cast<std::uint64_t>(end.count()))
    return errc::bad_value;
  const time_answer x{number, std::chrono::microseconds(static_cast<std::int64_t>(us)),
                      std::chrono::microseconds(in.big<std::uint32_t>())};
  return finish(in, x);
}

result<sink_event> decode_poll(byte_reader& in) {
  gateway_poll x;
  x.life = in.big<std::uint32_t>();
  x.term = in.big<std::uint32_t>();
  const auto leads = in.octet();
  if (in.ok() && leads > 1)
    return errc::bad_value;
  x.leads = leads == 1;
  return finish(in, x);
}

} // namespace

std::string to_string(leave_cause x) {
  switch (x) {
  case leave_cause::notice:
    return "notice";
  case leave_cause::silence:
    return "silence";
  case leave_cause::battery:
    return "battery";
  case leave_cause::out_of_range:
    return "out_of_range";
  }
  return "unknown";
}

bytes encode(const sink_event& x) {
  byte_writer out;
  std::visit(encoder{out}, x);
  return out.finish();
}

result<sink_event> decode_sink_event(byte_view octets) {
  byte_reader in(octets);
  const auto first = in.octet();
  if (!in.ok())
    return errc::truncated;
  switch (static_cast<kind>(first)) {
  case kind::joined:
    return decode_joined(in);
  case kind::left:
    return decode_left(in);
  case kind::roster:
    return decode_roster(in);
  case kind::started:
    return finish(in, sink_started{});
  case kind::time_request:
    return decode_time_request(in);
  case kind::time_answer:
    return decode_time_answer(in);
  case kind::gateway_poll:
    return decode_poll(in);
  case kind::gateway_answer: {
    gateway_answer x;
    x.life = in.big<std::uint32_t>();
    x.term = in.big<std::uint32_t>();
    return finish(in, x);
  }
  case kind::describe: {
    const describe x{mote_id{in.big<std::uint16_t>()}};
    return finish(in, x);
  }
  }
  return errc::unsupported;
}

} // namespace rubicon::network
