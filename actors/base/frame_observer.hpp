// Who follows the frames of a run from outside.
#pragma once

#include <functional>

namespace rubicon {

namespace radio {
struct overheard;
} // namespace radio

/// Called for every frame when it has ended; must not touch the ecology.
using frame_observer = std::function<void(const radio::overheard&)>;

} // namespace rubicon
