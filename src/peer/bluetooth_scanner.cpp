#include "peer/bluetooth_scanner.hpp"

#include <utility>
#include <vector>

#include "peis/bluetooth/hci_inquiry.hpp"

namespace rubicon::peer {

namespace {

constexpr duration inquiry_margin = 5s; ///< an inquiry that has not ended then has failed

} // namespace

bluetooth_scanner::bluetooth_scanner(io::loop& where, io::bluetooth_adapter& adapter,
                                     std::string name, adapter_user& user)
    : loop_(&where), adapter_(&adapter), name_(std::move(name)), user_(&user), end_(where) {}

void bluetooth_scanner::stop() {
  scanning_ = false;
  end_.stop();
  controller_ = {};
}

void bluetooth_scanner::start(duration length) {
  if (scanning_)
    return;
  auto socket = adapter_->open_controller();
  if (!std::holds_alternative<io::descriptor>(socket)) {
    ++failed_;
    return;
  }
  scanning_ = true;
  seen_.clear();
  controller_ = io::packet_stream(*loop_, std::move(std::get<io::descriptor>(socket)), room);
  controller_.start({[this](byte_view packet) { on_inquiry(packet); }, [](std::size_t) {},
                     [this](const std::string&) { end(false); }});
  static_cast<void>(controller_.send(peis::inquiry_command(length))); // its queue is empty
  end_.start(length + inquiry_margin, [this] { end(false); });
}

void bluetooth_scanner::on_inquiry(byte_view packet) {
  const auto event = peis::decode_inquiry_event(packet);
  if (const auto* ended = std::get_if<peis::inquiry_ended>(&event)) {
    end(ended->success);
    return;
  }
  for (const auto& each : std::get<std::vector<peis::seen_device>>(event)) {
    if (seen_.contains(each.address) || seen_.size() < seen_max)
      seen_[each.address] = each.strength_dbm;
  }
}

void bluetooth_scanner::end(bool success) {
  if (!std::exchange(scanning_, false))
    return;
  end_.stop();
  controller_ = {};
  std::vector<peis::seen_device> found;
  for (const auto& [address, strength_dbm] : std::exchange(seen_, {}))
    found.push_back({address, strength_dbm});
  if (success)
    user_->on_scan(name_, found);
  else
    ++failed_;
}

} // namespace rubicon::peer
