/* A flood: the mote with the highest id reads its sensor each second and sends the reading to all in
 * reach. Whoever receives a reading for the first time sends it on, once, after a random pause. */
#include <rubicon_mote.h>

#include <string.h>

enum {
  header_octets = 11,
  flood_type = 66, /* AM type, by which the gateway of the island knows the packets */
  payload_octets = 8,
  period_us = 1000000,
  pause_us = 40000,
  source_id = 6
};

/* Variables are those of one mote: each has a copy of the library. */
static const struct rubicon_mote_host *host;
static uint16_t self;
static uint8_t sequence_number;
static uint16_t last_round;
static uint8_t waiting[payload_octets]; /* a reading that is to be sent on */
static uint64_t send_at;                /* 0: none */
static uint64_t next_round_at;

static void put(uint8_t *at, unsigned x) { /* network byte order */
  at[0] = (uint8_t)(x >> 8);
  at[1] = (uint8_t)x;
}

static unsigned at(const uint8_t *x) { return (unsigned)x[0] << 8 | x[1]; }

/* A data frame as TinyOS has it: to all, from this mote, with the AM type before the payload. */
static void send(const uint8_t *payload) {
  uint8_t frame[header_octets + payload_octets] = {0x41, 0x88};
  frame[2] = sequence_number++;
  frame[3] = (uint8_t)host->island;
  frame[4] = (uint8_t)(host->island >> 8);
  frame[5] = 0xff;
  frame[6] = 0xff;
  frame[7] = (uint8_t)self;
  frame[8] = (uint8_t)(self >> 8);
  frame[9] = 0x3f;
  frame[10] = flood_type;
  memcpy(frame + header_octets, payload, payload_octets);
  host->send(host->context, frame, sizeof frame);
}

static void set_timer(void) {
  if (self == source_id)
    host->timer(host->context, next_round_at);
  else
    host->timer(host->context, send_at != 0 ? send_at : UINT64_MAX);
}

static void *init(uint16_t id, const struct rubicon_mote_host *its) {
  host = its;
  self = id;
  next_round_at = period_us;
  host->log(host->context, "flood starts");
  return &self;
}

/* Payload: id of the mote that reads, number of the round, hops so far, the reading. */
static void begin_round(void) {
  int32_t reading = 0;
  uint8_t payload[payload_octets];
  host->read(host->context, "temperature", &reading);
  put(payload, self);
  put(payload + 2, ++last_round);
  put(payload + 4, 0);
  put(payload + 6, (unsigned)reading);
  send(payload);
}

static void run(void *mote, uint64_t now) {
  (void)mote;
  if (self == source_id && now >= next_round_at) {
    next_round_at += period_us;
    begin_round();
  }
  if (send_at != 0 && now >= send_at) {
    send_at = 0;
    send(waiting);
  }
  set_timer();
}

static void received(void *mote, uint64_t now, const uint8_t *frame, size_t length, int rssi_dbm) {
  const uint8_t *payload = frame + header_octets;
  (void)mote;
  (void)rssi_dbm;
  if (length != header_octets + payload_octets || frame[10] != flood_type || self == source_id ||
      at(payload + 2) == last_round)
    return;
  last_round = (uint16_t)at(payload + 2);
  memcpy(waiting, payload, payload_octets);
  put(waiting + 4, at(payload + 4) + 1);
  send_at = now + 1 + host->random(host->context) % pause_us;
  host->leds(host->context, last_round);
  set_timer();
}

static void sent(void *mote, uint64_t now, int outcome) {
  (void)mote;
  (void)now;
  (void)outcome;
}

const struct rubicon_mote_firmware rubicon_mote_firmware = {
    .version = RUBICON_MOTE_VERSION,
    .init = init,
    .run = run,
    .received = received,
    .sent = sent,
};
