/* What a firmware of Contiki-NG exports if it is built with TARGET=cooja, and nothing else of it. Mote 1
 * sends a frame to mote 2 each second and waits for its acknowledgement; mote 2 logs what it receives
 * and sends an acknowledgement of its own, as its medium access does. */
#include <stdio.h>
#include <string.h>

void cooja_init(void);
void cooja_tick(void);

long simCurrentTime;
int simMoteID;
char simMoteIDChanged;
int simRandomSeed;
char simReceiving;
char simInDataBuffer[128];
int simInSize;
char simOutDataBuffer[128];
int simOutSize;
char simTransmitting;
char simRadioHWOn = 1;
int simSignalStrength = -200;
int simRadioChannel = 26;
int simProcessRunValue;
char simEtimerPending;
long simEtimerNextExpirationTime;
char simLoggedData[256];
int simLoggedLength;
char simLoggedFlag;

static unsigned char sequence_number;
static int transmits;
static long ack_until; /* 0: none is awaited */

static void print(const char *what, int value) {
  simLoggedLength = snprintf(simLoggedData, sizeof simLoggedData, "%s %d\n", what, value);
  simLoggedFlag = 1;
}

static void transmit(const unsigned char *frame, int size) {
  memcpy(simOutDataBuffer, frame, (size_t)size);
  simOutSize = size;
  simTransmitting = 1;
  transmits = 1;
}

static void send_hello(void) {
  unsigned char frame[27] = {0x61, 0xdc, 0, 0xcd, 0xab, 0, 0, 0, 0, 0, 0, 0, 2,
                             0,    0,    0, 0,    0,    0, 0, 1, 'h', 'e', 'l', 'l', 'o'};
  int i;
  frame[2] = ++sequence_number;
  for (i = 0; i < 8; i += 2) { /* the id of a mote, four times, low octet first */
    frame[5 + i] = 2;
    frame[6 + i] = 0;
    frame[13 + i] = 1;
    frame[14 + i] = 0;
  }
  transmit(frame, sizeof frame);
}

static void take_frame(void) {
  const int size = simInSize;
  const unsigned char first = (unsigned char)simInDataBuffer[0];
  const unsigned char number = (unsigned char)simInDataBuffer[2];
  simInSize = 0;
  if (size == 3 && first == 2) {
    if (ack_until != 0 && number == sequence_number)
      print("acknowledged", number);
    ack_until = 0;
  } else {
    const unsigned char ack[3] = {2, 0, number};
    print("received", number);
    transmit(ack, sizeof ack);
  }
}

void cooja_init(void) {
  if (simMoteID == 1) {
    simEtimerPending = 1;
    simEtimerNextExpirationTime = 1000;
  }
  print("starts", simMoteID);
}

void cooja_tick(void) {
  simProcessRunValue = 0;
  if (transmits && !simTransmitting) { /* it has left the radio */
    transmits = 0;
    if (simMoteID == 1)
      ack_until = simCurrentTime + 5;
  }
  if (simInSize > 0)
    take_frame();
  if (ack_until != 0 && simCurrentTime >= ack_until) {
    print("lost", sequence_number);
    ack_until = 0;
  }
  if (simEtimerPending && simCurrentTime >= simEtimerNextExpirationTime) {
    simEtimerNextExpirationTime += 1000;
    send_hello();
  }
  simProcessRunValue = ack_until != 0;
}
