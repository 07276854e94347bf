/* Motes 1 and 2, whose state is in memory of their own: mote 1 sends to mote 2 with long addresses and
 * requests acknowledgements, with its radio on only while it sends. Mote 2 answers on its serial line. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rubicon_mote.h>

#ifndef TEST_VERSION
#define TEST_VERSION RUBICON_MOTE_VERSION
#endif

enum { period_us = 500000 };

struct pair {
  const struct rubicon_mote_host *host;
  uint16_t self;
  uint8_t sequence_number;
  unsigned outcomes[4];
};

static void *init(uint16_t id, const struct rubicon_mote_host *host) {
  struct pair *x = calloc(1, sizeof *x);
  int32_t counts = 0;
  if (x == NULL || id > 2)
    return NULL;
  x->host = host;
  x->self = id;
  if (host->read(host->context, "humidity", &counts) == RUBICON_MOTE_ABSENT)
    host->log(host->context, "no humidity");
  if (id == 1)
    host->radio(host->context, 0);
  return x;
}

static void put_long(uint8_t *at, unsigned id) {
  memset(at, 0, 8);
  at[0] = (uint8_t)id;
  at[1] = (uint8_t)(id >> 8);
}

static void run(void *mote, uint64_t now) {
  struct pair *x = mote;
  uint8_t frame[25] = {0x61, 0xdc}; /* data, with ack request, one PAN, both addresses long, 2006 */
  if (x->self != 1)
    return;
  x->host->timer(x->host->context, now + period_us);
  if (now == 0)
    return;
  frame[2] = x->sequence_number++;
  frame[3] = 0xcd;
  frame[4] = 0xab;
  put_long(frame + 5, 2);
  put_long(frame + 13, 1);
  memcpy(frame + 21, "ping", 4);
  x->host->radio(x->host->context, 1);
  if (x->host->send(x->host->context, frame, sizeof frame) != RUBICON_MOTE_OK)
    abort();
}

static void received(void *mote, uint64_t now, const uint8_t *frame, size_t length, int rssi_dbm) {
  struct pair *x = mote;
  char line[64];
  (void)now;
  if (length < 4)
    return;
  snprintf(line, sizeof line, "%.4s %u at %d dBm\n", (const char *)frame + length - 4, frame[2], rssi_dbm);
  x->host->serial(x->host->context, (const uint8_t *)line, strlen(line));
}

static void sent(void *mote, uint64_t now, int outcome) {
  struct pair *x = mote;
  char line[64];
  (void)now;
  ++x->outcomes[outcome & 3];
  snprintf(line, sizeof line, "sent %u lost %u", x->outcomes[0], x->outcomes[1]);
  x->host->log(x->host->context, line);
  x->host->radio(x->host->context, 0);
}

static void end(void *mote) { free(mote); }

const struct rubicon_mote_firmware rubicon_mote_firmware = {
    .version = TEST_VERSION,
    .init = init,
    .run = run,
    .received = received,
    .sent = sent,
    .end = end,
};
