/* The contraction of unbounded scenes (Barron et al. 2022, "Mip-NeRF 360"), with the largest coordinate as the norm: in
   a cube around the middle, places stay; outside, x becomes (2 - 1/|x|) x / |x|, in units of half the cube's side. */
#include "volume.h"

enum { LEAST_LEFT = 32 };        /* places within this part of the end of contracted space count as at that part */
enum { COARSER = 8 };            /* voxels of an expanded mesh are larger, so that its places need 28 bits */

static int64_t divide(int64_t a, int64_t b)
{
    return (a + (a < 0 ? -(b / 2) : b / 2)) / b;
}

static int64_t norm_of(const int64_t at[3])
{
    int64_t most = 0;
    for (int i = 0; i < 3; i++) {
        const int64_t size = at[i] < 0 ? -at[i] : at[i];
        most = size > most ? size : most;
    }
    return most;
}

static void resize(int64_t at[3], int64_t from, int64_t to)
{
    for (int i = 0; i < 3; i++)
        at[i] = divide(at[i] * to, from);         /* < 2^36 * 2^26 */
}

void fxs_contract(int64_t at_q16[3], int64_t half_q16)
{
    const int64_t norm = norm_of(at_q16);
    if (norm > half_q16)                          /* |y| = 2 h - h^2 / |x| */
        resize(at_q16, norm, 2 * half_q16 - divide(half_q16 * half_q16, norm));
}

int64_t fxs_expand(int64_t at_q16[3], int64_t half_q16)
{
    const int64_t norm = norm_of(at_q16), least = half_q16 / LEAST_LEFT;
    if (norm <= half_q16)
        return half_q16;
    const int64_t left = 2 * half_q16 - norm;     /* |x| = h^2 / (2 h - |y|) */
    const int64_t far = divide(half_q16 * half_q16, left > least ? left : least);
    resize(at_q16, norm, far);
    return far;
}

void fxs_mesh_expand(fxs_mesh *mesh)
{
    const int64_t half = mesh->half_q16, middle = mesh->middle_q16;
    for (size_t i = 0; i < mesh->vertex_count && half; i++) {
        int64_t at[3];
        for (size_t k = 0; k < 3; k++)
            at[k] = mesh->places[3 * i + k] - middle;
        fxs_expand(at, half);
        for (size_t k = 0; k < 3; k++)
            mesh->places[3 * i + k] = (int32_t)divide(at[k], COARSER);
    }
    for (int k = 0; k < 3 && half; k++)
        mesh->origin[k] += mesh->step * ((double)middle / 65536);
    mesh->step *= half ? COARSER : 1;
    mesh->half_q16 = mesh->middle_q16 = 0;
}
