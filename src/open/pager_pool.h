/* The pool of a pager: which chunks of 256 Gaussians are in memory, which are wanted, and which are read next. The pool
 * has places for some of a scene's chunks. It starts no thread and reads no file: the pager's threads call these
 * functions. Between two turns the places of chunks do not change, so frames may draw from the pool. */
#ifndef FXS_PAGER_POOL_H
#define FXS_PAGER_POOL_H

#include <fixsplat/pager.h>
#include <fixsplat/internal/message.h>
#include <fixsplat/internal/parts.h>

#include "src/core/pool_places.h"

/* A chunk is lost after this many failed reads. An error is reported after this many failed reads in a row. */
enum { FXS_PAGER_TRIES = 3 };

/* A chunk to read, and the free place for it. */
typedef struct fxs_arrival {
    uint32_t chunk, place;
} fxs_arrival;

typedef struct fxs_pager_pool {
    unsigned char *rows;               /* `room` places of chunk_bytes each */
    uint32_t chunks, room;             /* all chunks, places */
    size_t chunk_bytes, memory;

    /* The fields from here to `queue` are for the caller's thread only. */
    uint32_t *places;                  /* place of each chunk; FXS_NOTHING: not in the pool */
    fxs_place *list;
    fxs_places in_pool;                /* with both arrays */
    uint32_t *asked;                   /* last turn in which a chunk was wanted */
    int has_asked;
    uint32_t *wanted, wanted_count;    /* chunks that the current frames lack, most needed first */

    /* The pager's lock guards the fields below. */
    uint32_t *queue, queue_count, queue_next;
    uint32_t *spare, spare_count;      /* free places */
    uint8_t *tries, *taken;            /* failed reads of each chunk; 1: the chunk is being read */
    fxs_arrival *arrived;              /* chunks that were read since the last turn */
    uint32_t arrived_count, lost, failures;
    uint64_t bytes_read;
} fxs_pager_pool;

/* Allocates a pool of at most `bytes` bytes (0: 256 MiB) for the chunks of a scene, and lets the scene draw from it.
   After an error, fxs_pager_pool_free is still needed. */
int fxs_pager_pool_create(fxs_pager_pool *p, fxs_scene *scene, size_t bytes, const char *name, fxs_message *message);
void fxs_pager_pool_free(fxs_pager_pool *p);

/* Returns memory for `count` items from fxs_aligned_allocate, and adds it to the pool's use of memory. Returns null if
   memory runs out. */
void *fxs_pager_allocate(fxs_pager_pool *p, uint64_t count, size_t size);

/* Returns the rows (Gaussian codes) of a place. */
unsigned char *fxs_pager_rows(const fxs_pager_pool *p, uint32_t place);

/* Notes that the caller's frames draw a chunk (there = 1) or lack it (0). */
void fxs_pager_pool_want(fxs_pager_pool *p, uint32_t chunk, int there);

/* The caller holds the pager's lock for the functions below. */

/* Puts the chunks that have arrived into their places, makes the queue of chunks to read and evicts chunks for them.
   Fills in the counts of `state`. */
void fxs_pager_pool_turn(fxs_pager_pool *p, fxs_pager_state *state);

/* Puts the root, the coarsest chunk, into the pool. Its rows are in place `place`. */
void fxs_pager_pool_root(fxs_pager_pool *p, uint32_t place);

/* Takes at most `most` chunks from the queue, with a free place for each. Returns their number. */
uint32_t fxs_pager_pool_take(fxs_pager_pool *p, fxs_arrival *list, uint32_t most);

/* Notes which chunks were read, for the next turn. good[i] = 1: chunk i is valid and its rows are in its place.
   unread = 1: the read itself failed. */
void fxs_pager_pool_note(fxs_pager_pool *p, const fxs_arrival *list, uint32_t count, const uint8_t *good, int unread);

#endif
