/* A firmware that works for three seconds, and then loops (1), crashes (2), or uses a gigabyte (3). */
#include <stdlib.h>

#include <rubicon_mote.h>

enum { fails_at_us = 3000000 };

static const struct rubicon_mote_host *host;

static void *init(uint16_t id, const struct rubicon_mote_host *its) {
  (void)id;
  host = its;
  return &host;
}

static void fail(void) {
  volatile unsigned long n = 0;
  volatile char *memory = NULL;
#if TEST_FAILURE == 1
  for (;;)
    ++n;
#elif TEST_FAILURE == 3
  memory = malloc((size_t)1 << 30);
#endif
  memory[n] = 1;
}

static void run(void *mote, uint64_t now) {
  (void)mote;
  if (now >= fails_at_us)
    fail();
  host->timer(host->context, fails_at_us);
}

static void received(void *mote, uint64_t now, const uint8_t *frame, size_t length, int rssi_dbm) {
  (void)mote, (void)now, (void)frame, (void)length, (void)rssi_dbm;
}

static void sent(void *mote, uint64_t now, int outcome) { (void)mote, (void)now, (void)outcome; }

const struct rubicon_mote_firmware rubicon_mote_firmware = {
    .version = RUBICON_MOTE_VERSION,
    .init = init,
    .run = run,
    .received = received,
    .sent = sent,
};
