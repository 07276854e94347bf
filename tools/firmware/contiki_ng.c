/* Firmware of Contiki-NG, built with TARGET=cooja, as a firmware of Rubicon. Compiled by
 * tools/firmware/contiki-ng, with the octets of the library inside, which each mote loads for itself.
 *
 * The simulator's side of that interface, as its documents have it: the simulator sets variables,
 * calls cooja_tick(), and reads variables. Time is in milliseconds; that of rtimers in microseconds.
 * A firmware that transmits waits, in ticks, until simTransmitting is 0 again. Acknowledgements are
 * Rubicon's: those that the firmware sends itself go no further, and it receives one for each frame
 * of its own that was acknowledged. */
#define _GNU_SOURCE

#include <link.h>
#include <string.h>

#include "inner_library.h"

enum { fcf_ack = 2, ack_octets = 3, ack_requested = 0x20, us_per_ms = 1000 };

static const char *const advice = "build it with TARGET=cooja";
static void (*tick)(void);

/* A variable of the firmware; `at` is NULL if it does not have it. */
struct variable {
  void *at;
  size_t size;
};

static struct variable current_time, mote_id, mote_id_changed, random_seed;
static struct variable sending, sent_data, sent_size, received_data, received_size;
static struct variable signal_strength, last_signal_strength, radio_channel, radio_on;
static struct variable process_runs, etimer_pending, etimer_at, rtimer_pending, rtimer_at, rtimer_now;
static struct variable serial_data, serial_size, serial_flag, log_data, log_size, log_flag, leds;

static uint8_t frame[RUBICON_MOTE_FRAME_MAX]; /* at the radio */
static size_t frame_size;                     /* 0: none */
static uint8_t ack[ack_octets];               /* that the firmware is to receive */
static int ack_waits;
static int radio_was_on = 1;

/* A whole number, of the size that the variable has. */
static long long get(struct variable x) {
  switch (x.at == NULL ? 0 : x.size) {
  case 0:
    return 0;
  case 1:
    return *(const signed char *)x.at;
  case 2:
    return *(const int16_t *)x.at;
  case 4:
    return *(const int32_t *)x.at;
  default:
    return *(const int64_t *)x.at;
  }
}

static void set(struct variable x, long long value) {
  switch (x.at == NULL ? 0 : x.size) {
  case 0:
    break;
  case 1:
    *(signed char *)x.at = (signed char)value;
    break;
  case 2:
    *(int16_t *)x.at = (int16_t)value;
    break;
  case 4:
    *(int32_t *)x.at = (int32_t)value;
    break;
  default:
    *(int64_t *)x.at = value;
  }
}

static struct variable find_variable(const char *name, int is_needed, int *lacks) {
  struct variable x = {find(name, is_needed, advice, lacks), 0};
  const ElfW(Sym) *symbol = NULL;
  Dl_info ignored;
  if (x.at != NULL && dladdr1(x.at, &ignored, (void **)&symbol, RTLD_DL_SYMENT) != 0 && symbol != NULL)
    x.size = symbol->st_size;
  return x;
}

static int find_all(void) {
  int lacks = 0;
  *(void **)&tick = find("cooja_tick", 1, advice, &lacks);
  current_time = find_variable("simCurrentTime", 1, &lacks);
  mote_id = find_variable("simMoteID", 1, &lacks);
  mote_id_changed = find_variable("simMoteIDChanged", 0, &lacks);
  random_seed = find_variable("simRandomSeed", 0, &lacks);
  sending = find_variable("simTransmitting", 0, &lacks);
  sent_data = find_variable("simOutDataBuffer", 1, &lacks);
  sent_size = find_variable("simOutSize", 1, &lacks);
  received_data = find_variable("simInDataBuffer", 1, &lacks);
  received_size = find_variable("simInSize", 1, &lacks);
  signal_strength = find_variable("simSignalStrength", 0, &lacks);
  last_signal_strength = find_variable("simLastSignalStrength", 0, &lacks);
  radio_channel = find_variable("simRadioChannel", 0, &lacks);
  radio_on = find_variable("simRadioHWOn", 0, &lacks);
  process_runs = find_variable("simProcessRunValue", 1, &lacks);
  etimer_pending = find_variable("simEtimerPending", 1, &lacks);
  etimer_at = find_variable("simEtimerNextExpirationTime", 1, &lacks);
  rtimer_pending = find_variable("simRtimerPending", 0, &lacks);
  rtimer_at = find_variable("simRtimerNextExpirationTime", 0, &lacks);
  rtimer_now = find_variable("simRtimerCurrentTicks", 0, &lacks);
  serial_data = find_variable("simSerialSendingData", 0, &lacks);
  serial_size = find_variable("simSerialSendingLength", 0, &lacks);
  serial_flag = find_variable("simSerialSendingFlag", 0, &lacks);
  log_data = find_variable("simLoggedData", 0, &lacks);
  log_size = find_variable("simLoggedLength", 0, &lacks);
  log_flag = find_variable("simLoggedFlag", 0, &lacks);
  leds = find_variable("simLedsValue", 0, &lacks);
  return !lacks;
}

