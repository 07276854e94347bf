// Why a message did not arrive. The report, explain, the CSV files, the live page and
// docs/losses.md take names and sentences from this list.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace rubicon {

// The name in reports, and the sentence in docs/losses.md: what happened, where it is counted.
#define RUBICON_LOSSES(X)                                                                          \
  X(unknown, "No copy is left, and no component reported the reason.")                             \
  X(duplicate, "A receiver discarded it as a duplicate of an earlier one; no other copy arrived.") \
  X(unanswered, "Its receiver did not answer the greeting, so the message was never sent.")        \
  X(not_received, "A frame that is not acknowledged, such as a broadcast, reached no receiver.")   \
  X(false_ack, "Its sender mistook the acknowledgement of another frame for its own: those of "    \
               "802.15.4 contain a number of 8 bits and no address.")                              \
  X(gave_up, "A mote repeated it to the next one until it gave up; `radio.mac_failed` counts the " \
             "failures.")                                                                          \
  X(queue_full, "The queue of a mote or sink was full.")                                           \
  X(no_route, "A mote had no route to the sink for too long, or the sink none to the mote.")       \
  X(too_far, "It made more hops than a packet may.")                                               \
  X(malformed, "A receiver could not decode it.")                                                  \
  X(channel_full, "The channel's sender had too many packets waiting.")                            \
  X(channel_lost,                                                                                  \
    "A mote on the channel's route had no next hop for it, or gave up repeating it.")              \
  X(channel_closed, "It reached the end of the channel after that was closed or replaced.")        \
  X(overtaken, "A newer packet of the same channel was sent instead.")                             \
  X(line_failed,                                                                                   \
    "The serial line lost it: corrupted and not repeated, unplugged, or its queue "                \
    "was full; `serial.lost` counts the causes. Or a backbone did; `network.backbone.lost`.")      \
  X(not_listed, "The gateway did not list the mote that sent it, or its destination.")             \
  X(not_leading, "It reached a gateway that did not lead its island.")                             \
  X(not_expressible, "The other gateway uses the strict form of 5.4, which cannot express it.")    \
  X(gateway_stopped, "Its destination, a gateway or PC, was not running or not reachable.")        \
  X(package_lost, "A PEIS link lost the package that contained it, or closed.")                    \
  X(no_program, "No program at its destination accepts messages of its type.")                     \
  X(not_taken, "The receiver had restarted since, or had no room for it.")                         \
  X(sender_left, "Its sender left the island while it waited.")                                    \
  X(node_stopped, "The mote, gateway or PC that held it crashed, was switched off, or no longer "  \
                  "led its island.")                                                               \
  X(other_host, "It was handed over to another host of a deployment, where it did not arrive "     \
                "within a minute.")

/// Ordered so that a later one replaces an earlier one that two copies met at the same time.
enum class loss : std::uint8_t {
#define RUBICON_LOSS_NAME(name, meaning) name,
  RUBICON_LOSSES(RUBICON_LOSS_NAME)
#undef RUBICON_LOSS_NAME
};

#define RUBICON_LOSS_ONE(name, meaning) +1
inline constexpr std::size_t loss_count = RUBICON_LOSSES(RUBICON_LOSS_ONE);
#undef RUBICON_LOSS_ONE

/// `queue_full`
[[nodiscard]] std::string_view to_string(loss x);

/// A sentence in Markdown.
[[nodiscard]] std::string_view meaning_of(loss x);

[[nodiscard]] std::optional<loss> parse_loss(std::string_view name);

} // namespace rubicon
