/* Moves the chunks of a moving scene to a time: writes a chunk's header and rows as those of a still scene, which the
 * stages then read. */
#include "animate.h"

#include "memory.h"

FXS_STAGE int fxs_motion_read(fxs_motion_header *header, const fxs_scene *scene)
{
    memcpy(header, scene->motion, sizeof *header);
    fxs_motion_header_turn(header);
    const uint32_t still = fxs_chunk_bytes(scene->profile, scene->sh_degree);
    return fxs_motion_header_valid(header, fxs_scene_chunks(scene)) &&
                   scene->chunk_bytes == still + fxs_motion_bytes(header->degree, header->flags)
               ? 0 : FXS_ERR_SCENE;
}

uint32_t fxs_most_alive(const fxs_scene *scene)
{
    fxs_motion_header header;
    return !scene->motion || fxs_motion_read(&header, scene) ? scene->chunk_count : header.most_chunks;
}

FXS_STAGE int32_t fxs_time_of(const fxs_motion_header *motion, int64_t time_q32)
{
    const int64_t duration = motion->duration_q16, time = time_q32 >> 16;
    if (motion->flags & FXS_MOTION_LOOPS)
        return (int32_t)((time % duration + duration) % duration);
    return (int32_t)(time < 0 ? 0 : time < duration ? time : duration);
}

/* u = (time - middle) / 2^(unit - 16 seconds), Q15, limited to +-32767. */
FXS_STAGE int fxs_moment_of(fxs_moment *out, const fxs_scene *scene, uint32_t chunk, int32_t time_q16)
{
    fxs_chunk_motion m;
    memcpy(&m, scene->motion + sizeof(fxs_motion_header) + (size_t)chunk * sizeof m, sizeof m);
    fxs_chunk_motion_turn(&m);
    if (!fxs_chunk_motion_valid(&m))
        return FXS_ERR_SCENE;
    if (time_q16 < m.from_q16 || time_q16 >= m.to_q16)
        return 0;
    const int64_t away = (int64_t)time_q16 - m.middle_q16;
    const int64_t u = m.unit > 15 ? away >> (m.unit - 15) : away * (1 << (15 - m.unit));
    const int32_t u_q15 = (int32_t)(u < -32767 ? -32767 : u > 32767 ? 32767 : u);
    const int32_t square_q15 = fxs_mul_q15(u_q15, u_q15);
    const fxs_moment moment = {{(int16_t)u_q15, (int16_t)square_q15, (int16_t)fxs_mul_q15(square_q15, u_q15)},
                               m.shift, 1};
    *out = moment;
    return 1;
}

FXS_STAGE fxs_motion_rows fxs_motion_rows_of(const fxs_scene *scene, const fxs_motion_header *motion)
{
    const fxs_motion_rows rows = {fxs_chunk_bytes(scene->profile, scene->sh_degree), motion->degree, motion->cut_q16,
                                  (uint8_t)((motion->flags & FXS_MOTION_TURNS) != 0),
                                  (uint8_t)((motion->flags & FXS_MOTION_FADES) != 0), {0}};
    return rows;
}

#ifndef __CUDACC__
fxs_motion_info fxs_scene_motion(const fxs_scene *scene)
{
    fxs_motion_header h;
    if (!scene->motion || fxs_motion_read(&h, scene))
        return (fxs_motion_info){.duration_q32 = 0};
    return (fxs_motion_info){(int64_t)h.duration_q16 << 16, (int64_t)h.rate_q16 << 16,
                             (h.flags & FXS_MOTION_LOOPS) != 0, h.most_chunks};
}

uint32_t fxs_scene_alive(const fxs_scene *scene, int64_t time_q32)
{
    fxs_motion_header h;
    uint32_t count = 0;
    if (!scene->motion || fxs_motion_read(&h, scene))
        return scene->chunk_count * FXS_CHUNK;
    const int32_t time_q16 = fxs_time_of(&h, time_q32);
    for (uint32_t i = 0; i < scene->chunk_count; i++) {
        fxs_moment moment;
        count += fxs_moment_of(&moment, scene, i, time_q16) > 0;
    }
    return count * FXS_CHUNK;
}