static void *init(uint16_t id, const struct rubicon_mote_host *its) {
  int lacks = 0;
  void (*begin)(void) = NULL;
  host = its;
  if (!load_library() || !find_all())
    return NULL;
  *(void **)&begin = find("cooja_init", 1, advice, &lacks);
  if (lacks)
    return NULL;
  set(mote_id, id);
  set(mote_id_changed, 1);
  set(random_seed, host->random(host->context) & 0x7fffffff);
  set(radio_channel, host->channel);
  begin();
  return &library;
}

static void write_out(struct variable data, struct variable size, struct variable flag) {
  const long long count = get(size);
  if (get(flag) == 0)
    return;
  if (count > 0 && (size_t)count <= data.size)
    host->serial(host->context, data.at, (size_t)count);
  set(size, 0);
  set(flag, 0);
}

static void end_transmission(void) {
  frame_size = 0;
  set(sent_size, 0);
  set(sending, 0);
}

/* What the firmware has put at its radio. */
static void transmit(void) {
  const long long size = get(sent_size);
  const uint8_t *octets = sent_data.at;
  if (frame_size != 0 || size <= 0)
    return;
  if (size >= ack_octets && (octets[0] & 7) == fcf_ack) { /* the radio has sent one already */
    end_transmission();
    return;
  }
  if (size > RUBICON_MOTE_FRAME_MAX || host->send(host->context, octets, (size_t)size) != RUBICON_MOTE_OK) {
    host->log(host->context, "a frame was refused");
    end_transmission();
    return;
  }
  memcpy(frame, octets, (size_t)size);
  frame_size = (size_t)size;
}

/* @param transmitted it waits for what follows its frame */
static void set_timer(uint64_t now, int transmitted) {
  uint64_t at = UINT64_MAX;
  if (get(process_runs) != 0 || ack_waits || transmitted)
    at = now + us_per_ms;
  if (get(etimer_pending) != 0) {
    const uint64_t due = (uint64_t)get(etimer_at) * us_per_ms;
    at = due < at ? due : at;
  }
  if (get(rtimer_pending) != 0) {
    const uint64_t due = (uint64_t)get(rtimer_at);
    at = due < at ? due : at;
  }
  host->timer(host->context, at <= now ? now + us_per_ms : at);
}

static void step(uint64_t now) {
  int transmitted = 0;
  if (ack_waits && get(received_size) == 0) {
    memcpy(received_data.at, ack, sizeof ack);
    set(received_size, sizeof ack);
    ack_waits = 0;
  }
  set(current_time, (long long)(now / us_per_ms));
  set(rtimer_now, (long long)now);
  tick();
  if (radio_on.at != NULL && (get(radio_on) != 0) != radio_was_on) {
    radio_was_on = !radio_was_on;
    host->radio(host->context, radio_was_on);
  }
  transmitted = get(sent_size) > 0;
  transmit();
  write_out(serial_data, serial_size, serial_flag);
  write_out(log_data, log_size, log_flag);
  if (leds.at != NULL)
    host->leds(host->context, (unsigned)get(leds));
  set_timer(now, transmitted && frame_size == 0);
}

static void run(void *mote, uint64_t now) {
  (void)mote;
  step(now);
}

static void received(void *mote, uint64_t now, const uint8_t *octets, size_t length, int rssi_dbm) {
  (void)mote;
  if (get(received_size) != 0 || length > received_data.size) /* a radio has room for one frame */
    return;
  memcpy(received_data.at, octets, length);
  set(received_size, (long long)length);
  set(signal_strength, rssi_dbm);
  set(last_signal_strength, rssi_dbm);
  step(now);
}

static void sent(void *mote, uint64_t now, int outcome) {
  (void)mote;
  if (frame_size >= ack_octets && (frame[0] & ack_requested) != 0 && outcome == RUBICON_MOTE_SENT) {
    ack[0] = fcf_ack;
    ack[1] = 0;
    ack[2] = frame[2];
    ack_waits = 1;
  }
  end_transmission();
  step(now);
}

static void end(void *mote) {
  (void)mote;
  dlclose(library);
}

const struct rubicon_mote_firmware rubicon_mote_firmware = {
    .version = RUBICON_MOTE_VERSION,
    .init = init,
    .run = run,
    .received = received,
    .sent = sent,
    .end = end,
};
