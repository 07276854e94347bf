/*
 * The firmware of a mote in Rubicon, version 1 (docs/firmware.md).
 *
 * A firmware is a shared library that exports one object:
 *
 *   const struct rubicon_mote_firmware rubicon_mote_firmware = {
 *     .version = RUBICON_MOTE_VERSION, .init = init, .run = run, ...
 *   };
 *
 * Each mote loads a copy of the library of its own, so that global variables are those of one mote.
 * Functions of a firmware are called one at a time, and must return; a firmware has no threads. It
 * calls functions of the host only while one of its own is called. Time is in microseconds since
 * the mote was switched on, by the clock of the mote. C11 or later, or C++.
 */
#ifndef RUBICON_MOTE_H
#define RUBICON_MOTE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define RUBICON_MOTE_VERSION 1U

/* Octets of an IEEE 802.15.4 frame without its checksum, which the radio adds and removes. */
#define RUBICON_MOTE_FRAME_MIN 3U
#define RUBICON_MOTE_FRAME_MAX 125U

/* Of rubicon_mote_firmware.flags: it also runs in wall time. */
#define RUBICON_MOTE_WALL_TIME 1U

/* What became of a frame. */
enum rubicon_mote_outcome {
  RUBICON_MOTE_SENT = 0,   /* it has left the radio and was acknowledged, if it requests that */
  RUBICON_MOTE_NO_ACK = 1, /* never acknowledged, or received by nobody */
  RUBICON_MOTE_BUSY = 2,   /* the channel was never clear */
  RUBICON_MOTE_OFF = 3     /* the radio is, or was switched off meanwhile */
};

/* What functions of the host return. */
enum rubicon_mote_result {
  RUBICON_MOTE_OK = 0,
  RUBICON_MOTE_FULL = 1,    /* four frames are open */
  RUBICON_MOTE_INVALID = 2, /* no frame of that length or type, no such channel */
  RUBICON_MOTE_ABSENT = 3   /* the mote has no such sensor */
};

/* What the mote is, and what its firmware may request. Valid until `end` has returned. */
struct rubicon_mote_host {
  uint32_t version;  /* RUBICON_MOTE_VERSION of the host: members of later versions follow */
  uint16_t island;   /* number of its island: the PAN of its radio */
  uint8_t channel;   /* of its radio, 11 to 26 */
  uint8_t reserved;
  void *context;     /* first argument of all functions */

  /* A frame from its frame control field to its last octet, without checksum. The radio waits for a
   * clear channel, and repeats a frame that requests an acknowledgement until it is received. `sent`
   * is called once for each frame that was accepted. Acknowledgements are the radio's. */
  int (*send)(void *context, const uint8_t *frame, size_t length);
  void (*radio)(void *context, int on); /* it is on at the start */
  void (*timer)(void *context, uint64_t at); /* `run` is called then; a later call replaces it */
  void (*serial)(void *context, const uint8_t *octets, size_t count);
  uint32_t (*random)(void *context); /* of the run's seed: the same in each repetition */
  int (*read)(void *context, const char *sensor, int32_t *counts); /* sensor: "temperature" */
  void (*leds)(void *context, unsigned on); /* a bit for each */
  void (*log)(void *context, const char *line);
};

struct rubicon_mote_firmware {
  uint32_t version;
  uint32_t flags;
  /* Returns what the other functions receive as `mote`; NULL: it cannot run. */
  void *(*init)(uint16_t id, const struct rubicon_mote_host *host);
  void (*run)(void *mote, uint64_t now); /* at the start, and when a timer is due */
  void (*received)(void *mote, uint64_t now, const uint8_t *frame, size_t length, int rssi_dbm);
  void (*sent)(void *mote, uint64_t now, int outcome); /* in the order of `send` */
  void (*end)(void *mote);                             /* the mote is switched off; may be NULL */
};

#ifdef __cplusplus
}
#endif

#endif