static void put_word(unsigned char *row, uint32_t g, uint32_t word)
{
    word = fxs_little_32(word);
    memcpy(row + 4 * g, &word, sizeof word);
}

static void put_half(unsigned char *row, uint32_t g, uint16_t half)
{
    half = fxs_little_16(half);
    memcpy(row + 2 * g, &half, sizeof half);
}

/* Profile small keeps the upper 11 bits of a position code, and 23 bits of the rotation word. */
static void put_small(unsigned char *out, const unsigned char *rows, uint32_t g, const fxs_codes *codes)
{
    const uint32_t x = codes->position[0] >> 5, y = codes->position[1] >> 5, z = codes->position[2] >> 5;
    const uint32_t rotation = codes->rotation;
    put_word(out + FXS_SMALL_A, g, x | y << 11 | (rotation >> 10 & 3) << 22 | (codes->colour & 0xff000000u));
    put_word(out + FXS_SMALL_B, g, (fxs_word_at(rows + FXS_SMALL_B, g) & 0x7ffff800u) | z | (rotation >> 9 & 1) << 31);
    put_word(out + FXS_SMALL_C, g, (fxs_word_at(rows + FXS_SMALL_C, g) & 0xfffffu) | (rotation & 0xfff00000u));
    out[FXS_SMALL_D + g] = (unsigned char)(rotation >> 12);
}

void fxs_animate_c(const fxs_scene *scene, const fxs_motion_rows *motion, const fxs_moment *moment,
                   uint32_t scale_step_q24, const unsigned char *rows, unsigned char *out)
{
    for (uint32_t g = 0; g < FXS_CHUNK; g++) {
        fxs_codes codes = fxs_codes_of(scene, rows, g);
        fxs_animate_codes(&codes, motion, rows, g, moment, scene->profile, scale_step_q24);
        if (scene->profile == FXS_PROFILE_SMALL) {
            put_small(out, rows, g, &codes);
            continue;
        }
        for (uint32_t i = 0; i < 3; i++)
            put_half(out + FXS_ROW_POSITION, FXS_CHUNK * i + g, codes.position[i]);
        put_word(out + FXS_ROW_ROTATION, g, codes.rotation);
        put_word(out + FXS_ROW_SCALE, g, codes.scale);
        put_word(out + FXS_ROW_COLOUR, g, codes.colour);
    }
}

int fxs_animate_chunk(const fxs_kernels *kernels, const fxs_scene *scene, const fxs_motion_rows *motion, uint32_t chunk,
                      const fxs_moment *moment, unsigned char *room)
{
    fxs_chunk header;
    const int error = fxs_chunk_read(&header, scene, chunk);
    if (error)
        return error;
    const uint32_t scale_step_q24 = header.scale_step_q24;
    fxs_chunk_turn(&header);
    memcpy(room, &header, sizeof header);
    kernels->animate(scene, motion, moment, scale_step_q24, fxs_rows(scene, chunk), room + sizeof header);
    return 0;
}

fxs_scene fxs_animated_scene(const fxs_scene *scene, const unsigned char *room)
{
    fxs_scene out = *scene;
    out.chunks = room;
    out.rows = room + sizeof(fxs_chunk);
    out.chunk_count = 1;
    out.chunk_bytes = fxs_chunk_bytes(scene->profile, scene->sh_degree);
    out.places = 0;
    out.motion = 0;
    return out;
}

void fxs_animate_sh(const fxs_scene *scene, uint32_t chunk, unsigned char *room)
{
    const uint32_t at = scene->profile == FXS_PROFILE_SMALL ? FXS_SMALL_SH : FXS_ROW_SH;
    memcpy(room + sizeof(fxs_chunk) + at, fxs_rows(scene, chunk) + at,
           fxs_chunk_bytes(scene->profile, scene->sh_degree) - at);
}
#endif
