/* SPDX-License-Identifier: GPL-3.0-or-later
 * LASzip streams: point records as they stand in a LAS file, compressed and decompressed chunk by chunk.
 *
 * Functions return 0, or a code below with a message in `message` (NUL-terminated, cut to its capacity).
 * `threads`: 1 works in the caller's thread; 0 one per processor; otherwise that many. Bytes do not depend on it.
 * A handle is for one thread at a time. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { SWATH_LAZ_OK = 0, SWATH_LAZ_DATA = 1, SWATH_LAZ_FILE = 2, SWATH_LAZ_USAGE = 3, SWATH_LAZ_PANIC = 4 };

/* The bits of the crate's DecompressionSelection. */
enum {
  SWATH_LAZ_FIELD_Z = 1 << 0,
  SWATH_LAZ_FIELD_CLASSIFICATION = 1 << 1,
  SWATH_LAZ_FIELD_FLAGS = 1 << 2,
  SWATH_LAZ_FIELD_INTENSITY = 1 << 3,
  SWATH_LAZ_FIELD_SCAN_ANGLE = 1 << 4,
  SWATH_LAZ_FIELD_USER_DATA = 1 << 5,
  SWATH_LAZ_FIELD_POINT_SOURCE = 1 << 6,
  SWATH_LAZ_FIELD_GPS_TIME = 1 << 7,
  SWATH_LAZ_FIELD_RGB = 1 << 8,
  SWATH_LAZ_FIELD_NIR = 1 << 9,
  SWATH_LAZ_FIELD_WAVES = 1 << 10,
  SWATH_LAZ_FIELD_EXTRA = 1 << 11
};

typedef struct swath_laz_reader swath_laz_reader;
typedef struct swath_laz_writer swath_laz_writer;

/* The record data of the laszip VLR. `chunk_points` points per chunk; 0: chunks of variable size. `size` gets the bytes
 * needed; they are written where `capacity` holds them (USAGE otherwise). */
int swath_laz_vlr(uint8_t point_format, uint16_t extra_bytes, uint32_t chunk_points, uint8_t* out, size_t capacity, size_t* size,
                  char* message, size_t message_capacity);

/* Bytes that the caller reads: `read` fills `to` with n bytes from byte `at` and returns 0, or something else where it cannot. It is called
 * in the thread of the reader's caller and never beyond `size`; `context` must outlive the reader. */
typedef struct {
  void* context;
  uint64_t size;
  int (*read)(void* context, uint64_t at, uint8_t* to, size_t n);
} swath_laz_source;

/* Opens the points of `source`, or where that is NULL of the file `path`. `data_start`: offset to point data; `vlr`: record data of the
 * laszip VLR. The chunk table is read and held against the file's size and `point_count`. */
int swath_laz_reader_open(const char* path, const swath_laz_source* source, uint64_t data_start, const uint8_t* vlr, size_t vlr_size,
                          uint8_t point_format, uint16_t record_length, uint64_t point_count, uint32_t threads, swath_laz_reader** reader,
                          char* message, size_t message_capacity);
/* The same for some chunks of a file of layered chunks or of chunks of variable size: those at these offsets, one after the other. */
int swath_laz_reader_open_chunks(const char* path, const swath_laz_source* source, const uint8_t* vlr, size_t vlr_size,
                                 uint8_t point_format, uint16_t record_length, const uint64_t* offsets, const uint64_t* bytes,
                                 const uint64_t* points, size_t chunks, uint32_t threads, swath_laz_reader** reader, char* message,
                                 size_t message_capacity);
/* Fields that are decompressed, a sum of SWATH_LAZ_FIELD_*; x, y, return numbers and scanner channel always are. Others hold what the first
 * record of the chunk has. To be called before the first read; without effect in point formats 0 to 5, whose records are one stream. */
void swath_laz_reader_select(swath_laz_reader* reader, uint32_t fields);
/* The next n records into `out` (n * record_length bytes); asking beyond point_count is USAGE. */
int swath_laz_reader_read(swath_laz_reader* reader, uint8_t* out, uint64_t n, char* message, size_t message_capacity);
void swath_laz_reader_close(swath_laz_reader* reader);

/* Appends compressed points to an existing file from byte `position` on. */
int swath_laz_writer_open(const char* path, uint64_t position, const uint8_t* vlr, size_t vlr_size, uint32_t threads,
                          swath_laz_writer** writer, char* message, size_t message_capacity);
/* n records; only with chunks of fixed size. */
int swath_laz_writer_write(swath_laz_writer* writer, const uint8_t* points, uint64_t n, char* message, size_t message_capacity);
/* `chunks` chunks of `counts[i]` records each (none 0), one after the other in `points`; only with chunks of variable size.
 * `offsets[i]`, `bytes[i]` get the place of each in the file. */
int swath_laz_writer_write_chunks(swath_laz_writer* writer, const uint8_t* points, const uint64_t* counts, size_t chunks, uint64_t* offsets,
                                  uint64_t* bytes, char* message, size_t message_capacity);
/* Writes what is left and the chunk table; `end` gets the file position after it. */
int swath_laz_writer_finish(swath_laz_writer* writer, uint64_t* end, char* message, size_t message_capacity);
void swath_laz_writer_close(swath_laz_writer* writer);

#ifdef __cplusplus
}
#endif
