/* An application of TinyOS, built for its simulator (`make micaz sim`), as a firmware of Rubicon. Compiled by
 * tools/firmware/tinyos-sim, with the octets of the library inside, which each mote loads for itself: of its
 * tables, which have an entry for each node, and of its queue a mote uses what is its own node's, and no
 * other is ever booted. So no mote waits for another, and what fails is one mote's.
 *
 * The simulator's side, as its documents have it: time is that of the next event of the queue, which runs
 * when the time of the mote has come; functions that are called from outside are called with time and node
 * set. The radio is behind the packet model of tools/firmware/tinyos. */
#define _GNU_SOURCE

#include <string.h>

#include "inner_library.h"
#include "tinyos/rubicon_sim.h"

enum { us_per_s = 1000000, header_octets = 11, ack_request = 0x20, broadcast = 0xffff };
enum { nodes_max = 1000 }; /* of a library that was built without another number */

static const char *const advice = "build it with `make micaz sim` and the packet model of Rubicon";

static void (*set_random_seed)(int seed);
static void (*set_node)(unsigned long node);
static void (*set_time)(long long at);
static void (*set_start_time)(int node, long long at);
static void (*enqueue_boot)(int node);
static unsigned char (*is_empty)(void);
static long long (*next_time)(void);
static unsigned char (*run_next)(void);
static void (*add_channel)(char *channel, FILE *to);
static void (*attach)(rubicon_sim_send send, rubicon_sim_power power);
static void (*is_sent)(int is_sent, int is_acknowledged);
static void (*has_received)(const struct rubicon_sim_packet *packet, int rssi_dbm);

static uint16_t self;
static long long ticks_per_us;
static uint8_t sequence_number;
static int requests_ack; /* the frame at the radio does */
static FILE *channels;   /* what the application prints; NULL: it is not shown */

static void put(uint8_t *at, unsigned x) { /* low octet first, as in headers of IEEE 802.15.4 */
  at[0] = (uint8_t)x;
  at[1] = (uint8_t)(x >> 8);
}

static unsigned get(const uint8_t *at) { return at[0] | (unsigned)at[1] << 8; }

/* A data frame between short addresses, with the octet of TinyOS's network and the AM type first. */
static int send(const struct rubicon_sim_packet *packet, int ack) {
  uint8_t frame[RUBICON_MOTE_FRAME_MAX] = {0x41, 0x88};
  const size_t length = header_octets + (size_t)packet->length;
  if (length > sizeof frame)
    return 0;
  requests_ack = ack && packet->destination != broadcast;
  frame[0] |= requests_ack ? ack_request : 0;
  frame[2] = sequence_number++;
  put(frame + 3, host->island);
  put(frame + 5, packet->destination);
  put(frame + 7, self);
  frame[9] = 0x3f;
  frame[10] = packet->am_type;
  memcpy(frame + header_octets, packet->payload, packet->length);
  return host->send(host->context, frame, length) == RUBICON_MOTE_OK;
}

static void power(int on) { host->radio(host->context, on); }

static ssize_t print(void *ignored, const char *octets, size_t count) {
  (void)ignored;
  host->serial(host->context, (const uint8_t *)octets, count);
  return (ssize_t)count;
}

static void add_channels(void) {
  static char *const names[] = {TINYOS_CHANNELS NULL};
  const cookie_io_functions_t functions = {.write = print};
  size_t i;
  if (names[0] == NULL || add_channel == NULL)
    return;
  channels = fopencookie(NULL, "w", functions);
  if (channels == NULL)
    return;
  setvbuf(channels, NULL, _IONBF, 0);
  for (i = 0; names[i] != NULL; ++i)
    add_channel(names[i], channels);
}

