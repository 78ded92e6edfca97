/*
 * Copyright 2026 The bahrs_driver authors
 * SPDX-License-Identifier: Apache-2.0
 *
 * Find the intact frames of a BAHRS in a file, and print how many there are and how many bytes
 * they have per second of processor time, in the fastest of five runs.
 *
 * After an intact frame the next one is expected; otherwise the search continues one byte later.
 * The CRC is CRC-32/MPEG-2 over little-endian words, a word at a time with four tables.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static uint32_t tables[4][256];

static void make_tables(void)
{
  for (uint32_t value = 0; value < 256; value++) {
    uint32_t crc = value << 24;
    for (int bit = 0; bit < 8; bit++) {
      crc = crc << 1 ^ (crc >> 31 ? 0x04C11DB7u : 0);
    }
    tables[0][value] = crc;
  }
  for (int place = 1; place < 4; place++) {
    for (int value = 0; value < 256; value++) {
      uint32_t crc = tables[place - 1][value];
      tables[place][value] = crc << 8 ^ tables[0][crc >> 24];
    }
  }
}

/* Return the size of a stream message, padded and with its CRC; 0 for another header. */
static size_t frame_size(const uint8_t * header)
{
  static const uint8_t payloads[] = {
    [1] = 15, [2] = 13, [3] = 15, [4] = 10, [5] = 10, [6] = 9, [15] = 7, [31] = 14};
  uint8_t type = header[4];
  if (header[0] != 'N' || header[1] != 'E' || header[2] != 3 || header[3] ||
    type >= sizeof payloads || !payloads[type])
  {
    return 0;
  }
  return (5u + payloads[type]) / 4 * 4 + 8;
}

static int passes(const uint8_t * frame, size_t size)
{
  uint32_t crc = 0xFFFFFFFFu, word;
  for (size_t place = 0; place < size; place += 4) {
    memcpy(&word, frame + place, 4);
    crc ^= word;
    crc = tables[3][crc >> 24] ^ tables[2][crc >> 16 & 255] ^ tables[1][crc >> 8 & 255] ^
      tables[0][crc & 255];
  }
  return crc == 0;
}

static long count_frames(const uint8_t * data, size_t length)
{
  long frames = 0;
  size_t place = 0;
  while (place + 5 <= length) {
    size_t size = frame_size(data + place);
    if (size && place + size <= length && passes(data + place, size)) {
      frames++;
      place += size;
    } else {
      place++;
    }
  }
  return frames;
}

int main(int count, char ** words)
{
  FILE * file = count == 2 ? fopen(words[1], "rb") : NULL;
  if (!file || fseek(file, 0, SEEK_END)) {
    return 1;
  }
  size_t length = (size_t)ftell(file);
  uint8_t * data = malloc(length);
  rewind(file);
  if (!data || fread(data, 1, length, file) != length) {
    return 1;
  }
  make_tables();
  double best = 0;
  long frames = 0;
  for (int run = 0; run < 5; run++) {
    clock_t begin = clock();
    frames = count_frames(data, length);
    double rate = (double)length * CLOCKS_PER_SEC / (double)(clock() - begin);
    best = rate > best ? rate : best;
  }
  printf("%ld %.0f\n", frames, best);
  free(data);
  fclose(file);
  return 0;
}
