// A proxy class: what turns a mote's octets into meaning, and words into octets (PXY-04,
// 05, 11..13).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/bytes.hpp"
#include "core/time.hpp"

namespace rubicon::proxy {

/// How a field's octets are read; multi-byte ones in network byte order (GW-11).
enum class encoding : std::uint8_t { u8, i8, u16, i16, u32, i32 };

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
};

/// One actuator input: a word written to the proxy's tuple becomes octets for the mote.
struct input {
  std::string name;                                 ///< last part of the tuple's key, `switch`
  std::uint16_t channel = 0;                        ///< of `devices.$ID.input.$CH`
  std::vector<std::pair<std::string, bytes>> words; ///< `on` -> 01
  bool meta = false; ///< it is the tuple that `mi-NAME` points at, at first its own (META-05)
};

/// Inclusive range of mote type ids.
struct type_range {
  std::uint32_t first = 0;
  std::uint32_t last = 0;
};

/// Ids on a kind of interface that begin so; without regard to letter case.
struct id_prefix {
  std::string channel; ///< `rfid`
  std::string prefix;  ///< empty: every id
};

/// One object of a class that is known beforehand, by its id.
struct known_object {
  std::string id;
  std::string name; ///< for {name} of the class's prefix; empty: its id
  std::vector<std::pair<std::string, std::string>> properties; ///< beside those of the class
};

struct proxy_class {
  std::string name;
  std::vector<type_range> types; ///< of motes it claims; the narrowest matching range wins
  std::vector<id_prefix> ids;    ///< of other objects it claims; the longest matching prefix wins
  std::vector<known_object> objects; ///< the table that prior information comes from (PXY-05)
  /// Key prefix of its tuples. Of motes {island}, {id} and {name} are replaced by the
  /// mote's decimal id and the mote's configured name.
  std::string prefix = "{island}.{name}";
  std::vector<std::pair<std::string, std::string>> properties; ///< prior information, key and text
  std::vector<field> fields;
  std::vector<input> inputs;
  instant known_from; ///< when proxy managers learn of it (PXY-10)
};

} // namespace rubicon::proxy
