/* Builds a .splat4d of splats4D, version 1. */
#ifndef SPLAT4D_BYTES_H
#define SPLAT4D_BYTES_H

#include "scene_bytes.h"

#if defined(FXS_WITH_ZSTD) && defined(FXS_WITH_CJSON)
#define WITH_SPLAT4D
#include <zstd.h>

enum { S4_ATTRIBUTES = 5, S4_MOST = 1 << 14 };

static const int s4_channels[S4_ATTRIBUTES] = {3, 4, 3, 1, 3};   /* position, rotation, colour, opacity, scale */

/* Returns number `channel` of an attribute of a Gaussian in a frame; frame -1: the number of the static section. */
typedef int s4_number(int gaussian, int attribute, int channel, int frame);

typedef struct splat4d_bytes {
    int count, frames, group;             /* Gaussians, frames, frames in a group */
    int (*is_still)(int gaussian, int attribute);
    s4_number *number;
    const char *extra;                    /* JSON before the groups */
    uint8_t body[1 << 19];
    size_t body_size;
    char groups[2048];
    size_t header_size;
} splat4d_bytes;

static inline uint32_t s4_folded(int number)
{
    return number < 0 ? 2 * (uint32_t)(-(number + 1)) + 1 : 2 * (uint32_t)number;
}

static inline int s4_width(const uint32_t *numbers, size_t count)
{
    uint32_t most = 0;
    for (size_t i = 0; i < count; i++)
        most = numbers[i] > most ? numbers[i] : most;
    return most < 256 ? 1 : most < 65536 ? 2 : 4;
}

static inline uint8_t *s4_head(uint8_t *to, int attribute, int kind, int width, size_t count, size_t packed)
{
    *to++ = (uint8_t)attribute;
    *to++ = (uint8_t)kind;
    *to++ = (uint8_t)width;
    for (int i = 0; i < 4; i++)
        *to++ = (uint8_t)(count >> 8 * i);
    for (int i = 0; i < 4; i++)
        *to++ = (uint8_t)(packed >> 8 * i);
    return to;
}

static inline size_t s4_pack(const uint32_t *numbers, size_t count, int width, uint8_t *to)
{
    static uint8_t planes[4 * S4_MOST];
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < width; k++)
            planes[(size_t)k * count + i] = (uint8_t)(numbers[i] >> 8 * k);
    return ZSTD_compress(to, S4_MOST, planes, count * (size_t)width, 3);
}

static inline void s4_put_static(splat4d_bytes *s, int attribute, const uint32_t *numbers, size_t count)
{
    uint8_t *head = s->body + s->body_size;
    const int width = s4_width(numbers, count);
    const size_t packed = s4_pack(numbers, count, width, head + 11);
    s4_head(head, attribute, 2, width, count, packed);
    s->body_size += 11 + packed;
}

static inline void s4_put_static_section(splat4d_bytes *s)
{
    static const int order[S4_ATTRIBUTES] = {0, 4, 2, 3, 1};
    uint32_t numbers[S4_MOST];
    for (int a = 0; a < S4_ATTRIBUTES; a++) {
        memset(numbers, 0, sizeof numbers);
        for (int i = 0; i < s->count; i++)
            numbers[i / 8] |= s->is_still(i, a) ? 128u >> i % 8 : 0;
        s4_put_static(s, a, numbers, (size_t)(s->count + 7) / 8);
    }
    for (int n = 0; n < S4_ATTRIBUTES; n++) {
        const int a = order[n];
        size_t count = 0;
        for (int i = 0; i < s->count; i++)
            for (int k = 0; k < s4_channels[a]; k++) {
                const int number = s->number(i, a, k, -1);
                numbers[count++] = a == 0 || a == 4 ? s4_folded(number - (i ? s->number(i - 1, a, k, -1) : 0))
                                   : a == 1 ? (uint32_t)(number + 128) : (uint32_t)number;
            }
        s4_put_static(s, a, numbers, count);
    }
}

static inline size_t s4_numbers(const splat4d_bytes *s, int attribute, int first, int end, uint32_t *numbers)
{
    size_t count = 0;
    for (int f = first; f < end; f++)
        for (int i = 0; i < s->count; i++)
            for (int k = 0; k < s4_channels[attribute] && !s->is_still(i, attribute); k++)
                numbers[count++] = s4_folded(s->number(i, attribute, k, f) -
                                             (f % s->group ? s->number(i, attribute, k, f - 1) : 0));
    return count;
}

static inline void s4_put_group(splat4d_bytes *s, int first, int end)
{
    uint8_t heads[2 + 11 * 2 * S4_ATTRIBUTES], payload[4 * S4_MOST], *to = heads + 2;
    uint32_t numbers[S4_MOST];
    size_t size_of_payload = 0;
    int streams = 0;
    for (int kind = 0; kind < 2; kind++)
        for (int a = 0; a < S4_ATTRIBUTES; a++) {
            const size_t count = s4_numbers(s, a, first + kind, kind ? end : first + 1, numbers);
            if (!count)
                continue;
            const int width = s4_width(numbers, count);
            const size_t packed = s4_pack(numbers, count, width, payload + size_of_payload);
            to = s4_head(to, a, kind, width, count, packed);
            size_of_payload += packed;
            streams++;
        }
    heads[0] = (uint8_t)streams;
    heads[1] = 0;
    const size_t head = (size_t)(to - heads), length = strlen(s->groups);
    snprintf(s->groups + length, sizeof s->groups - length, "%s{\"offset\":%zu,\"len\":%zu,\"f0\":%d,\"f1\":%d}",
             first ? "," : "", s->header_size + s->body_size, head + size_of_payload, first, end - 1);
    memcpy(s->body + s->body_size, heads, head);
    memcpy(s->body + s->body_size + head, payload, size_of_payload);
    s->body_size += head + size_of_payload;
}

/* Writes the file to `bytes`. The header is padded to 2048 bytes with blanks, so that offsets are known before. */
static inline void splat4d_make(splat4d_bytes *s)
{
    s->header_size = 12 + 2048;
    s->body_size = 0;
    s->groups[0] = '\0';
    s4_put_static_section(s);
    const size_t still = s->body_size;
    for (int f = 0; f < s->frames; f += s->group)
        s4_put_group(s, f, f + s->group < s->frames ? f + s->group : s->frames);
    size = 0;
    put("SP4D%c%c%c%c", 1, 'x', 'x', 'x');
    bytes[5] = bytes[6] = bytes[7] = 0;
    put_u32(2048);
    put("{\"n\":%d,\"t\":%d,%s,\"static_section\":{\"offset\":%zu,\"len\":%zu},\"gops\":[%s]}", s->count, s->frames,
        s->extra, s->header_size, still, s->groups);
    CHECK(size < s->header_size);
    memset(bytes + size, ' ', s->header_size - size);
    memcpy(bytes + s->header_size, s->body, s->body_size);
    size = s->header_size + s->body_size;
    put_file(size);
}

#endif
#endif
