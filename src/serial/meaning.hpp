// What packets of programs and layers that come with TinyOS say.
#pragma once

#include <string>

#include "serial/packet.hpp"

namespace rubicon::serial {

/// In words, by AM type and length: BlinkToRadio, RadioCountToLeds, Oscilloscope, MViz, printf, CTP
/// (docs/tinyos.md 4.4), dissemination, FTSP, and what is in a time-stamped message. One line
/// without control characters; empty: it is of something else.
[[nodiscard]] std::string meaning_of(const am_packet& x);

} // namespace rubicon::serial
