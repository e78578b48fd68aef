/* Which chunk (256 Gaussians) each place of a pool holds. Places whose chunks may be evicted form a list in the order
 * of last use. The coarsest chunks of a scene with levels of detail always stay. */
#ifndef FXS_POOL_PLACES_H
#define FXS_POOL_PLACES_H

#include <fixsplat/fixsplat.h>

enum {
    FXS_PLACES_LEAST = 16,
    FXS_KEPT_SHARE = 8, FXS_KEPT_MOST = 256   /* 1/8 of the pool keeps coarse chunks, 256 at most */
};

typedef struct fxs_place {
    uint32_t chunk;                /* FXS_NOTHING: the place is free or being filled */
    uint32_t drawn;                /* last turn in which the chunk was drawn */
    uint32_t newer, older;
} fxs_place;

typedef struct fxs_places {
    uint32_t *of_chunks;           /* place of each chunk; FXS_NOTHING: not in the pool */
    fxs_place *list;               /* the places */
    uint32_t leaves, chunks, room; /* chunks of the finest level, all chunks, places */
    uint32_t kept;                 /* number of coarse chunks that are never evicted, from chunk `leaves` on */
    uint32_t there, turn;          /* chunks in the pool; number of the current turn, from 1 on */
    uint32_t newest, oldest;
} fxs_places;

/* Returns the number of places of a pool of `bytes` bytes with `place_bytes` a place, at most the number of the scene's
   chunks. Returns 0 if the pool is smaller than FXS_PLACES_LEAST places. */
uint32_t fxs_places_room(const fxs_scene *scene, uint64_t bytes, uint64_t place_bytes);

/* Empties a pool of `room` places. The arrays have one element a chunk and one a place. */
void fxs_places_init(fxs_places *p, const fxs_scene *scene, uint32_t room, uint32_t *of_chunks, fxs_place *list);

/* Notes that the chunk in a place is drawn in this turn. */
void fxs_places_note_drawn(fxs_places *p, uint32_t place);

/* Puts a chunk into a free place. */
void fxs_places_settle(fxs_places *p, uint32_t chunk, uint32_t place);

/* Evicts the least recently drawn chunk, unless it was drawn in turn `since` or later. Returns its place or
   FXS_NOTHING. */
uint32_t fxs_places_evict(fxs_places *p, uint32_t since);

#endif
