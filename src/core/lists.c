/* Makes the lists of splats for macro tiles of 2x2 tiles. Counts the keys (entries) of each list, then fills as many
 * lists as fit in the memory. Parallel jobs each take a part of the splats. */
#include "lister.h"
#include "lists.h"
#include "memory.h"

/* The first pass over the splats notes its results for the second pass. Four numbers in fxs_frame.next describe the
   notes of one part of the splats: number of notes, index of the first splat that is not noted, offset and capacity of
   the notes. */
enum { NOTED, FROM, NOTES, ROOM };

static uint32_t *next_of(const fxs_frame *f, uint32_t part)
{
    return f->next + (size_t)part * (f->macros + FXS_NEXT_MORE);
}

static uint32_t *notes_of(const fxs_frame *f, uint32_t part)
{
    return next_of(f, part) + f->macros;
}

fxs_lister fxs_lister_of(const fxs_frame *f, uint32_t part)
{
    const uint32_t *notes = notes_of(f, part);
    return (fxs_lister){&f->view, f->splats, f->bounds, f->boxes, f->depths, f->context->config.kernels->spans,
                        f->context->config.kernels->note, f->first_macro, f->last_macro, next_of(f, part),
                        f->spare + notes[NOTES], notes[ROOM], 0, notes[NOTED], notes[FROM]};
}

static void count_part(void *argument, uint32_t part)
{
    fxs_frame *f = argument;
    const uint32_t end = fxs_part(f->blocks, f->parts, part + 1);
    memset(next_of(f, part), 0, f->macros * sizeof *f->next);
    fxs_lister l = fxs_lister_of(f, part);
    for (uint32_t block = fxs_part(f->blocks, f->parts, part); block < end; block++)
        fxs_bin_count(&l, f->block_slots[block], f->block_counts[block]);
    notes_of(f, part)[NOTED] = l.noted;
    notes_of(f, part)[FROM] = l.from;
}

static void fill_part(void *argument, uint32_t part)
{
    fxs_frame *f = argument;
    const uint32_t end = fxs_part(f->blocks, f->parts, part + 1);
    fxs_lister l = fxs_lister_of(f, part);
    fxs_bin_fill_noted(&l, f->keys);
    for (uint32_t block = fxs_part(f->blocks, f->parts, part); block < end; block++) {
        const uint32_t slot = f->block_slots[block], last = slot + f->block_counts[block];
        const uint32_t from = slot > l.from ? slot : l.from;
        if (from < last)
            fxs_bin_fill(&l, from, last - from, f->keys);
    }
    notes_of(f, part)[NOTED] = notes_of(f, part)[FROM] = 0;    /* the first pass's notes are lost, because sorting
                                                                  reuses their memory */
}

static void share_notes(fxs_frame *f)
{
    uint32_t before = 0, block = 0;
    for (uint32_t part = 0; part < f->parts; part++) {
        uint32_t *notes = notes_of(f, part), own = 0;
        for (const uint32_t end = fxs_part(f->blocks, f->parts, part + 1); block < end; block++)
            own += f->block_counts[block];
        notes[NOTED] = notes[FROM] = 0;
        notes[NOTES] = fxs_part(f->key_capacity, f->count ? f->count : 1, before);
        before += own;
        notes[ROOM] = fxs_part(f->key_capacity, f->count ? f->count : 1, before) - notes[NOTES];
    }
}

void fxs_lists_count(fxs_frame *f)
{
    const uint64_t start = fxs_now(f);
    const uint32_t across = fxs_macros(f->view.tiles_x);
    f->first_macro = (uint32_t)f->first_row / FXS_MACRO * across;
    f->last_macro = fxs_macros(f->end_row) * across - 1;
    share_notes(f);
    fxs_frame_run(f, count_part, f->parts);
    memset(f->tile_counts, 0, f->tiles * sizeof *f->tile_counts);
    memset(f->lengths, 0, f->macros * sizeof *f->lengths);
    for (uint32_t part = 0; part < f->parts; part++) {
        const uint32_t *next = next_of(f, part);
        for (uint32_t macro = 0; macro < f->macros; macro++)
            f->lengths[macro] += next[macro];
    }
    f->stats.nanoseconds[FXS_BIN] += fxs_now(f) - start;
}

int fxs_lists_rows_fit(const fxs_frame *f)
{
    const uint32_t across = fxs_macros(f->view.tiles_x);
    for (uint32_t row = f->first_macro; row <= f->last_macro; row += across) {
        uint32_t room = f->key_capacity;
        for (uint32_t macro = row; macro < row + across; macro++) {
            if (f->lengths[macro] > room)
                return 0;
            room -= f->lengths[macro];
        }
    }
    return 1;
}

void fxs_lists_fill(fxs_frame *f, uint32_t end)
{
    const uint32_t across = fxs_macros(f->view.tiles_x), row_end = (f->first_macro / across + 1) * across;
    const uint64_t start = fxs_now(f);
    uint32_t used = 0, macro = f->first_macro;
    for (uint32_t room = f->key_capacity; macro < end && f->lengths[macro] <= room; macro++)
        room -= f->lengths[macro];
    if (!f->draw_tile)
        macro = f->first_macro % across || macro < row_end ? (macro < row_end ? macro : row_end)
                                                           : macro / across * across;
    f->last_macro = macro - 1;
    for (macro = f->first_macro; macro <= f->last_macro; macro++)
        for (uint32_t part = 0; part < f->parts; part++) {
            uint32_t *next = &next_of(f, part)[macro], count = *next;
            *next = used;
            used += count;
        }
    fxs_frame_run(f, fill_part, f->parts);
    f->stats.nanoseconds[FXS_BIN] += fxs_now(f) - start;
}

static size_t start_of_list(const fxs_frame *f, uint32_t macro)
{
    return next_of(f, f->parts - 1)[macro] - f->lengths[macro];
}

const fxs_key *fxs_list_of(const fxs_frame *f, uint32_t macro)
{
    return f->keys + start_of_list(f, macro);
}

uint32_t *fxs_list_room(const fxs_frame *f, uint32_t macro)
{
    return (uint32_t *)(void *)(f->spare + start_of_list(f, macro));
}

const fxs_key *fxs_list_sort(const fxs_frame *f, uint32_t macro)
{
    const size_t at = start_of_list(f, macro);
    f->context->config.kernels->sort(f->keys + at, f->spare + at, f->lengths[macro]);
    return f->keys + at;
}

int fxs_tile_of(const fxs_frame *f, uint32_t macro, int32_t i, uint32_t *tile)
{
    const int32_t across = (int32_t)fxs_macros(f->view.tiles_x);
    const int32_t row = (int32_t)macro / across * FXS_MACRO + i / FXS_MACRO;
    const int32_t column = (int32_t)macro % across * FXS_MACRO + i % FXS_MACRO;
    *tile = fxs_tiles_above(f, row) + (uint32_t)column;
    return row >= f->first_row && row < f->end_row && column >= f->first_column && column < f->end_column &&
           (f->only_tile == FXS_NOTHING || f->only_tile == *tile);
}
