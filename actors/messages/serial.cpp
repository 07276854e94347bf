#include "actors/messages/serial.hpp"

#include "scheduler/messages/define_messages.hpp"

namespace rubicon::scheduler {

template void define_messages<serial_end_interface>();
template void define_messages<line_watcher_interface>();
template void define_messages<packet_end_interface>();
template void define_messages<serial_line_interface>();
template void define_messages<outside_line_interface>();
template void define_messages<pty_end_interface>();

} // namespace rubicon::scheduler
