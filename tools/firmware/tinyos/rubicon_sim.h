/* Between the packet model of a simulated TinyOS (TossimPacketModelC.nc here) and the adapter that makes a
 * firmware of Rubicon of it. The packet model exports three functions, and calls two of the adapter. */
#ifndef RUBICON_SIM_H
#define RUBICON_SIM_H

#ifndef NESC
#include <stdint.h>
#endif

/* An active message, as TinyOS has it on the radio. */
struct rubicon_sim_packet {
  uint16_t destination;
  uint16_t source;
  uint8_t am_type;
  uint8_t length; /* of the payload */
  const uint8_t *payload;
};

/* Functions of the adapter. `send` returns whether it is accepted: then rubicon_sim_sent follows. */
typedef int (*rubicon_sim_send)(const struct rubicon_sim_packet *packet, int requests_ack);
typedef void (*rubicon_sim_power)(int on);

/* Exported by the packet model. All are called with the node set (sim_set_node), between events.
 *
 *   void rubicon_sim_attach(rubicon_sim_send send, rubicon_sim_power power);
 *   void rubicon_sim_sent(int is_sent, int is_acknowledged);
 *   void rubicon_sim_received(const struct rubicon_sim_packet *packet, int rssi_dbm);
 */

#endif
