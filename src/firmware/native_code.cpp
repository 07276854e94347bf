#include "firmware/native_code.hpp"

#include <stdexcept>

#include "firmware/library.hpp"

namespace rubicon::firmware {

namespace {

host& of(void* context) {
  return *static_cast<host*>(context);
}

/// An octet count of 0 may come with a null pointer.
byte_view view_of(const std::uint8_t* octets, std::size_t count) {
  return octets == nullptr ? byte_view() : byte_view(octets, count);
}

rubicon_mote_host functions_for(const identity& who, host& its) {
  rubicon_mote_host x{};
  x.version = RUBICON_MOTE_VERSION;
  x.island = who.island;
  x.channel = who.channel;
  x.context = &its;
  x.send = [](void* context, const std::uint8_t* frame, std::size_t length) -> int {
    return of(context).send(view_of(frame, length));
  };
  x.radio = [](void* context, int on) { of(context).set_radio(on != 0); };
  x.timer = [](void* context, std::uint64_t at) { of(context).set_timer(at); };
  x.serial = [](void* context, const std::uint8_t* octets, std::size_t count) {
    of(context).write_serial(view_of(octets, count));
  };
  x.random = [](void* context) { return of(context).draw(); };
  x.read = [](void* context, const char* sensor, std::int32_t* counts) -> int {
    const auto found = sensor == nullptr ? std::nullopt : of(context).read(sensor);
    if (!found)
      return RUBICON_MOTE_ABSENT;
    if (counts != nullptr)
      *counts = *found;
    return RUBICON_MOTE_OK;
  };
  x.leds = [](void* context, unsigned on) { of(context).set_leds(on); };
  x.log = [](void* context, const char* line) {
    if (line != nullptr)
      of(context).log(line);
  };
  return x;
}

} // namespace

native_code::native_code(const rubicon_mote_firmware& exported) : exported_(exported) {
  if (const auto wrong = refusal({exported.version, exported.flags}); !wrong.empty())
    throw std::runtime_error("the firmware " + wrong);
  if (exported.init == nullptr || exported.run == nullptr || exported.received == nullptr ||
      exported.sent == nullptr)
    throw std::runtime_error("the firmware lacks one of init, run, received and sent");
}

native_code::~native_code() {
  if (mote_ != nullptr && exported_.end != nullptr)
    exported_.end(mote_);
}

void native_code::init(const identity& who, host& its) {
  host_ = functions_for(who, its);
  mote_ = exported_.init(who.mote, &host_);
  if (mote_ == nullptr)
    throw std::runtime_error("the firmware cannot run: its init returned NULL");
}

void native_code::run(std::uint64_t now_us) {
  exported_.run(mote_, now_us);
}

void native_code::received(std::uint64_t now_us, byte_view frame, int rssi_dbm) {
  exported_.received(mote_, now_us, frame.data(), frame.size(), rssi_dbm);
}

void native_code::sent(std::uint64_t now_us, outcome how) {
  exported_.sent(mote_, now_us, how);
}

} // namespace rubicon::firmware
