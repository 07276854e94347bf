// A proxy class: what turns a mote's octets into meaning, and words into octets (PXY-04,
// 05, 11..13).
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/address.hpp"
#include "core/bytes.hpp"
#include "core/time.hpp"
#include "proxy/classes/type_range.hpp"

namespace rubicon::proxy {

class program; // program.hpp

inline constexpr std::size_t mean_of_max = 16;

/// How a field's octets are read; multi-byte ones in network byte order (GW-11). A stamp is the low
/// 32 bits of the network time in milliseconds; its count is all of it, since 1970.
enum class encoding : std::uint8_t { u8, i8, u16, i16, u32, i32, stamp };

/// A stream of sensor records that ends at the proxy (PXY-18).
struct stream_input {
  std::uint16_t number = 0; ///< symbolic name
  duration every = 1s;      ///< as its writer's
};

/// What fields are read from together: a message on an output channel, or a record of a stream.
struct reading_source {
  bool is_stream = false;
  std::uint16_t number = 0;

  reading_source() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): most are
  constexpr reading_source(std::uint16_t channel) : number(channel) {}
  constexpr explicit reading_source(const stream_input& x) : is_stream(true), number(x.number) {}

  friend auto operator<=>(const reading_source&, const reading_source&) = default;
};

/// One published value: `count * scale + add`, or a word for a count.
struct field {
  std::string name;          ///< last part of the tuple's key, `temperature`
  std::uint16_t channel = 0; ///< of `devices.$ID.output.$CH`
  std::size_t offset = 0;    ///< first octet in the payload
  encoding layout = encoding::i16;
  double scale = 1;
  double add = 0;
  int decimals = 1;                                        ///< digits after the point, 0..6
  std::string unit;                                        ///< empty: no unit tuple is published
  std::vector<std::pair<std::int64_t, std::string>> words; ///< count -> word, instead of a number
  std::size_t mean_of = 1;       ///< the value is the mean of so many counts, 1..mean_of_max
  bool computed_by_mote = false; ///< that mean is what the mote sends (PXY-17)
  std::optional<stream_input> stream =
      {}; ///< instead of the channel: the count is a record's value

  [[nodiscard]] reading_source source() const {
    return stream ? reading_source(*stream) : reading_source(channel);
  }
};

/// One more tuple of a proxy, beside those that every proxy has. It is set for each message that
/// its fields are read from, or once, at the start, if it names none. In its key and its text names
/// in braces stand for what they name: {island}, {id}, {name}, {class}, {room}, {channel},
/// properties; in the text fields and their units, {temperature} and {temperature.unit}, too.
struct tuple_template {
  std::string key; ///< the whole key, `{room}.{name}.climate`
  std::string text;
  std::vector<std::string> json; ///< instead of a text: the fields of one JSON object
};

/// How well a proxy's users are to be served (PXY-12, PXY-20, GW-10).
struct proxy_settings {
  duration answer_timeout = 20s;          ///< for the outcome of a request
  std::optional<duration> inactive_after; ///< since the mote was last sensed; unset: never
  std::optional<duration> retire_after;   ///< since the mote was lost; unset: never
  duration retry_for{};   ///< what has failed is written again, until so long after the first time
  duration period{};      ///< asked of the mote for all outputs that are read; 0: as it likes
  duration stale_after{}; ///< a value that is older is marked so; 0: never
};

/// How an input takes numbers: (number - add) / scale, rounded, as a count in network byte order.
struct number_form {
  encoding layout = encoding::u8;
  double scale = 1; ///< not 0
  double add = 0;
  double min = 0; ///< of the number, inclusive, as the next one; their counts fit the encoding
  double max = 255;
};

/// One actuator input: a word or number written to the proxy's tuple becomes octets for the mote.
struct input {
  std::string name;                                 ///< last part of the tuple's key, `switch`
  std::uint16_t channel = 0;                        ///< of `devices.$ID.input.$CH`
  std::vector<std::pair<std::string, bytes>> words; ///< `on` -> 01
  bool meta = false; ///< it is the tuple that `mi-NAME` points at, at first its own (META-05)
  std::optional<number_form> numbers = {}; ///< beside the words; unset: it takes none
  std::string unit = {};                   ///< of the numbers; empty: no unit tuple is published
};

/// Ids on a kind of interface that begin so; without regard to letter case.
struct id_prefix {
  std::string channel; ///< `rfid`
  std::string prefix;  ///< empty: every id
};

/// One object of a class that is known beforehand, by its id; that of a mote is `island/mote`.
struct known_object {
  std::string id;
  std::string name; ///< for {name} of the class's prefix; empty: its id
  std::vector<std::pair<std::string, std::string>> properties; ///< beside those of the class
  std::optional<position> place = {}; ///< of a mote: where it was put (PXY-06)
};

struct proxy_class {
  // Compiled once: they are large.
  proxy_class();
  ~proxy_class();
  proxy_class(const proxy_class&);
  proxy_class& operator=(const proxy_class&);
  proxy_class(proxy_class&&) noexcept;
  proxy_class& operator=(proxy_class&&) noexcept;

  std::string name;
  std::vector<type_range> types; ///< of motes it claims; the narrowest matching range wins
  std::vector<id_prefix> ids;    ///< of other objects it claims; the longest matching prefix wins
  std::vector<known_object> objects; ///< the table that prior information comes from (PXY-05)
  /// Key prefix of its tuples. Of motes {island}, {id} and {name} are replaced by the
  /// mote's decimal id and the mote's configured name.
  std::string prefix = "{island}.{name}";
  std::vector<std::pair<std::string, std::string>> properties; ///< prior information, key and text
  std::vector<field> fields;
  /// Channels whose messages end with the time of their counts, as an encoding::stamp, on all motes
  /// of the class: behind what its fields cover.
  std::vector<std::uint16_t> stamped_channels;
  std::vector<input> inputs;
  instant known_from; ///< when proxy managers learn of it (PXY-10)
  std::vector<tuple_template> tuples;
  proxy_settings settings;
  bool indirect = false; ///< of motes: publish interface and position; tagged objects always do
  std::string program;   ///< name of the program whose code completes this table; empty: none
  std::function<std::unique_ptr<proxy::program>()> make_program; ///< empty if there is none
};

} // namespace rubicon::proxy
