// Frames of IEEE 802.15.4 that have another layout than TinyOS's: what a radio reads of them.
#pragma once

#include <cstdint>

#include "core/bytes.hpp"
#include "radio/frame.hpp"

namespace rubicon::radio {

/// What the address filter, the medium access and the receiver's memory need of a frame of any
/// layout (IEEE 802.15.4-2006 7.2.1, and the PAN rules of 802.15.4-2015 table 7-2): its sequence
/// number, whether it requests an acknowledgement, source and destination. A long address stands
/// for the mote in its low 16 bits. Who has no destination, or one that is not whole, sends to all,
/// and requests no acknowledgement.
/// @param octets without the FCS
/// @param pan of the sender's radio, whatever PAN the frame names: islands are apart
/// @returns a data frame without payload and AM type
[[nodiscard]] frame read_header(byte_view octets, std::uint16_t pan);

/// The PSDU: the octets and their FCS.
[[nodiscard]] bytes with_fcs(byte_view octets);

} // namespace rubicon::radio