static int find_all(void) {
  int lacks = 0;
  *(void **)&set_random_seed = find("sim_random_seed", 1, advice, &lacks);
  *(void **)&set_node = find("sim_set_node", 1, advice, &lacks);
  *(void **)&set_time = find("sim_set_time", 1, advice, &lacks);
  *(void **)&set_start_time = find("sim_mote_set_start_time", 0, advice, &lacks);
  *(void **)&enqueue_boot = find("sim_mote_enqueue_boot_event", 1, advice, &lacks);
  *(void **)&is_empty = find("sim_queue_is_empty", 1, advice, &lacks);
  *(void **)&next_time = find("sim_queue_peek_time", 1, advice, &lacks);
  *(void **)&run_next = find("sim_run_next_event", 1, advice, &lacks);
  *(void **)&add_channel = find("sim_add_channel", 0, advice, &lacks);
  *(void **)&attach = find("rubicon_sim_attach", 1, advice, &lacks);
  *(void **)&is_sent = find("rubicon_sim_sent", 1, advice, &lacks);
  *(void **)&has_received = find("rubicon_sim_received", 1, advice, &lacks);
  return !lacks;
}

static void *init(uint16_t id, const struct rubicon_mote_host *its) {
  int lacks = 0;
  void (*begin)(void) = NULL;
  long long (*ticks_per_second)(void) = NULL;
  host = its;
  self = id;
  if (id >= nodes_max) {
    host->log(host->context, "the simulator of TinyOS has nodes 0 to 999");
    return NULL;
  }
  if (!load_library() || !find_all())
    return NULL;
  *(void **)&begin = find("sim_init", 1, advice, &lacks);
  *(void **)&ticks_per_second = find("sim_ticks_per_sec", 1, advice, &lacks);
  if (lacks)
    return NULL;
  begin();
  ticks_per_us = ticks_per_second() / us_per_s;
  if (ticks_per_us < 1) {
    host->log(host->context, "the ticks of the library are longer than 1 us");
    return NULL;
  }
  set_random_seed((int)(host->random(host->context) & 0x7fffffff));
  attach(send, power);
  add_channels();
  power(0); /* until the application starts it */
  set_time(0);
  set_node(id);
  if (set_start_time != NULL)
    set_start_time(id, 0);
  enqueue_boot(id);
  return &library;
}

/* Runs all events that are due, and waits for the next one. */
static void run(void *mote, uint64_t now) {
  const long long until = (long long)now * ticks_per_us;
  (void)mote;
  while (!is_empty() && next_time() <= until)
    if (!run_next())
      break;
  host->timer(host->context,
              is_empty() ? UINT64_MAX : (uint64_t)((next_time() + ticks_per_us - 1) / ticks_per_us));
}

/* What comes from outside comes after the events that are due, and at its time. */
static void catch_up(void *mote, uint64_t now) {
  run(mote, now);
  set_time((long long)now * ticks_per_us);
  set_node(self);
}

static void received(void *mote, uint64_t now, const uint8_t *frame, size_t length, int rssi_dbm) {
  struct rubicon_sim_packet packet;
  const unsigned control = length < header_octets ? 0 : get(frame) & ~(unsigned)ack_request;
  if (control != 0x8841 || frame[9] != 0x3f) /* not of TinyOS's layout */
    return;
  packet.destination = (uint16_t)get(frame + 5);
  packet.source = (uint16_t)get(frame + 7);
  packet.am_type = frame[10];
  packet.length = (uint8_t)(length - header_octets);
  packet.payload = frame + header_octets;
  catch_up(mote, now);
  has_received(&packet, rssi_dbm);
  run(mote, now);
}

static void sent(void *mote, uint64_t now, int outcome) {
  catch_up(mote, now);
  is_sent(outcome == RUBICON_MOTE_SENT || outcome == RUBICON_MOTE_NO_ACK,
          outcome == RUBICON_MOTE_SENT && requests_ack);
  run(mote, now);
}

static void end(void *mote) {
  (void)mote;
  dlclose(library);
  if (channels != NULL)
    fclose(channels);
}

const struct rubicon_mote_firmware rubicon_mote_firmware = {
    .version = RUBICON_MOTE_VERSION,
    .init = init,
    .run = run,
    .received = received,
    .sent = sent,
    .end = end,
};
