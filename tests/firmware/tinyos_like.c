/* What an application of TinyOS that was built for its simulator exports: tables with an entry for each node,
 * one queue of events, and the packet model of tools/firmware/tinyos. Node 1 sends a packet to node 2 each
 * second and requests an acknowledgement; node 2 answers each with a broadcast. */
#include <stdio.h>
#include <stdlib.h>

#include "rubicon_sim.h"

enum { nodes = 1000, events_max = 16, period = 1, hello_type = 6, answer_type = 7 };

typedef long long sim_time;

struct event {
  sim_time at;
  int node;
};

void sim_init(void);
void sim_random_seed(int seed);
sim_time sim_ticks_per_sec(void);
void sim_set_time(sim_time at);
void sim_set_node(unsigned long node);
void sim_mote_set_start_time(int node, sim_time at);
void sim_mote_enqueue_boot_event(int node);
unsigned char sim_queue_is_empty(void);
sim_time sim_queue_peek_time(void);
unsigned char sim_run_next_event(void);
void sim_add_channel(char *channel, FILE *to);
void rubicon_sim_attach(rubicon_sim_send send, rubicon_sim_power power);
void rubicon_sim_sent(int is_sent, int is_acknowledged);
void rubicon_sim_received(const struct rubicon_sim_packet *packet, int rssi_dbm);

static struct event queue[events_max]; /* the first is the next */
static int queued;
static sim_time now;
static unsigned long node;
static FILE *channel;
static rubicon_sim_send send_packet;
static rubicon_sim_power set_power;

/* By node. */
static sim_time start_time[nodes];
static unsigned char is_on[nodes];
static uint8_t rounds[nodes];

static void enqueue(sim_time at) {
  int i = queued++;
  if (queued > events_max)
    abort();
  for (; i > 0 && queue[i - 1].at > at; --i)
    queue[i] = queue[i - 1];
  queue[i].at = at;
  queue[i].node = (int)node;
}

static void print(const char *what, int value) {
  if (channel != NULL)
    fprintf(channel, "%s %lu %d\n", what, node, value);
}

static void send(unsigned destination, unsigned am_type, const uint8_t *payload, int ack) {
  const struct rubicon_sim_packet x = {(uint16_t)destination, (uint16_t)node, (uint8_t)am_type, 2, payload};
  if (!send_packet(&x, ack))
    print("refused", payload[1]);
}

void sim_init(void) { queued = 0; }
void sim_random_seed(int seed) { srand((unsigned)seed); }
sim_time sim_ticks_per_sec(void) { return 10000000000LL; }
void sim_set_time(sim_time at) {
  if (at < now) /* time never goes back */
    abort();
  now = at;
}
void sim_set_node(unsigned long x) { node = x; }
void sim_mote_set_start_time(int x, sim_time at) { start_time[x] = at; }

void sim_mote_enqueue_boot_event(int x) {
  node = (unsigned long)x;
  enqueue(start_time[x]);
}

unsigned char sim_queue_is_empty(void) { return queued == 0; }
sim_time sim_queue_peek_time(void) { return queued == 0 ? -1 : queue[0].at; }

unsigned char sim_run_next_event(void) {
  struct event first = queue[0];
  int i;
  if (queued == 0)
    return 0;
  for (i = 1; i < queued; ++i)
    queue[i - 1] = queue[i];
  --queued;
  sim_set_time(first.at);
  node = (unsigned long)first.node;
  if (!is_on[node]) {
    is_on[node] = 1;
    print("boots", 0);
    set_power(1);
  } else {
    const uint8_t payload[2] = {0, ++rounds[node]};
    send(2, hello_type, payload, 1);
  }
  if (node == 1)
    enqueue(now + period * sim_ticks_per_sec());
  return 1;
}

void sim_add_channel(char *name, FILE *to) {
  (void)name;
  channel = to;
}

void rubicon_sim_attach(rubicon_sim_send to, rubicon_sim_power power) {
  send_packet = to;
  set_power = power;
}

void rubicon_sim_sent(int is_sent, int is_acknowledged) { print("sent", is_sent + 2 * is_acknowledged); }

void rubicon_sim_received(const struct rubicon_sim_packet *x, int rssi_dbm) {
  (void)rssi_dbm;
  print(x->am_type == hello_type ? "hello" : "answer", x->payload[1]);
  if (x->am_type == hello_type)
    send(0xffff, answer_type, x->payload, 0);
}
