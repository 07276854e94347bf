// Messages that leave by a serial line whose other end is another process.
#pragma once

namespace rubicon {

/// The octets that are being handled leave for another process, which accounts for what they hold.
void hand_over();

} // namespace rubicon
