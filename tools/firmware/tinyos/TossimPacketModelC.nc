/* The packet model of a simulated TinyOS whose radio is Rubicon's. In place of TinyOS's own one, if this
 * folder comes first among the folders that the compiler searches:
 *
 *   CFLAGS += -I/usr/share/rubicon/firmware/tinyos
 *
 * Medium access, acknowledgements, noise and gains are Rubicon's: what TinyOS's simulator has of them is
 * linked and never called. */
#include "rubicon_sim.h"

rubicon_sim_send rubiconSend = NULL;
rubicon_sim_power rubiconPower = NULL;

module TossimPacketModelC {
  provides {
    interface Init;
    interface SplitControl as Control;
    interface PacketAcknowledgements;
    interface TossimPacketModel as Packet;
  }
  uses interface GainRadioModel;
}
implementation {
  bool isOn;
  message_t *sending; /* at the radio; NULL: none */
  message_t incoming;

  tossim_header_t *headerOf(message_t *msg) {
    return (tossim_header_t *)(msg->data - sizeof(tossim_header_t));
  }

  tossim_metadata_t *metadataOf(message_t *msg) {
    return (tossim_metadata_t *)&msg->metadata;
  }

  void power(bool on) {
    isOn = on;
    if (rubiconPower != NULL)
      rubiconPower(on);
  }

  task void startDone() { signal Control.startDone(SUCCESS); }
  task void stopDone() { signal Control.stopDone(SUCCESS); }

  command error_t Init.init() {
    isOn = FALSE;
    sending = NULL;
    return SUCCESS;
  }

  command error_t Control.start() {
    power(TRUE);
    post startDone();
    return SUCCESS;
  }

  command error_t Control.stop() {
    power(FALSE);
    post stopDone();
    return SUCCESS;
  }

  async command error_t PacketAcknowledgements.requestAck(message_t *msg) {
    metadataOf(msg)->ack = TRUE;
    return SUCCESS;
  }

  async command error_t PacketAcknowledgements.noAck(message_t *msg) {
    metadataOf(msg)->ack = FALSE;
    return SUCCESS;
  }

  async command bool PacketAcknowledgements.wasAcked(message_t *msg) {
    return metadataOf(msg)->ack;
  }

  command error_t Packet.send(int destination, message_t *msg, uint8_t length) {
    struct rubicon_sim_packet packet;
    tossim_header_t *header = headerOf(msg);
    if (!isOn || rubiconSend == NULL)
      return EOFF;
    if (sending != NULL)
      return EBUSY;
    packet.destination = destination;
    packet.source = header->src;
    packet.am_type = header->type;
    packet.length = header->length;
    packet.payload = (uint8_t *)msg->data;
    if (!rubiconSend(&packet, metadataOf(msg)->ack))
      return FAIL;
    sending = msg;
    return SUCCESS;
  }

  command error_t Packet.cancel(message_t *msg) { return FAIL; }

  void rubicon_sim_attach(rubicon_sim_send send, rubicon_sim_power to) @C() @spontaneous() {
    rubiconSend = send;
    rubiconPower = to;
  }

  void rubicon_sim_sent(int isSent, int isAcknowledged) @C() @spontaneous() {
    message_t *msg = sending;
    if (msg == NULL)
      return;
    sending = NULL;
    metadataOf(msg)->ack = isAcknowledged;
    signal Packet.sendDone(msg, isSent ? SUCCESS : FAIL);
  }

  void rubicon_sim_received(const struct rubicon_sim_packet *packet, int rssi) @C() @spontaneous() {
    tossim_header_t *header = headerOf(&incoming);
    if (!isOn || packet->length > TOSH_DATA_LENGTH)
      return;
    header->dest = packet->destination;
    header->src = packet->source;
    header->type = packet->am_type;
    header->length = packet->length;
    header->group = TOS_AM_GROUP;
    memcpy(incoming.data, packet->payload, packet->length);
    metadataOf(&incoming)->strength = rssi;
    signal Packet.receive(&incoming);
  }

  event void GainRadioModel.acked(message_t *msg) {}
  event void GainRadioModel.receive(message_t *msg) {}
  event bool GainRadioModel.shouldAck(message_t *msg) { return FALSE; }
}
